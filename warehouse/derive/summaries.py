"""Tables that sum up: recordings per second and run, methods per season, print, and races replayed.

What a page or command says of many tows together is in a table too. The sums are
`pipeline.studies.summaries`, `pipeline.studies.claims` and `pipeline.register.replay`.
"""

from collections.abc import Sequence
from typing import Final

import polars as pl

from pipeline.blocks.run_blocks import PLACE
from pipeline.method.definition import Method
from pipeline.register import replay
from pipeline.studies import claims, summaries
from pipeline.tables.register import RaceChanges
from warehouse.derive.inputs import Blocks

EDITIONS: Final = ("from_edition", "to_edition")


def recording_tables(tows: pl.DataFrame, blocks: Blocks) -> dict[str, pl.DataFrame]:
    """The traces of all runs of sound tows, and the tool's figures of each of their channels."""
    of_all = blocks.columns(
        *dict.fromkeys(("tow_id", *PLACE, *summaries.SUMS, *claims.CHANNELS.values()))
    )
    sound = of_all.join(tows, on="tow_id", how="semi", maintain_order="left")
    return {
        "trace_seconds": summaries.second_means(sound),
        "run_statistics": claims.run_statistics(sound),
    }


def season_changes(curves: pl.DataFrame, methods: Sequence[Method]) -> pl.DataFrame:
    """What each method changes in each season, compared with the first."""
    return summaries.season_changes(curves, methods[0].name)


def race_changes(
    register_changes: pl.DataFrame, register_history: pl.DataFrame, listed_races: pl.DataFrame
) -> pl.DataFrame:
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
    return pl.concat(frames) if frames else RaceChanges.create_empty()
