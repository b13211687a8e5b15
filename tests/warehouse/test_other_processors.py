"""The same archive on another kind of processor: equal numbers, and no cry of forgery.

NumPy and OpenBLAS choose their kernels by the processor, and other kernels leave other last bits.
Environment variables make them choose those of an old processor.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from herijk.simulate import WorldSettings, simulate_world
from herijk.simulate.archive_writer import write_simulated_archive
from tests.numbers import unequal
from tests.warehouse.edition_bench import EditionBench
from warehouse.store.database import open_database

ROOT = Path(__file__).parents[2]
WORLD = WorldSettings(seasons=(2009, 2014, 2017), tows_per_season=10, rate_hz=10, seed=3)
"""Logs to estimate, boats towed again, types of several boats, races."""

EVERYTHING = """
import dataclasses, json, shutil, sys
from pathlib import Path
from tests.conftest import quickly
from tests.warehouse.edition_bench import METHODS, EditionBench
from warehouse.editions.verify import verify
bench = EditionBench(Path(sys.argv[1]), Path(sys.argv[2]))
with quickly(bench.store, left_out=["site"]):
    import assets.rebuild
    assets.rebuild.rebuild(bench.archive, bench.data, METHODS)
"""
PUBLISH = """
bench.publish("2014-1", "as-published")
bench.publish("2014-2", "rebased")
"""
VERIFY = """
shutil.copytree(sys.argv[3], bench.data / "editions")
print(json.dumps(dataclasses.asdict(verify(bench.store))))
"""


def older_kernels() -> dict[str, str]:
    """What makes NumPy and OpenBLAS do as on a processor of 2008."""
    found = np.show_config(mode="dicts")["SIMD Extensions"]["found"]
    return {"OPENBLAS_CORETYPE": "Nehalem", "NPY_DISABLE_CPU_FEATURES": " ".join(found)}


def run(program: str, bench: EditionBench, environment: dict[str, str], *arguments: Path) -> str:
    done = subprocess.run(
        [sys.executable, "-c", program, bench.archive, bench.data, *arguments],
        cwd=ROOT,
        env=os.environ | environment,
        stdout=subprocess.PIPE,
        text=True,
        check=True,
        timeout=300,
    )
    return done.stdout


def all_tables(bench):
    with open_database(bench.store.database) as db:
        names = [row[2] for row in db.execute("SHOW ALL TABLES").fetchall()]
        return {name: db.sql(f'SELECT * FROM "{name}"').pl() for name in names}  # noqa: S608


@pytest.fixture(scope="module")
def here_and_there(tmp_path_factory):
    """Two data folders of one archive, and what `verify` says there of editions made here."""
    root = tmp_path_factory.mktemp("processors")
    here, there = (EditionBench(root / "archive", root / place) for place in ("here", "there"))
    write_simulated_archive(here.archive, simulate_world(WORLD))
    run(EVERYTHING + PUBLISH, here, {})
    report = run(EVERYTHING + VERIFY, there, older_kernels(), here.data / "editions")
    return here, there, json.loads(report)


@pytest.mark.slow
def test_another_processor_makes_the_same_tables(here_and_there):
    """On a processor that ignores the variables this compares equal with equal."""
    here, there, _ = here_and_there
    tables = all_tables(here)
    assert unequal(tables, all_tables(there)) == []
    estimated = ("season_links", "predicted_cw", "race_changes")
    assert all(tables[name].height for name in estimated)


@pytest.mark.slow
def test_an_edition_of_another_processor_is_as_it_was_published(here_and_there):
    _, _, report = here_and_there
    assert report["findings"] == []
    assert [one["equal"] for one in report["editions"]] == [
        one["lines"] for one in report["editions"]
    ]
    assert len(report["editions"]) == 2
