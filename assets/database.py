"""What readers use: the database, the site, and the report of what changed; and their checks."""

import datetime as dt
from collections.abc import Sequence
from typing import Final

import dagster as dg
import polars as pl

from assets.lake import Folders, incremental
from assets.report import write_report
from assets.workers import side_by_side
from pipeline.tables.schemas import TABLES
from warehouse.derive import database as duck
from warehouse.editions.verify import verify
from warehouse.queries.change_report import change_report
from warehouse.store.database import open_database

ERROR, WARN = dg.AssetCheckSeverity.ERROR, dg.AssetCheckSeverity.WARN
LAKE_ONLY: Final = ("ensemble",)
"""Tables that are not in the database: 200 rows per tow would make up most of it."""

SHOWING: Final = ("dashboards", "pipeline", "warehouse")
"""What pages are made with: also their words."""

IN_DATABASE: Final = [name for name in TABLES if name not in LAKE_ONLY]


@dg.asset(deps=IN_DATABASE)
@incremental(is_whole=duck.is_whole)
def warehouse_database(folders: Folders, about_archive: pl.DataFrame) -> pl.DataFrame:
    """All tables in one DuckDB file, swapped in whole, with the meaning of each column."""
    tables = {name: folders.store.read(name) for name in IN_DATABASE}
    return duck.warehouse_database(tables, about_archive, folders.store)


@dg.asset(deps=[warehouse_database])
@incremental(code=SHOWING, is_whole=lambda store: (store.root / "site" / "index.html").exists())
def site(folders: Folders) -> pl.DataFrame:
    """Pages people can look at, swapped in whole."""
    from dashboards.site.render import build_site  # noqa: PLC0415 - Altair takes a second

    made = build_site(folders.store, side_by_side)
    return pl.DataFrame([made])


@dg.asset(deps=[warehouse_database])
@incremental()
def report(folders: Folders) -> pl.DataFrame:
    """What changed since the last report: a page, JSON, and its headlines."""
    news = write_report(folders.store, dt.datetime.now().astimezone())
    return pl.DataFrame({"headline": news.headlines}, schema={"headline": pl.String})


def _result(
    wrong: Sequence[object], severity: dg.AssetCheckSeverity = ERROR
) -> dg.AssetCheckResult:
    """Passed where nothing is wrong; else with the first twenty rows or sentences of it."""
    lines = [" ".join(map(str, w)) if isinstance(w, tuple) else str(w) for w in wrong[:20]]
    return dg.AssetCheckResult(
        passed=not wrong,
        severity=severity,
        metadata={"number": len(wrong), "first": dg.MetadataValue.json(lines)},
    )


@dg.asset_check(asset=warehouse_database, blocking=True)
def tables_fit_their_schemas(folders: Folders) -> dg.AssetCheckResult:
    """Every table of the database has the columns, types and ranges it promises."""
    with open_database(folders.store.database) as db:
        return _result(
            [n for n in IN_DATABASE if not TABLES[n].is_valid(db.sql(f'FROM "{n}"').pl())]
        )


@dg.asset_check(asset="quarantine", additional_deps=["tows", "samples"])
def every_listed_tow_accounted_for(folders: Folders) -> dg.AssetCheckResult:
    """No listed tow of the seasons read is neither accepted nor set aside."""
    store = folders.store
    known = pl.concat([store.read(name, columns=["tow_id"]) for name in ("tows", "quarantine")])
    return _result(store.read("samples").join(known, on="tow_id", how="anti")["tow_id"].to_list())


@dg.asset_check(
    asset="curves", additional_ins={"tows": dg.AssetIn("tows"), "methods": dg.AssetIn("methods")}
)
def every_tow_has_a_curve_row(
    curves: pl.DataFrame, tows: pl.DataFrame, methods: pl.DataFrame
) -> dg.AssetCheckResult:
    """Every method has a curve row for every tow."""
    asked = methods.select("method").join(tows.select("tow_id"), how="cross")
    return _result(asked.join(curves, on=["method", "tow_id"], how="anti").rows())


@dg.asset_check(asset="quarantine", additional_deps=["tows"])
def few_tows_set_aside(folders: Folders) -> dg.AssetCheckResult:
    """No more of the listed tows are set aside than the settings allow."""
    store = folders.store
    aside = store.read("quarantine").filter(lost="tow")["tow_id"].unique().sort().to_list()
    listed = len(aside) + store.count_rows("tows")
    return _result(aside if len(aside) > folders.settings.set_aside_share * listed else [], WARN)


@dg.asset_check(asset=warehouse_database, blocking=True)
def log_factors_stayed(folders: Folders) -> dg.AssetCheckResult:
    """No season's log factor jumped since the last report."""
    limit = folders.settings.factor_jump
    moved = change_report(folders.store).factors
    return _result([tuple(f.values()) for f in moved if abs(f["ratio"] - 1.0) > limit], WARN)


@dg.asset_check(asset=warehouse_database, blocking=True)
def boats_stayed_within_their_intervals(folders: Folders) -> dg.AssetCheckResult:
    """No line of a draft moved by more than its intervals since the last report."""
    columns = ("to_edition", "fsn_no", "rowers", "crew_class")
    beyond = change_report(folders.store).beyond_interval
    return _result([tuple(line[name] for name in columns) for line in beyond], WARN)


@dg.asset_check(asset=warehouse_database, blocking=True)
def editions_can_be_made_again(folders: Folders) -> dg.AssetCheckResult:
    """Published editions are what they were, and archive and code of today give them again."""
    wrong = [f for f in verify(folders.store, afresh=False).findings if f.wrong]
    changed = any(f.kind == "altered" for f in wrong)
    return _result([f"{f.edition}: {f.message}" for f in wrong], ERROR if changed else WARN)


@dg.asset_check(asset=warehouse_database, blocking=True)
def nothing_unforeseen(folders: Folders) -> dg.AssetCheckResult:
    """Our own code failed on no table; where it did, rows are missing."""
    store = folders.store
    failed = [f"table {name}" for name in TABLES if store.failed(name)]
    return _result([*store.read("unforeseen")["what"], *failed])


CHECKS: Final = [
    tables_fit_their_schemas,
    every_listed_tow_accounted_for,
    every_tow_has_a_curve_row,
    few_tows_set_aside,
    log_factors_stayed,
    boats_stayed_within_their_intervals,
    editions_can_be_made_again,
    nothing_unforeseen,
]
