"""Whatever is in a file of the archive, it is read as it stands or set aside with a reason."""

import csv
import datetime as dt
import gzip
import io
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import xlsxwriter
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from pipeline.errors import DefectiveInputError
from tests.warehouse.archive.conftest import FIRST, ROWS, TOWS, Archive, small_archive
from warehouse.archive import (
    ArchiveIndex,
    Failure,
    Fault,
    FileHashes,
    SeasonProfile,
    index_archive,
)
from warehouse.archive.files import ArchiveFile
from warehouse.archive.kinds import TOWS as TOW_LIST
from warehouse.archive.lists import read_lists
from warehouse.archive.profile import Profiles
from warehouse.archive.remedies import REMEDIES
from warehouse.archive.rows import Rows
from warehouse.archive.samples import read_samples

PROFILE = SeasonProfile(2014, sample_rate_hz=20)
Lines = list[str]
FEW = settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
WORDS = (
    *("NaN", "inf", "-inf", "1e999", "1.2.3", "1,2,3", "1e5", "0x10", "1_000", "--1", "+"),
    *("7", "0", "-1", "1.5", "1.012", "12:30", "9" * 400, " " * 1000),
    *("\u0661\u0662", "\u2212", "\x00", "\ufeff"),
    *("", ";", ";;;;;;", "\t", ",", "\n", "\r\n", "\r", '"', '""', '"\n"', "'", "=1+1", "#N/A"),
    *("../../etc/passwd", "<script>", "[km/h]", "[", "]", "run", "log1 [m/s]", "a" * 2000),
)  # fmt: skip
"""What people and programs really write wrong."""


@pytest.fixture(scope="module")
def archive(tmp_path_factory: pytest.TempPathFactory) -> Archive:
    return Archive(small_archive(tmp_path_factory.mktemp("small")))


@st.composite
def damaged(draw: st.DrawFn, content: bytes) -> bytes:
    """The content with one to three pieces changed, cut, doubled or replaced by a word."""
    for _ in range(draw(st.integers(1, 3))):
        near_the_begin = st.integers(0, min(len(content), 100))
        begin = draw(st.one_of(near_the_begin, st.integers(0, len(content))))
        end = min(len(content), begin + draw(st.sampled_from([0, 1, 2, 5, 20, 200])))
        piece = draw(
            st.one_of(
                st.just(b""),
                st.binary(min_size=1, max_size=8),
                st.sampled_from(WORDS).map(str.encode),
                st.just(content[begin:end] * 3),
                st.just(b"1" * 200_000),
            )
        )
        content = content[:begin] + piece + content[end:]
    return content


def read_independently(text: str) -> np.ndarray:
    """The numbers of the columns run, log 1, log 2 and force as Python reads them, else NaN."""
    rows = [_split(line.rstrip("\r")) for line in text.rstrip("\r\n").split("\n")]
    width = len(rows[0])
    numbers = [[_number(row[place]) if len(row) == width else np.nan for place in (0, 1, 2, 4)]
               for row in rows[1:]]  # fmt: skip
    return np.array(numbers)


def _split(line: str) -> list[str]:
    csv.field_size_limit(1_000_000)  # damage can be 200,000 digits long, and the limit is less
    try:
        return next(csv.reader([line], delimiter=";", strict=True), [""])
    except csv.Error:
        return [line]


def _number(cell: str) -> float:
    bare = cell.strip(" \t")
    if len(bare) > 1 and bare[0] == bare[-1] == '"':
        bare = bare[1:-1].strip(" \t")
    if not re.fullmatch(r"[+-]?([0-9]+([.,][0-9]*)?|[.,][0-9]+)([eE][+-]?[0-9]+)?", bare, re.ASCII):
        return np.nan
    number = float(bare.replace(",", "."))
    return number if abs(number) <= np.finfo(np.float32).max else np.nan


def assert_is_told(error: DefectiveInputError) -> None:
    assert error.reason_code in REMEDIES
    assert str(error).isprintable()


def some_samples(archive: Archive) -> bytes:
    lines = (archive.root / FIRST).read_text("utf-8").rstrip("\n").split("\n")
    return "\n".join([lines[0], *lines[1::100], ""]).encode()


@FEW
@given(st.data())
def test_damaged_samples_are_refused_or_read_as_they_stand(
    archive: Archive, tmp_path: Path, data: st.DataObject
) -> None:
    whole = some_samples(archive)
    content = data.draw(damaged(whole))
    path = tmp_path / "x.csv"
    path.write_bytes(content)
    try:
        samples, *_ = read_samples(path, PROFILE, None)
    except DefectiveInputError as error:
        assert_is_told(error)
        return
    header = whole.split(b"\n")[0]
    if content.split(b"\n")[0].rstrip(b"\r") != header or not content.isascii():
        return
    expected = read_independently(content.decode())
    assert len(expected) == samples.height
    has_run = np.isfinite(expected[:, 0])
    assert np.array_equal(expected[has_run, 0], samples["run"].to_numpy()[has_run])
    for place, name in ((1, "log1_m_s"), (2, "log2_m_s"), (3, "force_n")):
        found = samples[name].to_numpy()
        there = np.where(has_run, expected[:, place], np.nan).astype(np.float32)
        if b"." in content:  # among decimal commas 1.012 can be a thousand and twelve
            there = np.where(np.isnan(found), np.nan, there)
        assert np.array_equal(there, found, equal_nan=True)


@pytest.mark.parametrize("suffix", [".csv.gz", ".csv.zst", ".parquet"])
@FEW
@given(st.data())
def test_damaged_packed_samples_are_refused_or_read(
    archive: Archive, tmp_path: Path, suffix: str, data: st.DataObject
) -> None:
    path = tmp_path / f"x{suffix}"
    path.write_bytes(data.draw(damaged(packed(some_samples(archive), suffix))))
    try:
        read_samples(path, PROFILE, None)
    except DefectiveInputError as error:
        assert_is_told(error)


def packed(text: bytes, suffix: str) -> bytes:
    if suffix.endswith(".gz"):
        return gzip.compress(text, mtime=0)
    import polars as pl  # noqa: PLC0415
    import pyarrow as pa  # type: ignore[import-untyped]  # noqa: PLC0415

    if suffix.endswith(".zst"):
        return bytes(pa.compress(text, codec="zstd", asbytes=True))
    content = io.BytesIO()
    pl.read_csv(text.replace(b",", b"."), separator=";").write_parquet(content)
    return content.getvalue()


def read_tow_list(path: Path) -> Rows:
    file = ArchiveFile(path.name, path, TOW_LIST, 2014, inside=True)
    return read_lists([file], TOW_LIST, Profiles())


def assert_told(faults: list[Fault]) -> None:
    for fault in faults:
        assert not isinstance(fault, Failure), fault.trace
        assert fault.reason_code in REMEDIES
        assert str(fault.message).isprintable()


@pytest.fixture(scope="module")
def tow_lists(archive: Archive) -> dict[str, bytes]:
    """The tow list as text and as a workbook; made once, as that holds the time of its making."""
    text = (archive.root / TOWS).read_text("utf-8")
    content = io.BytesIO()
    with xlsxwriter.Workbook(content) as book:
        sheet = book.add_worksheet()
        for place, line in enumerate(text.splitlines()):
            sheet.write_row(place, 0, line.split(";"))
    return {".csv": text.encode(), ".xlsx": content.getvalue()}


@pytest.mark.parametrize("suffix", [".csv", ".xlsx"])
@FEW
@given(st.data())
def test_a_damaged_list_is_never_a_crash(
    tow_lists: dict[str, bytes], tmp_path: Path, suffix: str, data: st.DataObject
) -> None:
    path = tmp_path / f"sleeplijst_2014{suffix}"
    path.write_bytes(data.draw(damaged(tow_lists[suffix])))
    assert_told(read_tow_list(path).faults)


@FEW
@given(
    number=st.floats(0.5, 3.9).map(lambda value: round(value, 3)),
    day=st.dates(dt.date(2014, 1, 1), dt.date(2014, 12, 31)),
    written=st.sampled_from(["{:%Y-%m-%d}", "{:%d-%m-%Y}", "{0.day}-{0.month}-{0.year}"]),
    mark=st.sampled_from(",."),
    delimiter=st.sampled_from(";\t|"),
)
def test_numbers_and_dates_of_lists_read_as_they_are_written(
    tmp_path: Path, number: float, day: dt.date, written: str, mark: str, delimiter: str
) -> None:
    header = ["sleep_id", "datum", "fsn_nr", "meetfile", "roeiers", "klasse", "roeisnelheid [m/s]"]
    speed = f"{number:.2f}".replace(".", mark)
    row = ["1", written.format(day), "FSN1", "x", "8", "H", speed]
    path = tmp_path / "sleeplijst_2014.csv"
    path.write_text("\n".join(map(delimiter.join, [header, row])))
    rows = read_tow_list(path)
    assert rows.faults == []
    assert rows.frame["tow_date"].to_list() == [day]
    assert rows.frame["declared_speed_m_s"].to_list() == [float(f"{number:.2f}")]


# Faults of samples that are read without a crash, and must cost something


def change_cells(column: int, first: int, last: int, change: Callable[[str], str]) -> Callable:
    def spoil(lines: Lines) -> Lines:
        rows = [line.split(";") for line in lines]
        for row in rows[first:last]:
            row[column] = change(row[column])
        return [";".join(row) for row in rows]

    return spoil


def minus(cell: str) -> str:
    return f"-{cell.lstrip('-')}"


def times(factor: float) -> Callable[[str], str]:
    return lambda cell: f"{float(cell.replace(',', '.')) * factor:.3f}".replace(".", ",")


@st.composite
def faults_of_samples(draw: st.DrawFn) -> Callable[[Lines], Lines]:
    """A fault that a samples file of six runs really gets."""
    line, run = draw(st.integers(1, 6 * ROWS)), draw(st.integers(0, 5))
    begin = 1 + run * ROWS
    after = begin + 99
    word = draw(st.sampled_from(["abc", "NaN", "", "-", "1,2,3", "1e999", "1 2", "=A1", "1e9"]))
    a_log, a_channel = draw(st.sampled_from([1, 2])), draw(st.integers(1, 6))
    needed = draw(st.sampled_from([1, 4]))
    kinds = {
        "cell": change_cells(a_channel, line, line + 1, lambda _: word),
        "field too many": lambda text: [*text[:line], f"{text[line]};1,0", *text[line + 1 :]],
        "cut off": lambda text: [*text[: line - 60], text[line][:5]],
        "run lost": lambda text: [row for row in text if not row.startswith(f"{run + 1};")],
        "run torn": lambda text: [*text[:begin], *text[after:], *text[begin:after]],
        "run 21": change_cells(0, line, line + 1, lambda _: "21"),
        "dropout": change_cells(a_log, begin + 9, begin + 200, lambda _: "0"),
        "stuck": change_cells(needed, begin, begin + 700, lambda _: "2,4"),
        "negative force": change_cells(4, begin, begin + ROWS, minus),
        "km/h": change_cells(1, 1, 1 + 6 * ROWS, times(3.6)),
    }
    return kinds[draw(st.sampled_from(sorted(kinds)))]


@pytest.fixture(scope="module")
def index(archive: Archive) -> ArchiveIndex:
    return index_archive(archive.root, FileHashes().hash_file)


@settings(max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(spoil=faults_of_samples())
def test_a_fault_of_samples_costs_something(
    archive: Archive, index: ArchiveIndex, spoil: Callable[[Lines], Lines]
) -> None:
    before = (archive.root / FIRST).read_text("utf-8")
    try:
        archive.edit(FIRST, lambda text: "\n".join(spoil(text.rstrip("\n").split("\n"))) + "\n")
        scan = archive.read_first(index)
    finally:
        (archive.root / FIRST).write_text(before, "utf-8", newline="")
    assert scan.faults
