"""Adding up a tow's samples: one compiled loop makes the sums of every second.

What the sums are is in `pipeline.blocks.run_blocks`. The loop is compiled by Numba. Its result
follows from the samples alone, to the last bit and on every processor: it uses only additions,
multiplications and divisions, in a fixed order, and no mathematical library (docs/decisions/0015).
It has no branches, so that the compiler can work on several samples at a time; sample i of a block
is added to lane i modulo `LANES`, and the lanes to each other at the end. Importing this module
compiles the loop, or finds it compiled: import it late.
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

LANES: Final = np.uintp(16)
"""Running sums of each kind: enough for the widest registers, few enough for the nearest cache."""

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
_FORCE, _LOG1, _LOG2, _MEAN, _AIR, _WIND, _GPS, _ROWS = 0, 1, 10, 19, 28, 33, 38, 40
"""Where the sums of each kind begin in `SUM_NAMES`, and how many sums there are.

Plain numbers: the compiled loop is kept as long as this file does not change."""


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
        neighbours, threads or the processor.
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
    sums = np.empty((_ROWS, len(n)))
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
    return samples.with_columns(
        value.cast(pl.Float32).alias(name)
        for name, value in _NOT_MEASURED.items()
        if samples[name].null_count()
    ).with_columns(
        pl.when(pl.col("log2_m_s").is_nan().all().over("run"))
        .then("log1_m_s")
        .otherwise("log2_m_s")
        .alias("log2_m_s")
    )


P = ParamSpec("P")
R = TypeVar("R")


def _compiled(*signature: Any, **options: Any) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Numba's decorator, which has no types; dividing by zero gives infinity, as in NumPy."""
    decorator: Callable[[Callable[P, R]], Callable[P, R]]
    decorator = njit(*signature, error_model="numpy", **options)
    return decorator


_part = _compiled(inline="always")

Lane = int | np.uintp
Channel = NDArray[np.float32]


@_part
def _at(row: int, lane: Lane) -> np.uintp:
    """Place of a running sum; unsigned, or Numba would look for indices from the end."""
    return np.uintp(row) * LANES + lane


@_part
def _cos_sin(angle_deg: float) -> tuple[float, float]:
    """Cosine and sine, to 2e-15: from the tangent of a quarter of what is left after whole turns.

    The tangent is the eighth convergent of Lambert's continued fraction,
    tan x = x / (1 - x^2 / (3 - x^2 / (5 - ...))), as a fraction n / d. Twice the angle of
    a vector (d, n) is the angle of (d^2 - n^2, 2 n d).
    """
    turns = np.rint(angle_deg * (1.0 / 360.0))
    x = (angle_deg - 360.0 * turns) * (math.pi / 720.0)
    z = x * x
    n = x * (2027025.0 + z * (-270270.0 + z * (6930.0 + z * -36.0)))
    d = 2027025.0 + z * (-945945.0 + z * (51975.0 + z * (-630.0 + z)))
    d2, n2 = d * d, n * n
    cos_half, sin_half = d2 - n2, 2.0 * n * d  # times d2 + n2
    scale = 1.0 / ((d2 + n2) * (d2 + n2))
    return (cos_half * cos_half - sin_half * sin_half) * scale, 2.0 * cos_half * sin_half * scale


Kind = tuple[float, ...]
Terms = tuple[Kind, ...]
"""What a sample adds to the sums, kind by kind in the order of `SUM_NAMES`."""


@_part
def _of_air(along: float, cos: float, sin: float) -> Kind:
    """The squares that air force is proportional to, the first two from ahead and from behind.

    These are signed, in m2/s2: `head` is u|u| with u = w cos a, the wind along the course (old
    rule); `front` and `side` weigh it with |cos a| and |sin a| (oblique rule of 2015). Sources:
    presentation 2015, "Windweerstand" and "Dwarse tegenwind".
    """
    head = along * abs(along)
    ahead, behind = 0.5 * (head + abs(head)), 0.5 * (head - abs(head))
    front = abs(cos)
    return ahead, behind, ahead * front, behind * front, head * abs(sin)


@_part
def _inverse_squares(log1: float, log2: float, mean: float) -> tuple[float, float, float]:
    """1 / v^2 of the speed sources with one division: it takes as long as ten products.

    The product of three squares of 32-bit numbers is within the range of 64 bits.
    """
    a, b, c = log1 * log1, log2 * log2, mean * mean
    ab = a * b
    inverse = 1.0 / (ab * c)
    times_c = inverse * c
    return times_c * b, times_c * a, inverse * ab


@_part
def _of_source(v: float, inv_v2: float, force: float, air: Kind) -> Kind:
    """What is summed of one speed source."""
    cw = force * inv_v2
    return (
        v,
        inv_v2,
        cw,
        cw * cw,
        air[0] * inv_v2,
        air[1] * inv_v2,
        air[2] * inv_v2,
        air[3] * inv_v2,
        air[4] * inv_v2,
    )


@_part
def _of_wind(wind: float, cos: float, sin: float) -> Kind:
    return wind, cos, sin, wind * cos, wind * sin


@_part
def _of_gps(gps: float) -> Kind:
    """Ground speed, where there is one: the others are not numbers."""
    present = np.isfinite(gps)
    return (gps if present else 0.0), (1.0 if present else 0.0)


_NO_SAMPLE: Final = ((0.0,), *[(0.0,) * 9] * 3, *[(0.0,) * 5] * 2, (0.0,) * 2)


@_part
def _terms(
    i: Lane,
    log1: Channel,
    log2: Channel,
    gps: Channel,
    force: Channel,
    wind: Channel,
    angle_deg: Channel,
) -> Terms:
    v1, v2 = np.float64(log1[i]), np.float64(log2[i])
    f, w = np.float64(force[i]), np.float64(wind[i])
    mean = 0.5 * (v1 + v2)
    inverse1, inverse2, inverse_mean = _inverse_squares(v1, v2, mean)
    cos, sin = _cos_sin(np.float64(angle_deg[i]))
    air = _of_air(w * cos, cos, sin)
    return (
        (f,),
        _of_source(v1, inverse1, f, air),
        _of_source(v2, inverse2, f, air),
        _of_source(mean, inverse_mean, f, air),
        air,
        _of_wind(w, cos, sin),
        _of_gps(np.float64(gps[i])),
    )


@_part
def _add_kind(sums: FloatArray, row: int, lane: Lane, one: Kind, two: Kind) -> None:
    for k in range(len(one)):
        sums[_at(row + k, lane)] += one[k] + two[k]


@_part
def _add(sums: FloatArray, lane: Lane, one: Terms, two: Terms) -> None:
    """Adds two samples to each other and then to the running sums: half as much is stored."""
    _add_kind(sums, _FORCE, lane, one[0], two[0])
    _add_kind(sums, _LOG1, lane, one[1], two[1])
    _add_kind(sums, _LOG2, lane, one[2], two[2])
    _add_kind(sums, _MEAN, lane, one[3], two[3])
    _add_kind(sums, _AIR, lane, one[4], two[4])
    _add_kind(sums, _WIND, lane, one[5], two[5])
    _add_kind(sums, _GPS, lane, one[6], two[6])


_SAMPLES: Final = types.Array(float32, 1, "C", readonly=True)


def _compiled_once(signature: object) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Compiled now, or as it was kept beside this file or in the user's folder of caches."""

    def decorator(function: Callable[P, R]) -> Callable[P, R]:
        try:
            return _compiled(signature, nogil=True, cache=True)(function)
        except RuntimeError:  # neither folder may be written: two seconds of compiling, each time
            return _compiled(signature, nogil=True)(function)

    return decorator


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
    """Fills `totals`, shape (sums, blocks); `ends` says where each block ends, shape (blocks,)."""
    sums = np.empty(np.uintp(_ROWS) * LANES)
    end = 0
    for block in range(len(ends)):
        start, end = end, ends[block]
        sums[:] = 0.0
        first, after = np.uintp(start), np.uintp(end)
        while first + LANES + LANES <= after:
            for lane in range(LANES):
                i = first + lane
                one = _terms(i, log1, log2, gps, force, wind, angle_deg)
                two = _terms(i + LANES, log1, log2, gps, force, wind, angle_deg)
                _add(sums, lane, one, two)
            first += LANES + LANES
        while first < after:
            for lane in range(min(LANES, after - first)):
                one = _terms(first + lane, log1, log2, gps, force, wind, angle_deg)
                _add(sums, lane, one, _NO_SAMPLE)
            first += LANES
        for row in range(_ROWS):
            total = 0.0
            for lane in range(LANES):
                total += sums[_at(row, lane)]
            totals[row, block] = total
