"""Tables that sum up other tables: per season, per code, and races replayed.

What a page or command says of many tows together is in a table too. The sums are
`pipeline.studies.summaries`, `pipeline.studies.claims` and `pipeline.register.replay`.
"""

from collections.abc import Sequence
from typing import Final

import polars as pl

from pipeline.method.definition import Method
from pipeline.register import replay
from pipeline.studies import claims, summaries
from pipeline.tables.register import RaceChanges

EDITIONS: Final = ("from_edition", "to_edition")


def season_changes(curves: pl.DataFrame, methods: Sequence[Method]) -> dict[str, pl.DataFrame]:
    """What each method changes in each season, compared with the first."""
    return {"season_changes": summaries.season_changes(curves, methods[0].name)}


def season_ladder(correction_steps: pl.DataFrame, tows: pl.DataFrame) -> dict[str, pl.DataFrame]:
    """What each step of a method changes in each season."""
    return {"season_ladder": summaries.season_ladder(correction_steps, tows)}


def option_summary(option_effects: pl.DataFrame) -> dict[str, pl.DataFrame]:
    """How much each option matters."""
    return {"option_summary": summaries.option_summary(option_effects)}


def quality_counts(curves: pl.DataFrame, run_points: pl.DataFrame) -> dict[str, pl.DataFrame]:
    """How many curves and run points have each status."""
    return {"quality_counts": summaries.quality_counts(curves, run_points)}


def check_counts(assessments: pl.DataFrame) -> dict[str, pl.DataFrame]:
    """How often each check found something."""
    return {"check_counts": summaries.check_counts(assessments)}


def promise(curves: pl.DataFrame, repeat_pairs: pl.DataFrame) -> dict[str, pl.DataFrame]:
    """Whether repeat tows agree as their intervals promise."""
    return {"promise": claims.promise(curves, repeat_pairs)}


def print_tables(
    printed_registers: pl.DataFrame, curves: pl.DataFrame, tows: pl.DataFrame
) -> dict[str, pl.DataFrame]:
    """Printed registers beside what is computed today."""
    printed = claims.print_reproduction(printed_registers, curves, tows)
    return {"print_reproduction": printed, "print_summary": claims.print_summary(printed)}


def race_changes(
    register_changes: pl.DataFrame, register_history: pl.DataFrame, listed_races: pl.DataFrame
) -> dict[str, pl.DataFrame]:
    """All races in the archive under both editions of every pair that is compared."""
    pairs = register_changes.select(EDITIONS).unique().sort(EDITIONS)
    replayed = {
        edition: replay.replay(
            register_history.filter(pl.col("edition") == edition), listed_races, replay.RaceRules()
        )
        for edition in pairs.unpivot()["value"].unique()
    }
    frames = [
        replay.race_changes(replayed[old], replayed[new]).with_columns(
            from_edition=pl.lit(old), to_edition=pl.lit(new)
        )
        for old, new in pairs.iter_rows()
    ]
    return {"race_changes": pl.concat(frames) if frames else RaceChanges.create_empty()}
