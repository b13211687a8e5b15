"""What people write down of the load cell and the warning lamps: two lists, both optional.

`krachtijkingen_<jaar>.csv`: the load cell read while a known weight hung on it, daily or more often
(Sleepproef, R. Pot 2017, "Krachtopnemer"). `lampjes_<jaar>.csv`: when a lamp beside the beacon
burned because the tow line was not square ("Recht sturen"). What they do to a tow's numbers and
checks belongs to `pipeline`.
"""

from collections.abc import Collection
from functools import partial
from pathlib import Path
from typing import Final

import numpy as np
import polars as pl

from herijk.pipeline.channels import MOST_RUNS
from herijk.tables.lake import ListedForceChecks, ListedLamps
from herijk.tables.row import Row
from herijk.warehouse.archive.faults import Fault
from herijk.warehouse.archive.files import FORCE_CHECKS, LAMPS
from herijk.warehouse.archive.lists import ListRow, Wording
from herijk.warehouse.archive.published import read_lists
from herijk.warehouse.archive.text import Column
from herijk.warehouse.archive.tows import run_number
from herijk.words import say

GRAVITY_M_S2: Final = 9.813
"""In the Netherlands."""

ONE_READING_SD: Final = 0.003
"""Of the ratio of one reading, where a day has too few to show it (inferred)."""

WEIGHT_SD: Final = 0.001
"""Of the known weight (inferred)."""

FEWEST_READINGS: Final = 3

FORCE_CHECK_COLUMNS: Final = (
    Column("day", "datum"),
    Column("weight_kg", "gewicht", "mass", "kg"),
    Column("reading_n", "aflezing", "force", "N"),
)
LAMP_COLUMNS: Final = (
    Column("tow_id", "sleep_id"),
    Column("run", "run"),
    Column("start_s", "van", "time", "s"),
    Column("end_s", "tot", "time", "s"),
)


def read_force_checks(root: Path, wording: Wording) -> tuple[pl.DataFrame, tuple[Fault, ...]]:
    """Read every list of readings of the load cell, and the lines that cannot be read."""
    return read_lists(
        root,
        FORCE_CHECKS,
        FORCE_CHECK_COLUMNS,
        "bad_instrument_row",
        ListedForceChecks,
        _force_check,
        wording,
    )


def read_lamps(
    root: Path, wording: Wording, tow_ids: Collection[str]
) -> tuple[pl.DataFrame, tuple[Fault, ...]]:
    """Read every list of lamps, and the lines that cannot be read or are of no listed tow."""
    lamp = partial(_lamp, tow_ids)
    return read_lists(root, LAMPS, LAMP_COLUMNS, "bad_instrument_row", ListedLamps, lamp, wording)


def load_cell_of(tow: Row, checks: pl.DataFrame) -> dict[str, float | None]:
    """Reading / weight of the last day up to a tow's on which the cell was checked, and its sd.

    Where it was checked only later in the season, the first such day counts. The sd holds the
    scatter of that day's readings and the weight itself, as ratios.
    """
    mine = checks.filter(season=tow["season"])
    if mine.is_empty():
        return {"load_cell_ratio": None, "load_cell_sd": None}
    before = mine.filter(pl.col("day") <= tow["tow_date"])["day"].max()
    day = mine["day"].min() if before is None else before
    held = mine.filter(pl.col("day") == day)
    ratio = (held["reading_n"] / (held["weight_kg"] * GRAVITY_M_S2)).to_numpy()
    own = np.std(ratio, ddof=1) if len(ratio) >= FEWEST_READINGS else ONE_READING_SD
    sd = np.hypot(own / np.sqrt(len(ratio)), WEIGHT_SD)
    return {"load_cell_ratio": float(ratio.mean()), "load_cell_sd": float(sd)}


def lamp_seconds(lamps: pl.DataFrame) -> dict[str, float]:
    """How long a lamp burned in that run of each tow in which it burned longest."""
    burned = (pl.col("end_s") - pl.col("start_s")).sum().alias("burned")
    of_run = lamps.group_by("tow_id", "run", maintain_order=True).agg(burned)
    return dict(of_run.group_by("tow_id", maintain_order=True).agg(pl.col("burned").max()).rows())


def _force_check(row: ListRow, season: int) -> Row:
    day = row.date("day")
    if day.year != season:
        message = "the date {day} is not in {season}, the year of the file."
        raise row.fault(say(message, day=day, season=season))
    return {
        "season": season,
        "day": day,
        "weight_kg": row.number("weight_kg"),
        "reading_n": row.number("reading_n"),
    }


def _lamp(tow_ids: Collection[str], row: ListRow, season: int) -> Row:
    tow_id = row.text("tow_id")
    if tow_id not in tow_ids:
        raise row.fault(say("sleep_id {tow} is not in the tow list of that year.", tow=tow_id))
    start, end = row.number("start_s"), row.number("end_s")
    if start >= end:
        message = "'van' is {start} s and 'tot' {end} s; a window ends after it begins."
        raise row.fault(say(message, start=start, end=end))
    return {
        "season": season,
        "tow_id": tow_id,
        "run": run_number(row.text("run"), row, "run", range(1, MOST_RUNS + 1)),
        "start_s": start,
        "end_s": end,
    }
