"""Memory and time of a first rebuild at full scale: 1,000 tows of 300,000 samples.

    python benchmarks/robustness/full_scale.py [folder] [tows a season]

The archive of ten seasons stays in the folder, to be used again; without one it is made in the
temporary folder and removed. The rebuild runs in a process of its own, all methods; its peak
memory is what the system counted. Exit status 1 when that is 2 GiB or more.
"""

import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from pipeline.simulate import WorldSettings, simulate_world
from warehouse.archive.write import write_simulated_archive

SEASONS = tuple(range(2009, 2019))
LIMIT_GIB = 2.0
KIB_A_GIB = 2**20


def measure(folder: Path, tows_per_season: int) -> float:
    """Peak memory of a rebuild in GiB; prints what was done."""
    archive, data = folder / "archive", folder / "data"
    if not archive.exists():
        begin = time.monotonic()
        write_simulated_archive(
            archive, simulate_world(WorldSettings(SEASONS, tows_per_season, 1000, 1))
        )
        print(f"archive made in {time.monotonic() - begin:.0f} s", flush=True)
    size = sum(f.stat().st_size for f in archive.rglob("*") if f.is_file())
    begin = time.monotonic()
    subprocess.run(
        [sys.executable, "-m", "herijk", "rebuild", "--archive", archive, "--data", data],
        check=True,
        stdout=subprocess.DEVNULL,
    )
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    peak = used.ru_maxrss / KIB_A_GIB
    print(f"{len(SEASONS) * tows_per_season} tows, archive {size / 1e9:.1f} GB")
    print(f"rebuild: {time.monotonic() - begin:.0f} s, processor {used.ru_utime:.0f} s")
    print(f"peak memory {peak:.2f} GiB")
    return peak


def main() -> None:
    """Measures, and says by the exit status whether the limit holds."""
    tows = int(sys.argv[2]) if len(sys.argv) > 2 else 100
    if len(sys.argv) > 1:
        peak = measure(Path(sys.argv[1]), tows)
    else:
        with tempfile.TemporaryDirectory() as folder:
            peak = measure(Path(folder), tows)
    sys.exit(peak >= LIMIT_GIB)


if __name__ == "__main__":
    main()
