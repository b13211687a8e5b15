"""A run that is judged, and the statistics of each of its channels."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from pipeline.arrays import BoolArray
from pipeline.channels import SECOND_FILE_OFFSET
from pipeline.messages import say
from pipeline.tables.row import Row
from warehouse.archive.faults import Fault
from warehouse.archive.samples.frame import OUTPUT_NAMES

VANE_TURNS_M_S: Final = 0.5
CLIPPED_TIMES: Final = 3.0
"""Samples at the highest value, times those at the next one, where coarse steps explain them."""

Array = NDArray[np.float32]
CHANNELS: Final = {key: name for key, name in OUTPUT_NAMES.items() if key != "run"}
COLUMN_OF: Final = {
    "log1": "log1",
    "log2": "log2",
    "gps": "gps",
    "force": "kracht",
    "wind_speed": "wind [m/s]",
    "wind_angle": "wind [gra]",
}
"""What a volunteer calls a channel: the header of its column."""

SPARE: Final = ("log2", "gps")
"""Channels without which a run goes on."""
SPEEDS: Final = ("log1", "log2", "gps")
HEADER: Final = 1
FIRST_ROW: Final = 2
"""Line of the first row of a tow's samples where nothing but a header is above it."""

Cost = Literal["run", "column", "seconds"]
"""What a fault costs: the run, a spare channel in it, or some of its samples."""

_THEN: Final = {
    "run": say("the run is left out"),
    "column": say("the run goes on without this column"),
    "seconds": say("the run goes on without them"),
}


@dataclass(frozen=True)
class Statistics:
    """What a channel does in a run, measured when it is first asked for; NaN without any number.

    Attributes:
        values: its samples.
        moves: where the instrument must move; None for everywhere.
    """

    values: Array
    rate_hz: int
    moves: BoolArray | None = None

    @cached_property
    def median(self) -> float:
        """Of every tenth sample: only gross faults are looked for, and all of them take long."""
        some = self.values[::10]
        return float(np.nanmedian(some)) if np.isfinite(some).any() else np.nan

    @cached_property
    def mean(self) -> float:
        """Of the samples that are numbers."""
        known = np.isfinite(self.values).any()
        return float(np.nanmean(self.values, dtype=np.float64)) if known else np.nan

    @cached_property
    def extremes(self) -> tuple[float, float]:
        """The lowest and the highest value."""
        return float(np.fmin.reduce(self.values)), float(np.fmax.reduce(self.values))

    @cached_property
    def changes_hz(self) -> float:
        """Changes of value a second."""
        changes = np.count_nonzero(self.values[1:] != self.values[:-1])
        return float(changes) * self.rate_hz / len(self.values)

    @cached_property
    def held(self) -> tuple[float, int]:
        """Seconds of the longest stretch of one value where it must move, and its first row."""
        changes, moves = self.values[1:] != self.values[:-1], self.moves
        starts, lengths = stretches(changes if moves is None else changes | np.diff(moves))
        lengths = lengths if moves is None else lengths * moves[starts]
        longest = int(lengths.argmax())
        return float(lengths[longest]) / self.rate_hz, int(starts[longest])

    @cached_property
    def clipped_percent(self) -> tuple[float, int]:
        """Samples at the highest value, 0 where coarse steps explain them; the row of the first."""
        highest = self.extremes[1]
        at_end = self.values == highest
        below = np.nanmax(self.values, where=~at_end & np.isfinite(self.values), initial=-np.inf)
        is_coarse = at_end.sum() <= CLIPPED_TIMES * (self.values == below).sum()
        return (0.0 if is_coarse else 100.0 * float(at_end.mean())), int(at_end.argmax())


@dataclass(frozen=True)
class Run:
    """One selected run of a tow.

    Attributes:
        tow: a row of `ArchiveIndex.tows`.
        number: 21 and on are those of the second file.
        start: its first row in the samples of the tow.
    """

    tow: Row
    number: int
    start: int
    intended_m_s: float
    planned_s: float
    channels: Mapping[str, Array]

    @property
    def rate_hz(self) -> int:
        """Samples per second."""
        rate: int = self.tow["sample_rate_hz"]
        return rate

    @property
    def seconds(self) -> float:
        """How long it lasts."""
        return len(self.channels["log1"]) / self.rate_hz

    @property
    def path(self) -> str:
        """Its file, or the files that are a run each."""
        return path_of(self.tow, self.number)

    @property
    def first_line(self) -> int:
        """The line of its first row, counted over all samples of the tow."""
        return FIRST_ROW + self.start

    @property
    def name(self) -> str:
        """What a sentence calls it."""
        if self.number > SECOND_FILE_OFFSET:
            return say("Run b{}", self.number - SECOND_FILE_OFFSET)
        return say("Run {}", self.number)

    @cached_property
    def statistics(self) -> Mapping[str, Statistics]:
        """What each channel does; cups may stand still, and a vane needs wind."""
        moves = {}
        if "wind_speed" in self.channels:
            wind = self.channels["wind_speed"]
            moves = {"wind_speed": wind > 0.0, "wind_angle": wind > VANE_TURNS_M_S}
        return {k: Statistics(v, self.rate_hz, moves.get(k)) for k, v in self.channels.items()}

    def fault(
        self, reason_code: str, what: str, cost: Cost, row: int = 0, lost_s: float | None = None
    ) -> Fault:
        """What is lost of this run, and from which of its rows on."""
        message = say("{}: {what}; {then}.", self.name, what=what, then=_THEN[cost])
        return Fault(
            self.path,
            self.tow["tow_id"],
            self.first_line + row,
            reason_code,
            message,
            "run" if cost == "run" else "seconds",
            self.number,
            self.seconds if lost_s is None else lost_s,
        )

    def without(self, *keys: str) -> "Run":
        """The run with NaN for all samples of some channels."""
        gone = {key: np.full_like(self.channels[key], np.nan) for key in keys}
        return replace(self, channels={**self.channels, **gone})


def fault_of_all(
    runs: Sequence[Run], reason_code: str, message: str, lost_s: float | None = None
) -> Fault:
    """What all runs of a tow lose of one channel."""
    first, seconds = runs[0], sum(run.seconds for run in runs)
    return Fault(
        first.path,
        first.tow["tow_id"],
        first.first_line,
        reason_code,
        message,
        "seconds",
        lost_s=seconds if lost_s is None else lost_s,
    )


def path_of(tow: Row, run: int) -> str:
    """The file of a run, or the files that are a run each."""
    path: str = tow["second_path" if run > SECOND_FILE_OFFSET else "samples_path"]
    return path


def second_means(values: Array, rate_hz: int) -> NDArray[np.float64]:
    """The mean of every whole second, NaN where one of its samples is left out."""
    seconds = len(values) // rate_hz
    means: NDArray[np.float64] = (
        values[: seconds * rate_hz].reshape(seconds, rate_hz).mean(axis=1, dtype=np.float64)
    )
    return means


def stretches(changes: BoolArray) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """First rows and lengths of stretches, given whether each sample differs from that before."""
    starts = np.concatenate(([0], np.flatnonzero(changes) + 1))
    return starts, np.diff(starts, append=len(changes) + 1)


def what_it_holds(value: float) -> str:
    """What a sentence says of a value."""
    return say("holds {:.6g}", value) if np.isfinite(value) else say("holds no ordinary number")
