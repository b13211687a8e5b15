"""Registers as they were published, and race results: what the recomputed history is compared with.

Both are optional in an archive. Computing with them belongs elsewhere.
"""

import re
from pathlib import Path
from typing import Final

import polars as pl

from herijk.pipeline.register.register import NO_EMPTY_THWART
from herijk.tables.bases import TowFacts
from herijk.tables.frames import limits
from herijk.tables.row import Row
from herijk.warehouse.archive.faults import Fault, at_line
from herijk.warehouse.archive.kinds import RACES, REGISTERS
from herijk.warehouse.archive.lists import (
    ROWS_ARE_EQUAL,
    ROWS_DIFFER,
    ListRow,
    Wording,
    read_lists,
)
from herijk.warehouse.archive.profile import read_profiles
from herijk.words import say

NEVER_TOWED_CW: Final = (0.995, 1.005)
"""Published Cw of boats without a valid tow: 1, as printed in two decimals. No hull comes near."""

CW_AS_PRINTED: Final = 0.01
"""By how much a printed Cw may differ from its A and B, beside what rounding does: an intermediate
result was sometimes rounded too."""
_BELOW_ONE: Final = 0.999

_ROWING_TIME: Final = re.compile(
    r"([0-9]{1,2})(?::|\.|[uh]\s*)([0-5]?[0-9])(?::|\.|['m]\s*)([0-5]?[0-9])(?:[.,]0*|[\"s])?"
)


def read_published_registers(
    root: Path, wording: Wording | None = None
) -> tuple[pl.DataFrame, tuple[Fault, ...]]:
    """Read every `sloepregister/sloepregister_<jaar>.csv`.

    Returns:
        One row per line of a register (`PrintedLines`), and the lines that cannot be read. A boat
        without a valid curve (published as Cw = 1) has `has_valid_curve` false and no A, B and Cw.
    """
    wording = wording or read_profiles(root).wording
    return read_lists(root, REGISTERS, wording, _fitting_line)


def read_races(
    root: Path, wording: Wording | None = None
) -> tuple[pl.DataFrame, tuple[Fault, ...]]:
    """Read every `wedstrijden/<naam>_<jaar>.csv`.

    Returns:
        One row a result (`ListedRaces`; distances in m, times in s, penalties in W), and the lines
        that cannot be read.
    """
    wording = wording or read_profiles(root).wording
    results, faults = read_lists(root, RACES, wording, _possible_result)
    kept, twice = _once(results)
    return kept, (*faults, *twice)


_RESULT: Final = ("race", "race_date", "fsn_no", "rowers", "crew_class")
"""What a crew has one result of."""


def _once(results: pl.DataFrame) -> tuple[pl.DataFrame, list[Fault]]:
    """Return the results of crews that have one in a race; of equal rows the first counts."""
    others = [name for name in results.columns if name not in {"path", "line"}]
    is_again = pl.struct(others).is_first_distinct().not_()
    one = results.filter(is_again.not_())
    differ = one.filter(pl.struct(_RESULT).is_duplicated())
    faults = [
        _again(row, ending)
        for rows, ending in ((results.filter(is_again), ROWS_ARE_EQUAL), (differ, ROWS_DIFFER))
        for row in rows.iter_rows(named=True)
    ]
    return one.filter(pl.struct(_RESULT).is_unique()), faults


def _again(row: Row, ending: str) -> Fault:
    what = say(
        "{boat} {crew} is listed twice for {race}; {ending}",
        boat=row["fsn_no"],
        crew=f"{row['rowers']}{row['crew_class']}",
        race=row["race"],
        ending=ending,
    )
    return Fault(row["path"], None, row["line"], "bad_race_row", at_line(row["line"], what))


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
        message = "B is {b_m_s} m/s and the speed {declared_speed_m_s}; B must be higher."
        raise row.fault(say(message, **printed))
    half_a, half_b, half_cw, half_v = (_half_unit(printed[key]) for key in keys)
    slowest = (speed - half_v) / (b + half_b)
    fastest = min((speed + half_v) / (b - half_b), _BELOW_ONE)
    lowest = (a - half_a) / (1.0 - slowest**2) - half_cw
    highest = (a + half_a) / (1.0 - fastest**2) + half_cw
    if not lowest * (1.0 - CW_AS_PRINTED) <= cw <= highest * (1.0 + CW_AS_PRINTED):
        message = (
            "Cw is {cw_kg_m}, but A {a_kg_m} and B {b_m_s} give {given:.2f} at "
            "{declared_speed_m_s} m/s; one of them is wrong, or two are exchanged."
        )
        given = a / (1.0 - (speed / b) ** 2)
        raise row.fault(say(message, **printed, given=given))


def _half_unit(cell: str) -> float:
    """Half a unit of the last digit that is printed."""
    decimals = re.search(r"[.,]([0-9]+)", cell)
    return 0.5 * 10.0 ** -(len(decimals[1]) if decimals else 0)


def _race_result(row: ListRow, season: int) -> Row:
    result = row.values(column for column in RACES.columns if column.key != "rowing_time_s")
    day = result["race_date"]
    if season:
        row.check_year(day, season)
    return result | {"season": day.year, "rowing_time_s": _rowing_time(row)}


def _possible_result(row: ListRow, season: int) -> Row:
    """A result whose speed through the water a boat can have."""
    result = _race_result(row, season)
    through_water_m = result["distance_m"] - (result["stream_m"] or 0.0)
    speed = through_water_m / result["rowing_time_s"]
    lowest, highest = limits(TowFacts, "declared_speed_m_s")
    if not lowest <= speed <= highest:
        message = (
            "'roeitijd' is {cell} for {km:g} km through the water: {speed:.3g} m/s; {low:g} to "
            "{high:g} can be right."
        )
        km = through_water_m / 1000
        raise row.wrong(message, "rowing_time_s", km=km, speed=speed, low=lowest, high=highest)
    return result


def _rowing_time(row: ListRow) -> float:
    cell = row.text("rowing_time_s")
    match = _ROWING_TIME.fullmatch(cell)
    if match is None:
        raise row.wrong("'roeitijd' is '{cell}', not a time such as 2:10:25.", "rowing_time_s")
    seconds = int(match[1]) * 3600 + int(match[2]) * 60 + int(match[3])
    if seconds == 0:
        raise row.fault(say("'roeitijd' is 0."))
    return float(seconds)
