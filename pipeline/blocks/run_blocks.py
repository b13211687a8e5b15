"""Blocks: sums over each second of a run, from which every method can be computed.

Every formula of every method is linear in a few sums over samples, so a tow's samples are read once
and added up per second (docs/decisions.md, "Blocks of a second"). Means over any window that starts
on a second are then exactly those over the samples. What belongs here: which sums there are and how
they are stacked. What does not: making them (`pipeline.blocks.sums`), nor any choice of a method
(which window, which coefficient).

The sums of one block, over its `n` samples, with F the tow force, v the speed by log 1, and w and a
the apparent wind:

- `force`: F [N]
- `log1_v`, `log1_inv_v2`: v, 1/v^2; `log2_v`: the speed by log 2
- `log1_cw`, `log1_cw2`: F/v^2 [kg/m] and its square
- `<air>`: the terms of `pipeline.steps.wind` [m2/s2]: `head` and `front`, each for wind from
  `ahead` and from `behind`, and `side`
- `log1_<air>`: the same divided by v^2
- `wind_v`: w; `wind_cos`, `wind_sin`: cos a, sin a; `wind_x`, `wind_y`: w cos a, w sin a
- `gps`, `gps_n`: ground speed, and how many samples have one
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
import polars as pl

from pipeline.arrays import BoolArray, FloatArray, OnDemand
from pipeline.errors import BrokenPromiseError

AIR_SUMS: Final = ("head_ahead", "head_behind", "front_ahead", "front_behind", "side")
SUM_NAMES: Final = (
    "force",
    "log1_v",
    "log1_inv_v2",
    "log1_cw",
    "log1_cw2",
    "log1_head_ahead",
    "log1_head_behind",
    "log1_front_ahead",
    "log1_front_behind",
    "log1_side",
    "log2_v",
    "head_ahead",
    "head_behind",
    "front_ahead",
    "front_behind",
    "side",
    "wind_v",
    "wind_cos",
    "wind_sin",
    "wind_x",
    "wind_y",
    "gps",
    "gps_n",
)

PLACE: Final[dict[str, pl.DataType]] = {
    "tow_id": pl.String(),
    "run": pl.Int8(),
    "second": pl.Int16(),
    "n": pl.Int32(),
}
"""Columns of blocks beside their sums."""

BLOCK_SCHEMA: Final = PLACE | dict.fromkeys(SUM_NAMES, pl.Float64())
"""Columns of the blocks of a season."""


@dataclass(frozen=True)
class RunBlocks:
    """The blocks of many runs as arrays of shape (runs, seconds).

    Attributes:
        runs: one row per run, sorted by `tow_id` and `run`; row i belongs to row i of the arrays.
        n: samples in each block, 0 where the run has none.
        sums: the sums of `SUM_NAMES`, 0 where the run has no block.
    """

    runs: pl.DataFrame
    n: FloatArray
    sums: Mapping[str, FloatArray]

    def __getitem__(self, name: str) -> FloatArray:
        return self.sums[name]

    @property
    def seconds(self) -> int:
        """Length of the longest run, in blocks."""
        return int(self.n.shape[1])

    @cached_property
    def inside(self) -> BoolArray:
        """Seconds from the start of a run to its end, also those left without samples."""
        later = np.cumsum(self.n[:, ::-1], axis=1)[:, ::-1]
        return np.asarray(later > 0)

    def take(self, rows: BoolArray) -> "RunBlocks":
        """Return the runs marked in `rows`, shape (runs,)."""
        if rows.all():
            return self
        sums = OnDemand(self.sums.keys(), lambda name: self.sums[name][rows])
        return RunBlocks(self.runs.filter(pl.Series(rows)), self.n[rows], sums)

    def block_means(self, name: str) -> FloatArray:
        """Return the mean of each block, shape (runs, seconds); 0 after the run.

        A second without samples within the run has the mean of the nearest one before it, or of
        the first one after where there is none.
        """
        means = self.sums[name] / np.maximum(self.n, 1.0)
        if np.array_equal(self.inside, self.n > 0):
            return means
        second = np.arange(self.seconds)
        known = np.where(self.n > 0, second, -1)
        before = np.maximum.accumulate(known, axis=1)
        first = (self.n > 0).argmax(axis=1)[:, None]
        filled = np.take_along_axis(means, np.where(before < 0, first, before), axis=1)
        return np.where(self.inside, filled, 0.0)


@dataclass(frozen=True)
class WindowSums:
    """Sums over one window of every run.

    Attributes:
        window: blocks that count, shape (runs, seconds).
    """

    blocks: RunBlocks
    window: BoolArray

    @cached_property
    def count(self) -> FloatArray:
        """Samples, shape (runs,)."""
        return np.asarray(np.where(self.window, self.blocks.n, 0.0).sum(axis=1), dtype=np.float64)

    def mean(self, name: str) -> FloatArray:
        """Return the mean over the samples, shape (runs,); 0 where the window is empty."""
        total = np.where(self.window, self.blocks[name], 0.0).sum(axis=1)
        return np.asarray(total / np.maximum(self.count, 1.0), dtype=np.float64)


def stack_blocks(
    blocks: pl.DataFrame,
    runs: pl.DataFrame,
    sums_of: Callable[[str], pl.Series] | None = None,
) -> RunBlocks:
    """Arrange blocks of many tows as arrays of one row per run.

    Args:
        blocks: `tow_id`, and the columns that `block_sums` gives; those of `PLACE` are enough where
            the others can be asked for.
        runs: one row per run with at least `tow_id` and `run`.
        sums_of: reads one of the sums, a value per block; None where it is a column of `blocks`.

    Raises:
        BrokenPromiseError: a run without blocks.
    """
    runs = runs.sort("tow_id", "run").with_row_index("row")
    rows = runs.select("tow_id", "run", "row")
    place = blocks.select("tow_id", "run").join(
        rows, on=["tow_id", "run"], how="left", maintain_order="left"
    )["row"]
    missing = runs.filter(~pl.col("row").is_in(place.unique().implode()))
    if missing.height:
        tow, run = missing.row(0, named=True)["tow_id"], missing.row(0, named=True)["run"]
        raise BrokenPromiseError(
            "tow {}, run {}: no blocks, though its samples were read; rebuild with "
            "an empty data folder",
            tow,
            run,
        )
    column = sums_of or blocks.get_column
    known = place.is_not_null().to_numpy()
    second = blocks["second"].to_numpy()[known]
    seconds = int(second.max()) + 1 if len(second) else 0
    cell = place.drop_nulls().to_numpy() * seconds + second

    def place_seconds(values: pl.Series) -> FloatArray:
        cells = np.zeros(runs.height * seconds)
        cells[cell] = values.to_numpy()[known]
        return cells.reshape(runs.height, seconds)

    sums = OnDemand(SUM_NAMES, lambda name: place_seconds(column(name)))
    return RunBlocks(runs.drop("row"), place_seconds(blocks["n"]), sums)
