"""Curves of all tows under each method, and what the steps of a method change."""

import dagster as dg
import polars as pl

from assets.lake import Folders, detector, kept, outs
from assets.rules import methods_in
from pipeline.blocks.run_blocks import stack_blocks
from pipeline.recompute.facts import with_boats, with_hand_windows
from pipeline.recompute.recompute import recompute
from pipeline.recompute.run_cache import RunCache
from pipeline.studies import summaries
from warehouse.derive.registers import members_of
from warehouse.derive.studies import study_tables

OF_A_METHOD = (
    *("run_points", "curves", "log_factors", "season_links", "retow_choice", "season_steps"),
    *("season_diagnosis", "tow_instruments", "best_estimate_weights", "uncertainty_budget"),
    *("curve_points", "assessments", "ensemble"),
)


@dg.multi_asset(outs=outs(*OF_A_METHOD), can_subset=True)
@kept
def recomputed(
    folders: Folders,
    applied_methods: pl.DataFrame,
    boats: pl.DataFrame,
    tows: pl.DataFrame,
    tow_runs: pl.DataFrame,
    hand_windows: pl.DataFrame,
    blocks: pl.DataFrame,
) -> dict[str, pl.DataFrame]:
    """Run points, curves, log factors, assessments and members of all tows, per method."""
    runs, cache = stack_blocks(blocks, with_hand_windows(tow_runs, hand_windows)), RunCache()
    made = []
    for method in methods_in(folders, applied_methods):
        tables = recompute(method, with_boats(tows, boats), runs, cache)
        made.append({**vars(tables), "ensemble": members_of(method, tables)})
    return {name: pl.concat([of[name] for of in made]) for name in OF_A_METHOD}


@dg.multi_asset(outs=outs("correction_steps", "option_effects", "option_curves"), can_subset=True)
@kept
def studies(
    folders: Folders,
    applied_methods: pl.DataFrame,
    tows: pl.DataFrame,
    tow_runs: pl.DataFrame,
    hand_windows: pl.DataFrame,
    blocks: pl.DataFrame,
    tow_instruments: pl.DataFrame,
) -> dict[str, pl.DataFrame]:
    """The ladder from the first method to each other, and the studies of its options."""
    runs, cache = stack_blocks(blocks, with_hand_windows(tow_runs, hand_windows)), RunCache()
    methods = methods_in(folders, applied_methods)
    made = [
        study_tables(method, methods[0], tows, runs, tow_instruments, cache) for method in methods
    ]
    return {name: pl.concat([of[name] for of in made], how="diagonal") for name in made[0]}


@dg.asset
@detector
def season_changes(
    folders: Folders, applied_methods: pl.DataFrame, curves: pl.DataFrame
) -> pl.DataFrame:
    """Cw of each method / Cw of the first method, of the same tow, per season."""
    return summaries.season_changes(curves, methods_in(folders, applied_methods)[0])


@dg.asset
@detector
def print_reproduction(
    printed_registers: pl.DataFrame, curves: pl.DataFrame, tows: pl.DataFrame
) -> pl.DataFrame:
    """Printed A, B and Cw of each tow next to those of each method."""
    return summaries.print_reproduction(printed_registers, curves, tows)
