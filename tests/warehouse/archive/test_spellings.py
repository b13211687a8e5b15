"""Every allowed spelling of a samples file reads to the same frame."""

from collections.abc import Callable
from pathlib import Path

import polars as pl
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pipeline.channels import SAMPLE_SCHEMA
from tests.warehouse.archive.conftest import HEADER
from warehouse.archive import SeasonProfile
from warehouse.archive import sample_files as text_files
from warehouse.archive.samples import read_samples

PROFILE = SeasonProfile(season=2014)
ROWS = [
    "1;2,000;1,950;2,10;200,5;3,25;350,0",
    "1;2,100;1,960;2,10;-12,5;3,5;-10,0",
    "3;2,2;1,97;2,2;2e2;0;0",
    "2;2,3;1,98;2,3;+210;0,5;360",
]
PLAIN = "\n".join([HEADER, *ROWS, ""])
EXPECTED = pl.DataFrame(
    {
        "run": [1, 1, 3, 2],
        "log1_m_s": [2.0, 2.1, 2.2, 2.3],
        "log2_m_s": [1.95, 1.96, 1.97, 1.98],
        "gps_m_s": [2.1, 2.1, 2.2, 2.3],
        "force_n": [200.5, -12.5, 200.0, 210.0],
        "wind_speed_m_s": [3.25, 3.5, 0.0, 0.5],
        "wind_angle_deg": [350.0, 350.0, 0.0, 0.0],
    },
    schema=SAMPLE_SCHEMA,
)


def point(text: str) -> str:
    return text.replace(",", ".")


def extra_columns(text: str) -> str:
    lines = text.rstrip("\n").split("\n")
    return "\n".join([f"druk [Pa];{lines[0]};", *(f"één;{line};" for line in lines[1:])])


def loud_header(text: str) -> str:
    return text.replace(HEADER, HEADER.upper().replace("[", "  [ "))


def reversed_columns(text: str) -> str:
    return "\n".join(";".join(reversed(line.split(";"))) for line in text.split("\n"))


SPELLINGS: dict[str, Callable[[str], bytes]] = {
    "plain": str.encode,
    "BOM": lambda t: t.encode("utf-8-sig"),
    "Windows-1252": lambda t: extra_columns(t).encode("cp1252"),
    "extra columns": lambda t: extra_columns(t).encode(),
    "CRLF": lambda t: t.replace("\n", "\r\n").encode(),
    "blank lines at the end": lambda t: (t + "\n\r\n").encode(),
    "tab": lambda t: t.replace(";", "\t").encode(),
    "comma and point": lambda t: point(t).replace(";", ",").encode(),
    "header case and blanks": lambda t: loud_header(t).encode(),
    "one bare wind": lambda t: t.replace("wind [m/s]", "wind").encode(),
    "other order": lambda t: reversed_columns(t).encode(),
}  # fmt: skip


@pytest.mark.parametrize("spelling", SPELLINGS)
def test_spelling_reads_to_the_same_frame(tmp_path: Path, spelling: str) -> None:
    path = tmp_path / "x.csv"
    path.write_bytes(SPELLINGS[spelling](PLAIN))
    assert read_samples(path, PROFILE)[0].equals(EXPECTED)


@pytest.mark.parametrize(
    ("header", "unit", "column", "factor"),
    [
        ("log1 [m/s]", "km/h", "log1_m_s", 1 / 3.6),
        ("log1 [m/s]", "kn", "log1_m_s", 1852 / 3600),
        ("kracht [N]", "kgf", "force_n", 9.80665),
    ],
)
def test_units_are_converted(
    tmp_path: Path, header: str, unit: str, column: str, factor: float
) -> None:
    path = tmp_path / "x.csv"
    path.write_text(PLAIN.replace(header, f"{header.partition(' ')[0]} [{unit}]"))
    expected = (EXPECTED[column].cast(pl.Float64()) * factor).to_list()
    assert read_samples(path, PROFILE)[0][column].to_list() == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("gps", ["absent", "empty"])
def test_gps_may_be_absent_throughout(tmp_path: Path, gps: str) -> None:
    columns = [0, 1, 2, 4, 5, 6]
    path = tmp_path / "x.csv"
    split = [line.split(";") for line in [HEADER, *ROWS]]
    if gps == "absent":
        split = [[line[index] for index in columns] for line in split]
    else:
        split[1:] = [[*line[:3], "", *line[4:]] for line in split[1:]]
    path.write_text("\n".join(";".join(line) for line in split))
    samples, *_ = read_samples(path, PROFILE)
    assert samples["gps_m_s"].null_count() == len(ROWS)
    assert samples.drop("gps_m_s").equals(EXPECTED.drop("gps_m_s"))


CELLS = st.sampled_from(
    ["1", "2,5", "2.5", " 3", "3 ", "5,", ",5", "1e3", "1e999", "nan", "", "-", "a", '"2"', "1e39"]
)


@settings(max_examples=75)
@given(st.lists(st.lists(CELLS, min_size=6, max_size=8), min_size=1, max_size=4))
def test_fast_reading_gives_what_careful_reading_gives(
    tmp_path_factory: pytest.TempPathFactory, rows: list[list[str]]
) -> None:
    body = "\n".join(";".join(["1", *row[1:]]) for row in rows).encode()
    header = text_files._find_header(HEADER, PROFILE)
    fast = text_files._read_fast(body, header, frozenset())
    if fast is not None:
        careful = text_files._read_cells(body, header, 2).fill_null(float("nan"))
        assert fast.select(sorted(fast.columns)).equals(careful.select(sorted(fast.columns)))
