"""Tows and their runs: what is known of each, and the bookkeeping between the two.

Which run is of which tow, columns as arrays, one number per tow spread over its runs. No formula of
the method.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Final, Self

import numpy as np
import polars as pl

from pipeline.arrays import BoolArray, FloatArray, IntArray, OnDemand
from pipeline.blocks.run_blocks import RunBlocks
from pipeline.channels import BACK, OUT, SECOND_FILE_OFFSET
from pipeline.tables import archive
from pipeline.tables.frames import get_dtypes

DOUBTED_SPEED: Final = "speed_not_plausible"
"""A doubt for which a person must look, but that leaves the tow out of nothing."""

NOT_ALWAYS_KNOWN: Final = pl.DataFrame(
    schema={
        **get_dtypes(archive.Tows),
        "boat_type": pl.String,
        **dict.fromkeys(("listed_length_m", "listed_beam_m"), pl.Float64),
    }
)
"""Columns that the tows of an old edition, or a single tow, may lack."""


@dataclass(frozen=True)
class Tows:
    """Tows and their runs, both sorted by tow.

    Attributes:
        frame: rows of the table `tows` with type and listed sizes of the boat; null where a column
            was missing.
        blocks: their runs; `blocks.runs` has the columns of the table `tow_runs`.
        tow: index of each run's tow, shape (runs,).
    """

    frame: pl.DataFrame
    blocks: RunBlocks
    tow: IntArray

    @classmethod
    def from_frames(cls, tows: pl.DataFrame, blocks: RunBlocks) -> Self:
        """Return the given tows, with their runs among the given ones."""
        tows = pl.concat([tows, NOT_ALWAYS_KNOWN], how="diagonal_relaxed").sort("tow_id")
        mine = blocks.take(blocks.runs["tow_id"].is_in(tows["tow_id"].implode()).to_numpy())
        index = tows["tow_id"].search_sorted(mine.runs["tow_id"])
        return cls(tows, mine, index.to_numpy().astype(np.int64))

    @property
    def size(self) -> int:
        """Number of tows."""
        return self.frame.height

    @cached_property
    def has_gps(self) -> BoolArray:
        """Tows with GPS fixes in selected runs, both out and back, shape (tows,)."""
        return self.both_ways(self.selected & (self.blocks["gps_n"].sum(axis=1) > 0))

    def get_of_tows(self, column: str) -> FloatArray:
        """Return a number of each tow, shape (tows,); NaN where it is not known."""
        return self._columns[column]

    @cached_property
    def _columns(self) -> OnDemand:
        frame = self.frame
        return OnDemand(frame.columns, lambda name: frame[name].cast(pl.Float64).to_numpy())

    def get_of_runs(self, column: str) -> FloatArray:
        """Return a number of each run's tow, shape (runs,); NaN where it is not known."""
        return self.get_of_tows(column)[self.tow]

    def has_channel(self, channel: str) -> BoolArray:
        """Return which tows have a channel, `wind` or `log2`, shape (tows,)."""
        return np.asarray(
            self.get_of_tows(f"{channel}_measured") != 0.0
        )  # also where it is not known

    @cached_property
    def trusted(self) -> BoolArray:
        """Tows that the rest of the archive does not rule out, shape (tows,).

        Tows with a doubted speed are kept: the log may be off, and only those tows can show it.
        """
        others = pl.col("doubts").list.set_difference(pl.lit([DOUBTED_SPEED]))
        return self.frame.select((others.list.len() == 0).fill_null(True)).to_series().to_numpy()

    @cached_property
    def direction(self) -> IntArray:
        """1 out, -1 back, shape (runs,)."""
        return self.blocks.runs["direction"].to_numpy().astype(np.int64)

    @cached_property
    def is_in_second_file(self) -> BoolArray:
        """Runs of the second file of a combined tow, shape (runs,)."""
        return self.blocks.runs["run"].to_numpy() > SECOND_FILE_OFFSET

    @property
    def file(self) -> IntArray:
        """Index of each run's file, two per tow, shape (runs,)."""
        return 2 * self.tow + self.is_in_second_file

    @property
    def target_speed_ratio(self) -> FloatArray:
        """Intended speed / declared speed, shape (runs,)."""
        return self.blocks.runs["target_speed_ratio"].to_numpy()

    @property
    def lost_s(self) -> FloatArray:
        """Time left out of each run, shape (runs,); 0 where nothing is said."""
        runs = self.blocks.runs
        return runs["lost_s"].to_numpy() if "lost_s" in runs.columns else np.zeros(len(self.tow))

    @property
    def selected(self) -> BoolArray:
        """Runs that the tow list says to use, shape (runs,)."""
        return self.blocks.runs["selected"].to_numpy()

    def count(self, runs: BoolArray) -> IntArray:
        """Return the number of marked runs of each tow, shape (tows,)."""
        return np.bincount(self.tow, runs, self.size).astype(np.int64)

    def any(self, runs: BoolArray) -> BoolArray:
        """Return whether any run of each tow is marked, shape (tows,)."""
        return self.count(runs) > 0

    def both_ways(self, runs: BoolArray) -> BoolArray:
        """Return whether runs out and runs back of each tow are marked, shape (tows,)."""
        return self.any(runs & (self.direction == OUT)) & self.any(runs & (self.direction == BACK))

    def mean(self, values: FloatArray, runs: BoolArray) -> FloatArray:
        """Return the mean of a run quantity over the marked runs of each tow; 0 without any."""
        total = np.bincount(self.tow, np.where(runs, values, 0.0), self.size)
        return np.asarray(total / np.maximum(self.count(runs), 1), dtype=np.float64)

    def mean_of_ways(self, values: FloatArray, runs: BoolArray) -> FloatArray:
        """Return the mean of out and back, each way with the same weight; NaN without both."""
        ways = (self.mean(values, runs & (self.direction == way)) for way in (OUT, BACK))
        return np.where(self.both_ways(runs), 0.5 * sum(ways), np.nan)

    @cached_property
    def place(self) -> IntArray:
        """Rank of each run within its tow: 0, 1, 2, ..., shape (runs,)."""
        first = np.searchsorted(self.tow, self.tow, side="left")
        return np.asarray(np.arange(len(self.tow)) - first, dtype=np.int64)

    def group_by_tow(self, values: FloatArray | BoolArray) -> FloatArray:
        """Return a run quantity per tow, shape (tows, most runs of a tow); 0 without a run."""
        place = self.place
        rows = np.zeros((self.size, int(place.max(initial=0)) + 1))
        rows[self.tow, place] = values
        return rows
