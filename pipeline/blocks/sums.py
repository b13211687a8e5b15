"""Adding up a tow's samples: one compiled loop makes the sums of every second.

What the sums are is in `pipeline.blocks.run_blocks`. The loop is compiled by Numba, second by
second, so that what it works on stays in the processor's cache. Numba may add the samples of a
second in the order that suits the processor: another one leaves other last bits
(docs/decisions.md). Importing this module compiles the loop, or finds it compiled: import it
late.
"""

import math
from collections.abc import Callable
from typing import Any, Final, ParamSpec, TypeVar

import numpy as np
import polars as pl
from numba import float32, float64, int64, njit, types
from numpy.typing import NDArray

from pipeline.arrays import FloatArray, IntArray
from pipeline.blocks.run_blocks import BLOCK_SCHEMA, SUM_NAMES

_CHANNELS: Final = (
    "log1_m_s",
    "log2_m_s",
    "gps_m_s",
    "force_n",
    "wind_speed_m_s",
    "wind_angle_deg",
)
_GPS_NAME: Final = "gps_m_s"
_NOT_MEASURED: Final = {
    "log2_m_s": pl.col("log1_m_s"),
    "wind_speed_m_s": pl.col("log1_m_s"),
    "wind_angle_deg": pl.lit(0.0),
}


def block_sums(samples: pl.DataFrame, sample_rate_hz: int) -> pl.DataFrame:
    """Adds up the samples of one tow per run and second.

    Args:
        samples: columns of `pipeline.channels.SAMPLE_SCHEMA`, each run contiguous, speeds positive.
            Where no wind was measured the air is taken to be still; where there is no log 2, in the
            tow or in a run, it reads as log 1. A sample that is not a number in any channel but the
            GPS is left out of its block.
        sample_rate_hz: samples per second.

    Returns:
        One row per run and second: `run`, `second` (0 is the first), `n` (samples; the last
        block of a run may hold fewer, one with samples left out any number down to 0) and the
        sums of `SUM_NAMES`, float64. A sum depends on the samples of its block alone, not on its
        neighbours or threads; on another processor its last bits may be others.
    """
    number, second, n = _seconds(samples["run"].to_numpy(), sample_rate_hz)
    filled = _filled(samples)
    channels = {name: filled[name].to_numpy() for name in _CHANNELS}
    measured = np.logical_and.reduce(
        [np.isfinite(values) for name, values in channels.items() if name != _GPS_NAME]
    )
    if not measured.all():
        block = np.repeat(np.arange(len(n)), n)
        n = np.bincount(block[measured], minlength=len(n))
        channels = {name: values[measured] for name, values in channels.items()}
    sums = np.empty((len(SUM_NAMES), len(n)))
    _add_up(np.cumsum(n), sums, *channels.values())
    return pl.DataFrame(
        {
            "run": number,
            "second": second,
            "n": n,
            **dict(zip(SUM_NAMES, sums, strict=True)),
        },
        schema={name: kind for name, kind in BLOCK_SCHEMA.items() if name != "tow_id"},
    )


def _seconds(run: NDArray[np.int8], rate_hz: int) -> tuple[NDArray[np.int8], IntArray, IntArray]:
    """Run number, second and number of samples of every block, each of shape (blocks,)."""
    first = np.flatnonzero(np.append(True, run[1:] != run[:-1])[: len(run)])
    length = np.diff(np.append(first, len(run)))
    blocks = -(-length // rate_hz)
    which = np.repeat(np.arange(len(first)), blocks)
    second = np.arange(len(which)) - (np.cumsum(blocks) - blocks)[which]
    return run[first][which], second, np.minimum(length[which] - rate_hz * second, rate_hz)


def _filled(samples: pl.DataFrame) -> pl.DataFrame:
    """The samples with channels that were not measured as the sums take them."""
    filled = samples.with_columns(
        value.cast(pl.Float32).alias(name)
        for name, value in _NOT_MEASURED.items()
        if samples[name].null_count()
    )
    log2 = pl.col("log2_m_s")
    if not filled["log2_m_s"].is_nan().any():
        return filled
    return filled.with_columns(
        pl.when(log2.is_nan().all().over("run")).then("log1_m_s").otherwise(log2).alias("log2_m_s")
    )


P = ParamSpec("P")
R = TypeVar("R")


def _compiled(*signature: Any, **options: Any) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Numba's decorator, which has no types.

    Dividing by zero gives infinity, as in NumPy; a sum may be made of several running sums.
    """
    decorator: Callable[[Callable[P, R]], Callable[P, R]]
    decorator = njit(
        *signature, error_model="numpy", fastmath={"reassoc", "nsz", "contract"}, **options
    )
    return decorator


Channel = NDArray[np.float32]


@_compiled()
def _total(values: FloatArray) -> float:
    total = 0.0
    for i in range(len(values)):  # going over the values themselves takes twice as long
        total += values[i]
    return total


@_compiled()
def _dot(one: FloatArray, other: FloatArray) -> float:
    total = 0.0
    for i in range(len(one)):
        total += one[i] * other[i]
    return total


@_compiled()
def _cos_sin(angle_deg: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Cosine and sine, to 2e-15: from the tangent of a quarter of what is left after whole turns.

    The tangent is the eighth convergent of Lambert's continued fraction,
    tan x = x / (1 - x^2 / (3 - x^2 / (5 - ...))), as a fraction n / d. Twice the angle of
    a vector (d, n) is the angle of (d^2 - n^2, 2 n d). A mathematical library looks at one angle
    at a time, and takes 10 ms more for a tow.
    """
    cosine, sine = np.empty_like(angle_deg), np.empty_like(angle_deg)
    for i in range(len(angle_deg)):
        turns = np.rint(angle_deg[i] * (1.0 / 360.0))
        x = (angle_deg[i] - 360.0 * turns) * (math.pi / 720.0)
        z = x * x
        n = x * (2027025.0 + z * (-270270.0 + z * (6930.0 + z * -36.0)))
        d = 2027025.0 + z * (-945945.0 + z * (51975.0 + z * (-630.0 + z)))
        d2, n2 = d * d, n * n
        cos_half, sin_half = d2 - n2, 2.0 * n * d  # times d2 + n2
        scale = 1.0 / ((d2 + n2) * (d2 + n2))
        cosine[i] = (cos_half * cos_half - sin_half * sin_half) * scale
        sine[i] = 2.0 * cos_half * sin_half * scale
    return cosine, sine


@_compiled()
def _air(along: FloatArray, cos: FloatArray, sin: FloatArray) -> tuple[FloatArray, ...]:
    """The squares that air force is proportional to, in the order of `AIR_SUMS`.

    These are signed, in m2/s2: `head` is u|u| with u = w cos a, the wind along the course (old
    rule); `front` and `side` weigh it with |cos a| and |sin a| (oblique rule of 2015). Sources:
    presentation 2015, "Windweerstand" and "Dwarse tegenwind".
    """
    head, front = along * np.abs(along), np.abs(cos)
    ahead, behind = 0.5 * (head + np.abs(head)), 0.5 * (head - np.abs(head))
    return ahead, behind, ahead * front, behind * front, head * np.abs(sin)


@_compiled()
def _ground_speed(gps: Channel) -> tuple[float, float]:
    """Sum and number of the samples that have one: the others are not numbers."""
    total, number = 0.0, 0.0
    for speed in gps:
        if np.isfinite(speed):
            total += np.float64(speed)
            number += 1.0
    return total, number


def _compiled_once(signature: object) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Compiled now, or as it was kept beside this file or in the user's folder of caches."""

    def decorator(function: Callable[P, R]) -> Callable[P, R]:
        try:
            return _compiled(signature, nogil=True, cache=True)(function)
        except RuntimeError:  # neither folder may be written: two seconds of compiling, each time
            return _compiled(signature, nogil=True)(function)

    return decorator


_SAMPLES: Final = types.Array(float32, 1, "C", readonly=True)


@_compiled_once(types.void(int64[::1], float64[:, ::1], *[_SAMPLES] * len(_CHANNELS)))
def _add_up(
    ends: IntArray,
    totals: FloatArray,
    log1: Channel,
    log2: Channel,
    gps: Channel,
    force: Channel,
    wind: Channel,
    angle_deg: Channel,
) -> None:
    """Fills `totals`, shape (sums, blocks), in the order of `SUM_NAMES`.

    `ends` says where each block ends, shape (blocks,).
    """
    end = 0
    for block in range(len(ends)):
        start, end = end, ends[block]
        f, w = force[start:end].astype(np.float64), wind[start:end].astype(np.float64)
        v, v2 = log1[start:end].astype(np.float64), log2[start:end].astype(np.float64)
        cos, sin = _cos_sin(angle_deg[start:end].astype(np.float64))
        along = w * cos
        air = _air(along, cos, sin)
        inverse = 1.0 / (v * v)
        cw = f * inverse
        totals[0, block] = _total(f)
        totals[1, block] = _total(v)
        totals[2, block] = _total(inverse)
        totals[3, block] = _total(cw)
        totals[4, block] = _dot(cw, cw)
        for k in range(5):
            totals[5 + k, block] = _dot(air[k], inverse)
        totals[10, block] = _total(v2)
        row = 11
        for values in (*air, w, cos, sin, along, w * sin):
            totals[row, block] = _total(values)
            row += 1
        totals[row, block], totals[row + 1, block] = _ground_speed(gps[start:end])
