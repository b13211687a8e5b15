"""Tables that sum up other tables: per season, per code, and races replayed.

What a page or command says of many tows together is in a table too. The sums are
`pipeline.studies.summaries`, `pipeline.studies.claims` and `pipeline.register.replay`.
"""

from typing import TYPE_CHECKING, Final

import polars as pl

from herijk.pipeline.register.replay import RaceRules, race_changes, replay
from herijk.pipeline.studies import claims, summaries
from herijk.tables.register import RaceChanges

if TYPE_CHECKING:
    from herijk.warehouse.build.inputs import Inputs

EDITIONS: Final = ("from_edition", "to_edition")


def summary_tables(inputs: "Inputs") -> dict[str, pl.DataFrame]:
    """What many tows have in common, and races replayed under every edition.

    The first method is the one that others are compared with.
    """
    curves = inputs["curves"]
    printed = claims.print_reproduction(inputs["printed_registers"], curves, inputs["tows"])
    return {
        "race_changes": _race_changes(inputs),
        "season_changes": summaries.season_changes(curves, inputs.methods[0].name),
        "season_ladder": summaries.season_ladder(inputs["correction_steps"], inputs["tows"]),
        "option_summary": summaries.option_summary(inputs["option_effects"]),
        "quality_counts": summaries.quality_counts(curves, inputs["run_points"]),
        "check_counts": summaries.check_counts(inputs["assessments"]),
        "promise": claims.promise(curves, inputs["repeat_pairs"]),
        "print_reproduction": printed,
        "print_summary": claims.print_summary(printed),
    }


def _race_changes(inputs: "Inputs") -> pl.DataFrame:
    """All races in the archive under both editions of every pair that is compared."""
    pairs = inputs["register_changes"].select(EDITIONS).unique().sort(EDITIONS)
    history = inputs["register_history"]
    replayed = {
        edition: replay(
            history.filter(pl.col("edition") == edition), inputs["listed_races"], RaceRules()
        )
        for edition in pairs.unpivot()["value"].unique()
    }
    frames = [
        race_changes(replayed[old], replayed[new]).with_columns(
            from_edition=pl.lit(old), to_edition=pl.lit(new)
        )
        for old, new in pairs.iter_rows()
    ]
    return pl.concat(frames) if frames else RaceChanges.create_empty()
