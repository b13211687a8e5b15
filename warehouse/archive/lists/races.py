"""Race results. Computing with them belongs elsewhere."""

import re
from pathlib import Path
from typing import Final

import polars as pl

from pipeline.messages import say
from pipeline.tables.bases import TowFacts
from pipeline.tables.frames import limits
from pipeline.tables.row import Row
from warehouse.archive.faults import Fault, at_line
from warehouse.archive.files.list_kinds import RACES
from warehouse.archive.profile.reading import read_profiles
from warehouse.archive.sheets.reading import read_lists
from warehouse.archive.sheets.row import ROWS_ARE_EQUAL, ROWS_DIFFER, ListRow
from warehouse.archive.spelling.wording import Wording

_ROWING_TIME: Final = re.compile(
    r"([0-9]{1,2})(?::|\.|[uh]\s*)([0-5]?[0-9])(?::|\.|['m]\s*)([0-5]?[0-9])(?:[.,]0*|[\"s])?"
)


def read_races(
    root: Path, wording: Wording | None = None
) -> tuple[pl.DataFrame, tuple[Fault, ...]]:
    """Reads every `wedstrijden/<naam>_<jaar>.csv`.

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
    """The results of crews that have one in a race; of equal rows the first counts."""
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
        message = say(
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
