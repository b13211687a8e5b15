"""A tow that is judged: its runs, what is left of their samples, and what was found."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Final, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pipeline.arrays import BoolArray
from pipeline.channels import SECOND_FILE_OFFSET
from pipeline.messages import Sentence, say
from pipeline.tables.row import Row
from warehouse.archive.faults import DefectiveFileError, Fault, Lost
from warehouse.archive.samples.frame import OUTPUT_NAMES
from warehouse.archive.samples.tow import Place

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
HEADER: Final = -1
"""Stands for the row of the header."""

Cost = Literal["run", "column", "seconds"]
"""What a fault costs: the run, a spare channel in it, or some of its samples."""


_THEN: Final = {
    "run": say("the run is left out"),
    "column": say("the run goes on without this column"),
    "seconds": say("the run goes on without them"),
}


class Measured(NamedTuple):
    """What a channel holds in a run, or in a typical one; NaN where it holds no number."""

    median: float
    lowest: float
    highest: float
    changes_hz: float


@dataclass(eq=False)
class Run:
    """One selected run of a tow.

    Attributes:
        number: 21 and on are those of the second file.
        start: its first row in the samples of the tow.
        channels: its samples; those that are left out become NaN.
    """

    number: int
    start: int
    rate_hz: int
    intended_m_s: float
    planned_s: float
    channels: dict[str, Array]

    @property
    def seconds(self) -> float:
        """How long it lasts."""
        return len(self.channels["log1"]) / self.rate_hz

    @property
    def name(self) -> Sentence:
        """What a sentence calls it."""
        if self.number > SECOND_FILE_OFFSET:
            return say("Run b{}", self.number - SECOND_FILE_OFFSET)
        return say("Run {}", self.number)

    @cached_property
    def measured(self) -> dict[str, Measured]:
        """What each channel held before any sample was left out."""
        return {key: _measured(values, self.rate_hz) for key, values in self.channels.items()}

    def second_means(self, values: Array) -> NDArray[np.float64]:
        """The mean of every whole second of a channel, NaN where one of its samples is left out."""
        seconds = values[: len(values) // self.rate_hz * self.rate_hz].reshape(-1, self.rate_hz)
        return np.asarray(seconds.mean(axis=1, dtype=np.float64))


def _measured(values: Array, rate_hz: int) -> Measured:
    """The median is of every tenth sample: only gross faults are looked for, and all take long."""
    some = values[::10]
    return Measured(
        float(np.nanmedian(some)) if np.isfinite(some).any() else np.nan,
        float(np.fmin.reduce(values)),
        float(np.fmax.reduce(values)),
        float(np.count_nonzero(values[1:] != values[:-1])) * rate_hz / len(values),
    )


@dataclass
class Judgement:
    """What is left of a tow, and what was found.

    Attributes:
        tow: a row of `ArchiveIndex.tows`.
        place: where a row of its samples stands.
        wanted: how many runs were selected.
        runs: those that are left.
        faults: what was lost: seconds and runs.
    """

    tow: Row
    place: Place
    wanted: int = 0
    runs: list[Run] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)

    def lose(
        self,
        run: Run,
        reason_code: str,
        what: Sentence,
        cost: Cost,
        row: int = 0,
        lost_s: float | None = None,
    ) -> None:
        """Something of a run, from one of its rows on; of a run that is lost no less is told."""
        message = say("{}: {what}; {then}.", run.name, what=what, then=_THEN[cost])
        seconds = run.seconds if lost_s is None else lost_s
        lost: Lost = "run" if cost == "run" else "seconds"
        if cost == "run":
            self.runs = [other for other in self.runs if other is not run]
            self.faults = [f for f in self.faults if f.run != run.number or f.lost == "run"]
        self._add(run.start + row, reason_code, message, lost, run.number, seconds)

    def lose_of_all(
        self, reason_code: str, message: Sentence, *channels: str, row: int | None = None
    ) -> None:
        """Channels of all runs; a fault without a channel costs nothing."""
        seconds = sum(run.seconds for run in self.runs) if channels else 0.0
        where = self.runs[0].start if row is None else row
        self._add(where, reason_code, message, "seconds", None, seconds)
        for run in self.runs:
            for channel in channels:
                run.channels.pop(channel, None)

    def _add(
        self,
        row: int,
        reason_code: str,
        message: Sentence,
        lost: Lost,
        run: int | None,
        lost_s: float,
    ) -> None:
        path, line = self.place(row)
        tow_id = self.tow["tow_id"]
        self.faults.append(Fault(path, tow_id, line, reason_code, message, lost, run, lost_s))

    def lost(self, reason_code: str, message: Sentence, row: int = HEADER) -> DefectiveFileError:
        """The error for a tow that is lost whole."""
        path, line = self.place(row)
        return DefectiveFileError(reason_code, message, line, path)

    def check_left(self) -> None:
        """Raises where half of the runs or more are lost, for the first reason: so is the tow."""
        if 2 * len(self.runs) > self.wanted:
            return
        first = next(fault for fault in self.faults if fault.lost == "run")
        raise DefectiveFileError(first.reason_code, first.message, first.line, first.path)


def stretches(changes: BoolArray) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """First rows and lengths of stretches, given whether each sample differs from that before."""
    starts = np.concatenate(([0], np.flatnonzero(changes) + 1))
    return starts, np.diff(starts, append=len(changes) + 1)


def what_it_holds(value: float) -> Sentence:
    """What a sentence says of a value."""
    return say("holds {:.6g}", value) if np.isfinite(value) else say("holds no ordinary number")
