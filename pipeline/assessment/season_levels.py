"""What all boats towed in a season seem to change together: its instruments, not the boats.

A log that nothing calibrates gives every tow of its season the same error. Between two such seasons
each boat seems to change, though none did. The level of a season follows from the boats towed in it
and in another one, by medians, so that a tow that is off moves it little (median polish; Tukey
1977, Exploratory Data Analysis, ch. 11).
"""

from collections.abc import Collection
from typing import Final

import numpy as np
import polars as pl

FEWEST: Final = 4
"""Fewest changes for which what they share is taken to be the season's (inferred)."""

ROUNDS: Final = 60
"""Half a step is made in each, as neighbouring seasons move each other; 1e-4 is left at most."""


def season_levels(changes: pl.DataFrame, to_scale: Collection[int]) -> dict[int, float]:
    """Level of ln Cw of every season that is not to scale and has enough changes.

    Args:
        changes: `season`, `before` (the season of the boat's previous tow), and `ln`, the logarithm
            of its change.
        to_scale: seasons whose level is 0.
    """
    between = changes.filter(pl.col("season") != pl.col("before"))
    ends = (("season", "before", 1.0), ("before", "season", -1.0))
    rows = pl.concat(
        between.select(here=pl.col(here), there=pl.col(there), ln=sign * pl.col("ln"))
        for here, there, sign in ends
    )
    seasons, place = np.unique(rows[["here", "there"]].to_numpy(), return_inverse=True)
    here, there = place.reshape(-1, 2).T
    free = np.bincount(here, minlength=len(seasons)) >= FEWEST
    free &= ~np.isin(seasons, list(to_scale))
    level, ln = np.zeros(len(seasons)), rows["ln"].to_numpy()
    for _ in range(ROUNDS):
        apart = ln + level[there] - level[here]
        level += [0.5 * np.median(apart[here == s]) if free[s] else 0.0 for s in range(len(level))]
    return dict(zip(seasons[free].tolist(), level[free].tolist(), strict=True))
