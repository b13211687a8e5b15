"""When a warning lamp burned because the tow line was not square.

What that does to a tow's checks belongs to `pipeline`.
"""

from collections.abc import Collection
from functools import partial
from pathlib import Path

import polars as pl

from pipeline.messages import say
from pipeline.tables.row import Row
from warehouse.archive.faults import Fault
from warehouse.archive.files.list_kinds import LAMPS
from warehouse.archive.lists.windows import check_order
from warehouse.archive.sheets.reading import read_lists
from warehouse.archive.sheets.row import ListRow
from warehouse.archive.spelling.wording import Wording


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
