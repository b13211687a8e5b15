"""What is timed: functions that prepare and return the work, called in a process of their own."""

import shutil
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pandas as pd
import polars as pl
import pyarrow.parquet as pq

from benchmarks import plain, same
from benchmarks.harness import both
from benchmarks.world import FOLDER, RATE_HZ, World
from pipeline.blocks.run_blocks import stack_blocks
from pipeline.blocks.sums import block_sums
from pipeline.method.definition import parse_method, shipped_method
from pipeline.recompute.recompute import recompute
from warehouse.archive.files.contents import read_bytes
from warehouse.archive.profile.reading import read_profiles
from warehouse.intake import lake
from warehouse.intake import seasons as intake
from warehouse.queries.rebase import rebase
from warehouse.store.store import Store, write_parquet

Work = Callable[[], Any]
SIDES = {"as_it_was": 0.2, "changed": 0.3}
TEXT_LIMIT_BYTES = 10**9


def _written() -> Path:
    """Where a task puts what it writes."""
    folder = FOLDER / "written"
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def _method(side: str) -> Any:
    return parse_method(plain.METHOD.replace("AIR_SIDE", str(SIDES[side])), "benchmark")


def _parse(path: Path) -> pl.DataFrame:
    frame = pl.read_csv(read_bytes(path, TEXT_LIMIT_BYTES), separator=";", decimal_comma=True)
    return frame.with_columns(pl.col(pl.Float64).cast(pl.Float32), pl.col("run").cast(pl.Int8))


def _runs(world: World, tows: pl.DataFrame) -> pl.DataFrame:
    runs = world.store.read("tow_runs").filter("selected").select("tow_id", "run")
    sizes = ["waterline_length_m", "beam_m", "bow_height_m", "declared_speed_m_s"]
    return runs.join(tows.select("tow_id", *sizes), on="tow_id")


def _lake_files(world: World, tows: pl.DataFrame) -> dict[str, str]:
    keys = tows.select("tow_id", "season", "samples_key").iter_rows()
    return {t: str(world.store.samples_path(season, key)) for t, season, key in keys}


def _text_files(world: World, tows: pl.DataFrame) -> dict[str, str]:
    paths = tows.select("tow_id", "samples_path").iter_rows()
    return {t: str(world.archive / path) for t, path in paths}


# Text


def parse_text(tows_per_season: int, count: int, write: bool) -> Work:
    """Polars alone on the same files, all columns; written as Parquet or not."""
    world = World(tows_per_season)
    tows = world.tows(count, plain=True)
    folder = _written()

    def one(file: tuple[str, str]) -> None:
        frame = _parse(Path(file[1]))
        if write:
            write_parquet(frame, folder / f"{file[0]}.parquet", form=lake.LAKE_FORM)

    return lambda: both(one, _text_files(world, tows).items())


def read_text(tows_per_season: int, count: int) -> Work:
    """Text to checked samples and blocks in an empty lake."""
    world = World(tows_per_season)
    tows, store = world.tows(count, plain=True), _indexed_store(world)
    return lambda: _into_lake(world, store, tows)


def herijk_from_text(tows_per_season: int, count: int, result: str | None = None) -> Work:
    """Text to curves, by way of the lake."""
    world = World(tows_per_season)
    tows, store = world.tows(count, plain=True), _indexed_store(world)

    def work() -> None:
        index = _into_lake(world, store, tows)
        blocks = pl.concat(
            lake.season_blocks(store, season, found) for season, found in index.items()
        )
        _save(_recomputed(world, tows, blocks, "as_it_was"), result)

    return work


def _empty_store() -> Store:
    folder = FOLDER / "empty"
    shutil.rmtree(folder, ignore_errors=True)
    return Store(folder)


def _indexed_store(world: World) -> Store:
    """A lake without samples; indexing, which hashes every file, has been done."""
    store = _empty_store()
    store.file_hashes.parent.mkdir(parents=True)
    shutil.copy(world.store.file_hashes, store.file_hashes)
    return store


def _into_lake(world: World, store: Store, tows: pl.DataFrame) -> dict[int, pl.DataFrame]:
    profiles, runs = read_profiles(world.archive), world.store.read("tow_runs")
    listed = tows.drop("samples_key", "blocks_key")
    found = {}
    for (season,), rows in listed.group_by("season", maintain_order=True):
        mine = runs.join(rows.select("tow_id"), on="tow_id", how="semi")
        profile = profiles.for_season(season)
        index = lake.read_season(store, world.archive, rows, mine, profile, lambda *_: None)
        assert index["reason_code"].null_count() == index.height
        found[season] = index
    return found


# Parquet


def decode(tows_per_season: int, count: int, tool: str) -> Work:
    """A reader alone on the lake's files: every column of every sample in memory, once."""
    world = World(tows_per_season)
    files = _lake_files(world, world.tows(count))
    return lambda: both(
        {"pyarrow": _rows_by_pyarrow, "polars": _rows_by_polars}[tool], files.values()
    )


def _rows_by_polars(path: str) -> int:
    return pl.read_parquet(path, hive_partitioning=False).height


def _rows_by_pyarrow(path: str) -> int:
    return _samples(path).height


def _samples(path: str) -> pl.DataFrame:
    """As the lake reads them, but for the check of checksums, which no other tool makes."""
    with pq.ParquetFile(path) as file:
        return pl.DataFrame(pl.from_arrow(file.read(use_threads=False)))


def add_up(tows_per_season: int, count: int) -> Work:
    """Blocks from the lake's samples."""
    world = World(tows_per_season)
    tows = world.tows(count)
    return lambda: _blocks(world, tows)


def add_up_and_write(tows_per_season: int, count: int) -> Work:
    """The same, written tow by tow as a rebuild does after a change of the sums."""
    world = World(tows_per_season)
    tows = world.tows(count)
    folder = _written()

    def one(file: tuple[str, str]) -> None:
        write_parquet(_sums(file[1]), folder / f"{file[0]}.parquet", form=lake.LAKE_FORM)

    return lambda: both(one, _lake_files(world, tows).items())


def herijk_from_parquet(
    tows_per_season: int, count: int, result: str | None = None, plain_text: bool = False
) -> Work:
    """Samples in the lake to curves."""
    world = World(tows_per_season)
    tows = world.tows(count, plain=plain_text)

    def work() -> None:
        _save(_recomputed(world, tows, _blocks(world, tows), "as_it_was"), result)

    return work


def _sums(path: str) -> pl.DataFrame:
    return block_sums(_samples(path), RATE_HZ)


def _blocks(world: World, tows: pl.DataFrame) -> pl.DataFrame:
    files = _lake_files(world, tows)
    tow_id = pl.Series("tow_id", list(files))
    return lake.blocks_of_tows(tow_id, both(_sums, files.values()))


# All of history


def apply_method(tows_per_season: int, count: int, method: str) -> Work:
    """A method on tows whose blocks are in memory: computation and no more."""
    world = World(tows_per_season)
    tows = world.tows(count).drop("samples_key", "blocks_key")
    blocks = _stacked(world, tows)
    known = shipped_method(method) if method not in SIDES else _method(method)
    return partial(recompute, known, tows, blocks)


def herijk_changed(tows_per_season: int, count: int, result: str | None = None) -> Work:
    """A changed method on all tows, from the blocks on disk."""
    world = World(tows_per_season)
    tows = world.tows(count).drop("samples_key", "blocks_key")

    def work() -> None:
        made = recompute(_method("changed"), tows, _stacked(world, tows))
        _save(made.curves, result)

    return work


def _stacked(world: World, tows: pl.DataFrame) -> Any:
    runs = intake.runs_with_windows(world.store).join(
        tows.select("tow_id"), on="tow_id", how="semi"
    )
    return stack_blocks(intake.all_blocks(world.store), runs)


def whole_rebase(tows_per_season: int) -> Work:
    """What `herijk rebase rebased` computes: two methods, the ladder between them, registers."""
    methods = shipped_method("rebased"), shipped_method("as-published")
    return partial(rebase, World(tows_per_season).store, *methods)


# The others


def other(
    tows_per_season: int, count: int, tool: str, text: bool, result: str | None = None
) -> Work:
    """The same work with pandas, DuckDB or Polars, from text or from the lake's Parquet."""
    world = World(tows_per_season)
    tows = world.tows(count, plain=True)
    files = (_text_files if text else _lake_files)(world, tows)
    runs, folder = _runs(world, tows), _written()

    def work() -> None:
        means = same.means_of_runs(same.sums(tool, files, folder))
        _save(plain.curves(means, runs, SIDES["as_it_was"]), result)

    return work


def other_at_least(
    tows_per_season: int,
    count: int,
    tool: str,
    text: bool,
    side: str = "as_it_was",
    plain_text: bool = True,
    result: str | None = None,
) -> Work:
    """The least that gives the same curves: one method and nothing kept."""
    world = World(tows_per_season)
    tows = world.tows(count, plain=plain_text)
    files = (_text_files if text else _lake_files)(world, tows)
    runs = _runs(world, tows)

    def work() -> None:
        if tool == "pandas":
            made = pd.concat([plain.pandas_means(t, Path(path)) for t, path in files.items()])
            means = pl.from_pandas(made)
        else:
            means = {"duckdb": plain.duckdb_means, "polars": plain.polars_means}[tool](files)
        _save(plain.curves(means, runs, SIDES[side]), result)

    return work


def _recomputed(world: World, tows: pl.DataFrame, blocks: pl.DataFrame, side: str) -> pl.DataFrame:
    runs = world.store.read("tow_runs").join(tows.select("tow_id"), on="tow_id", how="semi")
    held = tows.drop("samples_key", "blocks_key")
    stacked = stack_blocks(blocks, runs)
    return recompute(_method(side), held, stacked, with_bands=False).curves


def _save(curves: pl.DataFrame, result: str | None) -> None:
    """Keeps what came out, for the comparison of the numbers."""
    if result is not None:
        curves.write_parquet(result)
