"""Race results. Computing with them belongs elsewhere."""

from pathlib import Path
from typing import Final

import polars as pl

from pipeline.messages import say
from pipeline.tables.bases import TowFacts
from pipeline.tables.frames import limits
from warehouse.archive.faults import Fault
from warehouse.archive.files.finding import files_of
from warehouse.archive.files.list_kinds import RACES
from warehouse.archive.profile.definition import Profiles
from warehouse.archive.profile.reading import read_profiles
from warehouse.archive.sheets.reading import read_sound
from warehouse.archive.sheets.rows import (
    cell,
    check_year,
    keep,
    one_of_each,
    to_table,
)

_RESULT: Final = ("race", "race_date", "fsn_no", "rowers", "crew_class")
"""What a crew has one result of."""


def read_races(root: Path, profiles: Profiles | None = None) -> tuple[pl.DataFrame, list[Fault]]:
    """Reads every `wedstrijden/<naam>_<jaar>.csv`.

    A crew has one result in a race; of equal rows the first counts.

    Returns:
        One row a result (`ListedRaces`; distances in m, times in s, penalties in W), and the lines
        that cannot be read.
    """
    profiles = profiles or read_profiles(root)
    rows, faults = read_sound(files_of(root, profiles.files), RACES, profiles)
    rows = check_year(rows, faults, "race_date", RACES.reason_code)
    rows = rows.with_columns(season=pl.col("race_date").dt.year().cast(pl.Int64))
    rows = _possible(rows, faults)
    own = [name for name in RACES.table.column_names() if name not in {"path", "line"}]
    crew = pl.format("{}{}", "rowers", "crew_class")
    text = say("{boat} {crew} is listed twice for {race}; {ending}")
    facts = {"boat": pl.col("fsn_no"), "crew": crew, "race": pl.col("race")}
    rows = one_of_each(rows, faults, _RESULT, own, RACES.reason_code, text, **facts)
    return to_table(RACES.table, rows, faults, RACES.reason_code), faults


def _possible(rows: pl.DataFrame, faults: list[Fault]) -> pl.DataFrame:
    """The results whose speed through the water a boat can have."""
    through_water_m = pl.col("distance_m") - pl.col("stream_m").fill_null(0.0)
    speed = through_water_m / pl.col("rowing_time_s")
    low, high = limits(TowFacts, "declared_speed_m_s")
    text = say(
        "'roeitijd' is {cell} for {km:g} km through the water: {speed:.3g} m/s; {low:g} to "
        "{high:g} can be right."
    )
    facts = {"cell": cell("rowing_time_s"), "km": through_water_m / 1000, "speed": speed}
    is_impossible = ~speed.is_between(low, high)
    return keep(rows, faults, is_impossible, RACES.reason_code, text, **facts, low=low, high=high)
