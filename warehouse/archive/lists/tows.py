"""The rows of the tow lists: `sleeplijst_<jaar>.csv`.

One row at a time: text to values. What rows, boats and files say about each other belongs to
the room `index`.
"""

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from pipeline.channels import MOST_RUNS, SECOND_FILE_OFFSET
from pipeline.errors import DefectiveInputError
from pipeline.messages import say
from pipeline.tables.row import Row
from warehouse.archive.files.list_kinds import TOWS
from warehouse.archive.profile.season import Plan
from warehouse.archive.sheets.row import DefectiveRowError, ListRow, run_number
from warehouse.archive.spelling.synonyms import ALL_RUNS
from warehouse.archive.spelling.text import fold_word, shorten

TWICE: Final = 2.0
"""A size this many times that of the boat list cannot be right (inferred)."""
_DIMENSIONS: Final = {
    column.key: column
    for column in TOWS.columns
    if column.key in {"waterline_length_m", "beam_m", "bow_height_m"}
}
"""What a tow or else its boat must have; the height of the bow only where wind was measured."""
_VALUES: Final = tuple(
    column
    for column in TOWS.columns
    if column.key != "tow_id" and column.key in TOWS.table.columns()
)
"""Columns whose cells are values of the tow as they are."""
_DECISIVE: Final = frozenset({"speed_correction_ratio", "sample_rate_hz", "altered"})
"""Optional, but where one cannot be read an empty cell would say something else: no alteration."""
_DISPENSABLE: Final = frozenset(
    column.key for column in _VALUES if not column.required and column.key not in _DECISIVE
)
"""Values whose absence makes a tow less sure, and not wrong."""
_RANGE: Final = re.compile(r"(b?[0-9]+)\s*(?:-|\.\.|:|t/m|tm|tot en met|to|bis|à)\s*(b?[0-9]+)")
_TOW_ID: Final = re.compile(r"[^/\\\x00-\x1f]{1,64}")


def with_ids(rows: Sequence[ListRow]) -> list[ListRow]:
    """The rows with the id of their tow; without a column of ids: day, boat and crew."""
    return [row if "tow_id" in row.columns else _with_id(row) for row in rows]


def _with_id(row: ListRow) -> ListRow:
    cells = row.cells
    try:
        day = row.date("tow_date").isoformat()
    except DefectiveInputError:  # said when the date is read
        day = cells.get("tow_date", "")
    crew = f"{cells.get('rowers', '')}{cells.get('crew_class', '')}"
    tow_id = f"{day} {cells.get('fsn_no', '')} {crew}".replace("/", "-")
    return replace(row, cells=cells | {"tow_id": tow_id})


def read_tow(
    row: ListRow, season: int, default_rate_hz: int
) -> tuple[Row, list[DefectiveInputError]]:
    """The values of a tow, without its files; empty dimensions are None.

    Returns:
        The values; and what is wrong in cells that the tow can do without, which count as empty.

    Raises:
        DefectiveInputError: `bad_list_row` with the line.
    """
    tow_id = row.text("tow_id")
    if not _TOW_ID.fullmatch(tow_id):
        message = say("'{tow}' cannot be a sleep_id: it is too long, or has a slash.")
        raise row.fault(say(message, tow=shorten(tow_id)))
    values: Row = {}
    wrong: dict[str, DefectiveInputError] = {}
    for column in _VALUES:
        try:
            values[column.key] = row.value(column)
        except DefectiveInputError as error:
            values[column.key] = None
            wrong[column.key] = error
    costly = [error for key, error in wrong.items() if key not in _DISPENSABLE]
    lost = [wrong[key] for key in sorted(wrong.keys() & _DISPENSABLE)]
    if costly:
        raise DefectiveRowError([*costly, *lost])
    return {
        "tow_id": tow_id,
        "season": season,
        **values,
        "sample_rate_hz": values["sample_rate_hz"] or default_rate_hz,
    }, lost


def unlike_boat(tow: Row, boat: Row, row: ListRow) -> dict[str, DefectiveInputError]:
    """What is wrong in cells that the boat list contradicts: in feet, or a digit too many.

    No rebuilding makes a boat twice as long or heavy. Which of the two is right nobody can know.
    """
    apart = {}
    for key in (*_DIMENSIONS, "weight_kg"):
        here, listed = tow[key], boat[key]
        if here is None or listed is None or 1 / TWICE < here / listed < TWICE:
            continue
        apart[key] = row.wrong(
            "column '{column}' is {cell} and the boat list says {listed:g}; one of the two cannot "
            "be right.",
            key,
            listed=listed,
        )
    return apart


def fill_dimensions(tow: Row, boat: Row, row: ListRow, has_wind: bool) -> Row:
    """The tow with the boat's dimensions where that day's were not written down.

    Args:
        tow: what the row says.
        boat: its boat.
        row: the row.
        has_wind: wind was measured, so that the boat's front has to be known.

    Raises:
        DefectiveInputError: `bad_list_row` when the boat list does not have them either.
    """
    filled = dict(tow) | {key: boat[key] for key in _DIMENSIONS if tow[key] is None}
    needed = {*_DIMENSIONS} - (set() if has_wind else {"bow_height_m"})
    lacking = [c for key, c in _DIMENSIONS.items() if key in needed and filled[key] is None]
    if lacking:
        message = say("{names} must be there, here or in the boat list.")
        raise row.fault(say(message, names=", ".join(f"'{column.named}'" for column in lacking)))
    return filled


def read_selection(row: ListRow, plan: Plan) -> frozenset[int]:
    """The runs to use; runs of the second file are 21 and on.

    Args:
        row: row of a tow list.
        plan: its runs; when the cell is empty all of the first file, and of the second where the
            plan has them.

    Raises:
        DefectiveInputError: `bad_list_row` with the line.
    """
    cell, planned = row.optional_text("use_runs"), plan.runs
    if cell is None or fold_word(cell) in ALL_RUNS:
        both = plan.second_directions and row.optional_text("second_file") is not None
        return frozenset(planned) | {SECOND_FILE_OFFSET + run for run in planned if both}
    parts = re.split(r"[\s,;+&]+", _spelled_out(fold_word(cell)).strip(" ,;"))
    runs = [run_number(part, row, row.named("use_runs"), planned) for part in parts]
    if len(set(runs)) < len(runs):
        raise row.wrong("column '{column}' is '{cell}'; it names one run twice.", "use_runs")
    if max(runs) > SECOND_FILE_OFFSET and row.optional_text("second_file") is None:
        raise row.wrong("column '{column}' is '{cell}', but there is no meetfile2.", "use_runs")
    return frozenset(runs)


def _spelled_out(cell: str) -> str:
    """The cell with ranges such as 1-6 as single numbers, and commas for `en`."""

    def numbers(match: re.Match[str]) -> str:
        letter = "b" if match[1].startswith("b") else ""
        first, last = (int(end.lstrip("b")) for end in match.groups())
        return ",".join(f"{letter}{run}" for run in range(first, min(last, first + MOST_RUNS) + 1))

    return _RANGE.sub(numbers, cell).replace(" en ", ",").replace(" and ", ",").replace(" et ", ",")
