"""Registers as they were published, and race results: what the recomputed history is held against.

Both are optional in an archive. Computing with them belongs elsewhere.
"""

import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Final

import polars as pl

from herijk.pipeline.errors import DefectiveInputError
from herijk.warehouse.archive.boats import ROWERS
from herijk.warehouse.archive.faults import Fault, fault_from
from herijk.warehouse.archive.files import (
    LIST_MAX_BYTES,
    RACES_PATTERN,
    REGISTER_PATTERN,
    ArchiveFile,
    list_files,
    path_inside,
    read_bytes,
)
from herijk.warehouse.archive.lists import ListRow, read_list
from herijk.warehouse.archive.messages import say
from herijk.warehouse.archive.profile import read_profiles
from herijk.warehouse.archive.text import Column, shorten
from herijk.warehouse.archive.tows import SPEED_M_S

NEVER_TOWED_CW: Final = (0.995, 1.005)
"""Published Cw of boats without a valid tow: 1, as printed in two decimals. No hull comes near."""

REGISTER_COLUMNS: Final = (
    Column("fsn_no", "fsn_nr"),
    Column("rowers", "roeiers"),
    Column("crew_class", "klasse"),
    Column("a_kg_m", "A"),
    Column("b_m_s", "B", "speed", "m/s"),
    Column("cw_kg_m", "Cw"),
    Column("declared_speed_m_s", "roeisnelheid", "speed", "m/s"),
    Column("tow_date", "sleepdatum"),
)
REGISTER_SCHEMA: Final[dict[str, pl.DataType]] = {
    "season": pl.Int32(),
    "fsn_no": pl.String(),
    "rowers": pl.Int32(),
    "crew_class": pl.String(),
    "has_valid_curve": pl.Boolean(),
    "a_kg_m": pl.Float64(),
    "b_m_s": pl.Float64(),
    "cw_kg_m": pl.Float64(),
    "declared_speed_m_s": pl.Float64(),
    "tow_date": pl.Date(),
    "path": pl.String(),
    "line": pl.Int32(),
}
RACE_COLUMNS: Final = (
    Column("race", "wedstrijd"),
    Column("race_date", "datum"),
    Column("distance_m", "afstand", "length", "km"),
    Column("fsn_no", "fsn_nr"),
    Column("rowers", "roeiers"),
    Column("crew_class", "klasse"),
    Column("rowing_time_s", "roeitijd"),
    Column("stream_m", "stroom", "length", "km", required=False),
    Column("penalty_w", "straf", "power", "W", required=False),
)
RACE_SCHEMA: Final[dict[str, pl.DataType]] = {
    "season": pl.Int32(),
    "race": pl.String(),
    "race_date": pl.Date(),
    "distance_m": pl.Float64(),
    "fsn_no": pl.String(),
    "rowers": pl.Int32(),
    "crew_class": pl.String(),
    "rowing_time_s": pl.Float64(),
    "stream_m": pl.Float64(),
    "penalty_w": pl.Float64(),
    "path": pl.String(),
    "line": pl.Int32(),
}
_ROWING_TIME: Final = re.compile(r"([0-9]{1,2}):([0-5][0-9]):([0-5][0-9])(?:[.,]0*)?")

_ReadRow = Callable[[ListRow, int], dict[str, Any]]


def read_published_registers(root: Path) -> tuple[pl.DataFrame, tuple[Fault, ...]]:
    """Read every `sloepregister/sloepregister_<jaar>.csv`.

    Returns:
        One row a line of a register (`REGISTER_SCHEMA`), and the lines that cannot be read. A boat
        without a valid curve (published as Cw = 1) has `has_valid_curve` false and no A, B and Cw.
    """
    files = list_files(root, "sloepregister", REGISTER_PATTERN)
    rows, faults = _read_all(root, files, REGISTER_COLUMNS, "bad_register_row", _register_line)
    return pl.DataFrame(rows, schema=REGISTER_SCHEMA), faults


def read_races(root: Path) -> tuple[pl.DataFrame, tuple[Fault, ...]]:
    """Read every `wedstrijden/<naam>_<jaar>.csv`.

    Returns:
        One row a result (`RACE_SCHEMA`; distances in m, times in s, penalties in W), and the lines
        that cannot be read.
    """
    files = list_files(root, "wedstrijden", RACES_PATTERN)
    rows, faults = _read_all(root, files, RACE_COLUMNS, "bad_race_row", _race_result)
    return pl.DataFrame(rows, schema=RACE_SCHEMA), faults


def _read_all(
    root: Path,
    files: Sequence[ArchiveFile],
    columns: Sequence[Column],
    reason_code: str,
    read_row: _ReadRow,
) -> tuple[list[dict[str, Any]], tuple[Fault, ...]]:
    wording = read_profiles(root).wording
    good: list[dict[str, Any]] = []
    faults: list[Fault] = []
    for file in files:
        try:
            data = read_bytes(path_inside(root, file.path), LIST_MAX_BYTES)
            rows = read_list(data, columns, reason_code, file.path, wording)
        except DefectiveInputError as error:
            faults.append(fault_from(error, file.path))
            continue
        for row in rows:
            try:
                row.check_whole()
                values = read_row(row, file.season)
            except DefectiveInputError as error:
                faults.append(fault_from(error, file.path))
            else:
                good.append({**values, "path": file.path, "line": row.line})
    return good, tuple(faults)


def _register_line(row: ListRow, season: int) -> dict[str, Any]:
    cw = row.number("cw_kg_m", 0.9, 1000)
    valid = not NEVER_TOWED_CW[0] <= cw <= NEVER_TOWED_CW[1]
    return {
        "season": season,
        "fsn_no": row.boat("fsn_no"),
        "rowers": row.integer("rowers", *ROWERS),
        "crew_class": row.crew_class("crew_class"),
        "has_valid_curve": valid,
        "a_kg_m": row.number("a_kg_m", 0, 1000) if valid else None,
        "b_m_s": row.number("b_m_s", 0.1, 1000) if valid else None,
        "cw_kg_m": cw if valid else None,
        "declared_speed_m_s": row.optional_number("declared_speed_m_s", *SPEED_M_S),
        "tow_date": row.optional_date("tow_date"),
    }


def _race_result(row: ListRow, season: int) -> dict[str, Any]:
    day = row.date("race_date")
    if day.year != season:
        message = "the date {day} is not in {season}, the year of the file."
        raise row.fault(say(message, day=day, season=season))
    return {
        "season": season,
        "race": row.text("race"),
        "race_date": day,
        "distance_m": row.number("distance_m", 100, 500_000),
        "fsn_no": row.boat("fsn_no"),
        "rowers": row.integer("rowers", *ROWERS),
        "crew_class": row.crew_class("crew_class"),
        "rowing_time_s": _rowing_time(row),
        "stream_m": row.optional_number("stream_m", -500_000, 500_000),
        "penalty_w": row.optional_number("penalty_w", -1000, 1000),
    }


def _rowing_time(row: ListRow) -> float:
    cell = row.text("rowing_time_s")
    match = _ROWING_TIME.fullmatch(cell)
    if match is None:
        message = "'roeitijd' is '{cell}', not a time such as 2:10:25."
        raise row.fault(say(message, cell=shorten(cell)))
    seconds = int(match[1]) * 3600 + int(match[2]) * 60 + int(match[3])
    if seconds == 0:
        raise row.fault(say("'roeitijd' is 0."))
    return float(seconds)
