"""The instruments: the load cell held against known weights, and warning lamps that burned.

What that does to a tow belongs to `pipeline`.
"""

import datetime as dt
from collections.abc import Iterable
from typing import Final

import numpy as np
import polars as pl

from pipeline.messages import say
from warehouse.archive.faults import Fault
from warehouse.archive.files.finding import ArchiveFile
from warehouse.archive.files.list_kinds import FORCE_CHECKS, LAMPS
from warehouse.archive.lists.windows import in_order
from warehouse.archive.profile.definition import Profiles
from warehouse.archive.sheets.reading import read_sound
from warehouse.archive.sheets.rows import check_year, keep, to_table

GRAVITY_M_S2: Final = 9.813
"""In the Netherlands."""

ONE_READING_SD: Final = 0.003
"""Spread of the ratio of one reading, where a day has too few to show it (inferred)."""

WEIGHT_SD: Final = 0.001
"""Relative error of the known weight (inferred)."""

FEWEST_READINGS: Final = 3


def read_force_checks(
    files: Iterable[ArchiveFile], profiles: Profiles
) -> tuple[pl.DataFrame, list[Fault]]:
    """Reads every list of readings of the load cell, and the lines that cannot be read."""
    rows, faults = read_sound(files, FORCE_CHECKS, profiles)
    rows = check_year(rows, faults, "day", FORCE_CHECKS.reason_code)
    return to_table(FORCE_CHECKS.table, rows, faults, FORCE_CHECKS.reason_code), faults


def load_cell_of(season: int, day: dt.date, checks: pl.DataFrame) -> tuple[float, float] | None:
    """Reading / weight of the last day up to a tow's on which the cell was checked, and its sd.

    Where it was checked only later in the season, the first such day counts. The sd holds the
    scatter of that day's readings and the weight itself, as ratios.
    """
    mine = checks.filter(season=season)
    if mine.is_empty():
        return None
    before = mine.filter(pl.col("day") <= day)["day"].max()
    of_day = mine.filter(pl.col("day") == (mine["day"].min() if before is None else before))
    ratio = (of_day["reading_n"] / (of_day["weight_kg"] * GRAVITY_M_S2)).to_numpy()
    own = np.std(ratio, ddof=1) if len(ratio) >= FEWEST_READINGS else ONE_READING_SD
    sd = np.hypot(own / np.sqrt(len(ratio)), WEIGHT_SD)
    return float(ratio.mean()), float(sd)


def read_lamps(
    files: Iterable[ArchiveFile], profiles: Profiles, tow_ids: pl.Series
) -> tuple[pl.DataFrame, list[Fault]]:
    """Reads every list of lamps, and the lines that cannot be read or are of no listed tow."""
    rows, faults = read_sound(files, LAMPS, profiles)
    is_unknown, tow = ~pl.col("tow_id").is_in(tow_ids.implode()), pl.col("tow_id")
    text = say("sleep_id {tow} is not in the tow list of that year.")
    rows = keep(rows, faults, is_unknown, LAMPS.reason_code, text, tow=tow)
    rows = in_order(rows, faults, LAMPS.reason_code)
    return to_table(LAMPS.table, rows, faults, LAMPS.reason_code), faults


def lamp_seconds(lamps: pl.DataFrame) -> pl.DataFrame:
    """How long a lamp burned in that run of each tow in which it burned longest: `burned_s`."""
    burned = (pl.col("end_s") - pl.col("start_s")).sum().alias("burned_s")
    of_run = lamps.group_by("tow_id", "run", maintain_order=True).agg(burned)
    return of_run.group_by("tow_id", maintain_order=True).agg(pl.col("burned_s").max())
