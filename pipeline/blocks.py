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

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Final, NamedTuple

import numpy as np
import polars as pl
from numpy.typing import NDArray

from pipeline.arrays import BoolArray, FloatArray, IntArray
from pipeline.errors import BrokenPromiseError

SPEED_SOURCES: Final = ("log1", "log2", "mean")
AIR_TERMS: Final = ("head", "front", "side")
WIND_SIDES: Final = ("ahead", "behind")
AIR_SUMS: Final = tuple(f"{term}_{side}" for term in AIR_TERMS for side in WIND_SIDES)
SUM_NAMES: Final = (
    "force",
    "force2",
    *(f"{s}_{q}" for s in SPEED_SOURCES for q in ("v", "v2", "inv_v2", "cw", "cw2", *AIR_SUMS)),
    *AIR_SUMS,
    *("wind_v", "wind_v2", "wind_cos", "wind_sin", "wind_x", "wind_y"),
    *("gps", "gps2", "gps_n"),
)
CHUNK_SAMPLES: Final = 25_000
"""Samples worked on at a time: few enough to stay in the processor's cache."""

_DIVIDED: Final = ("one", "force", *AIR_SUMS)
"""What is summed as it is and divided by v^2 of each source."""

_TERMS: Final = (
    *_DIVIDED,
    *(f"{s}_v" for s in SPEED_SOURCES),
    *("wind_v", "wind_cos", "wind_sin", "wind_x", "wind_y"),
    "gps",
)
_SQUARES: Final = (
    "force2",
    "wind_v2",
    "gps2",
    *(f"{s}_{q}" for q in ("v2", "cw2") for s in SPEED_SOURCES),
)
_MADE: Final = (
    *_TERMS,
    *(f"{s}_{q}" for s in SPEED_SOURCES for q in ("inv_v2", "cw", *AIR_SUMS)),
    *_SQUARES,
    "gps_n",
)
"""The sums in the order in which they are made."""


def block_sums(samples: pl.DataFrame, sample_rate_hz: int) -> pl.DataFrame:
    """Adds up the samples of one tow per run and second.

    Args:
        samples: columns of `pipeline.channels.SAMPLE_SCHEMA`, each run contiguous, speeds positive.
        sample_rate_hz: samples a second.

    Returns:
        One row per run and second: `run`, `second` (0 is the first), `n` (samples; the last
        block of a run may hold fewer) and the sums of `SUM_NAMES`, float64. A sum depends on
        the samples of its block alone, not on its neighbours nor on threads.
    """
    channels = {name: samples[name].to_numpy() for name in samples.columns}
    run = channels.pop("run")
    keys, sums = [], []
    for piece in _pieces(run, sample_rate_hz):
        shape = (piece.blocks, -1)
        keys.append(piece.keys(run))
        sums.append(
            _sums({c: v[piece.start : piece.end].reshape(shape) for c, v in channels.items()})
        )
    run_of_block, second, n = np.concatenate(keys, axis=1)
    made = dict(zip(_MADE, np.concatenate(sums, axis=1), strict=True))
    return pl.DataFrame(
        [
            pl.Series("run", run_of_block, pl.Int8),
            pl.Series("second", second, pl.Int16),
            pl.Series("n", n, pl.Int32),
            *(pl.Series(name, made[name]) for name in SUM_NAMES),
        ]
    )


class _Piece(NamedTuple):
    """Consecutive blocks of one length within a run: samples `start` to `end`."""

    start: int
    end: int
    blocks: int
    first_second: int

    def keys(self, run: IntArray) -> IntArray:
        """Run, second and number of samples of each block, shape (3, blocks)."""
        second = self.first_second + np.arange(self.blocks)
        length = (self.end - self.start) // self.blocks
        return np.stack(
            [np.full_like(second, run[self.start]), second, np.full_like(second, length)]
        )


def _pieces(run: IntArray, sample_rate_hz: int) -> Iterator[_Piece]:
    """Cuts every run into pieces of whole seconds, and what remains at its end."""
    starts = np.flatnonzero(run[1:] != run[:-1]) + 1
    most = max(1, CHUNK_SAMPLES // sample_rate_hz)
    for start, end in pairwise([0, *starts.tolist(), len(run)]):
        seconds, rest = divmod(end - start, sample_rate_hz)
        for first in range(0, seconds, most):
            blocks = min(most, seconds - first)
            at = start + first * sample_rate_hz
            yield _Piece(at, at + blocks * sample_rate_hz, blocks, first)
        if rest:
            yield _Piece(end - rest, end, 1, seconds)


def _sums(channel: Mapping[str, NDArray[np.float32]]) -> FloatArray:
    """The sums of `_MADE` over each block, shape (sums, blocks).

    Sums of products are made as scalar products; those of everything that is also divided by the
    v^2 of each source, as one matrix product a block.

    Args:
        channel: the channels, shape (blocks, samples).
    """
    shape = channel["force_n"].shape
    terms = np.empty((len(_TERMS), *shape))
    row = dict(zip(_TERMS, terms, strict=True))
    row["one"][:], row["force"][:] = 1.0, channel["force_n"]
    _fill_wind(row, channel["wind_speed_m_s"], channel["wind_angle_deg"])
    present = np.isfinite(channel["gps_m_s"])
    row["gps"][:] = np.where(present, channel["gps_m_s"], 0.0)
    speeds = terms[len(_DIVIDED) :][: len(SPEED_SOURCES)]
    speeds[0], speeds[1] = channel["log1_m_s"], channel["log2_m_s"]
    np.multiply(0.5, speeds[0] + speeds[1], out=speeds[2])

    divisors = np.ones((1 + len(SPEED_SOURCES), *shape))
    np.divide(1.0, speeds * speeds, out=divisors[1:])
    cw = row["force"] * divisors[1:]
    product = divisors.transpose(1, 0, 2) @ terms.transpose(1, 2, 0)
    divided = product[:, 1:, : len(_DIVIDED)].reshape(len(product), -1)
    squares = [np.vecdot(row[q], row[q]) for q in ("force", "wind_v", "gps")]
    of_sources = [*np.vecdot(speeds, speeds), *np.vecdot(cw, cw)]
    count = present.sum(axis=-1, dtype=np.float64)
    return np.concatenate([product[:, 0].T, divided.T, [*squares, *of_sources, count]])


def _fill_wind(
    row: Mapping[str, FloatArray], speed_m_s: NDArray[np.float32], angle_deg: NDArray[np.float32]
) -> None:
    """Fills the rows of the wind and of the three squares that air force is proportional to.

    These are signed, in m2/s2: `head` is u|u| with u = w cos a, the wind along the course (old
    rule); `front` and `side` weigh it with |cos a| and |sin a| (oblique rule of 2015). Sources:
    presentation 2015, "Windweerstand" and "Dwarse tegenwind".
    """
    wind, cos, sin, along = (row[f"wind_{name}"] for name in ("v", "cos", "sin", "x"))
    wind[:] = speed_m_s
    _fill_cos_sin(cos, sin, angle_deg)
    np.multiply(wind, cos, out=along)
    np.multiply(wind, sin, out=row["wind_y"])
    head = along * np.abs(along)
    np.maximum(head, 0.0, out=row["head_ahead"])
    np.minimum(head, 0.0, out=row["head_behind"])
    for term, weight in (("front", np.abs(cos)), ("side", np.abs(sin))):
        for side in WIND_SIDES:
            np.multiply(row[f"head_{side}"], weight, out=row[f"{term}_{side}"])


def _fill_cos_sin(cos: FloatArray, sin: FloatArray, angle_deg: NDArray[np.float32]) -> None:
    """Cosine and sine from the tangent of half the angle, in a third of the time of both."""
    half = np.multiply(angle_deg, np.pi / 360.0, dtype=np.float64)
    t = np.tan(half)
    np.divide(2.0, 1.0 + t * t, out=cos)
    np.multiply(t, cos, out=sin)
    cos -= 1.0


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
    rows = runs.select("tow_id", "run", "row")
    place = blocks.select("tow_id", "run").join(
        rows, on=["tow_id", "run"], how="left", maintain_order="left"
    )["row"]
    missing = runs.filter(~pl.col("row").is_in(place.unique().implode()))
    if missing.height:
        tow, run = missing.row(0, named=True)["tow_id"], missing.row(0, named=True)["run"]
        raise BrokenPromiseError(
            f"tow {tow}, run {run}: no blocks, though its samples were read; "
            "rebuild with an empty data folder"
        )
    if place.null_count():
        blocks, place = blocks.filter(place.is_not_null()), place.drop_nulls()
    row, second = place.to_numpy(), blocks["second"].to_numpy()
    shape = (runs.height, int(second.max()) + 1 if len(second) else 0)
    arrays = {name: _place(blocks[name], row, second, shape) for name in ("n", *SUM_NAMES)}
    return RunBlocks(runs.drop("row"), arrays.pop("n"), arrays)


def _place(
    values: pl.Series, row: IntArray, second: IntArray, shape: tuple[int, int]
) -> FloatArray:
    cube = np.zeros(shape)
    cube[row, second] = values.to_numpy()
    return cube
