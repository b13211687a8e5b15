"""Registers as they were published: what the recomputed history is compared with."""

import re
from pathlib import Path
from typing import Final

import polars as pl

from pipeline.messages import say
from pipeline.register.register import NO_EMPTY_THWART
from pipeline.tables.row import Row
from warehouse.archive.faults import Fault
from warehouse.archive.files.list_kinds import REGISTERS
from warehouse.archive.profile.reading import read_profiles
from warehouse.archive.sheets.reading import read_lists
from warehouse.archive.sheets.row import ListRow
from warehouse.archive.spelling.wording import Wording

NEVER_TOWED_CW: Final = (0.995, 1.005)
"""Published Cw of boats without a valid tow: 1, as printed in two decimals. No hull comes near."""

CW_AS_PRINTED: Final = 0.01
"""By how much a printed Cw may differ from its A and B, beside what rounding does: an intermediate
result was sometimes rounded too."""
_BELOW_ONE: Final = 0.999


def read_published_registers(
    root: Path, wording: Wording | None = None
) -> tuple[pl.DataFrame, tuple[Fault, ...]]:
    """Reads every `sloepregister/sloepregister_<jaar>.csv`.

    Returns:
        One row per line of a register (`PrintedLines`), and the lines that cannot be read. A boat
        without a valid curve (published as Cw = 1) has `has_valid_curve` false and no A, B and Cw.
    """
    wording = wording or read_profiles(root).wording
    return read_lists(root, REGISTERS, wording, _fitting_line)


def _register_line(row: ListRow, season: int) -> Row:
    cw = row.number("cw_kg_m")
    is_valid = not NEVER_TOWED_CW[0] <= cw <= NEVER_TOWED_CW[1]
    curve = {key: row.number(key) if is_valid else None for key in ("a_kg_m", "b_m_s", "cw_kg_m")}
    line = row.values(column for column in REGISTERS.columns if column.key not in curve)
    thwart = line["empty_thwart"] or NO_EMPTY_THWART
    return line | curve | {"season": season, "has_valid_curve": is_valid, "empty_thwart": thwart}


def _fitting_line(row: ListRow, season: int) -> Row:
    """A line of a register that is its own curve."""
    line = _register_line(row, season)
    if line["has_valid_curve"]:
        _check_curve(row)
    return line


def _check_curve(row: ListRow) -> None:
    """Holds a printed Cw against A, B and the speed beside it: two exchanged, or one mistyped.

    Raises:
        DefectiveInputError: Cw = A / (1 - (v/B)^2) does not hold, however the numbers were rounded.
    """
    keys = ("a_kg_m", "b_m_s", "cw_kg_m", "declared_speed_m_s")
    if row.optional_number("declared_speed_m_s") is None:
        return
    a, b, cw, speed = (row.number(key) for key in keys)
    printed = {key: row.text(key) for key in keys}
    if b <= speed:
        message = say("B is {b_m_s} m/s and the speed {declared_speed_m_s}; B must be higher.")
        raise row.fault(say(message, **printed))
    half_a, half_b, half_cw, half_v = (_half_unit(printed[key]) for key in keys)
    slowest = (speed - half_v) / (b + half_b)
    fastest = min((speed + half_v) / (b - half_b), _BELOW_ONE)
    lowest = (a - half_a) / (1.0 - slowest**2) - half_cw
    highest = (a + half_a) / (1.0 - fastest**2) + half_cw
    if not lowest * (1.0 - CW_AS_PRINTED) <= cw <= highest * (1.0 + CW_AS_PRINTED):
        message = say(
            "Cw is {cw_kg_m}, but A {a_kg_m} and B {b_m_s} give {given:.2f} at "
            "{declared_speed_m_s} m/s; one of them is wrong, or two are exchanged."
        )
        given = a / (1.0 - (speed / b) ** 2)
        raise row.fault(say(message, **printed, given=given))


def _half_unit(cell: str) -> float:
    """Half a unit of the last digit that is printed."""
    decimals = re.search(r"[.,]([0-9]+)", cell)
    return 0.5 * 10.0 ** -(len(decimals[1]) if decimals else 0)
