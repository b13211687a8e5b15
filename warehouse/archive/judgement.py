"""A tow that is judged: its runs, what is left of their samples, and what was lost."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from pipeline.arrays import BoolArray
from pipeline.channels import SECOND_FILE_OFFSET
from pipeline.messages import Sentence, say
from pipeline.tables.row import Row
from warehouse.archive.faults import DefectiveFileError, Fault, Lost
from warehouse.archive.samples import OUTPUT_NAMES, Place

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
HEADER: Final = -1
"""Stands for the row of the header."""

Cost = Literal["run", "column", "seconds"]
"""What a fault costs: the run, a spare channel in it, or some of its samples."""
_THEN: Final = {
    "run": say("the run is left out"),
    "column": say("the run goes on without this column"),
    "seconds": say("the run goes on without them"),
}


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
    rate_hz: float
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
    def medians(self) -> dict[str, float]:
        """The median of each channel before any sample was left out; NaN for no number.

        Of every tenth sample: only gross faults are looked for, and all take long.
        """
        medians = {}
        for key, values in self.channels.items():
            some = values[::10]
            medians[key] = float(np.nanmedian(some)) if np.isfinite(some).any() else np.nan
        return medians

    def typical(self, channel: str) -> tuple[float, float, float]:
        """Return the median, the lowest and the highest value of a channel."""
        values = self.channels[channel]
        return self.medians[channel], np.fmin.reduce(values), np.fmax.reduce(values)

    def changes_hz(self, channel: str) -> float:
        """Return how many times a second a channel changes."""
        values = self.channels[channel]
        return float(np.count_nonzero(values[1:] != values[:-1])) * self.rate_hz / len(values)

    def second_means(self, values: Array) -> NDArray[np.float64]:
        """Return the mean of every whole second of a channel; NaN where a sample is left out."""
        rate = round(self.rate_hz)
        seconds = values[: len(values) // rate * rate].reshape(-1, rate)
        return np.asarray(seconds.mean(axis=1, dtype=np.float64))


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

    def has_channels(self, *channels: str) -> bool:
        """Whether all runs have some channels."""
        return all(run.channels.keys() >= set(channels) for run in self.runs)

    def typical_median(self, channel: str) -> float:
        """Return the median over the runs of their median of a channel."""
        return float(np.median([run.medians[channel] for run in self.runs]))

    def lose(
        self,
        run: Run,
        reason_code: str,
        what: Sentence,
        cost: Cost,
        row: int = 0,
        lost_s: float | None = None,
    ) -> None:
        """Add a fault that costs seconds of a run or the run; a lost run keeps no lesser fault."""
        message = say("{}: {what}; {then}.", run.name, what=what, then=_THEN[cost])
        if cost == "run":
            self.runs = [other for other in self.runs if other is not run]
            self.faults = [f for f in self.faults if f.run != run.number or f.lost == "run"]
        lost: Lost = "run" if cost == "run" else "seconds"
        seconds = run.seconds if lost_s is None else lost_s
        self._add(run.start + row, reason_code, message, lost, run.number, seconds)

    def lose_of_all(self, reason_code: str, message: Sentence, *channels: str) -> None:
        """Add a fault that costs some channels of all runs; without a channel it costs nothing."""
        seconds = sum(run.seconds for run in self.runs) if channels else 0.0
        self._add(self.runs[0].start, reason_code, message, "seconds", None, seconds)
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
        fault = Fault(
            path=path,
            tow_id=self.tow["tow_id"],
            line=line,
            reason_code=reason_code,
            message=message,
            lost=lost,
            run=run,
            lost_s=lost_s,
        )
        self.faults.append(fault)

    def make_lost_error(
        self, reason_code: str, message: Sentence, row: int = HEADER
    ) -> DefectiveFileError:
        """Return the error for a tow that is lost whole."""
        path, line = self.place(row)
        return DefectiveFileError(reason_code, message, line, path)

    def check_left(self) -> None:
        """Raise where half of the runs or more are lost, for the first reason: so is the tow."""
        if 2 * len(self.runs) > self.wanted:
            return
        first = next(fault for fault in self.faults if fault.lost == "run")
        raise DefectiveFileError(first.reason_code, first.message, first.line, first.path)


def find_stretches(changes: BoolArray) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return first rows and lengths of stretches of one value.

    Args:
        changes: whether each sample but the first differs from that before; shape (samples - 1,).
    """
    starts = np.concatenate(([0], np.flatnonzero(changes) + 1))
    return starts, np.diff(starts, append=len(changes) + 1)


def describe_value(value: float) -> Sentence:
    """Return a value as a sentence writes it."""
    return say("holds {:.6g}", value) if np.isfinite(value) else say("holds no ordinary number")
