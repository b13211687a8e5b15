"""Which runs to keep where runs were towed again: the most reliable of each kind.

When a run is towed again "the most reliable six runs" count (Sleepproef, R. Pot 2017, "Eerste
beoordeling"). Which these are is proposed here, with the reason; a person writes them into
`gebruik runs`, and no number follows from it.
"""

from typing import Final

import polars as pl

KEEP: Final = "most_reliable"
NO_WINDOW: Final = "no_steady_part"
ENDS: Final = "ends_differ_more"
LOST: Final = "more_left_out"
SCATTER: Final = "more_scatter"
KIND: Final = ("tow_id", "target_speed_ratio", "direction")


def choose_repeated_runs(run_points: pl.DataFrame) -> pl.DataFrame:
    """Add `choice` to run points, where there are several at one target speed and direction.

    They are ranked by, in this order: a steady window; ends that agree within the method's limits;
    how little was left out; the standard error of the mean Cw (`cw_sd` over the root of the
    window's length).

    Returns:
        The rows as they were, with `choice`: `most_reliable`, or for the others the first of these
        in which they are behind; null where there is no choice.
    """
    window = pl.col("window_end_s") - pl.col("window_start_s")
    beyond = (pl.col("ends_ratio").fill_null(0.0) - 1.0).clip(lower_bound=0.0)
    behind = {
        NO_WINDOW: pl.col("cw_kg_m").is_null().cast(pl.Float64),
        ENDS: beyond,
        LOST: pl.col("lost_s"),
        SCATTER: (pl.col("cw_sd") / window.sqrt()).fill_null(0.0),
    }
    place = pl.struct(pl.col(list(behind)), "run").rank("ordinal").over(KIND)
    ranked = run_points.with_columns(**behind).with_columns(place=place)
    why = pl.lit(SCATTER)
    for code in reversed(list(behind)[:-1]):
        best = pl.col(code).sort_by("place").first().over(KIND)
        why = pl.when(pl.col(code) > best).then(pl.lit(code)).otherwise(why)
    reason = pl.when(pl.col("place") == 1).then(pl.lit(KEEP)).otherwise(why)
    choice = pl.when(pl.len().over(KIND) > 1).then(reason).alias("choice")
    return ranked.with_columns(choice).drop(list(behind) + ["place"])
