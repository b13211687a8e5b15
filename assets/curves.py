"""Curves of all tows under each method, and what the steps of a method change."""

import datetime as dt
from typing import Final

import dagster as dg
import polars as pl

from assets.lake import Folders, incremental, make_outs
from assets.rules import read_methods
from pipeline.assessment.acceptance import judge_acceptances
from pipeline.blocks.run_blocks import stack_blocks
from pipeline.recompute.facts import add_hand_windows
from pipeline.studies import summaries
from pipeline.tables.schemas import conform
from warehouse.derive.archive_tables import add_first_seen, read_earlier
from warehouse.derive.recomputing import METHOD_TABLES, ArchiveRuns, recompute_archive
from warehouse.derive.studies import study_methods
from warehouse.store.unforeseen import note

STUDIES: Final = ("correction_steps", "vote_curves")


@dg.multi_asset(
    outs=make_outs(*METHOD_TABLES, "tows", "tow_runs", "failed_tows", "unforeseen"),
    can_subset=True,
)
@incremental()
def recomputed(
    folders: Folders,
    applied_methods: pl.DataFrame,
    boats: pl.DataFrame,
    read_tows: pl.DataFrame,
    read_runs: pl.DataFrame,
    hand_windows: pl.DataFrame,
    blocks: pl.DataFrame,
    crew_classes: pl.DataFrame,
) -> dict[str, pl.DataFrame]:
    """Run points, curves, log factors, assessments and members of all tows, per method.

    A tow on which our own code fails is set aside, so the sound tows are known only here.
    """
    archive = ArchiveRuns(
        boats=boats,
        tows=read_tows,
        tow_runs=read_runs,
        hand_windows=hand_windows,
        blocks=blocks,
        crew_classes=crew_classes,
    )
    made = recompute_archive(read_methods(folders, applied_methods), archive)
    for what, trace in made.failures.iter_rows():
        note(folders.store.root, what.removeprefix("tow "), trace)
    return {
        **made.tables,
        "tows": made.tows,
        "tow_runs": made.tow_runs,
        "failed_tows": made.set_aside,
        "unforeseen": made.failures,
    }


@dg.asset
@incremental()
def quarantine(
    folders: Folders, set_aside: pl.DataFrame, failed_tows: pl.DataFrame
) -> pl.DataFrame:
    """Everything that is set aside: what the archive is wrong in, and tows on which we fail."""
    before = read_earlier(folders.store, "quarantine")
    failed = add_first_seen(failed_tows, before, dt.date.today())
    return pl.concat([set_aside, conform("quarantine", failed)])


@dg.asset
@incremental(may_fail=True)
def acceptances(
    listed_acceptances: pl.DataFrame, listed_tows: pl.DataFrame, curves: pl.DataFrame
) -> pl.DataFrame:
    """Return who accepted which tow, and the checks of each method that doubt it since."""
    return judge_acceptances(listed_acceptances, listed_tows, curves)


@dg.multi_asset(outs=make_outs(*STUDIES), can_subset=True)
@incremental()
def studies(
    folders: Folders,
    methods: pl.DataFrame,
    tows: pl.DataFrame,
    tow_runs: pl.DataFrame,
    hand_windows: pl.DataFrame,
    blocks: pl.DataFrame,
    tow_instruments: pl.DataFrame,
) -> dict[str, pl.DataFrame]:
    """Return the ladder from the first method to each other, and the parts of the vote."""
    runs = stack_blocks(blocks, add_hand_windows(tow_runs, hand_windows))
    return study_methods(read_methods(folders, methods), tows, runs, tow_instruments)


@dg.asset
@incremental(may_fail=True)
def season_changes(folders: Folders, methods: pl.DataFrame, curves: pl.DataFrame) -> pl.DataFrame:
    """Cw of each method / Cw of the first method, of the same tow, per season."""
    return summaries.season_changes(curves, read_methods(folders, methods)[0])


@dg.asset
@incremental(may_fail=True)
def print_reproduction(
    printed_registers: pl.DataFrame, curves: pl.DataFrame, tows: pl.DataFrame
) -> pl.DataFrame:
    """Return the printed A, B and Cw of each tow next to those of each method."""
    return summaries.print_reproduction(printed_registers, curves, tows)
