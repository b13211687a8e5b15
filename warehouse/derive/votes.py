"""The register and its races under every combination of what is put to the vote."""

from collections.abc import Sequence

import polars as pl

from pipeline.crews import STANDARD_CREWS
from pipeline.method.definition import Method
from pipeline.register.changes import compare_lines
from pipeline.register.printed import carry_lines
from pipeline.register.register import (
    find_reference_day,
    list_lines_of_all_days,
    list_lines_on_days,
)
from pipeline.register.replay import RaceRules, race_changes, replay
from pipeline.studies.combinations import choose_ends, uses_new_instruments
from pipeline.studies.switches import find_switches, list_combinations, name_combination
from pipeline.tables.studies import VoteLines, VoteRaces

INTERVALS = ("cw_lo_kg_m", "cw_hi_kg_m", "cw_best_lo_kg_m", "cw_best_hi_kg_m")
"""What is not known of a curve under a combination."""


def vote_tables(
    vote_curves: pl.DataFrame,
    curves: pl.DataFrame,
    tows: pl.DataFrame,
    listed_races: pl.DataFrame,
    printed_registers: pl.DataFrame,
    log_factors: pl.DataFrame,
    decisions: pl.DataFrame,
    methods: Sequence[Method],
    crew_classes: pl.DataFrame = STANDARD_CREWS,
) -> dict[str, pl.DataFrame]:
    """Return what every combination makes of the register, and of the races of the last season.

    Lines and places stand beside those of the first combination, in which nothing is on. As soon as
    something is on, the proposed method says how long a tow counts and which tows are rejected. A
    printed line whose tow has no samples follows the instruments.
    """
    lines: list[pl.DataFrame] = [VoteLines.create_empty()]
    races: list[pl.DataFrame] = [VoteRaces.create_empty()]
    ends = choose_ends(methods)
    if ends is None or vote_curves.is_empty():
        return {"vote_lines": lines[0], "vote_races": races[0]}
    from_method, to_method = ends
    switches = find_switches(vote_curves["combination"].unique().to_list())
    as_of = find_reference_day(tows, listed_races)
    race_year = pl.col("race_date").dt.year()
    last_races = listed_races.filter(race_year == race_year.max())
    printed = printed_registers.filter("has_valid_curve").sort("season", maintain_order=True)
    first_lines = first_results = pl.DataFrame()
    for on in list_combinations(switches):
        combination = name_combination(on)
        method = to_method if on else from_method
        instruments = to_method if uses_new_instruments(on, switches) else from_method
        factors = log_factors.filter(method=instruments.name)
        carried = carry_lines(printed, factors, instruments, tows)
        own_curves = replace_curves(
            curves.filter(method=method.name), vote_curves.filter(combination=combination)
        )
        in_time = list_lines_of_all_days(own_curves, tows, method.validity, decisions, carried)
        on_day = list_lines_on_days(in_time, [as_of]).with_columns(edition=pl.lit(combination))
        results = replay(in_time, last_races, RaceRules(), crew_classes)
        if not on:
            first_lines, first_results = on_day, results
        columns = {
            "from_method": pl.lit(from_method.name),
            "to_method": pl.lit(to_method.name),
            "combination": pl.lit(combination),
        }
        compared = compare_lines(first_lines, on_day).with_columns(
            tow_id="new_tow_id", cw_kg_m="new_cw_kg_m", **columns
        )
        lines.append(compared.select(VoteLines.column_names()))
        placed = race_changes(first_results, results).with_columns(**columns)
        races.append(placed.select(VoteRaces.column_names()))
    return {"vote_lines": pl.concat(lines), "vote_races": pl.concat(races)}


def replace_curves(curves: pl.DataFrame, computed: pl.DataFrame) -> pl.DataFrame:
    """Return the curves of a method with other A, B and Cw; a best estimate changes with its Cw.

    Args:
        curves: rows of `curves` of a method.
        computed: rows of `vote_curves` of a combination. A tow without a row is rejected.
    """
    found = computed.select("tow_id", new_a="a_kg_m", new_b="b_m_s", new_cw="cw_kg_m")
    is_rejected_by_check = (pl.col("status") == "rejected") & pl.col("cw_kg_m").is_not_null()
    status = (
        pl.when(pl.col("new_cw").is_null() | is_rejected_by_check)
        .then(pl.lit("rejected"))
        .otherwise(pl.lit("accepted"))
    )
    return (
        curves.join(found, on="tow_id", how="left", maintain_order="left")
        .with_columns(**dict.fromkeys(INTERVALS, pl.lit(None, pl.Float64)))
        .with_columns(
            a_kg_m="new_a",
            b_m_s="new_b",
            cw_kg_m="new_cw",
            cw_best_kg_m=pl.col("cw_best_kg_m") / pl.col("cw_kg_m") * pl.col("new_cw"),
            status=status,
        )
    )
