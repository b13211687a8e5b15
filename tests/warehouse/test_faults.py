"""What is set aside stands in quarantine, with what it costs and the day it was first seen.

Which faults are found, and that they move no other tow, is tried in `archive/test_reason_codes` and
`tests/properties/test_archive`.
"""

import datetime as dt
import re
from collections.abc import Callable

import polars as pl
import pytest

from pipeline.method.reading import read_shipped_method
from tests.tables import compute_tables
from tests.warehouse.edition_bench import SMALL, EditionBench
from warehouse.derive.archive_tables import read_archive
from warehouse.derive.database import build_database

ROWS = 50 * SMALL.rate_hz
DAYS = [dt.date(2026, 11, day) for day in (20, 21, 22)]
Lines = list[str]


def no_number(lines: Lines) -> Lines:
    """A force that is none, in one row."""
    cells = lines[76].split(";")
    return [*lines[:76], ";".join([*cells[:3], "abc", *cells[4:]]), *lines[77:]]


def without_run_4(lines: Lines) -> Lines:
    return [line for line in lines if not line.startswith("4;")]


def nothing(_: Lines) -> Lines:
    return []


def spoil(bench: EditionBench, tow: str, change: Callable[[Lines], Lines]) -> str:
    """Spoils the samples of a tow of 2009; gives their path."""
    return bench.change_samples(tow, lambda text: "\n".join(change(text.rstrip("\n").split("\n"))))


def read_again(bench: EditionBench, day: dt.date) -> pl.DataFrame:
    """Brings the archive into the lake as a rebuild of that day does; gives what is set aside."""
    read_archive(bench.store, bench.archive, day)
    return bench.store.read("quarantine")


def test_the_quarantine_says_what_each_fault_costs_and_tables_do_too(bench_of_editions):
    bench, register = bench_of_editions, "sloepregister/sloepregister_2014.csv"
    faults = {"2009-001": without_run_4, "2009-002": no_number, "2009-003": nothing}
    paths = {tow: spoil(bench, tow, change) for tow, change in faults.items()}
    lines = (bench.archive / register).read_text("cp1252").rstrip("\n").split("\n")
    broken = re.sub(r"[\d.]+(,[^,]*,[^,]*,[^,]*,[^,]*)$", r"x\1", lines[1])  # its A
    (bench.archive / register).write_text("\n".join([*lines, broken, ""]), "cp1252")
    found = read_again(bench, DAYS[0])
    columns = ("path", "tow_id", "line", "reason_code", "lost")
    assert sorted(found.select(columns).rows(), key=str) == sorted(
        [
            (paths["2009-001"], "2009-001", None, "missing_run", "run"),
            (paths["2009-002"], "2009-002", 77, "bad_number", "seconds"),
            (paths["2009-003"], "2009-003", None, "unreadable_file", "tow"),
            (register, None, len(lines) + 1, "bad_register_row", "row"),
        ],
        key=str,
    )
    compute_tables(bench.store, [read_shipped_method("as-published")], DAYS[0])
    points = bench.store.read("run_points", "as-published")
    lost_s = found.filter(tow_id="2009-002")["lost_s"].item()
    assert points.filter(tow_id="2009-002")["lost_s"].max() == pytest.approx(lost_s)
    assert lost_s > 0
    tows = bench.store.read("tows")
    assert tows.filter(tow_id="2009-001")["runs_set_aside"].item() == 1
    assert "2009-003" not in {*tows["tow_id"], *points["tow_id"]}


@pytest.mark.more
def test_a_fault_keeps_the_day_on_which_it_was_first_seen(bench_of_editions):
    for number, day in enumerate(DAYS, 1):
        spoil(bench_of_editions, f"2009-{number:03d}", no_number)
        seen = read_again(bench_of_editions, day)
    assert dict(seen.select("tow_id", "first_seen").rows()) == {
        f"2009-{number:03d}": day for number, day in enumerate(DAYS, 1)
    }


@pytest.mark.more
def test_the_day_is_known_from_the_database_where_the_lake_lost_it(bench_of_editions):
    bench = bench_of_editions
    spoil(bench, "2009-001", no_number)
    build_database(bench.store.database, {"quarantine": read_again(bench, DAYS[0])})
    bench.store.table_path("quarantine").unlink()
    assert read_again(bench, DAYS[1])["first_seen"].to_list() == DAYS[:1]
    bench.store.table_path("quarantine").unlink()
    bench.store.database.write_bytes(b"damaged too")
    assert read_again(bench, DAYS[2])["first_seen"].to_list() == DAYS[2:]
