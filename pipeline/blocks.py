"""Blocks: sums over each second of a run, from which every method can be computed.

Every formula of every method is linear in a few sums over samples, so a tow's samples are read
once and added up per second (HOUSE, idea 1). Means over any window that starts on a second are
then exactly those over the samples. What belongs here: the sums and how they are stacked. What
does not: any choice of a method (which log, which window, which coefficient).

The sums of one block, over its `n` samples, with F the tow force, v a speed source
(`log1`, `log2`, or `mean`, the mean of both), w and a the apparent wind:

- `force`, `force2`: F, F^2 [N, N2]
- `<source>_v`, `<source>_v2`, `<source>_inv_v2`: v, v^2, 1/v^2
- `<source>_cw`, `<source>_cw2`: F/v^2 [kg/m] and its square
- `<term>_<side>`: the air term of `pipeline.wind` [m2/s2], for wind from `ahead` and from `behind`
- `<source>_<term>_<side>`: the same divided by v^2
- `wind_v`, `wind_v2`: w, w^2; `wind_cos`, `wind_sin`: cos a, sin a
- `wind_x`, `wind_y`: w cos a, w sin a
- `gps`, `gps2`, `gps_n`: ground speed, its square, and how many samples have one
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
import polars as pl

from pipeline.arrays import BoolArray, FloatArray, IntArray
from pipeline.errors import BrokenPromiseError

SPEED_SOURCES: Final = ("log1", "log2", "mean")
AIR_TERMS: Final = ("head", "front", "side")
WIND_SIDES: Final = ("ahead", "behind")
AIR_SUMS: Final = tuple(f"{term}_{side}" for term in AIR_TERMS for side in WIND_SIDES)
WIND_SUMS: Final = ("wind_v", "wind_v2", "wind_cos", "wind_sin", "wind_x", "wind_y")
SUM_NAMES: Final = (
    "force",
    "force2",
    *(f"{s}_{q}" for s in SPEED_SOURCES for q in ("v", "v2", "inv_v2", "cw", "cw2", *AIR_SUMS)),
    *AIR_SUMS,
    *WIND_SUMS,
    *("gps", "gps2", "gps_n"),
)
BLOCK_SECONDS: Final = 1.0


def block_sums(samples: pl.DataFrame, sample_rate_hz: float) -> pl.DataFrame:
    """Adds up the samples of one tow per run and second.

    Args:
        samples: columns of `pipeline.channels.SAMPLE_SCHEMA`, each run contiguous, speeds positive.
        sample_rate_hz: samples a second.

    Returns:
        One row per run and second: `run`, `second` (0 is the first), `n` (samples; the last
        block of a run may hold fewer) and the sums of `SUM_NAMES`, float64. Each sum is made in
        the order of the samples, so it does not depend on threads.
    """
    run = samples["run"].to_numpy()
    starts, run_of_block, second = _block_starts(run, sample_rate_hz)
    n = np.diff(np.append(starts, len(run)))
    sums = {name: np.add.reduceat(values, starts) for name, values in _terms(samples)}
    return pl.DataFrame(
        {"run": run_of_block, "second": second.astype(np.int16), "n": n.astype(np.int32)}
        | {name: sums[name] for name in SUM_NAMES}
    )


def _block_starts(run: FloatArray, sample_rate_hz: float) -> tuple[IntArray, FloatArray, IntArray]:
    """First sample of every block, with its run and its second within the run."""
    new_run = np.flatnonzero(np.diff(run, prepend=run[:1] - 1))
    run_length = np.diff(np.append(new_run, len(run)))
    in_run = np.arange(len(run)) - np.repeat(new_run, run_length)
    second = (in_run / sample_rate_hz / BLOCK_SECONDS).astype(np.int64)
    starts = np.flatnonzero((in_run == 0) | (np.diff(second, prepend=-1) != 0))
    return starts, run[starts], second[starts]


def _terms(samples: pl.DataFrame) -> Iterator[tuple[str, FloatArray]]:
    """Every quantity that is summed, per sample, one at a time to keep memory small."""
    column = {c: samples[c].to_numpy().astype(np.float64) for c in samples.columns if c != "run"}
    force = column["force_n"]
    yield "force", force
    yield "force2", force * force
    wind, angle = column["wind_speed_m_s"], np.radians(column["wind_angle_deg"])
    cos, sin = np.cos(angle), np.sin(angle)
    yield from zip(WIND_SUMS, (wind, wind * wind, cos, sin, wind * cos, wind * sin), strict=True)
    air = _air_terms(wind * cos, cos, sin)
    yield from air.items()
    log1, log2 = column["log1_m_s"], column["log2_m_s"]
    for source, v in (("log1", log1), ("log2", log2), ("mean", 0.5 * (log1 + log2))):
        v2 = v * v
        cw = force / v2
        yield f"{source}_v", v
        yield f"{source}_v2", v2
        yield f"{source}_inv_v2", 1.0 / v2
        yield f"{source}_cw", cw
        yield f"{source}_cw2", cw * cw
        yield from ((f"{source}_{name}", term / v2) for name, term in air.items())
    yield from _gps_terms(column["gps_m_s"])


def _air_terms(along_m_s: FloatArray, cos: FloatArray, sin: FloatArray) -> dict[str, FloatArray]:
    """The three squares of wind speed that air force is proportional to, signed, in m2/s2.

    `head` is u|u| with u = w cos a, the wind along the course (old rule); `front` and `side` weigh
    it with |cos a| and |sin a| (oblique rule of 2015). Sources: presentation 2015,
    "Windweerstand" and "Dwarse tegenwind".
    """
    head = along_m_s * np.abs(along_m_s)
    terms = {"head": head, "front": head * np.abs(cos), "side": head * np.abs(sin)}
    return {
        f"{term}_{side}": np.maximum(values, 0.0) if side == "ahead" else np.minimum(values, 0.0)
        for term, values in terms.items()
        for side in WIND_SIDES
    }


def _gps_terms(gps_m_s: FloatArray) -> Iterator[tuple[str, FloatArray]]:
    present = np.isfinite(gps_m_s)
    gps = np.where(present, gps_m_s, 0.0)
    yield "gps", gps
    yield "gps2", gps * gps
    yield "gps_n", present.astype(np.float64)


@dataclass(frozen=True)
class RunBlocks:
    """The blocks of many runs as arrays of shape (runs, seconds).

    Attributes:
        runs: one row a run, sorted by `tow_id` and `run`; row i belongs to row i of the arrays.
        n: samples in each block, 0 where the run has none.
        sums: the sums of `SUM_NAMES`, 0 where the run has no block.
    """

    runs: pl.DataFrame
    n: FloatArray
    sums: dict[str, FloatArray]

    def __getitem__(self, name: str) -> FloatArray:
        return self.sums[name]

    @property
    def seconds(self) -> int:
        """Length of the longest run, in blocks."""
        return int(self.n.shape[1])

    def take(self, rows: BoolArray) -> "RunBlocks":
        """The runs marked in `rows`, shape (runs,); neighbours are not copied."""
        places = np.flatnonzero(rows)
        first, last = (int(places[0]), int(places[-1]) + 1) if len(places) else (0, 0)
        chosen = slice(first, last) if last - first == len(places) else places
        return RunBlocks(
            self.runs.filter(pl.Series(rows)),
            self.n[chosen],
            {name: values[chosen] for name, values in self.sums.items()},
        )

    def total(self, name: str, window: BoolArray) -> FloatArray:
        """Sum over the blocks marked in `window`, shape (runs, seconds), giving shape (runs,)."""
        return _masked_sum(self.sums[name], window)

    def count(self, window: BoolArray) -> FloatArray:
        """Samples in the blocks marked in `window`, shape (runs,)."""
        return _masked_sum(self.n, window)

    def mean(self, name: str, window: BoolArray) -> FloatArray:
        """Mean over the samples of a window, shape (runs,); 0 where the window is empty."""
        return self.total(name, window) / np.maximum(self.count(window), 1.0)

    def block_means(self, name: str) -> FloatArray:
        """Mean of each block, shape (runs, seconds); 0 where there is none."""
        return self.sums[name] / np.maximum(self.n, 1.0)


def _masked_sum(values: FloatArray, window: BoolArray) -> FloatArray:
    return np.asarray(np.where(window, values, 0.0).sum(axis=1), dtype=np.float64)


def stack_blocks(blocks: pl.DataFrame, runs: pl.DataFrame) -> RunBlocks:
    """Arranges blocks of many tows as arrays of one row a run.

    Args:
        blocks: `tow_id`, and the columns that `block_sums` gives.
        runs: one row a run with at least `tow_id` and `run`.

    Raises:
        BrokenPromiseError: a run without blocks.
    """
    runs = runs.sort("tow_id", "run").with_row_index("row")
    placed = blocks.join(runs.select("tow_id", "run", "row"), on=["tow_id", "run"], how="inner")
    missing = runs.filter(~pl.col("row").is_in(placed["row"].unique().implode()))
    if missing.height:
        tow, run = missing.row(0, named=True)["tow_id"], missing.row(0, named=True)["run"]
        raise BrokenPromiseError(
            f"tow {tow}, run {run}: no blocks, though its samples were read; "
            "rebuild with an empty data folder"
        )
    row, second = placed["row"].to_numpy(), placed["second"].to_numpy()
    shape = (runs.height, int(second.max()) + 1 if len(second) else 0)
    arrays = {name: _place(placed[name], row, second, shape) for name in ("n", *SUM_NAMES)}
    return RunBlocks(runs.drop("row"), arrays.pop("n"), arrays)


def _place(
    values: pl.Series, row: IntArray, second: IntArray, shape: tuple[int, int]
) -> FloatArray:
    cube = np.zeros(shape)
    cube[row, second] = values.to_numpy()
    return cube
