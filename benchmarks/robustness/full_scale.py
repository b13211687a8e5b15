"""Memory and time of a first rebuild at full scale: 1,000 tows of 300,000 samples.

    python benchmarks/robustness/full_scale.py [--folder DIR] [--archive DIR] [--tows-per-season N]

The archive is simulated, ten seasons of it, unless one is given. The data folder is made in the
folder, by default a temporary one, and removed afterwards. The rebuild runs in a process of its
own, all methods; its peak memory is what the system counted. Exit status 1 when that is 2 GiB or
more.
"""

import argparse
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from herijk.simulate import WorldSettings, simulate_world
from herijk.simulate.archive_writer import write_simulated_archive
from warehouse.store.store import Store

SEASONS = tuple(range(2009, 2019))
LIMIT_GIB = 2.0
KIB_A_GIB = 2**20


def simulate(archive: Path, tows_per_season: int) -> None:
    """Writes the archive; says how long that took."""
    begin = time.monotonic()
    world = simulate_world(WorldSettings(SEASONS, tows_per_season, 1000, 1))
    write_simulated_archive(archive, world)
    print(f"archive made in {time.monotonic() - begin:.0f} s", flush=True)


def measure(archive: Path, data: Path) -> float:
    """Peak memory of a rebuild in GiB; prints what was done."""
    begin = time.monotonic()
    subprocess.run(
        [sys.executable, "-m", "herijk", "rebuild", "--archive", archive, "--data", data],
        check=True,
        stdout=subprocess.DEVNULL,
    )
    seconds = time.monotonic() - begin
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    peak = used.ru_maxrss / KIB_A_GIB
    size = sum(f.stat().st_size for f in archive.rglob("*") if f.is_file())
    print(f"{Store(data).read('tows').height} tows, archive {size / 1e9:.1f} GB")
    print(f"rebuild: {seconds:.0f} s, processor {used.ru_utime + used.ru_stime:.0f} s")
    print(f"peak memory {peak:.2f} GiB")
    return peak


def main() -> None:
    """Measures, and says by the exit status whether the limit holds."""
    parser = argparse.ArgumentParser(description="Memory and time of a first rebuild.")
    parser.add_argument("--folder", type=Path, help="where to work; default: a temporary folder")
    parser.add_argument("--archive", type=Path, help="an archive that is there already")
    parser.add_argument("--tows-per-season", type=int, default=100)
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory(dir=chosen.folder) as folder:
        archive = chosen.archive or Path(folder) / "archive"
        if chosen.archive is None:
            simulate(archive, chosen.tows_per_season)
        peak = measure(archive, Path(folder) / "data")
    sys.exit(peak >= LIMIT_GIB)


if __name__ == "__main__":
    main()
