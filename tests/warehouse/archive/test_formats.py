"""One archive in many ways of writing reads to the same tables."""

import gzip
import unicodedata
from collections.abc import Callable

import polars as pl
import pyarrow as pa
import pytest
import xlsxwriter

from tests.warehouse.archive.conftest import BOATS, FIRST, TOWS, Archive, Scan

SECOND = "meetdata_2014/tweede boot 6d 2014.csv"
THIRD = "meetdata_2014/derde boot 12h 2014.csv"


def write_instead(archive: Archive, path: str, suffix: str, data: bytes) -> None:
    (archive.root / path).unlink()
    (archive.root / path.replace(".csv", suffix)).write_bytes(data)


def samples_in_other_text(archive: Archive) -> None:
    """Titles above the header, another encoding, and a name in decomposed letters."""
    archive.edit(FIRST, lambda text: f"sep=;\nSleepproef van de eerste boot\n\n{text}")
    text = (archive.root / SECOND).read_text("utf-8")
    write_instead(archive, SECOND, ".txt", text.encode("utf-16"))
    archive.replace(TOWS, "derde boot", "dërde boot")
    named = unicodedata.normalize("NFD", THIRD.replace("derde", "dërde"))
    (archive.root / THIRD).rename(archive.root / named)


def packed_samples(archive: Archive) -> None:
    first = (archive.root / FIRST).read_bytes()
    second = (archive.root / SECOND).read_bytes()
    third = (archive.root / THIRD).read_bytes()
    write_instead(archive, FIRST, ".txt.gz", gzip.compress(first))
    write_instead(archive, SECOND, ".csv.zst", pa.Codec("zstd").compress(second, asbytes=True))
    numbers = pl.read_csv(third.replace(b",", b"."), separator=";", infer_schema_length=None)
    (archive.root / THIRD).unlink()
    numbers.write_parquet(archive.root / THIRD.replace(".csv", ".parquet"))


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


def names_of_files(archive: Archive) -> None:
    """What the list says of them may differ in capitals, blanks and suffix."""
    archive.replace(TOWS, "eerste boot 8h 2014", " EERSTE  boot 8h 2014 ")
    archive.replace(TOWS, "derde boot 12h 2014", "Derde boot 12h 2014.CSV")


WAYS = (samples_in_other_text, packed_samples, xlsx, two_lists_of_boats, names_of_files)
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
    archive: Archive, good_scan: Scan, way: Callable[[Archive], None]
) -> None:
    way(archive)
    assert_same(archive.scan(), good_scan)
