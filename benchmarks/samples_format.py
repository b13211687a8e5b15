"""Size and time of ways to keep a tow's samples, on simulated tows of 300,000 samples.

    PYTHONPATH=. python -m benchmarks.samples_format [tows]

Two kinds of numbers: as the simulator makes them (noise in every bit of a float32) and as a CSV
file gives them (three decimals). Decision 0004 rests on this.
"""

import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pyarrow as pa
import pyarrow.parquet as pq

from herijk.simulate import WorldSettings, simulate_tow, simulate_world
from warehouse.intake.lake import LAKE_FORM
from warehouse.store.store import read_parquet, write_parquet

SCALE = 1000.0
"""Integers count thousandths: of a m/s, a N, a degree."""

ROUNDS = 3


def _floats(frame: pl.DataFrame) -> list[str]:
    return [name for name, dtype in frame.schema.items() if dtype == pl.Float32]


def _scaled(frame: pl.DataFrame) -> pl.DataFrame:
    return frame.with_columns((pl.col(_floats(frame)) * SCALE).round().cast(pl.Int32))


def _unscaled(frame: pl.DataFrame) -> pl.DataFrame:
    counted = [name for name, dtype in frame.schema.items() if dtype == pl.Int32]
    return frame.with_columns((pl.col(counted) / SCALE).cast(pl.Float32))


@dataclass(frozen=True)
class Format:
    """A way to write samples, and how to get them back."""

    name: str
    write: Callable[[pl.DataFrame, Path], None]
    read: Callable[[Path], pl.DataFrame]


def _polars(level: int) -> Callable[[pl.DataFrame, Path], None]:
    def write(frame: pl.DataFrame, path: Path) -> None:
        frame.write_parquet(path, compression="zstd", compression_level=level, statistics=False)

    return write


def _arrow(encoding: str, level: int, scaled: bool) -> Callable[[pl.DataFrame, Path], None]:
    def write(frame: pl.DataFrame, path: Path) -> None:
        numbers = _floats(frame)
        table: pa.Table = (_scaled(frame) if scaled else frame).to_arrow()
        pq.write_table(
            table,
            path,
            compression="zstd",
            compression_level=level,
            use_dictionary=False,
            column_encoding=dict.fromkeys(numbers, encoding),
            write_statistics=False,
        )

    return write


def _arrow_dictionary(frame: pl.DataFrame, path: Path) -> None:
    pq.write_table(
        frame.to_arrow(), path, compression="zstd", compression_level=1, write_statistics=False
    )


def _read(path: Path) -> pl.DataFrame:
    return pl.read_parquet(path)


def _as_in_the_lake(packing: dict[str, Any]) -> Callable[[pl.DataFrame, Path], None]:
    def write(frame: pl.DataFrame, path: Path) -> None:
        write_parquet(frame, path, form=LAKE_FORM | packing)

    return write


PACKINGS: dict[str, dict[str, Any]] = {
    "lz4 (the lake)": {},
    "zstd 1": {"compression": "zstd", "compression_level": 1},
    "snappy": {"compression": "snappy"},
    "not packed": {"compression": "none"},
    "lz4, dictionary": {"use_dictionary": True},
}

FORMATS = [
    *(
        Format(f"float32, {name}, page checksums, synced", _as_in_the_lake(packing), read_parquet)
        for name, packing in PACKINGS.items()
    ),
    Format("float32, zstd 1 (Polars, dictionary where it pays)", _polars(1), _read),
    Format("float32, zstd 3 (Polars, dictionary where it pays)", _polars(3), _read),
    Format("float32, zstd 1 (pyarrow, dictionary where it pays)", _arrow_dictionary, _read),
    Format("float32, byte stream split, zstd 1", _arrow("BYTE_STREAM_SPLIT", 1, False), _read),
    Format("float32, byte stream split, zstd 3", _arrow("BYTE_STREAM_SPLIT", 3, False), _read),
    Format(
        "int32 thousandths, delta, zstd 1",
        _arrow("DELTA_BINARY_PACKED", 1, True),
        lambda path: _unscaled(_read(path)),
    ),
    Format(
        "int32 thousandths, byte stream split, zstd 1",
        _arrow("BYTE_STREAM_SPLIT", 1, True),
        lambda path: _unscaled(_read(path)),
    ),
]


def tows(count: int) -> list[pl.DataFrame]:
    """Simulated tows at 1000 Hz, from seasons with GPS."""
    world = simulate_world(WorldSettings((2013, 2014), -(-count // 2), 1000, 1))
    return [simulate_tow(world, tow)[0] for tow in world.tows[:count]]


def as_from_csv(frame: pl.DataFrame) -> pl.DataFrame:
    """The numbers with three decimals."""
    return frame.with_columns(pl.col(_floats(frame)).cast(pl.Float64).round(3).cast(pl.Float32))


def measure(how: Format, frames: list[pl.DataFrame], folder: Path) -> tuple[float, ...]:
    """MB, write ms and read ms per tow (best round), and the largest error."""
    write_s, read_s, size, error = [], [], 0, 0.0
    path = folder / "tow.parquet"
    for i in range(ROUNDS):
        write_total = read_total = 0.0
        for frame in frames:
            start = time.perf_counter()
            how.write(frame, path)
            wrote = time.perf_counter()
            back = how.read(path)
            read_total += time.perf_counter() - wrote
            write_total += wrote - start
            if i == 0:
                size += path.stat().st_size
                error = max(error, *(_error(frame[c], back[c]) for c in _floats(frame)))
        write_s.append(write_total)
        read_s.append(read_total)
    n = len(frames)
    return size / n / 1e6, min(write_s) / n * 1e3, min(read_s) / n * 1e3, error


def _error(one: pl.Series, other: pl.Series) -> float:
    difference = np.abs(one.cast(pl.Float64).to_numpy() - other.cast(pl.Float64).to_numpy())
    return float(np.nanmax(difference, initial=0.0))


def main() -> None:
    """Prints a table for each kind of numbers."""
    made = tows(int(sys.argv[1]) if len(sys.argv) > 1 else 6)
    with tempfile.TemporaryDirectory() as folder:
        for kind, frames in (
            ("as simulated", made),
            ("three decimals", [as_from_csv(f) for f in made]),
        ):
            print(f"{kind}, {len(frames)} tows of {frames[0].height} samples")
            for how in FORMATS:
                size, write_ms, read_ms, error = measure(how, frames, Path(folder))
                print(
                    f"  {how.name:52} {size:6.2f} MB  write {write_ms:5.0f} ms  "
                    f"read {read_ms:5.1f} ms  largest error {error:.1e}"
                )


if __name__ == "__main__":
    main()
