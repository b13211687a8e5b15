"""The boats of the archive: `sloependata.csv`, or several lists of boats."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Final

import polars as pl

from pipeline.messages import say
from pipeline.tables.lake import ListedBoats
from warehouse.archive.faults import Fault
from warehouse.archive.files.finding import ArchiveFile
from warehouse.archive.files.list_kinds import BOATS
from warehouse.archive.profile.definition import Profiles
from warehouse.archive.sheets.reading import CREW, read_lists
from warehouse.archive.sheets.rows import header, keep, place_of, sound_rows
from warehouse.archive.spelling.synonyms import NO_TYPE
from warehouse.archive.spelling.text import fold, fold_word

OF_THE_BOAT: Final = (
    *("ht_no", "boat_type", "waterline_length_m", "beam_m", "bow_height_m", "weight_kg"),
)
"""What a boat has once; it may have had several names, and be rowed by several crews."""


@dataclass(frozen=True)
class Boats:
    """The boat lists.

    Attributes:
        listed: the boats that can be used (`ListedBoats`), a row for each crew that rows them, in
            the order of the list; the last row of a boat gives its name.
        bad: why others cannot be used.
        numbers: the numbers of the good boats by what each can be called: a name that it had,
            folded, or its number without leading zeros.
        faults: what is wrong in the lists.
        more: what else is wrong in those rows.
        unread: why one of the lists as a whole cannot be read.
    """

    listed: pl.DataFrame
    bad: Mapping[str, Fault]
    numbers: Mapping[tuple[str, str], set[str]]
    faults: list[Fault]
    more: list[Fault] = field(default_factory=list)
    unread: Fault | None = None

    def find(self, fsn_no: str) -> str | None:
        """The number of a boat by a number or a name; zeros before it count where two are alike."""
        bare = self.numbers.get(("number", _bare(fsn_no)), set())
        if fsn_no in bare:
            return fsn_no
        alike = bare or self.numbers.get(("name", fold(fsn_no)), set())
        return next(iter(alike)) if len(alike) == 1 else None


def _bare(fsn_no: str) -> str:
    return fsn_no.removeprefix("FSN").lstrip("0")


def read_boats(files: Iterable[ArchiveFile], profiles: Profiles) -> Boats:
    """Reads all boat lists; a defective row or an ambiguous boat becomes a fault.

    A boat may have a row for each of its names and crews, in one list or in several. Dimensions,
    weight and crew may be empty. Rows that contradict each other cost the boat: nobody can know
    which of them is right.
    """
    rows, problems, faults = read_lists(files, BOATS, profiles)
    unread = faults[-1] if faults else None
    of_rows: list[Fault] = []
    more: list[Fault] = []
    rows = rows.with_columns(of_tow="fsn_no")  # which boat a fault costs
    rows = _that_agree(sound_rows(rows, problems, of_rows, more), of_rows)
    of_rows.sort(key=lambda fault: (fault.path, fault.line))
    bad = {f.tow_id: replace(f, tow_id=None) for f in of_rows if f.tow_id is not None}
    is_no_type = pl.col("boat_type").map_elements(_is_no_type, pl.Boolean)
    rows = rows.filter(~pl.col("fsn_no").is_in([*bad])).with_columns(
        boat_type=pl.when(~is_no_type).then("boat_type")
    )
    whole = rows.group_by("fsn_no", maintain_order=True).agg(
        pl.col(*ListedBoats.column_names()).exclude("fsn_no").drop_nulls().last()
    )
    listed = rows.select("fsn_no", *CREW).join(whole.drop(CREW), on="fsn_no", maintain_order="left")
    numbers: dict[tuple[str, str], set[str]] = {}
    for number, name in rows.select("fsn_no", "name").rows():
        numbers.setdefault(("number", _bare(number)), set()).add(number)
        numbers.setdefault(("name", fold(name)), set()).add(number)
    return Boats(
        listed=ListedBoats.cast(
            listed.select(ListedBoats.column_names()).unique(maintain_order=True)
        ),
        bad=bad,
        numbers=numbers,
        faults=[*faults, *(replace(fault, tow_id=None) for fault in of_rows)],
        more=[replace(fault, tow_id=None) for fault in more],
        unread=unread,
    )


def _is_no_type(boat_type: str) -> bool:
    return fold_word(boat_type) in NO_TYPE


def _that_agree(rows: pl.DataFrame, faults: list[Fault]) -> pl.DataFrame:
    """The rows that do not contradict the first of their boat: two sizes cannot both be right."""
    text = say(
        "boat {boat} is listed twice and the rows differ in {key}: {one} here, {other} on {where}."
    )
    first = {f"first_{key}": pl.col(key).drop_nulls().first().over("fsn_no") for key in OF_THE_BOAT}
    where = place_of("line", "path").first().over("fsn_no")
    rows = rows.with_columns(**first, where=where)
    for key in OF_THE_BOAT:
        one, other = pl.col(key), pl.col(f"first_{key}")
        facts = {"boat": pl.col("fsn_no"), "key": header(key), "one": one, "other": other}
        facts |= {"where": pl.col("where")}
        rows = keep(rows, faults, one != other, "duplicate_boat", text, **facts)
    return rows
