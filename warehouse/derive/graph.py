"""The steps of a build, each declared once, in the order in which they are made.

Here are the functions of steps that only put together what `pipeline` computes.
"""

from collections.abc import Callable, Sequence
from itertools import takewhile
from pathlib import Path
from typing import Final

import polars as pl

from pipeline.blocks.run_blocks import PLACE
from pipeline.consistency import repeats
from pipeline.consistency.components import variance_components
from pipeline.consistency.eras import era_shifts
from pipeline.consistency.observed import of_trusted
from pipeline.consistency.tables import line_tables, type_tables
from pipeline.consistency.tow_speed import slow_tows
from pipeline.method.definition import Method
from pipeline.recompute.facts import with_boats, with_hand_windows
from pipeline.recompute.recompute import recompute
from pipeline.recompute.results import Recomputed
from pipeline.recompute.run_cache import RunCache
from pipeline.register import replay
from pipeline.register.register import as_ruled
from pipeline.studies.summaries import SUMS, print_reproduction, season_changes, second_means
from pipeline.tables.register import RaceChanges
from pipeline.tables.views import VIEWS
from pipeline.uncertainty.ensemble import tow_ensemble
from warehouse.derive import database
from warehouse.derive.archive_tables import archive_tables
from warehouse.derive.inputs import (
    ARCHIVE_TABLES,
    LINE_TABLES,
    METHOD_TABLES,
    STUDY_TABLES,
    TYPE_TABLES,
    Blocks,
)
from warehouse.derive.registers import register_tables
from warehouse.derive.step import Step
from warehouse.derive.studies import study_tables
from warehouse.intake import seasons as intake
from warehouse.store.store import Store

EDITIONS: Final = ("from_edition", "to_edition")


def trace_seconds(tows: pl.DataFrame, blocks: Blocks) -> pl.DataFrame:
    """The traces of all runs of sound tows."""
    of_all = blocks.columns(*dict.fromkeys(("tow_id", *PLACE, *SUMS)))
    return second_means(of_all.join(tows, on="tow_id", how="semi", maintain_order="left"))


def method_tables(
    method: Method,
    boats: pl.DataFrame,
    tows: pl.DataFrame,
    tow_runs: pl.DataFrame,
    hand_windows: pl.DataFrame,
    blocks: Blocks,
    run_cache: RunCache,
) -> dict[str, pl.DataFrame]:
    """Run points, curves, log factors, assessments and members of all tows under one method."""
    runs = blocks.of_runs(with_hand_windows(tow_runs, hand_windows))
    made = recompute(method, with_boats(tows, boats), runs, run_cache)
    return {**vars(made), "ensemble": members_of(method, made)}


def members_of(method: Method, made: Recomputed) -> pl.DataFrame:
    """Equally likely numbers of every tow: rows of the table `ensemble`."""
    ruled = as_ruled(made.curves, method.validity)
    return tow_ensemble(method.name, made.curves, ruled, made.uncertainty_budget, made.factors)


def repeat_pairs(curves: pl.DataFrame, tows: pl.DataFrame) -> pl.DataFrame:
    """Boats and crews that were towed again."""
    return repeats.repeat_pairs(of_trusted(curves, tows), tows)


def race_changes(
    register_changes: pl.DataFrame, register_history: pl.DataFrame, listed_races: pl.DataFrame
) -> pl.DataFrame:
    """All races in the archive under both editions of every pair that is compared."""
    pairs = register_changes.select(EDITIONS).unique().sort(EDITIONS)
    replayed = {
        edition: replay.replay(
            register_history.filter(edition=edition), listed_races, replay.RaceRules()
        )
        for edition in pairs.unpivot()["value"].unique()
    }
    frames = [
        replay.race_changes(replayed[old], replayed[new]).with_columns(
            from_edition=pl.lit(old), to_edition=pl.lit(new)
        )
        for old, new in pairs.iter_rows()
    ]
    return pl.concat(frames) if frames else RaceChanges.create_empty()


def _alone(group: str, *functions: Callable[..., pl.DataFrame]) -> list[Step]:
    """Steps that make one table each, of their own name."""
    return [Step(group, compute, (compute.__name__,)) for compute in functions]


ARCHIVE: Final = Step("archive", archive_tables, ARCHIVE_TABLES)
METHOD: Final = Step("method", method_tables, METHOD_TABLES)
STUDIES: Final = Step("studies", study_tables, STUDY_TABLES)
LINES: Final = Step("lines", line_tables, LINE_TABLES)
TYPES: Final = Step("consistency", type_tables, TYPE_TABLES)
REGISTERS: Final = Step(
    "register",
    register_tables,
    (
        *("register", "register_history", "editions", "register_changes", "lineage", "methods"),
        "due_list",
    ),
)
DATABASE: Final = Step(
    "database",
    database.warehouse_database,
    (database.DATABASE_TABLE,),
    also=str((database.MEANINGS, VIEWS)),
    is_whole=database.is_whole,
)

STEPS: Final = (
    ARCHIVE,
    *_alone("recordings", trace_seconds),
    *(METHOD, STUDIES, LINES, TYPES),
    *_alone("consistency", variance_components, slow_tows, repeat_pairs, era_shifts),
    *_alone("consistency", repeats.reproducibility),
    REGISTERS,
    *_alone("summaries", race_changes, season_changes, print_reproduction),
    DATABASE,
)
"""Every step comes after those whose tables it reads."""


def catch_up(store: Store, archive: Path, methods: Sequence[Method], step: Step) -> None:
    """Makes again what a step reads and what is not there as it should be."""
    intake.index(store, archive)
    for season in intake.damaged_seasons(store):
        intake.read_season(store, archive, season)
    for before in takewhile(lambda before: before is not step, STEPS):
        for scope in before.stale(store, methods):
            before.make(scope)
