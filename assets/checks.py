"""Checks of a finished rebuild, each with how bad it is when it fails.

An error means that a table is not what it promises; a warning, that a person should look.
"""

import logging
from collections.abc import Callable, Iterator, Sequence
from typing import Final

import dagster as dg
import polars as pl

from assets.resources import Setup
from pipeline.messages import say
from pipeline.tables.schemas import TABLES
from warehouse.derive.database import DATABASE_TABLE
from warehouse.derive.inputs import IN_DATABASE
from warehouse.editions.verify import verify
from warehouse.queries.change_report import change_report
from warehouse.store.database import open_database

ERROR, WARN = dg.AssetCheckSeverity.ERROR, dg.AssetCheckSeverity.WARN


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


def tables_fit_their_schemas(setup: Setup) -> dg.AssetCheckResult:
    """Every table of the database has the columns, types and ranges it promises."""
    with open_database(setup.store.database) as db:
        return _result(
            [n for n in IN_DATABASE if not TABLES[n].is_valid(db.sql(f'FROM "{n}"').pl())]
        )


def every_listed_tow_accounted_for(setup: Setup) -> dg.AssetCheckResult:
    """No listed tow of the seasons read is neither accepted nor set aside."""
    store = setup.store
    known = pl.concat([store.read(name, columns=["tow_id"]) for name in ("tows", "quarantine")])
    lost = store.read_all("season_tows").join(known, on="tow_id", how="anti")
    return _result(lost["tow_id"].to_list())


def every_tow_has_a_curve_row(setup: Setup) -> dg.AssetCheckResult:
    """Every method has a curve row for every tow."""
    tows = setup.store.read("tows", columns=["tow_id"])
    lost = [
        (method.name, tow)
        for method in setup.chosen_methods
        for (tow,) in tows.join(
            setup.store.read("curves", method.name, ["tow_id"]), on="tow_id", how="anti"
        ).iter_rows()
    ]
    return _result(lost)


def few_tows_set_aside(setup: Setup) -> dg.AssetCheckResult:
    """No more of the listed tows are set aside than the settings allow."""
    aside = setup.store.read("quarantine").filter(lost="tow")["tow_id"].unique().sort().to_list()
    listed = len(aside) + setup.store.count_rows("tows")
    return _result(aside if len(aside) > setup.settings.set_aside_share * listed else [], WARN)


def log_factors_stayed(setup: Setup) -> dg.AssetCheckResult:
    """No season's log factor jumped since the last report."""
    limit = setup.settings.factor_jump
    moved = change_report(setup.store).factors
    return _result([tuple(f.values()) for f in moved if abs(f["ratio"] - 1.0) > limit], WARN)


def boats_stayed_within_their_intervals(setup: Setup) -> dg.AssetCheckResult:
    """No line of a draft moved by more than its intervals since the last report."""
    columns = ("to_edition", "fsn_no", "rowers", "crew_class")
    beyond = change_report(setup.store).beyond_interval
    return _result([tuple(line[name] for name in columns) for line in beyond], WARN)


def editions_can_be_made_again(setup: Setup) -> dg.AssetCheckResult:
    """Published editions are what they were, and archive and code of today give them again.

    A file of the archive may be mended after publication, so only a changed edition is an error.
    """
    wrong = [f for f in verify(setup.store, afresh=False).findings if f.wrong]
    changed = any(f.kind == "altered" for f in wrong)
    return _result([f"{f.edition}: {f.message}" for f in wrong], ERROR if changed else WARN)


CHECKS: Final[Sequence[Callable[[Setup], dg.AssetCheckResult]]] = (
    tables_fit_their_schemas,
    every_listed_tow_accounted_for,
    every_tow_has_a_curve_row,
    few_tows_set_aside,
    log_factors_stayed,
    boats_stayed_within_their_intervals,
    editions_can_be_made_again,
)


@dg.multi_asset_check(
    specs=[
        dg.AssetCheckSpec(check.__name__, asset=DATABASE_TABLE, description=check.__doc__)
        for check in CHECKS
    ]
)
def of_the_whole(setup: Setup) -> Iterator[dg.AssetCheckResult]:
    """What all checks say of a finished database, in one step."""
    logging.getLogger("herijk").info(say("checking the tables"))
    for check in CHECKS:
        yield check(setup)._replace(
            asset_key=dg.AssetKey(DATABASE_TABLE), check_name=check.__name__
        )
