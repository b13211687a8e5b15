"""A run that is judged, and what can be right of it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from pipeline.arrays import BoolArray
from pipeline.channels import SECOND_FILE_OFFSET
from pipeline.messages import say
from warehouse.archive.faults import Fault, Lost
from warehouse.archive.samples.frame import OUTPUT_NAMES

LEFT_OUT_S: Final = 2.0
"""Longest time in all of a run in which what the run point needs may be left out; as long again for
log 2 and the GPS each."""
SPEED_RATIO: Final = (0.5, 1.6)
SPEEDS_AGREE_RATIO: Final = (0.6, 1.4)
RESISTANCE_KG_M: Final = (2.0, 500.0)
"""Mean force over intended speed squared; sloops lie between 15 and 60."""
WIND_SPEED_M_S: Final = (0.0, 40.0)
WIND_MEAN_M_S: Final = 20.0
WIND_ANGLE_DEG: Final = (-180.0, 360.0)

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
WIND: Final = ("wind_speed", "wind_angle")
HEADER: Final = 1
FIRST_ROW: Final = 2
"""Line of the first row of a tow's samples where nothing but a header is above it."""


@dataclass(frozen=True)
class Run:
    """One selected run.

    Attributes:
        number: 21 and on are those of the second file.
        path: its file, or the files that are a run each.
        first_line: of its first row, counted over the rows of that file.
    """

    tow_id: str
    number: int
    path: str
    first_line: int
    rate_hz: int
    intended_m_s: float
    planned_s: float
    channels: Mapping[str, Array]

    @property
    def seconds(self) -> float:
        """How long it lasts."""
        return len(self.channels["log1"]) / self.rate_hz

    @property
    def name(self) -> str:
        """What a sentence calls it."""
        if self.number > SECOND_FILE_OFFSET:
            return say("Run b{}", self.number - SECOND_FILE_OFFSET)
        return say("Run {}", self.number)

    def fault(
        self, reason_code: str, message: str, row: int, lost: Lost, lost_s: float | None = None
    ) -> Fault:
        """What is lost of this run; `row` counts from its start."""
        line = self.first_line + row
        lost_s = self.seconds if lost_s is None else lost_s
        return Fault(self.path, self.tow_id, line, reason_code, message, lost, self.number, lost_s)

    def without(self, *keys: str) -> "Run":
        """The run with NaN for all samples of some channels."""
        gone = {key: np.full_like(self.channels[key], np.nan) for key in keys}
        return replace(self, channels={**self.channels, **gone})


def known_of(measure: Callable[[Array], float], values: Array) -> float:
    """A measure of the samples that are numbers; NaN without any."""
    return float(measure(values)) if np.isfinite(values).any() else np.nan


def mean_of(values: Array) -> float:
    """Mean of the samples that are numbers."""
    return float(np.nanmean(values, dtype=np.float64))


def median_of(values: Array) -> float:
    """Median of every tenth sample: only gross faults are looked for, and all of them take long."""
    return known_of(np.nanmedian, values[::10])


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


def within(value: float, limits: tuple[float, float], unit: float = 1.0) -> bool:
    """Whether a value lies between two limits, given in this unit."""
    return limits[0] * unit <= value <= limits[1] * unit


def what_it_holds(value: float) -> str:
    """What a sentence says of a value."""
    return say("holds {:.6g}", value) if np.isfinite(value) else say("holds no ordinary number")


def what_then(lost: Lost) -> str:
    """What a sentence says of the run from which so much is lost."""
    if lost == "run":
        return say("up to {:g} s may be missing, so the run is left out", LEFT_OUT_S)
    return say("the run goes on without them")
