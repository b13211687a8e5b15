"""The boats of the archive: `sloependata.csv`."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import polars as pl

from herijk.pipeline.errors import DefectiveInputError
from herijk.tables.frames import frame_of
from herijk.tables.lake import ListedBoats
from herijk.tables.row import Row
from herijk.warehouse.archive.faults import Fault, fault_from
from herijk.warehouse.archive.files.list_kinds import BOATS
from herijk.warehouse.archive.sheets.reading import read_list
from herijk.warehouse.archive.sheets.row import ListRow, others_of
from herijk.warehouse.archive.spelling.synonyms import NO_TYPE
from herijk.warehouse.archive.spelling.text import fold_word
from herijk.warehouse.archive.spelling.wording import Wording
from herijk.words import say

OF_THE_BOAT: Final = (
    *("ht_no", "boat_type", "waterline_length_m", "beam_m", "bow_height_m", "weight_kg"),
)
"""What a boat has once; it may have had several names, and be rowed by several crews."""


@dataclass(frozen=True)
class Boats:
    """The boat list.

    Attributes:
        good: the boats that can be used, by `fsn_no`; the last row of a boat gives its name.
        crews: every row of those boats: a boat and a crew that rows it.
        bad: why others cannot be used.
        faults: what is wrong in the list.
        more: what else is wrong in those rows.
        unread: why the list as a whole cannot be read.
    """

    good: Mapping[str, Row]
    crews: Sequence[Row]
    bad: Mapping[str, Fault]
    faults: tuple[Fault, ...]
    more: tuple[Fault, ...] = ()
    unread: Fault | None = None

    def frame(self) -> pl.DataFrame:
        """The good boats, a row for each crew that rows them, in the order of the list."""
        rows = [{**boat, **self.good[boat["fsn_no"]], **_crew_of(boat)} for boat in self.crews]
        return frame_of(ListedBoats, rows).unique(maintain_order=True)

    def find(self, fsn_no: str) -> Row | None:
        """A boat by its number; leading zeros do not matter where that leaves one boat."""
        if fsn_no in self.good:
            return self.good[fsn_no]
        alike = [b for number, b in self.good.items() if _bare(number) == _bare(fsn_no)]
        return alike[0] if len(alike) == 1 else None


def _bare(fsn_no: str) -> str:
    return fsn_no.removeprefix("FSN").lstrip("0")


def _crew_of(boat: Row) -> Row:
    return {"rowers": boat["rowers"], "crew_class": boat["crew_class"]}


def read_boats(root: Path, path: str, wording: Wording) -> Boats:
    """Reads the boat list; a defective row or an ambiguous boat becomes a fault.

    A boat may have a row for each of its names and crews. Dimensions, weight and crew may be empty.

    Raises:
        DefectiveInputError: the list as a whole cannot be read.
    """
    good: dict[str, Row] = {}
    crews: list[Row] = []
    bad: dict[str, Fault] = {}
    faults: list[Fault] = []
    more: list[Fault] = []
    for row in read_list(root, BOATS, path, wording):
        try:
            boat = _boat(row)
            merged = _merged(row, boat, good.get(boat["fsn_no"]))
        except DefectiveInputError as error:
            fault = fault_from(error, path)
            faults.append(fault)
            more += [fault_from(other, path) for other in others_of(error)]
            if row.optional_text("fsn_no") is not None:
                bad[row.boat("fsn_no")] = fault
            continue
        good[boat["fsn_no"]] = merged
        crews.append(boat)
    usable = {fsn_no: boat for fsn_no, boat in good.items() if fsn_no not in bad}
    rowed = [boat for boat in crews if boat["fsn_no"] in usable]
    return Boats(usable, rowed, bad, tuple(faults), tuple(more))


def _boat(row: ListRow) -> Row:
    row.check_whole()
    boat = row.values(BOATS.columns)
    has_no_type = fold_word(boat["boat_type"] or "") in NO_TYPE
    return boat | {"boat_type": None} if has_no_type else boat


def _merged(row: ListRow, boat: Row, before: Row | None) -> Row:
    """A boat with what its rows so far say; two sizes or types cannot both be right."""
    if before is None:
        return boat
    for key in OF_THE_BOAT:
        if None not in (boat[key], before[key]) and boat[key] != before[key]:
            message = say(
                "boat {boat} is in the list twice and the rows differ in {key} ({one} and "
                "{other}).",
                boat=boat["fsn_no"],
                key=row.named(key),
                one=before[key],
                other=boat[key],
            )
            raise row.fault(message, "duplicate_boat")
    return {key: value if value is not None else before[key] for key, value in boat.items()}
