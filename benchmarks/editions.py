"""Publishing, comparing and verifying editions of 300 boats, from blocks.

    PYTHONPATH=. python -m benchmarks.editions [tows per season]

The samples are simulated at 5 Hz: the number of samples in a block does not matter here. Making the
archive and reading it is not counted.
"""

import datetime as dt
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.harness import machine
from herijk.simulate import WorldSettings, simulate_world
from herijk.simulate.archive_writer import write_simulated_archive
from pipeline.method.definition import shipped_method
from tests.intake import bring_in
from warehouse.derive.graph import ARCHIVE, METHOD
from warehouse.derive.inputs import Scope
from warehouse.editions.compare import diff
from warehouse.editions.publish import Terms, publish
from warehouse.editions.verify import verify
from warehouse.store.editions import read_edition
from warehouse.store.store import Store

DAY = dt.date(2018, 6, 1)
METHODS = ("as-published", "rebased")


def rebuilt(root, tows_per_season):
    """A data folder with the tables of both methods."""
    settings = WorldSettings(tuple(range(2009, 2019)), tows_per_season, 5)
    write_simulated_archive(root / "archive", simulate_world(settings))
    store = Store(root / "data")
    bring_in(store, root / "archive")
    ARCHIVE.make(Scope(store, (), today=DAY))
    for name in METHODS:
        METHOD.make(Scope(store, [shipped_method(name)]))
    return store


def timed(what, function, *arguments):
    start, cpu = time.perf_counter(), time.process_time()
    result = function(*arguments)
    took, used = time.perf_counter() - start, time.process_time() - cpu
    print(f"{what:34} {took:6.2f} s, {used:6.2f} s of processor")
    return result


def main(tows_per_season):
    with tempfile.TemporaryDirectory() as folder:
        store = rebuilt(Path(folder), tows_per_season)
        print(machine("polars"), f"{store.read('tows').height} tows")
        for name in METHODS:
            terms = Terms(f"edition-{name}", DAY, "benchmark", DAY)
            timed(f"publish {name}", publish, store, shipped_method(name), terms)
        names = [f"edition-{name}" for name in METHODS]
        print(f"lines: {read_edition(store, names[0]).register.height}")
        timed("diff", diff, store, *names)
        report = timed("verify both", verify, store)
        assert not report["wrong"], report["findings"]


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 75)
