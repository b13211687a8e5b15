"""The boats of the archive: `sloependata.csv`, or several lists of boats."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Final

import polars as pl

from pipeline.messages import say
from pipeline.tables.frames import frame_of
from pipeline.tables.lake import ListedBoats
from pipeline.tables.row import Row
from warehouse.archive.faults import Fault, fault_from, place
from warehouse.archive.files.finding import list_files
from warehouse.archive.files.list_kinds import BOATS
from warehouse.archive.sheets.reading import CREW, read_list
from warehouse.archive.sheets.row import ListRow, others_of
from warehouse.archive.spelling.synonyms import NO_TYPE
from warehouse.archive.spelling.text import fold, fold_word
from warehouse.archive.spelling.wording import Wording

OF_THE_BOAT: Final = (
    *("ht_no", "boat_type", "waterline_length_m", "beam_m", "bow_height_m", "weight_kg"),
)
"""What a boat has once; it may have had several names, and be rowed by several crews."""


@dataclass(frozen=True)
class Boats:
    """The boat lists.

    Attributes:
        good: the boats that can be used, by `fsn_no`; the last row of a boat gives its name.
        crews: every row of those boats: a boat and a crew that rows it.
        bad: why others cannot be used.
        faults: what is wrong in the lists.
        more: what else is wrong in those rows.
        unread: why one of the lists as a whole cannot be read.
    """

    good: Mapping[str, Row]
    crews: Sequence[Row]
    bad: Mapping[str, Fault]
    faults: tuple[Fault, ...]
    more: tuple[Fault, ...] = ()
    unread: Fault | None = None

    def frame(self) -> pl.DataFrame:
        """The good boats, a row for each crew that rows them, in the order of the list."""
        rows = [self.good[boat["fsn_no"]] | {key: boat[key] for key in CREW} for boat in self.crews]
        return frame_of(ListedBoats, rows).unique(maintain_order=True)

    def find(self, fsn_no: str) -> Row | None:
        """A boat by its number or a name; leading zeros do not matter where one boat is left."""
        if fsn_no in self.good:
            return self.good[fsn_no]
        alike = self._by_bare_number.get(_bare(fsn_no)) or self._by_name.get(fold(fsn_no), set())
        return self.good[next(iter(alike))] if len(alike) == 1 else None

    @cached_property
    def _by_name(self) -> Mapping[str, set[str]]:
        """The numbers of the boats that have or had a name, by that name folded."""
        return _grouped((fold(boat["name"]), boat["fsn_no"]) for boat in self.crews)

    @cached_property
    def _by_bare_number(self) -> Mapping[str, set[str]]:
        """The numbers of the good boats, by the number without leading zeros."""
        return _grouped((_bare(number), number) for number in self.good)


def _grouped(pairs: Iterable[tuple[str, str]]) -> dict[str, set[str]]:
    numbers: dict[str, set[str]] = {}
    for key, number in pairs:
        numbers.setdefault(key, set()).add(number)
    return numbers


def _bare(fsn_no: str) -> str:
    return fsn_no.removeprefix("FSN").lstrip("0")


def read_boats(root: Path, wording: Wording) -> Boats:
    """Reads all boat lists; a defective row or an ambiguous boat becomes a fault.

    A boat may have a row for each of its names and crews, in one list or in several. Dimensions,
    weight and crew may be empty. Rows that contradict each other cost the boat: nobody can know
    which of them is right.
    """
    good: dict[str, Row] = {}
    first: dict[str, str] = {}
    crews: list[Row] = []
    bad: dict[str, Fault] = {}
    faults: list[Fault] = []
    more: list[Fault] = []
    unread: Fault | None = None
    for file in list_files(root, BOATS, wording.files):
        try:
            rows = read_list(root, BOATS, file.path, wording)
        except BaseException as error:
            unread = fault_from(error, file.path)
            faults.append(unread)
            continue
        for row in rows:
            try:
                boat = _boat(row)
                fsn_no = boat["fsn_no"]
                where = first.setdefault(fsn_no, place(row.line, file.path))
                good[fsn_no] = _merged(row, boat, good.get(fsn_no), where)
            except BaseException as error:
                fault = fault_from(error, file.path)
                faults.append(fault)
                more += [fault_from(other, file.path) for other in others_of(error)]
                if row.optional_text("fsn_no") is not None:
                    bad[row.boat("fsn_no")] = fault
            else:
                crews.append(boat)
    usable = {fsn_no: boat for fsn_no, boat in good.items() if fsn_no not in bad}
    rowed = [boat for boat in crews if boat["fsn_no"] in usable]
    return Boats(usable, rowed, bad, tuple(faults), tuple(more), unread)


def _boat(row: ListRow) -> Row:
    row.check_whole()
    boat = row.values(BOATS.columns)
    has_no_type = fold_word(boat["boat_type"] or "") in NO_TYPE
    return boat | {"boat_type": None} if has_no_type else boat


def _merged(row: ListRow, boat: Row, before: Row | None, where: str) -> Row:
    """A boat with what its rows so far say; two sizes or types cannot both be right.

    Args:
        where: the first of these rows.
    """
    if before is None:
        return boat
    for key in OF_THE_BOAT:
        if None not in (boat[key], before[key]) and boat[key] != before[key]:
            message = say(
                "boat {boat} is listed twice and the rows differ in {key}: {one} here, {other} on "
                "{where}.",
                boat=boat["fsn_no"],
                key=row.named(key),
                one=boat[key],
                other=before[key],
                where=where,
            )
            raise row.fault(message, "duplicate_boat")
    return {key: value if value is not None else before[key] for key, value in boat.items()}
