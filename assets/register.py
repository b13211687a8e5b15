"""Draft registers beside the published ones, what changed between them, and what races show."""

import dagster as dg
import polars as pl

from assets.lake import Folders, incremental, make_outs
from assets.rules import read_methods
from pipeline.register import inspection, years
from warehouse.derive import registers as derive
from warehouse.derive.votes import vote_tables


@dg.multi_asset(
    outs=make_outs("register", "register_history", "register_changes", "lineage", "due_list"),
    can_subset=True,
)
@incremental()
def registers(
    folders: Folders,
    methods: pl.DataFrame,
    curves: pl.DataFrame,
    tows: pl.DataFrame,
    boats: pl.DataFrame,
    listed_boats: pl.DataFrame,
    listed_races: pl.DataFrame,
    listed_tows: pl.DataFrame,
    printed_registers: pl.DataFrame,
    log_factors: pl.DataFrame,
    decisions: pl.DataFrame,
    correction_steps: pl.DataFrame,
    crew_classes: pl.DataFrame,
    published_register: pl.DataFrame,
    published_register_history: pl.DataFrame,
    published_register_changes: pl.DataFrame,
    published_lineage: pl.DataFrame,
) -> dict[str, pl.DataFrame]:
    """Draft a register per method, with history, lineage and due boats, beside the editions."""
    published = {
        "register": published_register,
        "register_history": published_register_history,
        "register_changes": published_register_changes,
        "lineage": published_lineage,
    }
    return derive.register_tables(
        curves=curves,
        tows=tows,
        boats=boats,
        listed_boats=listed_boats,
        listed_races=listed_races,
        listed_tows=listed_tows,
        printed_registers=printed_registers,
        log_factors=log_factors,
        decisions=decisions,
        published=published,
        correction_steps=correction_steps,
        crew_classes=crew_classes,
        methods=read_methods(folders, methods),
    )


@dg.asset
@incremental()
def tolerances(folders: Folders) -> pl.DataFrame:
    """Return how far a boat may differ on a race day, by kind of measure, and who says so."""
    settings = folders.settings
    given = settings.model_fields_set
    of_kind = {
        "weight": "tolerance_weight",
        "freeboard": "tolerance_freeboard_m",
        "thwart": "tolerance_thwart_m",
        "rudder": "tolerance_rudder_m",
    }
    rows = []
    for kind, name in of_kind.items():
        size = float(getattr(settings, name))
        rows.append({"kind": kind, "size": size, "inferred": name not in given})
    return pl.DataFrame(rows)


@dg.asset
@incremental()
def inspections(
    listed_tows: pl.DataFrame, listed_boats: pl.DataFrame, tolerances: pl.DataFrame
) -> pl.DataFrame:
    """Return what was last measured of each boat, and what it may be on the day of a race."""
    return inspection.list_inspections(listed_tows, listed_boats, tolerances)


@dg.asset
@incremental(may_fail=True)
def race_changes(
    register_changes: pl.DataFrame,
    register_history: pl.DataFrame,
    listed_races: pl.DataFrame,
    crew_classes: pl.DataFrame,
) -> pl.DataFrame:
    """All races in the archive under both editions of every pair that is compared."""
    return derive.race_changes(register_changes, register_history, listed_races, crew_classes)


@dg.multi_asset(outs=make_outs("vote_lines", "vote_races"), can_subset=True)
@incremental(may_fail=True)
def votes(
    folders: Folders,
    methods: pl.DataFrame,
    vote_curves: pl.DataFrame,
    curves: pl.DataFrame,
    tows: pl.DataFrame,
    listed_races: pl.DataFrame,
    printed_registers: pl.DataFrame,
    log_factors: pl.DataFrame,
    decisions: pl.DataFrame,
    crew_classes: pl.DataFrame,
) -> dict[str, pl.DataFrame]:
    """Return the register and its last races under every combination that is put to the vote."""
    return vote_tables(
        vote_curves=vote_curves,
        curves=curves,
        tows=tows,
        listed_races=listed_races,
        printed_registers=printed_registers,
        log_factors=log_factors,
        decisions=decisions,
        methods=read_methods(folders, methods),
        crew_classes=crew_classes,
    )


@dg.multi_asset(outs=make_outs("register_years", "year_winners"), can_subset=True)
@incremental(may_fail=True)
def registers_of_years(
    folders: Folders,
    methods: pl.DataFrame,
    register_history: pl.DataFrame,
    correction_steps: pl.DataFrame,
    tows: pl.DataFrame,
    listed_races: pl.DataFrame,
    crew_classes: pl.DataFrame,
    ensemble: pl.DataFrame,
) -> dict[str, pl.DataFrame]:
    """Return the register of every past year, as published and by each method, and its races."""
    applied = read_methods(folders, methods)
    seasons = tows["season"].unique().sort().to_list()
    lines = years.register_years(register_history, correction_steps, applied, seasons)
    winners = years.year_winners(register_history, listed_races, ensemble, applied, crew_classes)
    return {"register_years": lines, "year_winners": winners}
