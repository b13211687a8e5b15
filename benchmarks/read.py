"""Reading tows at 1000 Hz, stage by stage: text to samples, checks, writing, adding up.

    python benchmarks/read.py [tows]

Each tow is simulated and written in the spelling of 2009 (plain CSV, decimal comma).
"""

import platform
import statistics
import sys
import tempfile
import time
from pathlib import Path

import polars as pl

from pipeline.blocks import block_sums
from pipeline.simulate import WorldSettings, simulate_world
from warehouse.archive import FileHashes, check_samples, index_archive, read_tow_samples
from warehouse.archive.write import write_simulated_archive
from warehouse.lake import SAMPLES_FORM
from warehouse.store import read_parquet, write_parquet


def timed(seconds, work, *arguments):
    start = time.perf_counter()
    made = work(*arguments)
    seconds.append(time.perf_counter() - start)
    return made


def main():
    tows = int(sys.argv[1]) if len(sys.argv) > 1 else 8
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder) / "archive"
        write_simulated_archive(root, simulate_world(WorldSettings((2009,), tows, 1000)))
        start = time.perf_counter()
        index = index_archive(root, FileHashes().hash_file)
        index_s = time.perf_counter() - start
        profile = index.profiles.for_season(2009)
        times = {
            "read text": [],
            "check": [],
            "write Parquet": [],
            "read Parquet": [],
            "add up": [],
        }
        sizes = []
        for tow in index.tows.iter_rows(named=True):
            parquet = Path(folder) / f"{tow['tow_id']}.parquet"
            samples = timed(times["read text"], read_tow_samples, root, tow, profile)
            timed(times["check"], check_samples, samples, tow, index.runs)
            timed(times["write Parquet"], write_parquet, samples, parquet, None, SAMPLES_FORM)
            timed(times["read Parquet"], read_parquet, parquet)
            timed(times["add up"], block_sums, samples, 1000)
            sizes.append(parquet.stat().st_size / 1e6)
    print(f"python {platform.python_version()}, polars {pl.__version__}; {tows} tows, median a tow")
    print(f"  {'index and hash':15} {index_s / tows * 1e3:8.1f} ms")
    for stage, seconds in times.items():
        print(f"  {stage:15} {statistics.median(seconds) * 1e3:8.1f} ms")
    print(f"  {'Parquet':15} {statistics.median(sizes):8.2f} MB")


if __name__ == "__main__":
    main()
