"""One archive in many ways of writing reads to the same tables."""

import gzip
import io
import unicodedata
from collections.abc import Callable

import polars as pl
import pyarrow as pa
import pytest
import xlsxwriter

from tests.warehouse.archive.conftest import BOATS, FIRST, TOWS, Archive, Scan

NAME = FIRST.removesuffix(".csv")


def samples_text(archive: Archive) -> str:
    return (archive.root / FIRST).read_text("utf-8")


def table(archive: Archive) -> pl.DataFrame:
    """The samples of the first tow as numbers."""
    text = samples_text(archive).replace(",", ".")
    return pl.read_csv(io.StringIO(text), separator=";", infer_schema_length=None)


def instead(archive: Archive, suffix: str, data: bytes) -> None:
    (archive.root / FIRST).unlink()
    (archive.root / (NAME + suffix)).write_bytes(data)


def as_text(change: Callable[[str], str], encoding: str = "utf-8", suffix: str = ".csv"):
    def write(archive: Archive) -> None:
        instead(archive, suffix, change(samples_text(archive)).encode(encoding))

    return write


SAMPLES: dict[str, Callable[[Archive], None]] = {
    "titles and sep": as_text(lambda t: f"sep=;\nSleepproef van de eerste boot\n\n{t}"),
    "UTF-16": as_text(str, "utf-16", ".txt"),
    "parquet": lambda a: (table(a).write_parquet(a.root / (NAME + ".parquet")),
                          (a.root / FIRST).unlink()),
    "gz": lambda a: instead(a, ".txt.gz", gzip.compress(samples_text(a).encode())),
    "zst": lambda a: instead(
        a, ".csv.zst", pa.Codec("zstd").compress(samples_text(a).encode(), asbytes=True)
    ),
    "decomposed name": lambda a: (a.root / FIRST).rename(
        a.root / unicodedata.normalize("NFD", FIRST)
    ),
}  # fmt: skip


def cells_of(archive: Archive, path: str) -> list[list[str]]:
    text = (archive.root / path).read_text("utf-8")
    return [line.split(";") for line in text.rstrip("\n").split("\n")]


def _typed(cell: str) -> str | float:
    try:
        return float(cell.replace(",", "."))
    except ValueError:
        return cell


def xlsx(archive: Archive) -> None:
    for path in (TOWS, BOATS):
        book = xlsxwriter.Workbook(str(archive.root / path.replace(".csv", ".xlsx")))
        sheet = book.add_worksheet("2014")
        sheet.write_string(0, 0, "Lijst van de commissie")
        for row, cells in enumerate(cells_of(archive, path), start=2):
            for column, cell in enumerate(cells):
                is_text = cell.startswith("0") or column == 0
                sheet.write(row, column, cell if is_text else _typed(cell.removeprefix("FSN")))
        book.close()
        (archive.root / path).unlink()


def two_lists_of_boats(archive: Archive) -> None:
    boats = (archive.root / BOATS).read_text().splitlines()
    (archive.root / BOATS).write_text("\n".join(boats[:2]))
    (archive.root / "sloepregister/Sloependata.txt").write_text("\n".join(boats))


def replaced(path: str, old: str, new: str) -> Callable[[Archive], None]:
    return lambda archive: archive.replace(path, old, new)


FORMS = {
    "two lists of boats": two_lists_of_boats,
    **{
        f"file {name}": replaced(TOWS, "eerste boot 8h 2014", name)
        for name in (" EERSTE  boot 8h 2014 ", "Eerste boot 8h 2014.CSV")
    },
}
"""Archives in forms of their own that are read as they are."""


LISTS = {"xlsx": xlsx}
WAYS = SAMPLES | LISTS | FORMS
PLACES = ["samples_path", "samples_sha256", "list_path", "list_line"]


def assert_same(scan: Scan, good: Scan) -> None:
    assert scan.faults == []
    assert scan.index.boats.sort("fsn_no").equals(good.index.boats)
    assert scan.index.tows.drop(PLACES).equals(good.index.tows.drop(PLACES))
    assert scan.index.runs.equals(good.index.runs)
    assert scan.good.keys() == good.good.keys()
    for tow_id, samples in good.good.items():
        assert scan.good[tow_id].equals(samples), tow_id


@pytest.mark.parametrize("way", WAYS)
def test_one_archive_in_many_ways_gives_equal_tables(
    archive: Archive, good_scan: Scan, way: str
) -> None:
    WAYS[way](archive)
    assert_same(archive.scan(), good_scan)
