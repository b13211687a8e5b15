"""One archive with one of every fault: all are in quarantine, and every other row is untouched."""

import datetime as dt
import shutil
from collections.abc import Callable
from pathlib import Path

import polars as pl
import pytest
from polars.testing import assert_frame_equal

from pipeline.method.definition import shipped_method
from tests.conftest import METHODS, SMALL, Workbench
from warehouse.derive.database import build_database
from warehouse.derive.graph import ARCHIVE, METHOD
from warehouse.derive.inputs import Scope
from warehouse.intake.seasons import bring_in

ROWS = 50 * SMALL.rate_hz
LIST_2009 = "sleeplijsten/sleeplijst_2009.csv"
RACES = "wedstrijden/race_2014.csv"
REGISTER = "sloepregister/sloepregister_2014.csv"
Lines = list[str]


def line_of(run: int, row: int = 0) -> int:
    """Line of the samples file of a row (from 0) of a run; the header is line 1."""
    return 2 + (run - 1) * ROWS + row


def cells(column: int, value: Callable[[str], str], first: int, last: int):
    """Changes a column (0 run, 1 log1, 2 log2, 3 force, 4 wind speed, 5 angle) on some lines."""

    def change(lines: Lines) -> Lines:
        fields = [line.split(";") for line in lines]
        for row in fields[first - 1 : last]:
            row[column] = value(row[column])
        return [";".join(row) for row in fields]

    return change


def times(factor: float) -> Callable[[str], str]:
    return lambda cell: f"{float(cell.replace(',', '.')) * factor:.3f}".replace(".", ",")


def to(value: str) -> Callable[[str], str]:
    return lambda cell: value


def three_times_too_fast(lines: Lines) -> Lines:
    for column in (1, 2):
        lines = cells(column, times(3.6), 2, line_of(6, ROWS - 1))(lines)
    return lines


IN_SAMPLES: dict[int, tuple[Callable[[Lines], Lines], str, int | None]] = {
    1: (lambda lines: [li for li in lines if not li.startswith("4;")], "missing_run", None),
    2: (lambda lines: lines[: line_of(6, ROWS - 60)], "short_run", line_of(6)),
    3: (lambda lines: [*lines[:3000], "3;2,"], "missing_run", None),
    4: (cells(3, to("abc"), 77, 77), "bad_number", 77),
    5: (cells(3, to("NaN"), 88, 88), "bad_number", 88),
    6: (cells(1, to("0,000"), line_of(2, 100), line_of(2, 300)), "log_dropout", line_of(2, 100)),
    7: (lambda lines: [swapped(lines[0]), *lines[1:]], "swapped_columns", 1),
    8: (three_times_too_fast, "speed_unit", 1),
    9: (cells(3, times(-1), 2, line_of(6, ROWS - 1)), "negative_force", line_of(1)),
    10: (cells(1, to("2,4"), line_of(3, 50), line_of(3, 200)), "stuck_channel", line_of(3, 50)),
}
"""Tow number of 2009: what is done to its file, the reason code and the line."""

KEPT = (1, 2, 4, 5, 6, 10)
"""Of these, the tows that lose a run or seconds."""


def swapped(header: str) -> str:
    names = header.split(";")
    names[1], names[3] = names[3], names[1]
    return ";".join(names)


def tow_ids(*numbers: int) -> list[str]:
    return [f"2009-{number:03d}" for number in numbers]


class Archive:
    """A copy of the small archive, to spoil."""

    def __init__(self, root: Path, built: Workbench) -> None:
        self.root = root
        self.path_of = dict(built.store.read("listed_tows").select("tow_id", "samples_path").rows())

    def samples(self, tow_id: str, change: Callable[[Lines], Lines]) -> None:
        file = self.root / self.path_of[tow_id]
        file.write_text(
            "\n".join(change(file.read_text("utf-8").rstrip("\n").split("\n"))), "utf-8"
        )

    def row(self, tow_id: str, change: Callable[[str], list[str]]) -> None:
        """Replaces a row of the list of 2009 by others."""
        file = self.root / LIST_2009
        lines = file.read_text("cp1252").rstrip("\n").split("\n")
        place = next(i for i, line in enumerate(lines) if line.startswith(tow_id))
        lines[place : place + 1] = change(lines[place])
        file.write_text("\n".join(lines) + "\n", "cp1252")

    def line_in_list(self, start: str) -> list[int]:
        lines = (self.root / LIST_2009).read_text("cp1252").split("\n")
        return [number for number, line in enumerate(lines, 1) if line.startswith(start)]


def spoil_everything(root: Path, built: Workbench) -> tuple[set[tuple], set[str]]:
    """One of every fault; gives (path, tow, line, code) of each, and the tows that are lost."""
    archive = Archive(root, built)
    for number, (change, _, _) in IN_SAMPLES.items():
        archive.samples(f"2009-{number:03d}", change)
    expected = {
        (archive.path_of[f"2009-{number:03d}"], f"2009-{number:03d}", line, code)
        for number, (_, code, line) in IN_SAMPLES.items()
    }
    no_file, no_boat, two_rows, twice, no_row, cut_gz = (*tow_ids(11, 12, 13, 14, 15), "2014-001")
    (archive.root / archive.path_of[no_file]).unlink()
    archive.row(no_boat, lambda row: [row.replace("FSN", "FSN9", 1)])
    archive.row(two_rows, lambda row: [row, row.replace(";H;", ";D;").replace("nee", "ja")])
    archive.row(twice, lambda row: [row, row.replace(twice, "2009-099", 1)])
    archive.row(no_row, lambda row: [])
    packed = archive.root / archive.path_of[cut_gz]
    packed.write_bytes(packed.read_bytes()[: packed.stat().st_size // 2])
    (archive.root / "archief.toml").write_text(
        (archive.root / "archief.toml").read_text("utf-8")
        + '\n[[set_aside]]\ndate = 2014-03-12\nreason = "wind: measured, but unreliable"\n',
        "utf-8",
    )
    (archive.root / "wedstrijden").mkdir(exist_ok=True)
    (archive.root / RACES).write_text(
        "wedstrijd;datum;afstand [km];fsn_nr;roeiers;klasse;roeitijd;stroom [km];straf [W]\n"
        "Race;2014-06-07;18,4;FSN1;8;H;2:10:25;;\nRace;2014-06-07;18,4;FSN2;8;H;2:70:25;;\n"
    )
    (archive.root / REGISTER).write_text(
        "fsn_nr;roeiers;klasse;A;B;Cw;roeisnelheid [m/s];sleepdatum\n"
        "FSN1;8;H;31,60;4,44;43,89;2,35;2012-03-10\nFSN2;8;H;x;4,44;43,89;2,35;2012-03-10\n"
    )
    (line_no_file,), (line_no_boat,) = map(archive.line_in_list, (no_file, no_boat))
    (line_twice,) = archive.line_in_list("2009-099")
    expected |= {
        (LIST_2009, no_file, line_no_file, "samples_missing"),
        (LIST_2009, no_boat, line_no_boat, "unknown_boat"),
        (LIST_2009, "2009-099", line_twice, "duplicate_tow"),
        (archive.path_of[no_row], None, None, "samples_not_listed"),
        (RACES, None, 3, "bad_race_row"),
        (REGISTER, None, 3, "bad_register_row"),
        (archive.path_of[cut_gz], cut_gz, None, "unreadable_file"),
        *(
            (LIST_2009, two_rows, line, "duplicate_tow_id")
            for line in archive.line_in_list(two_rows)
        ),
        *(
            ("sleeplijsten/sleeplijst_2014.csv", f"2014-{number:03d}", number + 1, "day_set_aside")
            for number in range(17, 21)
        ),
    }
    lost = {tow for _, tow, _, _ in expected if tow not in (None, "2009-099")} | {no_row}
    return expected, lost


@pytest.fixture(scope="module")
def spoiled(built: Workbench, tmp_path_factory: pytest.TempPathFactory):
    """The small archive with one of every fault, rebuilt from nothing."""
    root = tmp_path_factory.mktemp("spoiled")
    shutil.copytree(built.archive, root / "archive")
    bench = Workbench(root / "archive", root / "data")
    expected, lost = spoil_everything(bench.archive, built)
    bench.rebuild()
    return bench, expected, lost


def test_every_fault_is_in_quarantine_with_its_code_path_tow_and_line(spoiled):
    bench, expected, _ = spoiled
    found = bench.table("quarantine").select("path", "tow_id", "line", "reason_code").rows()
    assert len(found) == len(set(found))
    assert set(found) == expected


@pytest.mark.parametrize("table", ["tows", "tow_runs", "run_points", "curves"])
def test_all_other_rows_are_those_of_the_clean_archive(spoiled, built, table):
    bench, _, lost = spoiled
    untouched = ~pl.col("tow_id").is_in(list(lost))
    others = built.table(table).filter(untouched)
    assert 0 < others.height < built.table(table).height
    # A tow is also judged against others, so a missing one may change a flag, never a number.
    judged = [c for c in ("status", "flags", "unusual") if c in others.columns]
    found = bench.table(table).filter(untouched).drop(judged)
    assert_frame_equal(found, others.drop(judged), check_exact=True)
    kept = set(bench.table("tows")["tow_id"]) & lost
    assert kept == set(tow_ids(*KEPT))


def test_the_quarantine_says_what_each_fault_costs(spoiled):
    found = spoiled[0].table("quarantine")
    of_tow = dict(
        found.filter(pl.col("tow_id").str.starts_with("2009")).select("tow_id", "lost").rows()
    )
    assert {tow: of_tow[tow] for tow in tow_ids(*range(1, 11))} == dict(
        zip(
            tow_ids(*range(1, 11)),
            ["run", "run", "tow", "seconds", "seconds", "run", "tow", "tow", "tow", "run"],
            strict=True,
        )
    )
    assert found.filter(reason_code="bad_race_row")["lost"].to_list() == ["row"]
    assert found.filter(reason_code="samples_not_listed")["lost"].to_list() == ["file"]
    points = spoiled[0].table("run_points").filter(tow_id=tow_ids(4)[0], method="rebased-2015")
    assert points["lost_s"].max() == pytest.approx(
        found.filter(tow_id=tow_ids(4)[0])["lost_s"].item()
    )
    tows = spoiled[0].table("tows").filter(tow_id=tow_ids(1)[0])
    assert tows["runs_set_aside"].to_list() == [1]


def read_again(bench: Workbench, day: dt.date) -> pl.DataFrame:
    """Brings the archive into the lake as a rebuild of that day does; gives what is set aside."""
    store = bench.store
    bring_in(store, bench.archive)
    ARCHIVE.make(Scope(store, (), today=day))
    return store.read("quarantine")


def test_a_vane_that_reads_minus_180_to_180_is_no_fault(bench, built):
    file = min((bench.archive / "meetdata_2009").iterdir())
    path = file.relative_to(bench.archive).as_posix()
    tow = built.store.read("listed_tows").filter(samples_path=path)["tow_id"].item()
    lines = file.read_text("utf-8").rstrip("\n").split("\n")

    def signed(cell: str) -> str:
        angle = float(cell.replace(",", "."))
        return f"{angle - 360 if angle > 180 else angle:.3f}".replace(".", ",")

    changed = cells(5, signed, 2, len(lines))(lines)
    assert changed != lines
    file.write_text("\n".join(changed) + "\n", "utf-8")
    assert read_again(bench, DAYS[0]).height == 0
    for name in METHODS:
        METHOD.make(Scope(bench.store, [shipped_method(name)]))
        new, old = (b.store.read("curves", name).filter(tow_id=tow) for b in (bench, built))
        assert new["cw_kg_m"].item() == pytest.approx(old["cw_kg_m"].item(), rel=1e-6)


DAYS = [dt.date(2026, 11, day) for day in (20, 21, 22)]


def test_a_fault_keeps_the_day_on_which_it_was_first_seen(bench):
    archive = Archive(bench.archive, bench)
    for number, day in enumerate(DAYS, 1):
        archive.samples(f"2009-{number:03d}", cells(3, to("abc"), 77, 77))
        seen = read_again(bench, day)
    assert dict(seen.select("tow_id", "first_seen").rows()) == {
        f"2009-{number:03d}": day for number, day in enumerate(DAYS, 1)
    }


def test_the_day_is_known_from_the_database_where_the_lake_lost_it(bench):
    archive = Archive(bench.archive, bench)
    archive.samples("2009-001", cells(3, to("abc"), 77, 77))
    build_database(bench.store.database, {"quarantine": read_again(bench, DAYS[0])})
    bench.store.table_path("quarantine").unlink()
    assert read_again(bench, DAYS[1])["first_seen"].to_list() == DAYS[:1]
    bench.store.table_path("quarantine").unlink()
    bench.store.database.write_bytes(b"damaged too")
    assert read_again(bench, DAYS[2])["first_seen"].to_list() == DAYS[2:]
