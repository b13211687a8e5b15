"""The instruments: the load cell held against known weights, and warning lamps that burned.

What that does to a tow belongs to `pipeline`.
"""

from collections.abc import Collection
from functools import partial
from pathlib import Path
from typing import Final

import numpy as np
import polars as pl

from pipeline.messages import say
from pipeline.tables.row import Row
from warehouse.archive.faults import Fault
from warehouse.archive.files.list_kinds import FORCE_CHECKS, LAMPS
from warehouse.archive.lists.windows import check_order
from warehouse.archive.sheets.reading import read_lists
from warehouse.archive.sheets.row import ListRow
from warehouse.archive.spelling.wording import Wording

GRAVITY_M_S2: Final = 9.813
"""In the Netherlands."""

ONE_READING_SD: Final = 0.003
"""Spread of the ratio of one reading, where a day has too few to show it (inferred)."""

WEIGHT_SD: Final = 0.001
"""Relative error of the known weight (inferred)."""

FEWEST_READINGS: Final = 3


def read_force_checks(root: Path, wording: Wording) -> tuple[pl.DataFrame, tuple[Fault, ...]]:
    """Reads every list of readings of the load cell, and the lines that cannot be read."""
    return read_lists(root, FORCE_CHECKS, wording, _force_check)


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
    that_day = mine.filter(pl.col("day") == day)
    ratio = (that_day["reading_n"] / (that_day["weight_kg"] * GRAVITY_M_S2)).to_numpy()
    own = np.std(ratio, ddof=1) if len(ratio) >= FEWEST_READINGS else ONE_READING_SD
    sd = np.hypot(own / np.sqrt(len(ratio)), WEIGHT_SD)
    return {"load_cell_ratio": float(ratio.mean()), "load_cell_sd": float(sd)}


def _force_check(row: ListRow, season: int) -> Row:
    check = row.values(FORCE_CHECKS.columns)
    row.check_year(check["day"], season)
    return check | {"season": season}


def read_lamps(
    root: Path, wording: Wording, tow_ids: Collection[str]
) -> tuple[pl.DataFrame, tuple[Fault, ...]]:
    """Reads every list of lamps, and the lines that cannot be read or are of no listed tow."""
    return read_lists(root, LAMPS, wording, partial(_lamp, tow_ids))


def lamp_seconds(lamps: pl.DataFrame) -> dict[str, float]:
    """How long a lamp burned in that run of each tow in which it burned longest."""
    burned = (pl.col("end_s") - pl.col("start_s")).sum().alias("burned")
    of_run = lamps.group_by("tow_id", "run", maintain_order=True).agg(burned)
    return dict(of_run.group_by("tow_id", maintain_order=True).agg(pl.col("burned").max()).rows())


def _lamp(tow_ids: Collection[str], row: ListRow, season: int) -> Row:
    tow_id = row.text("tow_id")
    if tow_id not in tow_ids:
        raise row.fault(say("sleep_id {tow} is not in the tow list of that year.", tow=tow_id))
    lamp = row.values(LAMPS.columns)
    check_order(row, lamp)
    return lamp | {"season": season}
