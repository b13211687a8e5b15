"""Adding up a tow's samples: one compiled loop makes the sums of every second.

What the sums are stands in `pipeline.blocks`. The loop is compiled by Numba, and written so that
its result follows from the samples alone, to the last bit and on every processor: only additions,
multiplications and divisions, in a fixed order, and no function of a mathematical library
(docs/decisions/0015). It is written without branches, so that the compiler can work on several
samples at a time; sample i of a block is added to lane i modulo `LANES`, and the lanes to each
other at the end. Importing this module compiles the loop, or finds it compiled: import it late.
"""

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any, Final, ParamSpec, TypeVar

import numpy as np
import polars as pl
from numba import float32, float64, int64, njit, types
from numpy.typing import NDArray

from pipeline.arrays import FloatArray, IntArray
from pipeline.blocks import SUM_NAMES

LANES: Final = np.uintp(32)
"""Running sums of each kind: enough for the widest registers, few enough for the nearest cache."""

_CHANNELS: Final = (
    "log1_m_s",
    "log2_m_s",
    "gps_m_s",
    "force_n",
    "wind_speed_m_s",
    "wind_angle_deg",
)
_FORCE, _LOG1, _LOG2, _MEAN, _AIR, _WIND, _GPS, _ROWS = 0, 2, 13, 24, 35, 41, 47, 50
"""Where the sums of each kind begin in `SUM_NAMES`, and how many sums there are.

Plain numbers: the compiled loop is kept as long as this file does not change."""


def block_sums(samples: pl.DataFrame, sample_rate_hz: int) -> pl.DataFrame:
    """Adds up the samples of one tow per run and second.

    Args:
        samples: columns of `pipeline.channels.SAMPLE_SCHEMA`, each run contiguous, speeds positive.
        sample_rate_hz: samples a second.

    Returns:
        One row per run and second: `run`, `second` (0 is the first), `n` (samples; the last
        block of a run may hold fewer) and the sums of `SUM_NAMES`, float64. A sum depends on
        the samples of its block alone, not on its neighbours, threads or the processor.
    """
    run = samples["run"].to_numpy()
    start, end, second = _bounds(run, sample_rate_hz)
    sums = np.empty((_ROWS, len(start)))
    _add_up(start, end, sums, *(samples[name].to_numpy() for name in _CHANNELS))
    return pl.DataFrame(
        [
            pl.Series("run", run[start], pl.Int8),
            pl.Series("second", second, pl.Int16),
            pl.Series("n", end - start, pl.Int32),
            *(pl.Series(name, row) for name, row in zip(SUM_NAMES, sums, strict=True)),
        ]
    )


def _bounds(run: NDArray[np.int8], rate_hz: int) -> tuple[IntArray, IntArray, IntArray]:
    """First sample of each block, the one after its last, and which second of its run it is."""
    changes = np.flatnonzero(run[1:] != run[:-1]) + 1
    runs = list(pairwise([0, *changes.tolist(), len(run)]))
    starts = [np.arange(first, last, rate_hz) for first, last in runs]
    start = np.concatenate(starts)
    last = np.repeat([last for _, last in runs], [len(s) for s in starts])
    second = np.concatenate([np.arange(len(s)) for s in starts])
    return start, np.minimum(start + rate_hz, last), second


P = ParamSpec("P")
R = TypeVar("R")


def _compiled(*signature: Any, **options: Any) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Numba's decorator, which has no types; dividing by zero gives infinity, as in NumPy."""
    decorator: Callable[[Callable[P, R]], Callable[P, R]]
    decorator = njit(*signature, error_model="numpy", **options)
    return decorator


_part = _compiled(inline="always")

Lane = int | np.uintp


@_part
def _at(row: int, lane: Lane) -> np.uintp:
    """Place of a running sum; unsigned, or Numba would look for indices from the end."""
    return np.uintp(row) * LANES + lane


_SIN: Final = tuple((-1) ** (n // 2) / math.factorial(n) for n in range(3, 16, 2))
_COS: Final = tuple((-1) ** (n // 2) / math.factorial(n) for n in range(2, 17, 2))
"""Taylor's series: within an eighth of a turn the first term left out is below 1e-16."""


@_part
def _cos_sin(angle_deg: float) -> tuple[float, float]:
    """Cosine and sine: of what is left after whole quarter turns, turned by those quarters."""
    quarters = np.rint(angle_deg * (1.0 / 90.0))
    x = (angle_deg - 90.0 * quarters) * (math.pi / 180.0)
    z = x * x
    s, c = _SIN, _COS
    sin = s[3] + z * (s[4] + z * (s[5] + z * s[6]))
    sin = x + x * z * (s[0] + z * (s[1] + z * (s[2] + z * sin)))
    cos = c[3] + z * (c[4] + z * (c[5] + z * (c[6] + z * c[7])))
    cos = 1.0 + z * (c[0] + z * (c[1] + z * (c[2] + z * cos)))
    turned = quarters - 4.0 * np.rint(quarters * 0.25)  # -2 to 2
    cos_turned, sin_turned = 1.0 - abs(turned), turned * (2.0 - abs(turned))
    return cos_turned * cos - sin_turned * sin, sin_turned * cos + cos_turned * sin


_Air = tuple[float, float, float, float, float, float]


@_part
def _air_terms(along: float, cos: float, sin: float) -> _Air:
    """The three squares that air force is proportional to, from ahead and from behind.

    These are signed, in m2/s2: `head` is u|u| with u = w cos a, the wind along the course (old
    rule); `front` and `side` weigh it with |cos a| and |sin a| (oblique rule of 2015). Sources:
    presentation 2015, "Windweerstand" and "Dwarse tegenwind".
    """
    head = along * abs(along)
    ahead, behind = 0.5 * (head + abs(head)), 0.5 * (head - abs(head))
    front, side = abs(cos), abs(sin)
    return ahead, behind, ahead * front, behind * front, ahead * side, behind * side


@_part
def _add_air(sums: FloatArray, row: int, lane: Lane, air: _Air, weight: float) -> None:
    sums[_at(row, lane)] += air[0] * weight
    sums[_at(row + 1, lane)] += air[1] * weight
    sums[_at(row + 2, lane)] += air[2] * weight
    sums[_at(row + 3, lane)] += air[3] * weight
    sums[_at(row + 4, lane)] += air[4] * weight
    sums[_at(row + 5, lane)] += air[5] * weight


@_part
def _add_source(sums: FloatArray, row: int, lane: Lane, v: float, force: float, air: _Air) -> None:
    """What is summed of one speed source."""
    v2 = v * v
    inv_v2 = 1.0 / v2
    cw = force * inv_v2
    sums[_at(row, lane)] += v
    sums[_at(row + 1, lane)] += v2
    sums[_at(row + 2, lane)] += inv_v2
    sums[_at(row + 3, lane)] += cw
    sums[_at(row + 4, lane)] += cw * cw
    _add_air(sums, row + 5, lane, air, inv_v2)


@_part
def _add_wind(sums: FloatArray, row: int, lane: Lane, wind: float, cos: float, sin: float) -> None:
    sums[_at(row, lane)] += wind
    sums[_at(row + 1, lane)] += wind * wind
    sums[_at(row + 2, lane)] += cos
    sums[_at(row + 3, lane)] += sin
    sums[_at(row + 4, lane)] += wind * cos
    sums[_at(row + 5, lane)] += wind * sin


@_part
def _add_gps(sums: FloatArray, row: int, lane: Lane, gps: float) -> None:
    """Ground speed, where there is one: the others are not numbers."""
    present = np.isfinite(gps)
    speed = gps if present else 0.0
    sums[_at(row, lane)] += speed
    sums[_at(row + 1, lane)] += speed * speed
    sums[_at(row + 2, lane)] += 1.0 if present else 0.0


_INDICES: Final = types.Array(int64, 1, "C", readonly=True)
_CHANNEL: Final = types.Array(float32, 1, "C", readonly=True)
_SIGNATURE: Final = types.void(_INDICES, _INDICES, float64[:, ::1], *[_CHANNEL] * len(_CHANNELS))


def _compiled_once(function: Callable[P, R]) -> Callable[P, R]:
    """Compiled now, or as it was kept beside this file or in the user's folder of caches."""
    try:
        return _compiled(_SIGNATURE, nogil=True, cache=True)(function)
    except RuntimeError:  # neither folder may be written: two seconds of compiling, each time
        return _compiled(_SIGNATURE, nogil=True)(function)


@_compiled_once
def _add_up(
    start: IntArray,
    end: IntArray,
    found: FloatArray,
    log1: NDArray[np.float32],
    log2: NDArray[np.float32],
    gps: NDArray[np.float32],
    force: NDArray[np.float32],
    wind: NDArray[np.float32],
    angle_deg: NDArray[np.float32],
) -> None:
    """Fills `found`, shape (sums, blocks), from the channels, shape (samples,)."""
    sums = np.empty(np.uintp(_ROWS) * LANES)
    for block in range(len(start)):
        sums[:] = 0.0
        first, after = np.uintp(start[block]), np.uintp(end[block])
        while first < after:
            for lane in range(min(LANES, after - first)):
                i = first + lane
                v1, v2, f = np.float64(log1[i]), np.float64(log2[i]), np.float64(force[i])
                w = np.float64(wind[i])
                cos, sin = _cos_sin(np.float64(angle_deg[i]))
                air = _air_terms(w * cos, cos, sin)
                sums[_at(_FORCE, lane)] += f
                sums[_at(_FORCE + 1, lane)] += f * f
                _add_source(sums, _LOG1, lane, v1, f, air)
                _add_source(sums, _LOG2, lane, v2, f, air)
                _add_source(sums, _MEAN, lane, 0.5 * (v1 + v2), f, air)
                _add_air(sums, _AIR, lane, air, 1.0)
                _add_wind(sums, _WIND, lane, w, cos, sin)
                _add_gps(sums, _GPS, lane, np.float64(gps[i]))
            first += LANES
        for row in range(_ROWS):
            total = 0.0
            for lane in range(LANES):
                total += sums[_at(row, lane)]
            found[row, block] = total
