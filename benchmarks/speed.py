"""How fast tows are read, added up and computed, beside only decoding the same files.

    PYTHONPATH=. python -m benchmarks.speed [--tows-per-season 60] [--compared 60] [--repeats 5]

The archive is simulated and rebuilt once and kept under `benchmarks/data`: 1,020 tows take a
quarter of an hour. Tasks take turns, so that a slow minute of the machine meets them all.
"""

import os

os.environ["POLARS_MAX_THREADS"] = "2"  # read when Polars is imported
os.environ["OMP_NUM_THREADS"] = "2"

import argparse
import datetime as dt
import shutil
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import polars as pl
import pyarrow.parquet as pq

from benchmarks.commands import SEASONS, machine
from herijk.simulate import WorldSettings, simulate_world
from herijk.simulate.archive_writer import write_simulated_archive
from pipeline.blocks.run_blocks import stack_blocks
from pipeline.blocks.sums import block_sums
from pipeline.method.reading import read_shipped_method
from pipeline.recompute.recompute import recompute
from pipeline.register.replay import RaceRules
from warehouse.archive.files import read_bytes
from warehouse.archive.profile import read_profiles
from warehouse.intake import lake
from warehouse.intake import seasons as intake
from warehouse.store.store import Store, write_parquet

FOLDER = Path(os.environ.get("BENCH_FOLDER", "benchmarks/data"))
RATE_HZ, THREADS = 1000, 2
TEXT_LIMIT_BYTES = 10**9
METHODS = ("rebased", "as-published")
PLAIN_HEADER = b"run;log1 [m/s];log2 [m/s];gps [m/s];"
"""Files that begin like this are spelled as Polars can read them unaided."""
AT_MOST = {
    ("blocks from Parquet", "decode Parquet, pyarrow"): 1.5,
    ("blocks from Parquet", "decode Parquet, polars"): 1.5,
    ("blocks from text", "parse text, write Parquet"): 1.6,
}
"""What the project asks of the ratio of two tasks."""
WITHIN_S = {"rebased, all tows, from blocks": 1.0, "herijk compare, all tows": 4.0}
COMMANDS = ("--help", "methods", "audit --help", "compare --help", "register --help")
COMMAND_WITHIN_S = 0.5


@dataclass(frozen=True)
class Figures:
    """Medians of seconds by the clock and of the processor, all threads together."""

    seconds: float
    processor_s: float


@dataclass(frozen=True)
class World:
    """A simulated archive with its data folder."""

    archive: Path
    store: Store

    def tows(self, count: int | None = None) -> pl.DataFrame:
        """Sound tows with their place in the lake; `count` of them, evenly spread over the
        seasons, whose text any reader understands as it stands."""
        index = self.store.read("samples").drop_nulls("samples_key")
        keys = index.select("tow_id", "samples_key", "blocks_key")
        found = self.store.read("tows").join(keys, on="tow_id").sort("tow_id")
        if count is None:
            return found
        plain = pl.col("samples_path").map_elements(self._is_plain, pl.Boolean)
        found = found.filter(pl.col("second_path").is_null(), plain)
        count = min(count, found.height)
        return found[[i * found.height // count for i in range(count)]]

    def _is_plain(self, path: str) -> bool:
        with (self.archive / path).open("rb") as opened:
            return path.endswith(".csv") and opened.read(40).startswith(PLAIN_HEADER)

    def lake_files(self, tows: pl.DataFrame) -> list[Path]:
        """Where the samples of tows lie."""
        keys = tows.select("season", "samples_key").iter_rows()
        return [self.store.samples_path(season, key) for season, key in keys]


def made(tows_per_season: int) -> World:
    """The world, simulated and rebuilt unless it is there."""
    folder = FOLDER / str(tows_per_season)
    archive, data = folder / "archive", folder / "data"
    if not archive.exists():
        settings = WorldSettings(SEASONS, tows_per_season, RATE_HZ)
        write_simulated_archive(archive, simulate_world(settings))
    methods = [word for name in METHODS for word in ("--method", name)]
    places = ["--archive", str(archive), "--data", str(data)]
    herijk = [sys.executable, "-m", "herijk"]
    subprocess.run([*herijk, "rebuild", *methods, *places], check=True)
    return World(archive, Store(data))


def both(function: Callable[[Any], Any], rows: Iterable[Any]) -> list[Any]:
    """The function of every row, two at a time."""
    with ThreadPoolExecutor(THREADS) as pool:
        return list(pool.map(function, rows))


def parse_and_write(world: World, tows: pl.DataFrame, folder: Path) -> None:
    """Polars alone on the same text, all columns, written as Parquet."""

    def one(path: str) -> None:
        text = read_bytes(world.archive / path, TEXT_LIMIT_BYTES)
        frame = pl.read_csv(text, separator=";", decimal_comma=True)
        frame = frame.with_columns(pl.col(pl.Float64).cast(pl.Float32), pl.col("run").cast(pl.Int8))
        write_parquet(frame, folder / f"{Path(path).name}.parquet", form=lake.LAKE_FORM)

    folder.mkdir(exist_ok=True)
    both(one, tows["samples_path"])


def read_text(world: World, tows: pl.DataFrame, folder: Path) -> None:
    """Text to checked samples and blocks in an empty lake; the files were hashed before."""
    shutil.rmtree(folder, ignore_errors=True)
    store = Store(folder)
    store.file_hashes.parent.mkdir(parents=True)
    shutil.copy(world.store.file_hashes, store.file_hashes)
    profiles = read_profiles(world.archive)
    for season in tows["season"].unique().sort():
        own = tows.filter(season=season).select("tow_id")
        listed = world.store.read("listed_tows").join(own, on="tow_id", how="semi")
        runs = world.store.read("listed_runs").join(own, on="tow_id", how="semi")
        profile = profiles.find(season)
        index = lake.read_tows(store, world.archive, listed, runs, profile)
        assert index["reason_code"].null_count() == index.height


def by_polars(path: Path) -> pl.DataFrame:
    return pl.read_parquet(path, hive_partitioning=False)


def by_pyarrow(path: Path) -> pl.DataFrame:
    """As the lake reads them, but for the check of checksums."""
    with pq.ParquetFile(path) as file:
        return pl.DataFrame(pl.from_arrow(file.read(use_threads=False)))


def tasks(world: World, compared: int) -> dict[str, Callable[[], object]]:
    """What is timed, by its label."""
    some, all_tows = world.tows(compared), world.tows().drop("samples_key", "blocks_key")
    files, written = world.lake_files(some), FOLDER / "written"
    runs = intake.read_runs_with_windows(world.store).join(
        all_tows.select("tow_id"), on="tow_id", how="semi"
    )
    blocks = stack_blocks(intake.read_all_blocks(world.store), runs)
    return {
        "parse text, write Parquet": partial(parse_and_write, world, some, written),
        "blocks from text": partial(read_text, world, some, FOLDER / "empty"),
        "decode Parquet, pyarrow": partial(both, by_pyarrow, files),
        "decode Parquet, polars": partial(both, by_polars, files),
        "blocks from Parquet": partial(both, lambda f: block_sums(by_pyarrow(f), RATE_HZ), files),
        "rebased, all tows, from blocks": partial(
            recompute, read_shipped_method(METHODS[0]), all_tows, blocks
        ),
        "herijk compare, all tows": partial(compared, world.store, *METHODS, RaceRules()),
    } | {
        f"herijk {command}": partial(
            subprocess.run,
            [sys.executable, "-m", "herijk", *command.split()],
            check=True,
            stdout=subprocess.DEVNULL,
        )
        for command in COMMANDS
    }


def timed(works: dict[str, Callable[[], object]], repeats: int) -> dict[str, Figures]:
    """Medians of each after a first round that does not count: it compiles and fills caches."""
    found: dict[str, list[tuple[float, float]]] = {label: [] for label in works}
    for number in range(repeats + 1):
        for label, work in works.items():
            start, processor = time.perf_counter(), time.process_time()
            work()
            took = time.perf_counter() - start, time.process_time() - processor
            print(f"  {label:34} {took[0]:8.3f} s", file=sys.stderr)
            found[label] += [took] * bool(number)
    return {
        label: Figures(*map(statistics.median, zip(*pairs, strict=True)))
        for label, pairs in found.items()
    }


def asked(found: dict[str, Figures]) -> Iterator[tuple[str, str, str, str, bool]]:
    """What, by the clock, by processor time, what is asked of the clock, and whether it holds."""
    for (of, to), limit in AT_MOST.items():
        clock = found[of].seconds / found[to].seconds
        processor = found[of].processor_s / found[to].processor_s
        holds = clock <= limit
        yield f"{of} / {to}", f"{clock:.2f}", f"{processor:.2f}", f"at most {limit:g}", holds
    for label, limit in WITHIN_S.items():
        one = found[label]
        cells = f"{one.seconds:.2f} s", f"{one.processor_s:.2f} s", f"at most {limit:g} s"
        yield label, *cells, one.seconds <= limit
    for command in COMMANDS:
        seconds = found[f"herijk {command}"].seconds
        limit = f"at most {COMMAND_WITHIN_S:g} s"
        yield f"`herijk {command}`", f"{seconds:.2f} s", "", limit, seconds <= COMMAND_WITHIN_S


def page(found: dict[str, Figures], world: World, compared: int, repeats: int) -> str:
    """The page of the documentation."""
    about = machine("numpy", "polars", "pyarrow")
    tows = world.tows(compared).height
    lines = [
        "# Performance",
        "",
        f"Made by `python -m benchmarks.speed` on {dt.datetime.now(dt.UTC).date()}. Machine: "
        f"{about}. Simulated archive of {world.tows().height} tows at {RATE_HZ} Hz; text and "
        f"Parquet of {tows} of them. Medians of {repeats} repeats in turn, two threads. Every "
        "file is checked, which only decoding does not do. Load is that of the machine at the "
        "end: above the number of cores, other work was going on, and processor time is the more "
        "reliable one.",
        "",
        "| what | by the clock | by processor time | asked | holds |",
        "| --- | --- | --- | --- | --- |",
        *(
            f"| {what} | {clock} | {processor} | {limit} | {'yes' if holds else '**no**'} |"
            for what, clock, processor, limit, holds in asked(found)
        ),
        "",
        "| task | seconds | processor s |",
        "| --- | --- | --- |",
        *(
            f"| {label} | {one.seconds:.2f} | {one.processor_s:.2f} |"
            for label, one in found.items()
            if label.removeprefix("herijk ") not in COMMANDS
        ),
    ]
    return "\n".join(lines) + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tows-per-season", type=int, default=60)
    parser.add_argument("--compared", type=int, default=60, help="tows whose samples are read")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--write", type=Path, metavar="FILE", help="write the page here too")
    chosen = parser.parse_args()
    world = made(chosen.tows_per_season)
    found = timed(tasks(world, chosen.compared), chosen.repeats)
    text = page(found, world, chosen.compared, chosen.repeats)
    print(text)
    if chosen.write:
        chosen.write.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
