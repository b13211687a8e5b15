"""Adding up a tow's samples: the sums of every second.

What the sums are is in `pipeline.blocks.run_blocks`. NumPy adds the samples of a second in the
order that suits the processor: another one leaves other last bits (docs/decisions.md).
"""

from collections.abc import Iterator, Mapping
from typing import Final

import numpy as np
import polars as pl
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

BLOCKS_AT_A_TIME: Final = 16
"""Added up together, so that what is worked on stays in the processor's cache."""


def block_sums(samples: pl.DataFrame, sample_rate_hz: float) -> pl.DataFrame:
    """Add up the samples of one tow per run and second.

    Args:
        samples: columns of `pipeline.channels.SAMPLE_SCHEMA`, each run contiguous, speeds positive.
            Where no wind was measured the air is taken to be still; where there is no log 2, in the
            tow or in a run, it reads as log 1. A sample that is not a number in any channel but the
            GPS is left out of its block.
        sample_rate_hz: samples per second; with a rate that is not whole, some seconds have one
            sample more than others.

    Returns:
        One row per run and second: `run`, `second` (0 is the first), `n` (samples; the last
        block of a run may hold fewer, one with samples left out any number down to 0) and the
        sums of `SUM_NAMES`, float64. On another processor their last bits may be others.
    """
    number, second, n = _divide_into_seconds(samples["run"].to_numpy(), sample_rate_hz)
    filled = _fill_unmeasured(samples)
    channels = {name: filled[name].to_numpy() for name in _CHANNELS}
    measured = np.logical_and.reduce(
        [np.isfinite(values) for name, values in channels.items() if name != _GPS_NAME]
    )
    if not measured.all():
        block = np.repeat(np.arange(len(n)), n)
        n = np.bincount(block[measured], minlength=len(n))
        channels = {name: values[measured] for name, values in channels.items()}
    sums = {name: np.zeros(len(n)) for name in SUM_NAMES}
    known, ends = np.flatnonzero(n), np.cumsum(n)
    for start in range(0, len(known), BLOCKS_AT_A_TIME):
        blocks = known[start : start + BLOCKS_AT_A_TIME]
        mine = slice(ends[blocks[0]] - n[blocks[0]], ends[blocks[-1]])
        part = {name: values[mine].astype(np.float64) for name, values in channels.items()}
        first = np.cumsum(n[blocks]) - n[blocks]
        for name, terms in _compute_terms(part):
            sums[name][blocks] = np.add.reduceat(terms, first)
    return pl.DataFrame(
        {"run": number, "second": second, "n": n} | sums,
        schema={name: kind for name, kind in BLOCK_SCHEMA.items() if name != "tow_id"},
    )


def _divide_into_seconds(
    run: NDArray[np.int8], rate_hz: float
) -> tuple[NDArray[np.int8], IntArray, IntArray]:
    """Return run, second and number of samples of every block, each of shape (blocks,)."""
    first = np.flatnonzero(np.append(True, run[1:] != run[:-1])[: len(run)])
    length = np.diff(np.append(first, len(run)))
    blocks = np.ceil(length / rate_hz).astype(np.int64)
    which = np.repeat(np.arange(len(first)), blocks)
    second = np.arange(len(which)) - (np.cumsum(blocks) - blocks)[which]
    begin = np.ceil(second * rate_hz).astype(np.int64)
    end = np.minimum(np.ceil((second + 1) * rate_hz).astype(np.int64), length[which])
    return run[first][which], second, end - begin


def _fill_unmeasured(samples: pl.DataFrame) -> pl.DataFrame:
    """Return the samples with channels that were not measured as the sums take them."""
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


def _compute_terms(channels: Mapping[str, FloatArray]) -> Iterator[tuple[str, FloatArray]]:
    """Yield the name of each sum with its terms, one for every sample.

    The squares that air force is proportional to are signed, in m2/s2: `head` is u|u| with
    u = w cos a, the wind along the course (old rule); `front` and `side` weigh it with |cos a| and
    |sin a| (oblique rule of 2015). Sources: presentation 2015, "Windweerstand" and "Dwarse
    tegenwind".
    """
    force, log1, wind = channels["force_n"], channels["log1_m_s"], channels["wind_speed_m_s"]
    angle = np.radians(channels["wind_angle_deg"])
    cos, sin = np.cos(angle), np.sin(angle)
    along, front = wind * cos, np.abs(cos)
    head = along * np.abs(along)
    ahead = np.maximum(head, 0.0)
    behind = head - ahead
    air = {
        "head_ahead": ahead,
        "head_behind": behind,
        "front_ahead": ahead * front,
        "front_behind": behind * front,
        "side": head * np.abs(sin),
    }
    inverse = 1.0 / (log1 * log1)
    cw = force * inverse
    yield "force", force
    yield "log1_v", log1
    yield "log1_inv_v2", inverse
    yield "log1_cw", cw
    yield "log1_cw2", cw * cw
    for name, square in air.items():
        yield f"log1_{name}", square * inverse
    yield "log2_v", channels["log2_m_s"]
    yield from air.items()
    yield "wind_v", wind
    yield "wind_cos", cos
    yield "wind_sin", sin
    yield "wind_x", along
    yield "wind_y", wind * sin
    gps = channels["gps_m_s"]
    has_fix = np.isfinite(gps)
    yield "gps", np.where(has_fix, gps, 0.0)
    yield "gps_n", has_fix.astype(np.float64)
