"""How rebuilds and reading commands grow with the number of tows, from the shell.

    PYTHONPATH=. python -m benchmarks.growth [--tows-per-season 60 180 600] [--write FILE]

Archives of 17 seasons are simulated at 10 samples per second, so that ten thousand tows fit on a
disk. Everything after the blocks, which are sums over a second, costs what it does at 1000 Hz;
reading costs less.
"""

import argparse
import datetime as dt
import tempfile
from pathlib import Path
from typing import Final

from benchmarks.commands import COLD, Cost, readings, rebuilds
from benchmarks.harness import machine
from benchmarks.world import SEASONS
from herijk.simulate import WorldSettings, simulate_world
from herijk.simulate.archive_writer import write_simulated_archive
from warehouse.store.store import Store

RATE_HZ: Final = 10
MOST_MIB: Final = {1_000: 1024, 10_000: 2048}
"""What the project asks: memory of a cold rebuild with so many tows."""


def costs(tows_per_season: int, folder: Path) -> tuple[int, int, dict[str, Cost]]:
    """How many tows and boats there are, and what each command took."""
    archive = folder / "simulated"
    world = simulate_world(WorldSettings(SEASONS, tows_per_season, RATE_HZ))
    write_simulated_archive(archive, world)
    found = rebuilds(archive, folder)
    data = folder / "data"
    found |= readings(data, repeats=1)
    tows = Store(data).read("tows")
    return tows.height, tows["fsn_no"].n_unique(), found


def page(sizes: list[tuple[int, int, dict[str, Cost]]]) -> str:
    """The page of the documentation."""
    about = ", ".join(f"{key} {value}" for key, value in machine("numpy", "polars").items())
    heads = [f"{tows:,} tows, {boats:,} boats" for tows, boats, _ in sizes]
    lines = [
        "# Growth with the number of tows",
        "",
        f"Made by `python -m benchmarks.growth` on {dt.datetime.now(dt.UTC).date()}. Machine: "
        f"{about}. Simulated archives of {len(SEASONS)} seasons at {RATE_HZ} Hz: everything after "
        "the blocks costs what it does at 1000 Hz, reading costs less. Every command once, from "
        "the shell: seconds by the clock / seconds of processor / peak MiB, both of all its "
        "processes. At 1000 Hz: [commands.md](commands.md).",
        "",
        "| command | " + " | ".join(heads) + " |",
        "| --- |" + " --- |" * len(sizes),
        *(
            f"| {name} | "
            + " | ".join(
                f"{one[name].seconds:.1f} / {one[name].processor_s:.1f} / {one[name].peak_mib:.0f}"
                for *_, one in sizes
            )
            + " |"
            for name in sizes[0][2]
        ),
        "",
        *(
            f"- Asked of a rebuild with {number:,} tows: at most {most:,} MiB. Found with "
            f"{tows:,}: {found[COLD].peak_mib:,.0f}."
            for number, most in MOST_MIB.items()
            for tows, _, found in sizes
            if number <= tows < 2 * number
        ),
    ]
    return "\n".join(lines) + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tows-per-season", type=int, nargs="+", default=[60, 180, 600])
    parser.add_argument("--write", type=Path, metavar="FILE", help="write the page here too")
    chosen = parser.parse_args()
    sizes = []
    for tows_per_season in chosen.tows_per_season:
        with tempfile.TemporaryDirectory() as folder:
            sizes.append(costs(tows_per_season, Path(folder)))
        print(page(sizes), flush=True)
    if chosen.write:
        chosen.write.write_text(page(sizes), encoding="utf-8")


if __name__ == "__main__":
    main()
