"""Reading speeds with forces or coefficients from a table that anybody made, for `herijk fit`."""

from pathlib import Path
from typing import Final

import polars as pl

from pipeline.errors import DefectiveInputError
from pipeline.messages import say
from pipeline.tables import column
from pipeline.tables.declare import dy
from warehouse.archive.sheets.reading import read_rows
from warehouse.archive.sheets.row import ListRow
from warehouse.archive.spelling.columns import Column
from warehouse.archive.spelling.headers import split_header, unit_behind
from warehouse.archive.spelling.text import decode, find_delimiter, split_line

KNOWN: Final = {
    "speed": ("snelheid", "speed", "v"),
    "force": ("kracht", "force", "weerstand", "resistance", "drag", "f"),
    "cw": ("cw",),
}
LARGEST: Final = 1e9
"""A speed, force or coefficient above it is a slip of the keyboard."""


class _Points(dy.Schema):
    """A table that anybody made."""

    speed = column.number("m/s", "speed", min=0, max=LARGEST)
    force = column.number("N", "force", min=0, max=LARGEST)
    cw = column.number("kg/m", "force / speed squared", min=0, max=LARGEST)


def read_points(path: Path, speed: str | None, force: str | None) -> pl.DataFrame:
    """The points of a text table with a header, in SI units.

    Args:
        path: the file, with fields and numbers as in the archive's lists.
        speed, force: names of the columns; without, the usual ones are found.

    Returns:
        `line`, `speed_m_s` and `cw_kg_m`; the latter is force / speed^2 where forces are given.

    Raises:
        DefectiveInputError: the file or a row cannot be read; the message has the line.
    """
    data = path.read_bytes()
    header = decode(data).split("\n", 1)[0]
    names = [split_header(cell)[0] for cell in split_line(header, find_delimiter(header))]
    speed_column = _column("speed", speed or _first(names, "speed", header), "m/s")
    if force is None and any(name in names for name in KNOWN["cw"]):
        other = Column("cw", KNOWN["cw"][0])
    else:
        other = _column("force", force or _first(names, "force", header), "N")
    rows = read_rows(data, (speed_column, other), "bad_point", _Points)
    return pl.DataFrame(
        [_point(row, other.key) for row in rows],
        schema={"line": pl.Int64, "speed_m_s": pl.Float64, "cw_kg_m": pl.Float64},
    )


def _column(key: str, name: str, unit: str) -> Column:
    return Column(key, split_header(name)[0], key, unit_behind(name, key) or unit)


def _first(names: list[str], key: str, header: str) -> str:
    """The first usual name that a header has."""
    for name in KNOWN[key]:
        if name in names:
            return name
    raise DefectiveInputError(
        "missing_column",
        say(
            "no column for {} in the header {!r}; name it with {}", key, header.strip(), f"--{key}"
        ),
    )


def _point(row: ListRow, key: str) -> dict[str, float]:
    row.check_whole()
    speed = row.number("speed")
    value = row.number(key)
    if not speed or not value:
        raise row.fault(say("a speed and a force must be above zero."))
    cw = value / speed**2 if key == "force" else value
    return {"line": row.line, "speed_m_s": speed, "cw_kg_m": cw}
