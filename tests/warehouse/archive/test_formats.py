"""One archive in many ways of writing reads to the same tables."""

import gzip
import io
import re
import unicodedata
import zipfile
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from pathlib import Path
from xml.sax.saxutils import escape

import polars as pl
import pyarrow as pa
import pytest
import xlsxwriter
from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter

from pipeline.errors import DefectiveInputError
from tests.warehouse.archive.conftest import BOATS, FIRST, HEADER, ROWS, TOWS, Archive, Scan
from warehouse.archive import SeasonProfile
from warehouse.archive.samples import read_samples

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


def lvm(archive: Archive) -> None:
    """LabVIEW's text: a segment a run, units in a row of their own, decimal comma."""
    parts = ["LabVIEW Measurement\t", "Writer_Version\t2", "Separator\tTab", "Decimal_Separator\t,"]
    parts += ["***End_of_Header***\t", "\t"]
    units = ["m/s", "m/s", "m/s", "N", "m/s", "deg"]
    names = ["log1", "log2", "gps", "kracht", "wind", "wind"]
    lines = samples_text(archive).split("\n")[1:]
    for run in range(1, 7):
        rows = [line.split(";")[1:] for line in lines if line.startswith(f"{run};")]
        parts += ["Channels\t6", "\t".join(["Y_Unit_Label", *units]), "***End_of_Header***\t"]
        parts.append("\t".join(["X_Value", *names, "Comment"]))
        parts += [
            "\t".join([f"{i / 20:.3f}".replace(".", ","), *row]) for i, row in enumerate(rows)
        ]
        parts.append("")
    instead(archive, ".lvm", "\r\n".join(parts).encode("cp1252"))


def tdms(archive: Archive) -> None:
    samples = table(archive)
    (archive.root / FIRST).unlink()
    with TdmsWriter(str(archive.root / (NAME + ".tdms"))) as writer:
        for run in range(1, 7):
            mine = samples.filter(run=run).drop("run")
            channels = [
                ChannelObject(
                    f"Run {run}",
                    _named(name),
                    mine[name].to_numpy(),
                    properties={"unit_string": name.partition("[")[2].rstrip("]")},
                )
                for name in mine.columns
            ]
            writer.write_segment([RootObject(), GroupObject(f"Run {run}"), *channels])


def _named(header: str) -> str:
    """LabVIEW has no two channels of one name."""
    names = {"wind [m/s]": "windsnelheid", "wind [gra]": "windrichting"}
    return names.get(header, header.partition(" ")[0])


def a_file_a_run(archive: Archive) -> None:
    lines = samples_text(archive).split("\n")
    (archive.root / FIRST).unlink()
    header = HEADER.removeprefix("run;")
    for run in range(1, 7):
        rows = [line[2:] for line in lines if line.startswith(f"{run};")]
        (archive.root / f"{NAME} run {run}.csv").write_text("\n".join([header, *rows]))


def clock(text: str) -> str:
    lines = text.rstrip("\n").split("\n")
    rows = [
        f"12:{i // 1200:02}:{i // 20 % 60:02},{i % 20 * 50:03};{line}"
        for i, line in enumerate(lines[1:])
    ]
    return "\n".join(["tijd;" + lines[0], *rows])


SAMPLES: dict[str, Callable[[Archive], None]] = {
    "titles and sep": as_text(lambda t: f"sep=;\nSleepproef van de eerste boot\n\n{t}"),
    "UTF-16": as_text(str, "utf-16", ".txt"),
    "blanks": as_text(
        lambda t: t.replace(HEADER, "run log1 log2 gps kracht windsnelheid windrichting")
        .replace(",", ".").replace(";", "   ")
    ),
    "other words": as_text(
        lambda t: t.replace(HEADER, "Run nr;Log-1 (m/s);LOG 2, m/s;dGPS;Trekkracht (N);"
                                    "Windsnelheid in m/s;Windrichting [°]")
    ),
    "clock": as_text(clock),
    "parquet": lambda a: (table(a).write_parquet(a.root / (NAME + ".parquet")),
                          (a.root / FIRST).unlink()),
    "gz": lambda a: instead(a, ".txt.gz", gzip.compress(samples_text(a).encode())),
    "zst": lambda a: instead(
        a, ".csv.zst", pa.Codec("zstd").compress(samples_text(a).encode(), asbytes=True)
    ),
    "lvm": lvm,
    "tdms": tdms,
    "a file per run": a_file_a_run,
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


def ods(archive: Archive) -> None:
    for path in (TOWS, BOATS):
        rows = "".join(
            "<table:table-row>"
            + "".join(
                '<table:table-cell office:value-type="string"><text:p>'
                f"{escape(cell)}</text:p></table:table-cell>"
                for cell in cells
            )
            + "</table:table-row>"
            for cells in cells_of(archive, path)
        )
        spaces = " ".join(
            f'xmlns:{name}="urn:oasis:names:tc:opendocument:xmlns:{name}:1.0"'
            for name in ("office", "table", "text")
        )
        content = (
            f"<office:document-content {spaces}><office:body><office:spreadsheet>"
            f'<table:table table:name="1">{rows}</table:table>'
            "</office:spreadsheet></office:body></office:document-content>"
        )
        with zipfile.ZipFile(archive.root / path.replace(".csv", ".ods"), "w") as book:
            book.writestr("mimetype", "application/vnd.oasis.opendocument.spreadsheet")
            book.writestr("content.xml", content)
            book.writestr("META-INF/manifest.xml", MANIFEST)
        (archive.root / path).unlink()


MANIFEST = (
    '<manifest:manifest xmlns:manifest="urn:oasis:names:tc:opendocument:xmlns:manifest:1.0">'
    '<manifest:file-entry manifest:full-path="content.xml" manifest:media-type="text/xml"/>'
    "</manifest:manifest>"
)


def in_words(archive: Archive) -> None:
    """As committees write it."""
    for old, new in (
        ("sleep_id;datum;fsn_nr", "Sleep nr;Datum;FSN-nr"),
        ("roeisnelheid [m/s]", "Roeisnelheid (m/s)"), ("bemanning [kg]", "Bemanning, kg"),
        ("2014-03-01;FSN1;", "1.3.2014;FSN 1;"), ("02-03-2014;FSN2;", "02-03-14 14:20;2;"),
        (";8;H;2,40", ";8;Heren;2,40"), (";6;D;2,10", ";6;dames;2,10"),
        (";1400;", ";1400 kg;"), (";8,7;6;", ";8,7 °C;6;"), ("1,2,3,4,5,6", "1-6"),
        ("1,2,3,4,5,6", "alle"), (";5,2;;", ";5,2;n.v.t.;"), (";;ja;", ";;x;"),
    ):  # fmt: skip
        archive.replace(TOWS, old, new)
    archive.edit(TOWS, lambda t: f"sep=;\nSleepproeven 2014\n\n{t}")
    archive.replace(BOATS, "fsn_nr;ht_nr;sloep;type", "FSN nr.;HT-nr;Naam sloep;Sloeptype")
    archive.replace(BOATS, "8,08;2,25", "808 cm;225 cm")


def units_below(archive: Archive) -> None:
    """Names in one row, units in the next, in lists and samples."""
    archive.replace(FIRST, HEADER, "run;log1;log2;gps;kracht;wind;windvaan\n-;m/s;m/s;m/s;N;m/s;°")
    archive.replace(TOWS, "roeisnelheid [m/s]", "roeisnelheid")
    archive.edit(TOWS, lambda t: t.replace("\n", f"\n{';' * 7}m/s{';' * 12}\n", 1))


def a_sheet_a_year(archive: Archive) -> None:
    """One workbook for all years, with a sheet that is about something else."""
    header, *rows = cells_of(archive, TOWS)
    book = xlsxwriter.Workbook(str(archive.root / "sleeplijsten/sleeplijst.xlsx"))
    book.add_worksheet("Toelichting").write(0, 0, "Van de commissie")
    for name, kept in (("a", rows[:2]), ("b", rows[2:])):
        sheet = book.add_worksheet(name)
        sheet.write_row(0, 0, header)
        for place, row in enumerate(kept, start=1):
            sheet.write_row(place, 0, row)
    book.close()
    (archive.root / TOWS).unlink()


def runs_in_a_folder(archive: Archive) -> None:
    """A folder for a tow, in which a file is named after its run alone."""
    header, *lines = (archive.root / FIRST).read_text("utf-8").splitlines()
    folder = archive.root / FIRST.removesuffix(".csv")
    folder.mkdir()
    for run in "123456":
        own = [line for line in lines if line.startswith(run)]
        (folder / f"vaart {run}.csv").write_text("\n".join([header, *own, ""]))
    (archive.root / FIRST).unlink()


def thousands(archive: Archive) -> None:
    """Marks between thousands, where a number can mean nothing else."""
    for old, new in (
        (";1400;1405;", ";1.400,00;1 405;"),
        (";864;870;1140;", ";864,0;870;1.140,0;"),
    ):
        archive.replace(TOWS, old, new)
    archive.replace(BOATS, ";1417;", ";1.417 kg;")


def days_as_numbers(archive: Archive) -> None:
    """Dates in cells that are not set to show dates, and tows numbered a year and a slash."""
    for old, new in (("2014-03-01", "41699"), ("02-03-2014", "41700"), ("2014-03-03", "41701")):
        archive.replace(TOWS, old, new)
    archive.edit(TOWS, lambda text: text.replace("2014-00", "2014/00"))


def a_clock_that_goes_on(archive: Archive) -> None:
    """No column of runs, and a pause between them."""
    path = archive.root / FIRST
    header, *lines = path.read_text("utf-8").splitlines()
    rows = [f"{60 * (i // 1000) + i % 1000 / 20:.2f}{line[1:]}" for i, line in enumerate(lines)]
    path.write_text("\n".join([header.replace("run;", "tijd;", 1), *rows, ""]))


def numbered_labview(archive: Archive) -> None:
    """One segment, a column of runs, and no times."""
    header, *rows = samples_text(archive).split("\n")
    lines = ["LabVIEW Measurement\t", "Separator\tTab", "Decimal_Separator\t,"]
    lines += ["***End_of_Header***", "", "Channels\t7", "***End_of_Header***"]
    lines += ["\t".join(["X_Value", *header.split(";"), "Comment"])]
    lines += ["\t" + row.replace(";", "\t") for row in rows]
    instead(archive, ".lvm", "\n".join(lines).encode())


def as_people_write(archive: Archive) -> None:
    """A month by its name with two digits of the year; a file as the federation's tool shows it."""
    for old, new in (
        ("2014-03-01", "01-mrt-14"), ("02-03-2014", "2 mrt '14"),
        (";derde boot", ";E:\\slepen\\meetdata_2014\\derde boot"), (";8;H;2,40", ";8 heren;H;2,40"),
    ):  # fmt: skip
        archive.replace(TOWS, old, new)


def returns_alone(archive: Archive) -> None:
    """As Excel writes "CSV (Macintosh)"."""
    for path in (BOATS, TOWS, FIRST):
        file = archive.root / path
        file.write_bytes(file.read_bytes().replace(b"\n", b"\r"))


def blank_lines_part_runs(archive: Archive) -> None:
    header, *rows = samples_text(archive).rstrip("\n").split("\n")
    without = [row.split(";", 1)[1] for row in rows]
    runs = ["\n".join(without[i : i + ROWS]) for i in range(0, len(without), ROWS)]
    archive.edit(FIRST, lambda _: header.split(";", 1)[1] + "\n" + "\n;;;;;\n\n".join(runs))


def two_lists_of_boats(archive: Archive) -> None:
    boats = (archive.root / BOATS).read_text().splitlines()
    (archive.root / BOATS).write_text("\n".join(boats[:2]))
    (archive.root / "sloepregister/Sloependata.txt").write_text("\n".join(boats))


def crew_in_one_cell(header: str) -> Callable[[Archive], None]:
    """Rowers and class in one cell, under any of these headers."""
    empty = ";" if ";" in header else ""

    def write(archive: Archive) -> None:
        archive.replace(TOWS, "roeiers;klasse", header)
        in_one = partial(re.sub, r";([0-9]+);([HD]);", rf";\1 \2;{empty}")
        archive.edit(TOWS, in_one)

    return write


def replaced(path: str, old: str, new: str) -> Callable[[Archive], None]:
    return lambda archive: archive.replace(path, old, new)


def run_word(word: str) -> Callable[[Archive], None]:
    return lambda archive: archive.cells(0, lambda cell, _: word + cell, 2, 6 * ROWS + 1)


FORMS = {
    **{
        form.__name__: form
        for form in (
            *(units_below, a_sheet_a_year, runs_in_a_folder, thousands, days_as_numbers),
            *(a_clock_that_goes_on, numbered_labview, as_people_write, returns_alone),
            *(blank_lines_part_runs, two_lists_of_boats),
        )
    },
    **{f"crew under {h}": crew_in_one_cell(h) for h in ("roeiers", "klasse", "roeiers;klasse")},
    **{f"{word}before its number": run_word(word) for word in ("run ", "RUN-")},
    **{
        f"file {name}": replaced(TOWS, "eerste boot 8h 2014", name)
        for name in (" EERSTE  boot 8h 2014 ", "Eerste boot 8h 2014.CSV")
    },
}
"""Archives in forms of their own that are read as they are."""


LISTS = {"xlsx": xlsx, "ods": ods, "words": in_words}
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


def test_a_header_beside_the_file(tmp_path: Path) -> None:
    (tmp_path / "x.txt").write_text("1\t2,0\t1,9\t200\n1\t2,1\t1,9\t210\n")
    header = "run;log1;log2;kracht"
    plain = SeasonProfile(season=2014)
    columns = tuple(c for c in plain.columns if not c.key.startswith("wind"))
    with pytest.raises(DefectiveInputError, match="Not found in the header"):
        read_samples(tmp_path / "x.txt", plain)
    found, _ = read_samples(tmp_path / "x.txt", SeasonProfile(2014, columns, header=header))
    assert found["force_n"].to_list() == [200, 210]
    assert found["wind_speed_m_s"].null_count() == 2


def test_a_damaged_tdms_is_a_fault_wherever_it_was_cut(
    archive: Archive, caplog: pytest.LogCaptureFixture
) -> None:
    """Told once: the library's own warnings would print the file's bytes."""
    tdms(archive)
    (path,) = (archive.root / "meetdata_2014").glob("*.tdms")
    content = path.read_bytes()
    for place in range(1, len(content), len(content) // 40):
        path.write_bytes(content[:place])
        with suppress(DefectiveInputError):
            read_samples(path, SeasonProfile(2014))
    assert caplog.records == []


@pytest.mark.parametrize("limit", ["MOST_ROWS", "SAMPLES_MAX_BYTES"])
def test_a_recording_that_is_larger_or_claims_more_samples_is_not_read(
    archive: Archive, monkeypatch: pytest.MonkeyPatch, limit: str
) -> None:
    tdms(archive)
    (path,) = (archive.root / "meetdata_2014").glob("*.tdms")
    monkeypatch.setattr(f"warehouse.archive.samples.{limit}", 10)
    with pytest.raises(DefectiveInputError) as told:
        read_samples(path, SeasonProfile(2014))
    assert told.value.reason_code == "too_large"
