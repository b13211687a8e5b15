"""How near the truth `rebased` comes in every named world: bias, RMSE, coverage, flags, alarms.

    PYTHONPATH=. python -m benchmarks.accuracy.worlds [--seeds 20] [--processes 2] [--world NAME]

An archive has ten seasons of 24 tows. It is simulated at 10 samples per second, added up to blocks
and recomputed, without files; `--files` writes it, lets `herijk rebuild` read it and takes the
tables from there, which is ten times slower. Results are kept as lines of JSON under the version
of the code, so that a run that was stopped goes on. The blocks are kept too, so that another
version of the method costs a second an archive. All is under `benchmarks/data`; delete it at will.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"  # one process a core; read when numpy is imported
os.environ["OPENBLAS_NUM_THREADS"] = "1"
os.environ["POLARS_MAX_THREADS"] = "1"

import argparse
import json
import pickle
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import polars as pl

from benchmarks.accuracy.score import EQUAL_BOATS, Record, score, table
from herijk.simulate import WORLDS, simulate_world, world_settings
from herijk.simulate.archive_writer import write_simulated_archive
from pipeline.assessment.plausibility import plausibility
from pipeline.blocks.tows import Tows
from pipeline.consistency.observed import observe
from pipeline.consistency.repeats import repeat_pairs
from pipeline.consistency.types import compare_types
from pipeline.method.reading import read_shipped_method
from pipeline.recompute.recompute import recompute
from tests.worlds import Measured, measure, truth_rows
from warehouse.derive.plausible import add_doubts
from warehouse.store.code import code_version, hash_code
from warehouse.store.database import open_database

FOLDER = Path(os.environ.get("BENCH_FOLDER", "benchmarks/data")) / "accuracy"
SIZE = {"seasons": tuple(range(2009, 2019)), "tows_per_season": 24}
RATE_HZ = 10
FILES_RATE_HZ = 50
FIRST_SEED = 7000
"""Tests and the other benchmarks have other seeds."""
ONLY_FROM_FILES = ("dropouts",)
"""Worlds whose fault is for the reader of files."""
METHOD = "rebased"
TABLES = ("curves", "log_factors", "season_diagnosis", EQUAL_BOATS)

Task = tuple[str, int, bool]


def main() -> None:
    """Runs what is missing and prints the table."""
    asked = _arguments()
    tasks = [
        (world, FIRST_SEED + number, asked.files or world in ONLY_FROM_FILES)
        for number in range(asked.seeds)
        for world in asked.world or WORLDS
    ]
    kept = FOLDER / f"{code_version()}.jsonl"
    kept.parent.mkdir(parents=True, exist_ok=True)
    done = _read(kept)
    missing = [task for task in tasks if task not in done]
    with (
        ProcessPoolExecutor(asked.processes, mp_context=get_context("spawn")) as pool,
        kept.open("a", encoding="utf-8") as file,
    ):
        start = time.monotonic()
        running = {pool.submit(measured, *task): task for task in missing}
        for count, future in enumerate(as_completed(running), start=1):
            done[running[future]] = future.result()
            line = {"task": running[future], "records": future.result()}
            file.write(json.dumps(line) + "\n")
            file.flush()
            left_s = (time.monotonic() - start) / count * (len(missing) - count)
            print(f"{count} of {len(missing)}, {left_s / 60:.0f} min left", file=sys.stderr)
    print(f"version {code_version()}, method {METHOD}\n")
    wanted = sorted(tasks, key=lambda task: list(WORLDS).index(task[0]))
    records = [{"world": task[0], **record} for task in wanted for record in done[task]]
    print("\n".join(table(pl.DataFrame(records, infer_schema_length=None))))


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=20, help="archives of each world")
    parser.add_argument("--processes", type=int, default=os.cpu_count())
    parser.add_argument("--world", action="append", choices=WORLDS, help="this world only")
    parser.add_argument("--files", action="store_true", help="through files and a rebuild")
    return parser.parse_args()


def _read(kept: Path) -> dict[Task, list[Record]]:
    """Results that are there; a last line cut off by a stop is left out."""
    found: dict[Task, list[Record]] = {}
    if kept.exists():
        for line in kept.read_text(encoding="utf-8").splitlines():
            if line.endswith("]}"):
                held = json.loads(line)
                found[tuple(held["task"])] = held["records"]
    return found


def measured(world: str, seed: int, files: bool) -> list[Record]:
    """One archive, simulated, recomputed and compared with its truth."""
    tables, truth = (_by_files if files else _by_blocks)(world, seed)
    return score(world, tables, truth)


def _by_blocks(world: str, seed: int) -> tuple[dict[str, pl.DataFrame], pl.DataFrame]:
    archive = simulated(world, seed)
    return recomputed(archive, WORLDS[world].options.get("spread") == 0.0), archive.truth


def recomputed(archive: Measured, equal_boats: bool) -> dict[str, pl.DataFrame]:
    """Tables of an archive as a rebuild makes them; where asked, whether equal boats are alike."""
    tows = add_doubts(archive.tows, plausibility(Tows.from_frames(archive.tows, archive.blocks)))
    made = recompute(read_shipped_method(METHOD), tows, archive.blocks, with_bands=False)
    tables = {name: getattr(made, name) for name in TABLES if hasattr(made, name)}
    if equal_boats:
        boats = archive.tows.select("fsn_no", "boat_type").unique()
        observed = observe(made.curves, archive.tows, boats, made.run_points)
        pairs = repeat_pairs(made.curves, archive.tows)
        tables[EQUAL_BOATS] = compare_types(observed, pairs).consistency
    return tables


def simulated(world: str, seed: int) -> Measured:
    """Simulated once for every version of the simulator; sums are kept with seven digits."""
    version = hash_code("herijk.simulate", "pipeline.blocks")
    kept = FOLDER / "blocks" / version / f"{world}-{seed}.pickle"
    if kept.exists():
        return _with_sums(pickle.loads(kept.read_bytes()), np.float64)  # noqa: S301, our own file
    settings = world_settings(world, rate_hz=RATE_HZ, seed=seed, **SIZE)
    types = {boat.fsn_no: boat.boat_type.name or None for boat in simulate_world(settings).boats}
    found = measure(settings)
    boat_type = pl.col("fsn_no").replace_strict(types, return_dtype=pl.String).alias("boat_type")
    small = _with_sums(replace(found, tows=found.tows.with_columns(boat_type)), np.float32)
    kept.parent.mkdir(parents=True, exist_ok=True)
    partial = kept.with_suffix(f".{os.getpid()}")
    partial.write_bytes(pickle.dumps(small))
    partial.replace(kept)
    return _with_sums(small, np.float64)


def _with_sums(archive: Measured, kind: type) -> Measured:
    sums = {name: values.astype(kind) for name, values in archive.blocks.sums.items()}
    return replace(archive, blocks=replace(archive.blocks, sums=sums))


def _by_files(world: str, seed: int) -> tuple[dict[str, pl.DataFrame], pl.DataFrame]:
    simulated = simulate_world(world_settings(world, rate_hz=FILES_RATE_HZ, seed=seed, **SIZE))
    with tempfile.TemporaryDirectory() as folder:
        archive, data = Path(folder) / "archief", Path(folder) / "data"
        write_simulated_archive(archive, simulated, workers=1)
        subprocess.run(
            [
                *(sys.executable, "-m", "herijk", "rebuild", "--method", METHOD),
                *("--archive", str(archive), "--data", str(data)),
            ],
            check=True,
            capture_output=True,
        )
        with open_database(data / "warehouse.duckdb") as db:
            there = {row[2] for row in db.execute("SHOW ALL TABLES").fetchall()}
            tables = {
                name: db.table(name).filter(f"method = '{METHOD}'").pl()
                for name in TABLES
                if name in there
            }
    return tables, truth_rows(simulated)


if __name__ == "__main__":
    main()
