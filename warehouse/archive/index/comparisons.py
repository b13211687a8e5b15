"""Rows, boats and files compared with each other, one check after the other."""

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from itertools import chain
from typing import TypeVar

from pipeline.errors import DefectiveInputError
from pipeline.messages import say
from pipeline.tables.frames import frame_of
from pipeline.tables.lake import ListedTows
from warehouse.archive.faults import Fault, fault_from
from warehouse.archive.index.tow_rows import Entry
from warehouse.archive.lists import tows as tow_list
from warehouse.archive.lists.boats import Boats
from warehouse.archive.profile.definition import Profiles
from warehouse.archive.sheets.reading import misfits
from warehouse.archive.sheets.row import (
    ROWS_ARE_EQUAL,
    ROWS_DIFFER,
    DefectiveRowError,
    all_of,
    others_of,
)
from warehouse.archive.spelling.text import shorten

T = TypeVar("T")


def keep(
    check: Callable[[Entry], None],
    entries: list[Entry],
    faults: list[Fault],
    more: list[Fault] | None = None,
) -> list[Entry]:
    """The entries that pass a check; the others leave a fault, and `more` of a row."""
    passed = []
    for entry in entries:
        try:
            check(entry)
        except BaseException as error:
            faults.append(fault_from(error, entry.list_path, entry.tow_id))
            if more is not None:
                more += [fault_from(e, entry.list_path, entry.tow_id) for e in others_of(error)]
        else:
            passed.append(entry)
    return passed


def unique_ids(entries: Iterable[Entry]) -> Callable[[Entry], None]:
    """The check that a row's `sleep_id` is its own."""
    by_id: dict[str, list[Entry]] = defaultdict(list)
    for entry in entries:
        if entry.tow_id is not None:
            by_id[entry.tow_id].append(entry)
    is_equal = {
        tow_id: all(other.row.cells == same[0].row.cells for other in same)
        for tow_id, same in by_id.items()
    }

    def check(entry: Entry) -> None:
        if entry.tow_id is None:
            return
        same, identical = by_id[entry.tow_id], is_equal[entry.tow_id]
        is_first = entry is same[0]
        if len(same) == 1 or (identical and is_first):
            return
        other = same[1] if is_first else same[0]
        message = say(
            "sleep_id {tow} is also on {where}; {ending}",
            tow=shorten(entry.tow_id or ""),
            where=other.where,
            ending=ROWS_ARE_EQUAL if identical else ROWS_DIFFER,
        )
        raise entry.row.fault(message, "duplicate_tow_id")

    return check


def read_cells(entry: Entry, profiles: Profiles) -> None:
    """Reads what the row itself says of the tow, without its files."""
    entry.row.check_whole()
    rate_hz = profiles.for_season(entry.season).sample_rate_hz
    read = all_of(
        {
            "tow": partial(tow_list.read_tow, entry.row, entry.season, rate_hz),
            "selection": partial(tow_list.read_selection, entry.row, entry.plan),
            "file": partial(entry.row.text, "file"),
        }
    )
    (entry.tow, entry.lost_cells), entry.selection = read["tow"], read["selection"]
    day = entry.tow["tow_date"]
    entry.row.check_year(day, entry.season, "date_outside_season")


def lost_cells(entry: Entry) -> Iterator[Fault]:
    """A fault for each cell that the tow does without."""
    for error in entry.lost_cells:
        fault = fault_from(error, entry.list_path, entry.tow_id)
        message = say("{what} The cell counts as empty.", what=fault.message)
        yield replace(fault, message=message, lost="cell")


def fits_table(entries: Iterable[Entry]) -> Callable[[Entry], None]:
    """The check that a tow lies within the limits of the table `tows`."""
    frame = frame_of(ListedTows, [entry.tow for entry in entries])
    why = {row["tow_id"]: sentence for row, sentence in misfits(ListedTows, frame)}

    def check(entry: Entry) -> None:
        if entry.tow_id in why:
            raise entry.row.fault(why[entry.tow_id], "bad_list_row")

    return check


def unique_samples(entries: Iterable[Entry]) -> Callable[[Entry], None]:
    """The check that a row's samples are its own, by content.

    A first file may be the second file of another tow of the same boat: that is how two tows are
    combined.
    """
    crews: dict[str, dict[tuple[int, str], Entry]] = defaultdict(dict)
    boats: dict[str, dict[str, Entry]] = defaultdict(dict)
    for entry in entries:
        crews[entry.tow["samples_sha256"]].setdefault(_crew(entry), entry)
        for sha256 in _contents(entry):
            boats[sha256].setdefault(entry.tow["fsn_no"], entry)

    def check(entry: Entry) -> None:
        sha256 = entry.tow["samples_sha256"]
        if sha256 == entry.tow["second_sha256"]:
            message = say("meetfile and meetfile2 hold the same samples.")
            raise entry.row.fault(message, "samples_listed_twice")
        boat = entry.tow["fsn_no"]
        strangers = chain(
            *(_of_others(boats[used], boat) for used in _contents(entry)),
            _of_others(crews[sha256], _crew(entry)),
        )
        if (stranger := next(strangers, None)) is not None:
            raise _listed_twice(entry, stranger)
        earliest = crews[sha256][_crew(entry)]
        if entry is not earliest:
            message = say(
                "'{path}' holds the samples that {where} uses already for {boat}.",
                path=entry.tow["samples_path"],
                where=earliest.where,
                boat=boat,
            )
            raise entry.row.fault(message, "duplicate_tow")

    return check


def _of_others(users: Mapping[T, Entry], own: T) -> Iterator[Entry]:
    """Gives the users of samples that are not this boat or crew."""
    return (user for key, user in users.items() if key != own)


def _contents(entry: Entry) -> list[str]:
    hashes = (entry.tow["samples_sha256"], entry.tow["second_sha256"])
    return [sha256 for sha256 in hashes if sha256 is not None]


def _crew(entry: Entry) -> tuple[int, str]:
    return entry.tow["rowers"], entry.tow["crew_class"]


def _listed_twice(entry: Entry, other: Entry) -> DefectiveInputError:
    boat, crew = other.tow["fsn_no"], f"{other.tow['rowers']}{other.tow['crew_class']}"
    message = say(
        "the samples are also used for {boat} {crew} on {where}; nobody can know whose they are.",
        boat=boat,
        crew=crew,
        where=other.where,
    )
    return entry.row.fault(message, "samples_listed_twice")


def join_boat(entry: Entry, boats: Boats) -> None:
    """Gives the tow its boat, with the sizes that were not written down that day."""
    fsn_no = entry.tow["fsn_no"]
    boat = boats.find(fsn_no)
    why = boats.bad.get(fsn_no) or (boats.unread if boat is None else None)
    if why is not None:
        message = say(
            "boat {boat} cannot be used, see {path}: {why}",
            boat=fsn_no,
            path=why.path,
            why=why.message,
        )
        raise entry.row.fault(message, why.reason_code)
    if boat is None:
        message = say("boat {boat} is not in the boat list.", boat=shorten(fsn_no))
        raise entry.row.fault(message, "unknown_boat")
    apart = tow_list.unlike_boat(entry.tow, boat, entry.row)
    weight = [apart.pop(key) for key in ("weight_kg",) if key in apart]
    if apart:
        raise DefectiveRowError([*apart.values(), *weight])
    entry.lost_cells = [*entry.lost_cells, *weight]
    entry.tow |= {"weight_kg": None} if weight else {}
    has_wind = "wind" not in entry.profiles.for_season(entry.season).absent
    filled = tow_list.fill_dimensions(entry.tow, boat, entry.row, has_wind)
    entry.tow = filled | {"fsn_no": boat["fsn_no"]}


def place_day(entry: Entry, profiles: Profiles) -> None:
    """Notes which logs were on board that day, unless it is set aside."""
    day = entry.tow["tow_date"]
    reason = profiles.reason_set_aside(day)
    if reason is not None:
        message = say("{day} is set aside in archief.toml: {reason}.", day=day, reason=reason)
        raise entry.row.fault(message, "day_set_aside")
    absent = profiles.for_season(entry.season).absent
    entry.tow |= {f"{channel}_measured": channel not in absent for channel in ("wind", "log2")}
    for log in ("log1", "log2"):
        entry.tow[f"{log}_part"] = profiles.part_of_log(log, day)
