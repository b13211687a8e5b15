"""Checks of a finished rebuild, each with how bad it is when it fails.

An error means that a table is not what it promises; a warning, that a person should look. Each
check is a function that returns what is wrong. The asset `check_results` keeps what all of them
find, so that the report and Dagster's page show the same.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import dagster as dg
import polars as pl

from assets.lake import Folders
from assets.settings import Settings
from pipeline.register.register import choose_default_method
from pipeline.tables.schemas import TABLES
from warehouse.derive.database import IN_DATABASE
from warehouse.editions.verify import verify
from warehouse.queries.change_report import change_report
from warehouse.store.database import open_database
from warehouse.store.store import Store
from warehouse.store.unforeseen import UNFORESEEN, is_unforeseen, shorten_error

ERROR: Final = "ERROR"
WARN: Final = "WARN"
"""The names of Dagster's severities."""

MAX_SHOWN: Final = 20
"""Number of findings of a check that are kept."""


@dataclass(frozen=True)
class Found:
    """What a check found.

    Attributes:
        wrong: a sentence or a name for everything that is wrong.
        severity: how bad that is.
    """

    wrong: Sequence[str]
    severity: str = ERROR


def tables_fit_their_schemas(store: Store, _: Settings) -> Found:
    """Every table of the database has the columns, types and ranges it promises."""
    with open_database(store.database) as db:
        tables = {name: db.sql(f'FROM "{name}"') for name in IN_DATABASE}
        wrong = [name for name, table in tables.items() if not TABLES[name].is_valid(table.pl())]
    return Found(wrong)


def every_listed_tow_accounted_for(store: Store, _: Settings) -> Found:
    """No listed tow of the seasons read is neither accepted nor set aside."""
    known = pl.concat([store.read(name, columns=["tow_id"]) for name in ("tows", "quarantine")])
    lost = store.read("samples").join(known, on="tow_id", how="anti")
    return Found(lost["tow_id"].to_list())


def every_tow_has_a_curve_row(store: Store, _: Settings) -> Found:
    """Every method has a curve row for every tow."""
    methods = store.read("methods").select("method")
    expected = methods.join(store.read("tows").select("tow_id"), how="cross")
    lost = expected.join(store.read("curves"), on=["method", "tow_id"], how="anti")
    return Found(lost.select(pl.format("{} {}", "method", "tow_id")).to_series().to_list())


def few_tows_set_aside(store: Store, settings: Settings) -> Found:
    """No more of the listed tows are set aside than the settings allow."""
    aside = store.read("quarantine").filter(lost="tow")["tow_id"].unique().sort().to_list()
    n_listed = len(aside) + store.count_rows("tows")
    too_many = len(aside) > settings.set_aside_share * n_listed
    return Found(aside if too_many else [], WARN)


def log_factors_stayed(store: Store, settings: Settings) -> Found:
    """No season's log factor jumped since the last report."""
    moved = change_report(store).factors
    jumped = [row for row in moved if abs(row["ratio"] - 1.0) > settings.factor_jump]
    return Found([" ".join(map(str, row.values())) for row in jumped], WARN)


def boats_stayed_within_their_intervals(store: Store, _: Settings) -> Found:
    """No line of a draft moved by more than its intervals since the last report."""
    moved = []
    for line in change_report(store).beyond_interval:
        key = (line["to_edition"], line["fsn_no"], line["rowers"], line["crew_class"])
        moved.append(" ".join(map(str, key)))
    return Found(moved, WARN)


def editions_can_be_made_again(store: Store, _: Settings) -> Found:
    """Check that editions are what they were, and that archive and code of today give them again.

    A file of the archive may be mended after publication, so only a changed edition is an error.
    """
    findings = [one for one in verify(store, afresh=False).findings if one.wrong]
    is_changed = any(one.kind == "altered" for one in findings)
    wrong = [f"{one.edition}: {one.message}" for one in findings]
    return Found(wrong, ERROR if is_changed else WARN)


def nothing_unforeseen(store: Store, _: Settings) -> Found:
    """Herijk itself failed on nothing.

    A tow or a file on which it failed is set aside; of a method, a table or a page the rows or the
    page are missing, which is an error.
    """
    set_aside = store.read("quarantine").filter(reason_code=UNFORESEEN)
    tows = set_aside.select(pl.coalesce("tow_id", "path"))["tow_id"].to_list()
    failures = store.read("unforeseen")["what"]
    missing = [what for what in failures if not what.startswith("tow ")]
    missing += [f"table {name}" for name in TABLES if store.get_failure(name)]
    missing += store.read("site")["failed"].explode().drop_nulls().to_list()
    return Found([*missing, *tows], ERROR if missing else WARN)


CHECKS: Final[Mapping[Callable[[Store, Settings], Found], str]] = {
    tables_fit_their_schemas: "warehouse_database",
    every_listed_tow_accounted_for: "quarantine",
    every_tow_has_a_curve_row: "curves",
    few_tows_set_aside: "quarantine",
    log_factors_stayed: "log_factors",
    boats_stayed_within_their_intervals: "register",
    editions_can_be_made_again: "editions",
    nothing_unforeseen: "unforeseen",
}
"""Every check, with the table that it is about."""


def evaluate_checks(store: Store, settings: Settings) -> pl.DataFrame:
    """Return what every check finds: a row per check.

    A check that fails itself, by an error that nobody foresaw, counts as an error.
    """
    rows = []
    for check, asset in CHECKS.items():
        try:
            found = check(store, settings)
        except BaseException as error:  # a panic of a library in Rust is no Exception
            if not is_unforeseen(error):
                raise
            found = Found([f"Herijk itself failed: {shorten_error(error)}"])
        rows.append(
            {
                "asset": asset,
                "check": check.__name__,
                "severity": found.severity,
                "number": len(found.wrong),
                "first": list(found.wrong[:MAX_SHOWN]),
            }
        )
    return pl.DataFrame(rows, schema_overrides={"first": pl.List(pl.String)})


def show_result(asset: str, name: str, description: str) -> dg.AssetChecksDefinition:
    """Return Dagster's check that shows on an asset what the last `check_results` found."""

    @dg.asset_check(
        asset=asset, name=name, description=description, additional_deps=["check_results"]
    )
    def evaluate(folders: Folders) -> dg.AssetCheckResult:
        results = folders.store.read("check_results")
        row = results.row(by_predicate=pl.col("check") == name, named=True)
        return dg.AssetCheckResult(
            passed=row["number"] == 0,
            severity=dg.AssetCheckSeverity(row["severity"]),
            metadata={"number": row["number"], "first": dg.MetadataValue.json(row["first"])},
        )

    return evaluate


@dg.asset_check(asset="quarantine")
def archive_without_faults(folders: Folders) -> dg.AssetCheckResult:
    """Nothing of the archive is set aside; the metadata count what is, by reason."""
    reasons = folders.store.read("quarantine")["reason_code"].value_counts(sort=True)
    return dg.AssetCheckResult(
        passed=reasons.is_empty(),
        severity=dg.AssetCheckSeverity.WARN,
        metadata=dict(reasons.iter_rows()),
    )


EQUAL: Final = {
    "equal_in_cw": "cw_standard_kg_m",
    "equal_in_b": "b_m_s",
    "equal_in_a": "a_kg_m",
}
"""Checks on `type_consistency`, by the quantity that each is about."""


def show_verdicts(name: str, quantity: str) -> dg.AssetChecksDefinition:
    """Return Dagster's check that shows the verdict on each type, under the method that is shown.

    It warns of types whose boats are not equal.
    """

    @dg.asset_check(
        asset="type_consistency", name=name, description="Boats of a type are equal; by type."
    )
    def evaluate(folders: Folders) -> dg.AssetCheckResult:
        verdicts = folders.store.read("type_consistency").filter(quantity=quantity)
        method = choose_default_method(verdicts["method"].unique().sort().to_list())
        by_type = dict(verdicts.filter(method=method).select("boat_type", "verdict").rows())
        return dg.AssetCheckResult(
            passed="differ" not in by_type.values(),
            severity=dg.AssetCheckSeverity.WARN,
            metadata={"method": method, **by_type},
        )

    return evaluate


DAGSTER_CHECKS: Final = [
    archive_without_faults,
    *(show_verdicts(name, quantity) for name, quantity in EQUAL.items()),
    *(show_result(asset, check.__name__, str(check.__doc__)) for check, asset in CHECKS.items()),
]
