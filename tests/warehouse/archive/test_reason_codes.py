"""Each thing that goes wrong in a real archive is found, and costs no other tow."""

# ruff: noqa: E501 - one case a line

import gzip
import shutil
from collections.abc import Callable

import polars as pl
import pytest

from tests.warehouse.archive.conftest import (
    BOATS,
    FIRST,
    HEADER,
    ROWS,
    TOWS,
    Archive,
    Scan,
    line_of,
)
from warehouse.archive import read_races

Spoil = Callable[[Archive], object]
ALL = {"2014-001", "2014-002", "2014-003"}
LAST = line_of(6, ROWS - 1)
SECOND = "meetdata_2014/tweede boot 6d 2014.csv"


def constant(column: int, value: str, first: int, last: int) -> Spoil:
    return lambda a: a.cells(column, lambda cell, line: value, first, last)


def scaled(column: int, factor: float, first: int = 2, last: int = LAST) -> Spoil:
    def change(cell: str, line: int) -> str:
        return f"{float(cell.replace(',', '.')) * factor:.3f}".replace(".", ",")

    return lambda a: a.cells(column, change, first, last)


def run_again(run: int, instead_of: int) -> Spoil:
    def change(content: list[str]) -> list[str]:
        rows = content[line_of(run) - 1 : line_of(run, ROWS - 1)]
        again = [f"{instead_of};{row.split(';', 1)[1]}" for row in rows]
        return [
            *content[: line_of(instead_of) - 1], *again, *content[line_of(instead_of, ROWS - 1) :]
        ]  # fmt: skip

    return lines(change)


def several(*spoils: Spoil) -> Spoil:
    def run(a: Archive) -> None:
        for spoil in spoils:
            spoil(a)

    return run


def header(old: str, new: str) -> Spoil:
    return lambda a: a.replace(FIRST, old, new)


def swap_header(one: str, other: str) -> Spoil:
    return lambda a: a.replace(
        FIRST, HEADER, HEADER.replace(one, "@").replace(other, one).replace("@", other)
    )


def text(old: str, new: str, path: str = TOWS) -> Spoil:
    return lambda a: a.replace(path, old, new)


def lines(change: Callable[[list[str]], list[str]], path: str = FIRST) -> Spoil:
    return lambda a: a.edit(path, lambda content: "\n".join(change(content.split("\n"))))


def with_time(step_s: float, set_back: range = range(0)) -> Spoil:
    """A column of time, in some rows 20 s less."""

    def change(content: list[str]) -> list[str]:
        times = [i % ROWS * step_s - 20.0 * (i in set_back) for i in range(len(content) - 2)]
        rows = [f"{row};{t:.4f}" for row, t in zip(content[1:-1], times, strict=True)]
        return [content[0] + ";tijd [s]", *rows, ""]

    return lines(change)


def copy(source: str, target: str) -> Spoil:
    return lambda a: shutil.copy(a.root / source, a.root / target)


def link_outside(a: Archive) -> None:
    outside = a.root.parent / "outside.csv"
    (a.root / FIRST).rename(outside)
    (a.root / FIRST).symlink_to(outside)


def bomb(a: Archive) -> None:
    (a.root / FIRST).unlink()
    (a.root / (FIRST + ".gz")).write_bytes(26 * gzip.compress(bytes(10_000_000)))


# name: (what is spoiled in the samples, code, line)
SAMPLE_CASES: dict[str, tuple[Spoil, str, int | None]] = {
    "run missing": (lines(lambda c: [r for r in c if not r.startswith("4;")]), "missing_run", None),
    "run short": (lines(lambda c: c[: LAST - 10 - 10]), "short_run", line_of(6)),
    "cut in mid-row": (lines(lambda c: [*c[:5500], "6;2,"]), "short_run", line_of(6)),
    "cut in half": (lines(lambda c: [*c[:3000], "3;2,"]), "missing_run", None),
    "too many fields": (lines(lambda c: [*c[:9], c[9] + ";1", *c[10:]]), "broken_row", 10),
    "blank line": (lines(lambda c: [*c[:9], "", *c[9:]]), "broken_row", 10),
    "empty gps": (constant(3, "", 77, 77), "bad_number", 77),
    "log1 drops out": (constant(1, "0,000", line_of(2, 100), line_of(2, 300)), "log_dropout", line_of(2, 100)),
    "gps drops out": (constant(3, "0,00", line_of(3, 60), line_of(3, 79)), "gps_dropout", line_of(3, 60)),
    "km/h": (several(scaled(1, 3.6), scaled(2, 3.6), scaled(3, 3.6)), "speed_unit", 1),
    "speeds twice": (several(scaled(1, 2), scaled(2, 2), scaled(3, 2)), "implausible_speed", line_of(1)),
    "force as log1": (swap_header("log1 [m/s]", "kracht [N]"), "swapped_columns", 1),
    "force spike": (constant(4, "-99999,9", line_of(3, 7), line_of(3, 7)), "implausible_value", line_of(3, 7)),
    "wind too strong": (constant(5, "41", line_of(4, 9), line_of(4, 9)), "implausible_value", line_of(4, 9)),
    "sign of force": (scaled(4, -1), "negative_force", line_of(1)),
    "a negative second": (scaled(4, -1, line_of(2, 40), line_of(2, 59)), "negative_force", line_of(2, 40)),
    "log1 stuck": (constant(1, "2,400", line_of(2, 50), line_of(2, 149)), "stuck_channel", line_of(2, 50)),
    "gps under log2": (swap_header("log2 [m/s]", "gps [m/s]"), "swapped_columns", 1),
    "a run twice": (run_again(2, 3), "samples_listed_twice", line_of(3)),
    "run 21": (constant(0, "21", 500, 500), "unknown_run", 500),
    "run in two pieces": (constant(0, "2", 500, 500), "split_run", 501),
    "time goes back": (with_time(0.05, range(498, 499)), "bad_time", 500),
    "time at another rate": (with_time(0.051), "bad_time", 2),
    "column missing": (header("kracht [N]", "krach [N]"), "missing_column", 1),
    "column twice": (header("log2", "log1"), "duplicate_column", 1),
    "unknown unit": (header("kracht [N]", "kracht [stone]"), "unknown_unit", 1),
    "bare wind": (header("wind [m/s];wind [gra]", "wind;wind"), "unknown_unit", 1),
    "empty file": (lambda a: (a.root / FIRST).write_bytes(b""), "unreadable_file", None),
    "wind 999 in a run": (constant(5, "999", line_of(2), line_of(3) - 1), "implausible_value", line_of(2)),
    "gps and a log jump": (several(scaled(1, 1.2, line_of(2, 200), line_of(2, 219)), scaled(3, 1.2, line_of(2, 200), line_of(2, 219))), "implausible_value", line_of(2, 200)),
    "clock jumps back": (with_time(0.05, range(ROWS + 500, 2 * ROWS)), "bad_time", line_of(2, 500)),
}  # fmt: skip


# name: (what is spoiled, code, path, line)
LIST_CASES: dict[str, tuple[Spoil, str, str, int | None]] = {
    "unpacks to gigabytes": (bomb, "too_large", FIRST + ".gz", None),
    "link outside": (link_outside, "path_outside_archive", TOWS, 2),
    "no file": (lambda a: (a.root / FIRST).unlink(), "samples_missing", TOWS, 2),
    "two files": (copy(FIRST, FIRST.replace("eerste", "Eerste")), "ambiguous_file", TOWS, 2),
    "boat unknown": (text("FSN1;", "FSN9;"), "unknown_boat", TOWS, 2),
    "day set aside": (
        lambda a: (a.root / "archief.toml").write_text('[[set_aside]]\ndate = 2014-03-01\nreason = "storm"\n'),
        "day_set_aside", TOWS, 2,
    ),
    "date of another year": (text("2014-03-01", "2013-03-01"), "date_outside_season", TOWS, 2),
    "no such date": (text("2014-03-01", "2014-02-30"), "bad_list_row", TOWS, 2),
    "length in cm": (text(";8,00;", ";800;"), "bad_list_row", TOWS, 2),
    "length in feet": (text("8,00", "24,9"), "bad_list_row", TOWS, 2),
    "weight of ten boats": (text(";1400;", ";14000;"), "bad_list_row", TOWS, 2),
    "half the rate": (text(";nee;20;", ";nee;10;"), "long_run", FIRST, 2),
    "run b1 without second file": (text("1,2,3,4,5,6", "1,2,3,b4"), "bad_list_row", TOWS, 2),
    "verbouwd": (text("nee", "misschien"), "bad_list_row", TOWS, 2),
    "quote not closed": (text("8,7;6;", '8,7;6;"'), "bad_list_row", TOWS, 2),
}  # fmt: skip


SAID = {
    "length in feet": "'lengte [m]' is 24,9 and the boat list says",
    "weight of ten boats": "14000 and the boat list says 1417",
    "half the rate": "is the rate 20?",
    "gps and a log jump": "column 'gps",
    "clock jumps back": "jump back",
}
"""What only the message of a fault tells."""


def assert_others_unchanged(scan: Scan, good: Scan, lost: set[str]) -> None:
    assert set(scan.good) == ALL - lost
    for tow_id, samples in scan.good.items():
        assert samples.equals(good.good[tow_id])
        of_tow = pl.col("tow_id") == tow_id
        same = pl.exclude("list_line")
        left, right = (s.index.tows.filter(of_tow).select(same) for s in (scan, good))
        assert left.equals(right)
        assert scan.index.runs.filter(of_tow).equals(good.index.runs.filter(of_tow))


def test_good_archive_has_no_faults(good_scan: Scan) -> None:
    assert good_scan.faults == []
    assert set(good_scan.good) == ALL


SECONDS, RUN, CELL = "seconds", "run", "cell"
COSTS = {
    **dict.fromkeys(["length in cm", "weight of ten boats"], CELL),
    **dict.fromkeys(
        [
            *("run missing", "cut in mid-row", "log1 drops out", "log1 stuck", "a run twice"),
            *("wind 999 in a run", "time goes back", "clock jumps back"),
        ],
        RUN,
    ),
    **dict.fromkeys(
        [
            *("run short", "too many fields", "blank line", "empty gps", "gps drops out"),
            *("force spike", "wind too strong", "a negative second"),
            *("half the rate", "gps and a log jump"),
        ],
        SECONDS,
    ),
}
"""What a fault costs that does not cost the tow."""


def assert_told(scan: Scan, case: str, code: str, path: str, line: int | None) -> None:
    """The first tow has this one fault, and loses what it costs."""
    (fault,) = scan.faults
    assert (fault.reason_code, fault.path, fault.line) == (code, path, line), fault
    assert fault.tow_id == "2014-001"
    assert fault.message.endswith(".")
    assert SAID.get(case, "") in fault.message
    assert fault.lost == COSTS.get(case), fault
    assert ("2014-001" in scan.good) == (fault.lost is not None)


@pytest.mark.parametrize("case", SAMPLE_CASES)
def test_a_fault_of_samples(archive: Archive, good_scan: Scan, case: str) -> None:
    spoil, code, line = SAMPLE_CASES[case]
    spoil(archive)
    assert_told(archive.read_first(good_scan.index), case, code, FIRST, line)


@pytest.mark.parametrize("case", LIST_CASES)
def test_a_fault_of_a_list_or_a_file(archive: Archive, good_scan: Scan, case: str) -> None:
    spoil, code, path, line = LIST_CASES[case]
    spoil(archive)
    scan = archive.scan()
    assert_told(scan, case, code, path, line)
    scan.good.pop("2014-001", None)
    assert_others_unchanged(scan, good_scan, {"2014-001"})


def second_row(**changes: str) -> Callable[[list[str]], list[str]]:
    """Append a row like the first with some of its text replaced."""

    def change(content: list[str]) -> list[str]:
        row = content[1]
        for old, new in changes.items():
            row = row.replace(old.removeprefix("_").replace("_", "-"), new, 1)
        return [*content[:-1], row, ""]

    return change


# name: (what is spoiled, the faults as (code, path, tow, line), the tows lost)
MANY_CASES: dict[str, tuple[Spoil, list[tuple[str, str, str | None, int | None]], set[str]]] = {
    "file without row": (
        copy(FIRST, "meetdata_2014/vreemd.csv"),
        [("samples_not_listed", "meetdata_2014/vreemd.csv", None, None)], set(),
    ),
    "path up": (
        text("eerste boot 8h", "../meetdata_2013/eerste boot 8h"),
        [("path_outside_archive", TOWS, "2014-001", 2), ("samples_not_listed", FIRST, None, None)],
        {"2014-001"},
    ),
    "equal rows": (
        lines(second_row(), TOWS), [], set(),
    ),
    "one id, different rows": (
        lines(second_row(FSN1="FSN2"), TOWS),
        [("duplicate_tow_id", TOWS, "2014-001", 2), ("duplicate_tow_id", TOWS, "2014-001", 5)],
        {"2014-001"},
    ),
    "file listed twice": (
        lines(second_row(_2014_001="2014-009"), TOWS),
        [("duplicate_tow", TOWS, "2014-009", 5)], set(),
    ),
    "copied file": (
        several(
            copy(FIRST, "meetdata_2014/kopie.csv"),
            lines(lambda c: [*c[:-1], c[1].replace("2014-001", "2014-009").replace("eerste boot 8h 2014", "kopie"), ""], TOWS),
        ),
        [("duplicate_tow", TOWS, "2014-009", 5)], set(),
    ),
    "file of two boats": (
        text("tweede boot 6d 2014", "eerste boot 8h 2014"),
        [
            ("samples_not_listed", SECOND, None, None),
            ("samples_listed_twice", TOWS, "2014-001", 2),
            ("samples_listed_twice", TOWS, "2014-002", 3),
        ],
        {"2014-001", "2014-002"},
    ),
    "second file of another boat": (
        text("tweede boot 6d 2014;", "tweede boot 6d 2014;eerste boot 8h 2014"),
        [
            ("samples_listed_twice", TOWS, "2014-001", 2),
            ("samples_listed_twice", TOWS, "2014-002", 3),
        ],
        {"2014-001", "2014-002"},
    ),
    "boat row defective": (
        text("8,08", "acht", BOATS),
        [("bad_boat_row", TOWS, "2014-001", 2), ("bad_boat_row", BOATS, None, 2)], {"2014-001"},
    ),
    "boat twice": (
        lambda a: a.edit(BOATS, lambda t: t + "FSN1;0001;eerste boot;;8,18;2,25;0,90;1417;8;H\n"),
        [("duplicate_boat", TOWS, "2014-001", 2), ("duplicate_boat", BOATS, None, 5)],
        {"2014-001"},
    ),
    "tow list unreadable": (
        lambda a: (a.root / TOWS).write_bytes(b"\x00\x01"),
        [("unreadable_file", TOWS, None, None)], ALL,
    ),
    "tow list without boats": (
        text("fsn_nr", "lege doft"), [("missing_column", TOWS, None, 1)], ALL,
    ),
    "header lost": (
        text("gebruik runs", ""), [("unknown_column", TOWS, None, 1)], ALL,
    ),
    "settings for what no list has": (
        lambda a: (a.root / "archief.toml").write_text(
            '[[set_aside]]\ndate = 2014-03-30\nreason = "x"\n'
            '[[profile]]\nseasons = "1999:2001"\n[[plan]]\ntows = ["2014-999"]\n'
        ),
        [("idle_setting", "archief.toml", None, None)] * 3, set(),
    ),
    "copy of a list": (
        copy(TOWS, "sleeplijsten/sleeplijst_2014 (2).csv"),
        [("unrecognised_file", "sleeplijsten/sleeplijst_2014 (2).csv", None, None)], set(),
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", MANY_CASES)
def test_faults_between_rows_boats_and_files(archive: Archive, good_scan: Scan, case: str) -> None:
    spoil, expected, lost = MANY_CASES[case]
    spoil(archive)
    scan = archive.scan()
    found = [(f.reason_code, f.path, f.tow_id, f.line) for f in scan.faults]
    assert sorted(found, key=repr) == sorted(expected, key=repr)
    assert_others_unchanged(scan, good_scan, lost)


@pytest.mark.parametrize("number", ["1e999", "1_000", "1.000,5", ""])
def test_no_numbers_from_garbage(archive: Archive, good_scan: Scan, number: str) -> None:
    archive.cells(4, lambda cell, line: number, 77, 77)
    faults = archive.read_first(good_scan.index).faults
    assert [(f.reason_code, f.line) for f in faults] == [("bad_number", 77)]


def test_a_fault_in_a_run_that_is_not_used_does_no_harm(archive: Archive) -> None:
    archive.cells(1, lambda cell, line: "0", line_of(1), line_of(1, 200))
    archive.replace(TOWS, "1,2,3,4,5,6", "6 5 4 3 2")
    assert archive.scan().faults == []


def test_an_unreadable_list_costs_only_its_own_season(archive: Archive) -> None:
    (archive.root / "sleeplijsten/sleeplijst_2015.csv").write_bytes(b"\xff\x00")
    (archive.root / "meetdata_2015").mkdir()
    shutil.copy(archive.root / FIRST, archive.root / "meetdata_2015/x.csv")
    scan = archive.scan()
    assert [f.reason_code for f in scan.faults] == ["unreadable_file"]
    assert set(scan.good) == ALL


@pytest.mark.parametrize(("again", "kept"), [("2:10:25", 2), ("2:10:26", 1)])
def test_a_result_that_is_listed_twice_counts_once_or_not_at_all(
    archive: Archive, again: str, kept: int
) -> None:
    rows = ["FSN1;8;H;2:10:25", "FSN2;6;D;2:20:00", f"FSN1;8;H;{again}"]
    (archive.root / "wedstrijden/tocht_2014.csv").write_text(
        "wedstrijd;datum;afstand [km];fsn_nr;roeiers;klasse;roeitijd\n"
        + "".join(f"Tocht;2014-06-01;18,4;{row}\n" for row in rows)
    )
    results, faults = read_races(archive.root)
    assert results.height == kept
    places = {(fault.reason_code, fault.line) for fault in faults}
    assert places == (set() if kept == 2 else {("bad_race_row", 2), ("bad_race_row", 4)})
