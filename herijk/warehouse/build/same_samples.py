"""Samples that were measured once and are in the archive twice.

A file that was packed again, saved with other line ends or in another format has another hash and
the same content: a run whose sums are equal to the last bit was measured once. Whose it is nobody
can know, so between boats or crews it costs all of them; of one boat and crew the first tow keeps
it. Files equal byte by byte are found before, in `warehouse.archive.index`.
"""

import dataclasses
from collections.abc import Iterator
from typing import Final

import polars as pl

from herijk.pipeline.channels import SECOND_FILE_OFFSET
from herijk.tables.frames import frame_of
from herijk.tables.keys import LINE
from herijk.tables.lake import Faults
from herijk.warehouse.archive.faults import Fault
from herijk.words import say

_CONTENT: Final = ("n", "force", "log1_v", "log1_cw", "wind_v")


def same_samples(tows: pl.DataFrame, blocks: pl.DataFrame) -> pl.DataFrame:
    """A fault of every tow with a run that is another tow's.

    Args:
        tows: rows of `tows`.
        blocks: their blocks, with `tow_id`.
    """
    if tows.is_empty():
        return Faults.create_empty()
    facts = tows.select("tow_id", "tow_date", *LINE, "samples_path")
    runs = (
        blocks.join(facts, on="tow_id", how="semi")
        .group_by("tow_id", "run", maintain_order=True)
        .agg(pl.col(_CONTENT).sum())
        .filter(pl.struct(_CONTENT).is_duplicated())
        .join(facts, on="tow_id")
        .sort("tow_date", "tow_id", "run")
    )
    faults = [
        fault for _, same in runs.group_by(_CONTENT, maintain_order=True) for fault in _faults(same)
    ]
    rows = frame_of(Faults, map(dataclasses.asdict, faults))
    return rows.unique("tow_id", keep="first", maintain_order=True)


def _faults(same: pl.DataFrame) -> Iterator[Fault]:
    """Faults for one content: of all its tows, or of all but the first."""
    first = same.row(0, named=True)
    of_one = same.select(LINE).n_unique() == 1
    for row in same.iter_rows(named=True):
        other = next((r for r in same.iter_rows(named=True) if r["tow_id"] != row["tow_id"]), None)
        if other is None or (of_one and row["tow_id"] == first["tow_id"]):
            continue
        if of_one and row["run"] > SECOND_FILE_OFFSET:
            continue
        yield Fault(
            row["samples_path"],
            row["tow_id"],
            None,
            "duplicate_tow" if of_one else "samples_listed_twice",
            say(
                "Run {} holds the very samples of tow {} ({}) of {} {}{}, packed or "
                "written otherwise.",
                row["run"] % SECOND_FILE_OFFSET,
                other["tow_id"],
                other["samples_path"],
                other["fsn_no"],
                other["rowers"],
                other["crew_class"],
            ),
            lost="tow",
        )
