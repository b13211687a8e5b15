"""Layouts that `archief.toml` declares: each reads to the same samples, or is asked about."""

import re
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import polars as pl
import pytest
from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter

from tests.warehouse.archive.conftest import FIRST, HEADER, RATE_HZ, ROWS, TOWS, Archive, Scan
from warehouse.archive.check import CheckReport, check_archive

NAME = FIRST.removesuffix(".csv")
CHANNELS = ("log1", "log2", "gps", "kracht", "wind", "windrichting")
UNITS = ("m/s", "m/s", "m/s", "N", "m/s", "deg")
OF_2014 = '[[profile]]\nseasons = "2014"\n'


def declare(archive: Archive, *lines: str) -> None:
    (archive.root / "archief.toml").write_text("\n".join(lines) + "\n")


def rows_of(archive: Archive) -> list[list[str]]:
    """The cells of the first tow's samples, without the header."""
    text = (archive.root / FIRST).read_text("utf-8").rstrip("\n")
    return [line.split(";") for line in text.split("\n")[1:]]


def numbers_of(archive: Archive) -> np.ndarray:
    return np.array([[float(cell.replace(",", ".")) for cell in row] for row in rows_of(archive)])


def write(archive: Archive, header: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    text = "\n".join(";".join(row) for row in [header, *rows])
    (archive.root / FIRST).write_text(text + "\n", "utf-8")


def assert_first_tow_is(scan: Scan, good: Scan, tolerance: float = 0.0) -> None:
    assert scan.faults == []
    found, expected = scan.good["2014-001"], good.good["2014-001"]
    assert found["run"].equals(expected["run"])
    for name in expected.columns[1:]:
        difference = (found[name] - expected[name]).abs().max()
        assert difference <= tolerance, name


def only_cause(archive: Archive) -> tuple[str, str, list[str]]:
    (cause,) = check_archive(archive.root).causes
    return cause.reason_code, cause.sentence, [line.split("\n")[-1] for line in cause.ask]


# Units


@pytest.mark.parametrize(
    ("header", "column", "factor"),
    [
        ("kracht [daN]", 4, 0.1),
        ("kracht [kN]", 4, 0.001),
        ("kracht [lbf]", 4, 1 / 4.4482216152605),
        ("kracht [kgf]", 4, 1 / 9.80665),
        ("log1 [mm/s]", 1, 1000),
        ("log1 [km/h]", 1, 3.6),
        ("log1 [kn]", 1, 3600 / 1852),
        ("log1 [ m/s ]", 1, 1),
    ],
)
def test_a_unit_in_brackets_is_converted(
    archive: Archive, good_scan: Scan, header: str, column: int, factor: float
) -> None:
    rows = rows_of(archive)
    for row in rows:
        row[column] = f"{float(row[column].replace(',', '.')) * factor:.9f}".replace(".", ",")
    names = HEADER.split(";")
    names[column] = header
    write(archive, names, rows)
    assert_first_tow_is(archive.read_first(good_scan.index), good_scan, 1e-4)


def test_a_suffix_of_a_name_is_no_unit(archive: Archive) -> None:
    archive.replace(FIRST, "log1 [m/s]", "log1_ms")
    code, sentence, ask = only_cause(archive)
    assert (code, ask[0]) == ("missing_column", 'columns.log1 = "?"')
    assert "'log1_ms'" in sentence


def test_every_unknown_unit_is_asked_at_once_and_the_answer_holds(
    archive: Archive, good_scan: Scan
) -> None:
    for path in sorted((archive.root / "meetdata_2014").glob("*.csv")):
        name = path.relative_to(archive.root).as_posix()
        archive.replace(name, "kracht [N]", "kracht [Newton]")
        archive.replace(name, "log2 [m/s]", "log2 [meters/second]")
    code, _, ask = only_cause(archive)
    assert code == "unknown_unit"
    assert sorted(ask) == ['units.force = "?"', 'units.log2 = "?"']
    declare(archive, OF_2014, 'units = { force = "N", log2 = "m/s" }')
    assert_first_tow_is(archive.scan(), good_scan)


def test_a_blank_that_nobody_filled_in_is_named(archive: Archive) -> None:
    from pipeline.errors import MissingKnowledgeError  # noqa: PLC0415

    declare(archive, OF_2014, 'units.force = "?"')
    with pytest.raises(MissingKnowledgeError, match=r"profile\.units\.force"):
        archive.scan()


# Slower channels, rates and times


def with_slow_gps(archive: Archive, every: int = RATE_HZ) -> None:
    rows = rows_of(archive)
    for place, row in enumerate(rows):
        if place % every:
            row[3] = ""
    write(archive, HEADER.split(";"), rows)


def test_a_slower_channel_is_asked_about_and_held(archive: Archive, good_scan: Scan) -> None:
    with_slow_gps(archive)
    code, sentence, ask = only_cause(archive)
    assert (code, ask) == ("slow_channel", ['hold = ["?"]'])
    assert "'gps [m/s]' is empty in 95 % of the rows" in sentence
    declare(archive, OF_2014, 'hold = ["gps"]')
    assert_first_tow_is(archive.read_first(good_scan.index), good_scan)


def test_a_receiver_that_fails_is_not_held_for_ever(archive: Archive, good_scan: Scan) -> None:
    with_slow_gps(archive)
    archive.cells(3, lambda *_: "", 2 + 200, 2 + 600)
    declare(archive, OF_2014, 'hold = ["gps"]')
    scan = archive.read_first(good_scan.index)
    assert [(f.reason_code, f.run, f.lost) for f in scan.faults] == [("bad_number", 1, "seconds")]
    gps = scan.good["2014-001"].filter(run=1)["gps_m_s"]
    assert gps.is_nan().any()


def test_a_few_empty_cells_cost_their_seconds(archive: Archive, good_scan: Scan) -> None:
    archive.cells(3, lambda *_: "", 100, 103)
    (fault,) = archive.read_first(good_scan.index).faults
    assert (fault.reason_code, fault.lost, fault.line) == ("bad_number", "seconds", 100)


def times_of(step_s: float) -> list[float]:
    return [place % ROWS * step_s for place in range(6 * ROWS)]


def with_times(archive: Archive, name: str, times: Sequence[str]) -> None:
    rows = [[time, *row] for time, row in zip(times, rows_of(archive), strict=True)]
    write(archive, [name, *HEADER.split(";")], rows)


CLOCKS = {
    "clock": lambda t: f"{10 + int(t // 3600)}:{int(t // 60 % 60):02}:{t % 60:06.3f}",
    "clock with a comma": lambda t: f"10:{int(t // 60):02}:{t % 60:06.3f}".replace(".", ","),
    "clock with PM": lambda t: f"01:{int(t // 60):02}:{t % 60:09.6f} PM",
    "clock of a timestamp": lambda t: f"2014-03-01 10:{int(t // 60):02}:{t % 60:05.2f}",
}
WRITTEN: dict[str, tuple[str, Callable[[float], str]]] = {
    "s": ("tijd [s]", lambda t: f"{t:.2f}".replace(".", ",")),
    "ms": ("tijd [ms]", lambda t: f"{t * 1000:.0f}"),
    "days": ("tijd [days]", lambda t: f"{41_699 + t / 86_400:.9f}".replace(".", ",")),
    "epoch": ("tijd [epoch_ms]", lambda t: f"{1_393_668_000_000 + t * 1000:.0f}"),
    **{name: ("tijd [clock]", clock) for name, clock in CLOCKS.items()},
}


@pytest.mark.parametrize("written", WRITTEN)
def test_a_time_is_read_in_the_unit_that_it_declares(
    archive: Archive, good_scan: Scan, written: str
) -> None:
    name, write_time = WRITTEN[written]
    with_times(archive, name, [write_time(t) for t in times_of(1 / RATE_HZ)])
    assert_first_tow_is(archive.read_first(good_scan.index), good_scan)


@pytest.mark.parametrize("written", WRITTEN)
def test_times_at_another_rate_are_told(archive: Archive, good_scan: Scan, written: str) -> None:
    name, write_time = WRITTEN[written]
    with_times(archive, name, [write_time(t) for t in times_of(1.1 / RATE_HZ)])
    (fault,) = archive.read_first(good_scan.index).faults
    assert fault.reason_code == "bad_time"
    assert "18.18" in fault.message


def test_a_time_that_is_no_number_is_asked_about_with_its_line(archive: Archive) -> None:
    with_times(archive, "tijd", [CLOCKS["clock with PM"](t) for t in times_of(1 / RATE_HZ)])
    (cause,) = check_archive(archive.root).causes
    assert (cause.reason_code, cause.places[0].line) == ("bad_time", 2)
    assert cause.ask[0].endswith('units.time = "?"')
    declare(archive, OF_2014, 'units.time = "clock"')
    assert check_archive(archive.root).causes == []


def test_a_few_times_that_cannot_be_read_cost_their_rows(archive: Archive, good_scan: Scan) -> None:
    times = [CLOCKS["clock"](t) for t in times_of(1 / RATE_HZ)]
    times[40:43] = ["ochtend"] * 3
    with_times(archive, "tijd [clock]", times)
    (fault,) = archive.read_first(good_scan.index).faults
    assert (fault.reason_code, fault.lost, fault.line) == ("broken_row", "seconds", 42)


def test_a_clock_may_pass_midnight(archive: Archive, good_scan: Scan) -> None:
    def around_midnight(t: float) -> str:
        seconds = (86_380 + t) % 86_400
        return f"{int(seconds // 3600)}:{int(seconds // 60 % 60):02}:{seconds % 60:06.3f}"

    with_times(archive, "tijd [clock]", [around_midnight(t) for t in times_of(1 / RATE_HZ)])
    assert_first_tow_is(archive.read_first(good_scan.index), good_scan)


def test_a_rate_that_is_not_whole(archive: Archive) -> None:
    with_times(archive, "tijd [s]", [f"{t:.4f}" for t in times_of(0.0512)])
    archive.replace(TOWS, ";nee;20;\n2014-002", ";nee;19,53125;\n2014-002")
    scan = archive.scan()
    assert scan.faults == []
    assert scan.index.tows["sample_rate_hz"].to_list() == [19.53125, 20, 20]


def test_a_clock_that_jumps_back_costs_its_run(archive: Archive, good_scan: Scan) -> None:
    """Where that run is not used, it costs nothing."""
    seconds = times_of(1 / RATE_HZ)
    first = 2 * ROWS + 100
    back = [t - 3600 if row >= first else t for row, t in enumerate(seconds)]
    with_times(archive, "tijd [s]", [f"{t:.3f}" for t in back])
    scan = archive.scan()
    (fault,) = scan.faults
    assert (fault.reason_code, fault.lost, fault.run) == ("bad_time", "run", 3)
    assert fault.line == 2 + first
    assert "jump back by 3599.95 s" in fault.message
    assert scan.good["2014-001"]["run"].unique().to_list() == [1, 2, 4, 5, 6]
    archive.replace(TOWS, "1,2,3,4,5,6", "1,2,4,5,6")
    assert archive.scan().faults == []
    archive.replace(TOWS, "1,2,4,5,6", "1,2,3,4,5,6")
    declare(archive, OF_2014, 'absent = ["time"]')
    assert_first_tow_is(archive.scan(), good_scan)


@pytest.mark.parametrize(
    "write_time",
    [
        lambda t: f"01-03-2014 {CLOCKS['clock'](t)}",
        lambda t: f"2014-03-01T{CLOCKS['clock'](t)}Z",
        lambda t: f"3/1/2014 {CLOCKS['clock'](t)}",
    ],
)
def test_a_date_before_a_clock_is_not_read(archive: Archive, good_scan: Scan, write_time) -> None:
    with_times(archive, "tijd [clock]", [write_time(t) for t in times_of(1 / RATE_HZ)])
    assert_first_tow_is(archive.read_first(good_scan.index), good_scan)


def test_a_time_in_no_known_form_can_be_left_out(archive: Archive, good_scan: Scan) -> None:
    with_times(archive, "tijd", [f"{t / 60:.0f}m{t % 60:.2f}" for t in times_of(1 / RATE_HZ)])
    (cause,) = check_archive(archive.root).causes
    assert cause.ask[-1].endswith('absent = ["?"]')
    declare(archive, OF_2014, 'absent = ["time"]')
    assert_first_tow_is(archive.read_first(good_scan.index), good_scan)


def test_times_in_another_unit_are_asked_about(archive: Archive, good_scan: Scan) -> None:
    with_times(archive, "tijd", [f"{t * 1000:.0f}" for t in times_of(1 / RATE_HZ)])
    code, _, ask = only_cause(archive)
    assert code == "bad_time"
    assert 'units.time = "?"' in ask
    declare(archive, OF_2014, 'units.time = "ms"')
    assert_first_tow_is(archive.read_first(good_scan.index), good_scan)


def test_quoted_fields_with_decimal_commas(archive: Archive, good_scan: Scan) -> None:
    archive.edit(FIRST, lambda text: re.sub(r"[^;\n]+", r'"\g<0>"', text).replace(";", ","))
    assert_first_tow_is(archive.read_first(good_scan.index), good_scan)


def test_commas_between_fields_and_before_decimals_are_refused(
    archive: Archive, good_scan: Scan
) -> None:
    archive.edit(FIRST, lambda text: text.replace(";", ","))
    (fault,) = archive.read_first(good_scan.index).faults
    assert (fault.reason_code, fault.line) == ("broken_row", 2)
    assert "13 fields where the header has 7" in fault.message


def test_runs_that_are_words_are_refused_with_what_stands_there(
    archive: Archive, good_scan: Scan
) -> None:
    archive.edit(FIRST, lambda text: re.sub(r"\n(\d)", r"\nrun \1", text))
    (fault,) = archive.read_first(good_scan.index).faults
    assert (fault.reason_code, fault.line) == ("unknown_run", 2)
    assert "holds 'run 1'" in fault.message


def test_answers_may_stay_in_quotation_marks(archive: Archive, good_scan: Scan) -> None:
    """A question shows a blank in quotation marks."""
    for path in (archive.root / "meetdata_2014").iterdir():
        units = "\n;m/s;m/s;m/s;N;m/s;gra\n"
        archive.edit(f"meetdata_2014/{path.name}", lambda text: text.replace("\n", units, 1))  # noqa: B023
    archive.edit(TOWS, lambda text: text.replace(";20;", ";;"))
    answers = ['skip_below_header = "1"', 'sample_rate_hz = "20"']
    targets = "[[plan]]\nseasons = '2014'\ntargets = ['0.9', '1', '1.1', '0.9', '1', '1.1']"
    declare(archive, OF_2014, *answers, targets)
    scan = archive.scan()
    assert scan.faults == []
    assert scan.good["2014-001"].equals(good_scan.good["2014-001"])


def test_a_rate_in_kilohertz(archive: Archive, good_scan: Scan) -> None:
    archive.edit(TOWS, lambda text: text.replace("[Hz]", "[kHz]").replace(";20;", ";0,02;"))
    scan = archive.scan()
    assert scan.faults == []
    assert scan.index.tows["sample_rate_hz"].to_list() == [20, 20, 20]


def test_an_ambiguous_number_says_how_to_write_it(archive: Archive) -> None:
    archive.replace(TOWS, ";nee;20;", ";nee;20.125;")
    code, sentence, _ = only_cause(archive)
    assert code == "ambiguous_number"
    assert "Write it without a mark, or with a ','." in sentence


# Runs


def test_files_that_can_be_runs_are_asked_about(archive: Archive, good_scan: Scan) -> None:
    write_run_files(archive, NAME + "_run0{run}.csv")
    _, sentence, ask = only_cause_of_code(archive, "samples_missing")
    assert "6 with that in their name" in sentence
    assert [line.split("\n")[-1] for line in ask] == ['runs = "?"', 'run_files = "?"']
    declare(archive, OF_2014, 'runs = "file"', 'run_files = "{meetfile}_run{run:02}"')
    scan = archive.scan()
    assert scan.good["2014-001"].equals(good_scan.good["2014-001"])


def test_a_file_for_each_run(archive: Archive, good_scan: Scan) -> None:
    write_run_files(archive, NAME + " run {run}.csv")
    code, _, _ = only_cause_of_code(archive, "samples_missing")
    assert code == "samples_missing"
    declare(archive, OF_2014, 'runs = "file"')
    for other in ("tweede boot 6d 2014", "derde boot 12h 2014"):
        path = archive.root / f"meetdata_2014/{other}.csv"
        path.unlink()
    scan = archive.scan()
    assert scan.good["2014-001"].equals(good_scan.good["2014-001"])
    assert {fault.tow_id for fault in scan.faults} == {"2014-002", "2014-003"}


def only_cause_of_code(archive: Archive, code: str) -> tuple[str, str, list[str]]:
    causes = [cause for cause in check_archive(archive.root).causes if cause.reason_code == code]
    (cause,) = causes
    return cause.reason_code, cause.sentence, cause.ask


def write_run_files(archive: Archive, pattern: str) -> None:
    rows = rows_of(archive)
    (archive.root / FIRST).unlink()
    for run in range(1, 7):
        own = [";".join(row[1:]) for row in rows if row[0] == str(run)]
        text = "\n".join([HEADER.removeprefix("run;"), *own, ""])
        (archive.root / pattern.replace("{run}", str(run))).write_text(text)


def test_the_list_may_name_a_file_for_each_run(archive: Archive, good_scan: Scan) -> None:
    write_run_files(archive, "meetdata_2014/snol {run} van 6.csv")
    archive.replace(TOWS, ";eerste boot 8h 2014;", ";snol {run} van 6;")
    assert_first_tow_is(archive.scan(), good_scan)
    (archive.root / "meetdata_2014/snol 4 van 6.csv").unlink()
    (fault,) = archive.scan().faults
    assert (fault.reason_code, fault.run, fault.lost) == ("missing_run", 4, "run")


def test_a_fault_in_the_file_of_a_run_names_it(archive: Archive) -> None:
    write_run_files(archive, "meetdata_2014/snol {run}.csv")
    archive.replace(TOWS, ";eerste boot 8h 2014;", ";snol {run};")
    archive.edit("meetdata_2014/snol 3.csv", lambda text: text.replace("\n2,", "\nmist 2,", 1))
    (fault,) = archive.scan().faults
    assert (fault.path, fault.line) == ("meetdata_2014/snol 3.csv", 2)
    assert (fault.run, fault.reason_code) == (3, "bad_number")


def test_a_file_that_says_another_run_than_its_name_is_refused(archive: Archive) -> None:
    write_run_files(archive, "meetdata_2014/snol {run}.csv")
    archive.replace(TOWS, ";eerste boot 8h 2014;", ";snol {run};")
    two = (archive.root / "meetdata_2014/snol 2.csv").read_text().rstrip("\n").split("\n")
    numbered = [f"run;{two[0]}", *(f"3;{row}" for row in two[1:])]
    (archive.root / "meetdata_2014/snol 2.csv").write_text("\n".join(numbered) + "\n")
    (fault,) = archive.scan().faults
    assert (fault.reason_code, fault.path) == ("unknown_run", "meetdata_2014/snol 2.csv")


def as_recording(archive: Archive, pause: int = 300, form: str = ":.0f") -> str:
    """One recording with a pause before each run; returns the list of its windows."""
    rows = [row[1:] for row in rows_of(archive)]
    between = [["0,5", "0,5", "0,5", "3", "4", "90"]] * pause
    recording, windows = [], ["sleep_id;run;van [s];tot [s];reden"]
    for run in range(1, 7):
        recording += between
        start = len(recording) / RATE_HZ
        recording += rows[(run - 1) * ROWS : run * ROWS]
        window = f"{{{form}}};{{{form}}}".format(start, start + 50)
        windows.append(f"2014-001;{run};{window};vaart")
    write(archive, HEADER.removeprefix("run;").split(";"), recording)
    return "\n".join([*windows, ""])


def test_one_recording_with_begin_and_end_of_each_run(archive: Archive, good_scan: Scan) -> None:
    windows = as_recording(archive)
    for other in ("tweede boot 6d 2014", "derde boot 12h 2014"):
        (archive.root / f"meetdata_2014/{other}.csv").unlink()
    _, sentence, ask = only_cause_of_code(archive, "missing_column")
    assert "list vensters" in sentence
    assert any('runs = "?"' in line for line in ask)
    declare(archive, OF_2014, 'runs = "windows"')
    (fault,) = [f for f in archive.scan().faults if f.tow_id == "2014-001"]
    assert (fault.reason_code, "vensters_2014.csv" in fault.message) == ("missing_run", True)
    (archive.root / "sleeplijsten/vensters_2014.csv").write_text(windows)
    scan = archive.scan()
    assert scan.good["2014-001"].equals(good_scan.good["2014-001"])
    assert scan.index.windows.is_empty()


def write_windows(archive: Archive, windows: str) -> None:
    declare(archive, OF_2014, 'runs = "windows"')
    (archive.root / "sleeplijsten/vensters_2014.csv").write_text(windows)


@pytest.mark.parametrize("pause", [8_000, 30], ids=["of half an hour", "with halves of seconds"])
def test_windows_of_a_recording(archive: Archive, good_scan: Scan, pause: int) -> None:
    """A recording may be long, its windows may have decimals, and they need no reason."""
    windows = as_recording(archive, pause, ":.1f")
    rows = [line.rsplit(";", 1)[0] for line in windows.strip().split("\n")]
    write_windows(archive, "\n".join([*rows, ""]))
    scan = archive.scan()
    assert scan.good["2014-001"].equals(good_scan.good["2014-001"])


def test_windows_that_nobody_gives_are_missed_in_each_tow(archive: Archive) -> None:
    write_windows(archive, as_recording(archive))
    faults = [fault for fault in archive.scan().faults if fault.reason_code == "missing_run"]
    assert {fault.tow_id for fault in faults} == {"2014-002", "2014-003"}


def test_a_recording_may_pass_midnight(archive: Archive, good_scan: Scan) -> None:
    windows = as_recording(archive)
    add_clock(archive, 86_300.0)
    write_windows(archive, windows)
    scan = archive.scan()
    assert scan.good["2014-001"].equals(good_scan.good["2014-001"])


def test_a_recording_whose_clock_jumps_back_is_refused(archive: Archive, good_scan: Scan) -> None:
    windows = as_recording(archive)
    add_clock(archive, 40_000.0, jump_at=2_000)
    write_windows(archive, windows)
    (fault,) = [fault for fault in archive.scan().faults if fault.tow_id == "2014-001"]
    assert (fault.reason_code, fault.line) == ("bad_time", 2_002)
    assert fault.ask[0].endswith('absent = ["?"]')
    declare(archive, OF_2014, 'runs = "windows"', 'absent = ["time"]')
    assert archive.scan().good["2014-001"].equals(good_scan.good["2014-001"])


def add_clock(archive: Archive, start_s: float, jump_at: int | None = None) -> None:
    """Add a column with the time of day to the first file."""
    header, *rows = (archive.root / FIRST).read_text("utf-8").strip().split("\n")
    times = [start_s + row / RATE_HZ for row in range(len(rows))]
    if jump_at is not None:
        times[jump_at:] = [time - 3600 for time in times[jump_at:]]
    clocks = [divmod(time % 86_400, 60) for time in times]
    written = [f"{int(minute // 60)}:{int(minute % 60):02}:{s:06.3f}" for minute, s in clocks]
    lines = [f"{row};{time}" for row, time in zip(rows, written, strict=True)]
    (archive.root / FIRST).write_text("\n".join([f"{header};tijd [clock]", *lines, ""]))


def test_a_window_in_a_run_is_in_whole_seconds_and_has_a_reason(archive: Archive) -> None:
    rows = ["sleep_id;run;van [s];tot [s];reden", "2014-001;1;0,5;45;zwaan", "2014-001;2;0;45;", ""]
    (archive.root / "sleeplijsten/vensters_2014.csv").write_text("\n".join(rows))
    scan = archive.scan()
    assert [(fault.reason_code, fault.line) for fault in scan.faults] == [
        ("bad_window_row", 2),
        ("bad_window_row", 3),
    ]
    assert scan.index.windows.is_empty()


def test_runs_of_a_recording_that_overlap_are_set_aside(archive: Archive) -> None:
    windows = as_recording(archive).replace(";2;80;130;", ";2;60;130;")
    declare(archive, OF_2014, 'runs = "windows"')
    (archive.root / "sleeplijsten/vensters_2014.csv").write_text(windows)
    faults = [f for f in archive.scan().faults if f.path.endswith("vensters_2014.csv")]
    assert [(f.reason_code, f.line) for f in faults] == [
        ("bad_window_row", 2),
        ("bad_window_row", 3),
    ]


# TDMS


def write_tdms(
    archive: Archive,
    groups: Sequence[str],
    slow: int = 1,
    properties: dict[str, float] | None = None,
) -> None:
    numbers = numbers_of(archive)
    (archive.root / FIRST).unlink()
    with TdmsWriter(str(archive.root / (NAME + ".tdms"))) as writer:
        for run, group in enumerate(groups, start=1):
            own = numbers[numbers[:, 0] == run]
            channels = []
            for place, (name, unit) in enumerate(zip(CHANNELS, UNITS, strict=True), start=1):
                step = slow if name == "gps" else 1
                told = {"unit_string": unit}
                if properties is not None:
                    told |= {"wf_increment": step / RATE_HZ}
                values = own[::step, place]
                channels.append(ChannelObject(group, name, values, properties=told))
            writer.write_segment([RootObject(), GroupObject(group), *channels])


DEFAULT_GROUPS = ["Untitled", *(f"Untitled {number}" for number in range(1, 6))]


@pytest.mark.parametrize("groups", [DEFAULT_GROUPS, [f"Run {run}" for run in range(1, 7)]])
def test_groups_of_a_tdms_are_runs_in_their_order(
    archive: Archive, good_scan: Scan, groups: list[str]
) -> None:
    write_tdms(archive, groups)
    assert_first_tow_is(archive.scan(), good_scan)


def test_groups_in_another_order_than_their_numbers_are_asked_about(
    archive: Archive, good_scan: Scan
) -> None:
    groups = ["Run 2", "Run 1", "Run 3", "Run 4", "Run 5", "Run 6"]
    write_tdms(archive, groups)
    code, sentence, ask = only_cause(archive)
    assert (code, ask) == ("unknown_run", ['groups = ["?"]'])
    assert "'Run 2', 'Run 1'" in sentence
    declare(archive, OF_2014, f"groups = {groups}".replace("'", '"'))
    assert_first_tow_is(archive.scan(), good_scan)


def test_a_slower_channel_of_a_tdms_is_held_where_its_increment_says_so(
    archive: Archive, good_scan: Scan
) -> None:
    write_tdms(archive, DEFAULT_GROUPS, slow=RATE_HZ, properties={})
    assert_first_tow_is(archive.scan(), good_scan)


def test_a_shorter_channel_of_a_tdms_is_asked_about(archive: Archive, good_scan: Scan) -> None:
    write_tdms(archive, DEFAULT_GROUPS, slow=RATE_HZ)
    code, sentence, ask = only_cause(archive)
    assert (code, ask) == ("slow_channel", ['hold = ["?"]'])
    assert "channel 'gps [m/s]' has 50 samples and 'log1 [m/s]' 1000" in sentence
    declare(archive, OF_2014, 'hold = ["gps"]')
    assert_first_tow_is(archive.scan(), good_scan)


def test_a_damaged_tdms_is_a_fault_wherever_it_was_cut(
    archive: Archive, caplog: pytest.LogCaptureFixture
) -> None:
    write_tdms(archive, DEFAULT_GROUPS)
    path = archive.root / (NAME + ".tdms")
    index, content = archive.scan().index, path.read_bytes()
    for place in range(1, len(content), len(content) // 12):
        path.write_bytes(content[:place])
        assert {fault.tow_id for fault in archive.read_first(index).faults} == {"2014-001"}


# What is refused, with what to do


@pytest.mark.parametrize("suffix", [".lvm", ".txt", ".csv"])
def test_labview_text_is_refused_with_what_to_do(archive: Archive, suffix: str) -> None:
    (archive.root / FIRST).unlink()
    (archive.root / (NAME + suffix)).write_text("LabVIEW Measurement\t\nWriter_Version\t2\n")
    code, sentence, _ = only_cause(archive)
    assert code == "labview_text"
    assert "docs/archive.md" in sentence


def test_lines_below_the_header_are_asked_about(archive: Archive, good_scan: Scan) -> None:
    archive.replace(FIRST, HEADER, f"{HEADER}\n-;m/s;m/s;m/s;N;m/s;deg\n;Avg;Avg;Smp;Smp;Smp;Smp")
    code, sentence, ask = only_cause(archive)
    assert (code, ask) == ("broken_row", ['skip_below_header = "?"'])
    assert "up to line 3" in sentence
    declare(archive, OF_2014, "skip_below_header = 2")
    scan = archive.read_first(good_scan.index)
    assert scan.good["2014-001"].equals(good_scan.good["2014-001"])


def test_a_column_that_may_be_the_gps_is_asked_about(archive: Archive, good_scan: Scan) -> None:
    archive.replace(FIRST, "gps [m/s]", "SOG")
    code, sentence, ask = only_cause(archive)
    assert (code, ask) == ("unknown_column", ['columns.gps = "?"'])
    assert "'SOG' can be it" in sentence
    declare(archive, OF_2014, 'columns.gps = "SOG"')
    assert_first_tow_is(archive.read_first(good_scan.index), good_scan)


# Words and names that are asked about


def asked(report: CheckReport) -> list[str]:
    return [line for cause in report.causes for line in cause.ask]


def test_words_and_headers_are_asked_by_name_and_the_answers_hold(
    archive: Archive, good_scan: Scan
) -> None:
    archive.edit(TOWS, lambda text: text.replace(";H;", ";Hrn;").replace(";D;", ";Dms;"))
    assert asked(check_archive(archive.root)) == [
        '[words]\n"Hrn" = "?"',
        '[words]\n"Dms" = "?"',
    ]
    archive.replace(TOWS, "bemanning [kg]", "Ploeggewicht [kg]")
    assert asked(check_archive(archive.root)) == ['[headers]\n"Ploeggewicht [kg]" = "?"']
    answers = ['[words]\nHrn = "H"\nDms = "D"', '[headers]\n"Ploeggewicht [kg]" = "bemanning [kg]"']
    declare(archive, *answers)
    scan = archive.scan()
    assert scan.faults == []
    columns = [c for c in good_scan.index.tows.columns if not c.endswith(("path", "sha256"))]
    assert scan.index.tows.select(columns).equals(good_scan.index.tows.select(columns))


def test_a_unit_of_a_list_is_asked_by_its_header(archive: Archive, good_scan: Scan) -> None:
    archive.replace(TOWS, "roeisnelheid [m/s]", "roeisnelheid [meters/sec]")
    assert asked(check_archive(archive.root)) == ['[headers]\n"roeisnelheid [meters/sec]" = "?"']
    declare(archive, '[headers]\n"roeisnelheid [meters/sec]" = "roeisnelheid [m/s]"')
    assert (
        archive.scan()
        .index.tows["declared_speed_m_s"]
        .equals(good_scan.index.tows["declared_speed_m_s"])
    )


def test_boats_may_be_listed_by_their_exact_name(archive: Archive, good_scan: Scan) -> None:
    archive.replace(TOWS, ";FSN1;", ";Eerste Boot;")
    archive.replace(TOWS, ";FSN2;", ";tweede sloep;")
    scan = archive.scan()
    assert scan.index.tows["fsn_no"].to_list() == ["FSN1", "FSN3"]
    (fault,) = scan.faults
    assert (fault.reason_code, fault.tow_id) == ("unknown_boat", "2014-002")


def test_a_word_for_not_finished_is_declared_once(archive: Archive) -> None:
    from warehouse.archive import read_races  # noqa: PLC0415

    rows = ["FSN1;8;H;2:10:25", "FSN2;6;D;DNF", "FSN3;12;H;dnf"]
    (archive.root / "wedstrijden/tocht_2014.csv").write_text(
        "wedstrijd;datum;afstand [km];fsn_nr;roeiers;klasse;roeitijd\n"
        + "\n".join(f"Tocht;1-6-2014;18,4;{row}" for row in rows)
    )
    _, faults = read_races(archive.root)
    assert [fault.line for fault in faults] == [3, 4]
    assert faults[0].ask == ('[words]\n"DNF" = "?"',)
    declare(archive, '[words]\nDNF = "uitgevallen"')
    races, faults = read_races(archive.root)
    assert (races.height, faults) == (1, [])


def test_one_bad_optional_list_costs_nothing_else(archive: Archive, good_scan: Scan) -> None:
    for name in ("vensters", "lampjes", "krachtijkingen"):
        path = archive.root / f"sleeplijsten/{name}_2014.csv"
        path.write_bytes(bytes(range(256)))
    (archive.root / "wedstrijden/tocht_2014.xlsx").write_bytes(b"PK\x03\x04")
    scan = archive.scan()
    assert {fault.reason_code for fault in scan.faults} == {"unreadable_file"}
    assert scan.good.keys() == good_scan.good.keys()


def test_causes_come_by_what_they_cost(archive: Archive) -> None:
    archive.edit(TOWS, lambda text: text.replace("2014-03-01", "2014-02-31"))
    (archive.root / "meetdata_2014/a.csv").write_text("x")
    (archive.root / "meetdata_2014/b.csv").write_text("x")
    report = check_archive(archive.root)
    assert [(cause.reason_code, cause.tows, cause.number) for cause in report.causes] == [
        ("bad_list_row", 1, 1),
        ("samples_not_listed", 0, 2),
    ]


def test_samples_of_a_tdms_frame_have_the_declared_types(archive: Archive) -> None:
    write_tdms(archive, DEFAULT_GROUPS)
    samples = archive.scan().good["2014-001"]
    assert samples["run"].dtype == pl.Int8
    assert Path(archive.root / (NAME + ".tdms")).exists()


def test_the_conversion_of_labview_text_that_is_documented_works(
    archive: Archive, good_scan: Scan
) -> None:
    page = (Path(__file__).parents[3] / "docs/archive.md").read_text("utf-8")
    (code,) = re.findall(r"```text\n(import csv.*?)```", page, re.DOTALL)
    names = ["X_Value", *CHANNELS, "Comment"]
    lines = ["LabVIEW Measurement\t", "***End_of_Header***"]
    for run in range(1, 7):
        lines += ["Channels\t6", "***End_of_Header***", "\t".join(names)]
        own = [row[1:] for row in rows_of(archive) if row[0] == str(run)]
        lines += ["\t".join(["0,1", *row, ""]) for row in own]
        lines.append("")
    source = archive.root.parent / "x.lvm"
    source.write_text("\n".join(lines), "cp1252")
    scope: dict[str, Callable[[Path, Path], None]] = {}
    exec(code, scope)  # noqa: S102 - as it is printed
    scope["convert_lvm"](source, archive.root / FIRST)
    assert_first_tow_is(archive.read_first(good_scan.index), good_scan)


def test_a_file_of_any_name_costs_no_tow(archive: Archive, good_scan: Scan) -> None:
    for name in (
        "sleeplijsten/sleeplijst_0000.csv",
        "sleeplijsten/vensters_9999.csv",
        "meetdata_2014/run 99999999999999999999.csv",
        "meetdata_2014/{run} {} %s.csv",
        "meetdata_2014/\u0661\u0662.csv",
        "wedstrijden/_2014.csv",
        "sloepregister/sloepregister_2014.xlsx",
    ):
        (archive.root / name).write_text("sleep_id;datum\n1;2\n")
    assert archive.scan().good.keys() == good_scan.good.keys()
    assert check_archive(archive.root).tows == 3
