"""Random numbers: one independent stream for every thing that is drawn.

Every stream hangs from the seed by the address of what it is for (a boat, a season, a component
of one tow). So tows can be simulated in any order, a season can be added and a defect switched
off without any other number changing. No physics here.
"""

from enum import IntEnum

import numpy as np
import scipy
from numpy.typing import NDArray

FLICKER_S = (0.2, 0.8, 3.2, 12.8, 51.2)
"""Correlation times of the parts of `flicker_noise`."""

Floats = NDArray[np.float64]


class Subject(IntEnum):
    """First part of an address. The numbers are part of every simulated world: never renumber."""

    BOAT = 1
    SEASON = 2
    DAY = 3
    ALTERATION = 4
    TOW = 5
    RACE = 6
    LOG_REPLACED = 7
    SECOND_FILE = 8


class Component(IntEnum):
    """Last part of a tow's address. Never renumber."""

    LOG_OF_TOW = 1
    LOG2_RATIO = 2
    ASKEW = 3
    FAST_RUN = 4
    SCALES = 5
    SLOW = 6
    EMPTY_THWART = 7
    SECOND_FILE = 8
    TEMPERATURE = 9
    SPEED = 10
    RAMP = 11
    GUST = 12
    STEERING = 13
    STREAM = 14
    WIND = 15
    TIDE = 16
    LOG1_SLOW = 20
    LOG1_NOISE = 21
    LOG2_SLOW = 22
    LOG2_NOISE = 23
    GPS = 24
    VANE = 25
    FORCE_SURGE = 26
    FORCE_WANDER = 27
    FORCE_NOISE = 28
    DAMAGE = 29
    LOG1_FLICKER = 30
    LOG2_FLICKER = 31
    SLOW_GUSTS = 32
    STEERING_PEAKS = 33
    SURGE = 34
    FORCE_ZERO = 35


def stream(seed: int, subject: Subject, *address: int) -> np.random.Generator:
    """Return the generator that belongs to this address."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(subject, *address)))


class TowStreams:
    """The streams of one file of a tow, by component; each goes on from run to run."""

    def __init__(self, seed: int, season: int, number: int, subject: Subject) -> None:
        self._address = (subject, season, number)
        self._seed = seed
        self._streams: dict[Component, np.random.Generator] = {}

    def __getitem__(self, component: Component) -> np.random.Generator:
        if component not in self._streams:
            self._streams[component] = stream(self._seed, *self._address, component)
        return self._streams[component]


def coloured_noise(
    rng: np.random.Generator, count: int, step_s: float, correlation_s: float
) -> NDArray[np.float32]:
    """Return stationary noise of unit variance with autocorrelation exp(-t / correlation_s).

    The same process at every sampling rate. Shape (count,).
    """
    decay = np.exp(-step_s / correlation_s)
    white = rng.standard_normal(count + 1, dtype=np.float32)
    gain = np.float32(np.sqrt(1.0 - decay**2))
    coefficients = (np.array([gain]), np.array([1.0, -decay], dtype=np.float32))
    start = np.array([decay * white[0]], dtype=np.float32)
    noise, _ = scipy.signal.lfilter(*coefficients, white[1:], zi=start)
    return np.asarray(noise, dtype=np.float32)


def flicker_noise(rng: np.random.Generator, count: int, step_s: float) -> Floats:
    """Return noise of unit variance with a 1/f spectrum from 1/300 to 1 Hz, shape (count,).

    A sum of first-order processes with equal variances and correlation times that are a factor
    apart has such a spectrum (van der Ziel 1950).
    """
    parts = [coloured_noise(rng, count, step_s, time_s) for time_s in FLICKER_S]
    return np.asarray(np.sum(parts, axis=0, dtype=np.float64) / np.sqrt(len(FLICKER_S)))


def swing(rng: np.random.Generator, time_s: Floats, frequency_hz: float, phase_s: float) -> Floats:
    """Return a swing of unit variance that loses its phase in some seconds, at even times."""
    step_s = time_s[1] - time_s[0]
    cosine = coloured_noise(rng, time_s.size, step_s, phase_s)
    sine = coloured_noise(rng, time_s.size, step_s, phase_s)
    angle = 2 * np.pi * frequency_hz * time_s
    return np.asarray(cosine * np.cos(angle) + sine * np.sin(angle))


def smooth_wander(
    rng: np.random.Generator, count: int, step_s: float, correlation_s: float
) -> Floats:
    """Return stationary noise of unit variance that also has a bounded rate of change.

    Two first-order filters in a row, so its derivative exists (a speed needs that). Shape (count,).
    """
    settle = int(10 * correlation_s / step_s)
    decay = np.exp(-step_s / correlation_s)
    white = rng.standard_normal(settle + count)
    wander = scipy.signal.lfilter([1.0], [1.0, -2.0 * decay, decay**2], white)[settle:]
    # Variance of white noise through a double pole at `decay`.
    variance = (1.0 + decay**2) / (1.0 - decay**2) ** 3
    return np.asarray(wander / np.sqrt(variance))
