"""The rows of all tow lists on their way to becoming tows."""

import datetime as dt
from dataclasses import dataclass, field
from pathlib import Path

from pipeline.errors import DefectiveInputError
from pipeline.messages import say
from pipeline.tables.row import Row
from warehouse.archive.faults import Fault, fault_from, place
from warehouse.archive.files.finding import ArchiveFile, list_files
from warehouse.archive.files.list_kinds import TOWS
from warehouse.archive.files.names import PARTS, PROFILE_FILE
from warehouse.archive.lists import tows as tow_list
from warehouse.archive.profile.definition import Profiles
from warehouse.archive.profile.season import Plan
from warehouse.archive.sheets.reading import read_list
from warehouse.archive.sheets.row import ListRow


@dataclass(frozen=True)
class SamplesFile:
    """The samples that a name in a list stands for: a file, or one for every run.

    Attributes:
        parts: the files, in the order of their runs.
    """

    parts: tuple[ArchiveFile, ...]

    @property
    def path(self) -> str:
        """Path relative to the archive; of several files with `PARTS` between them."""
        return PARTS.join(part.path for part in self.parts)


@dataclass
class Entry:
    """A row of a tow list on its way to becoming a tow."""

    row: ListRow
    list_path: str
    season: int
    profiles: Profiles
    files: list[SamplesFile] = field(default_factory=list)
    tow: Row = field(default_factory=dict)
    selection: frozenset[int] = frozenset()
    lost_cells: list[DefectiveInputError] = field(default_factory=list)

    @property
    def tow_id(self) -> str | None:
        """Its `sleep_id`, None where the cell is empty."""
        return self.row.optional_text("tow_id")

    @property
    def plan(self) -> Plan:
        """The runs that it is meant to have."""
        return self.profiles.plan_of(self.tow_id or "", self.season)

    @property
    def where(self) -> str:
        """Where it is listed, for a sentence."""
        return place(self.row.line, self.list_path)


def read_tow_lists(
    root: Path, profiles: Profiles, faults: list[Fault]
) -> tuple[list[Entry], set[int]]:
    """The rows of all tow lists, and the seasons of lists that cannot be read."""
    entries: list[Entry] = []
    unread_seasons: set[int] = set()
    for file in list_files(root, TOWS, profiles.wording.files):
        try:
            rows = read_list(root, TOWS, file.path, profiles.wording)
        except BaseException as error:
            faults.append(fault_from(error, file.path))
            unread_seasons.add(file.season)
            continue
        entries += [
            Entry(row, file.path, file.season or _year_of(row), profiles)
            for row in tow_list.with_ids(rows)
        ]
    return entries, unread_seasons


def _year_of(row: ListRow) -> int:
    """The season of a row in a list of all years; 0 where its date cannot be read."""
    day = _day_of(row)
    return 0 if day is None else day.year


def _day_of(row: ListRow) -> dt.date | None:
    try:
        return row.date("tow_date")
    except DefectiveInputError:
        return None


def idle_settings(profiles: Profiles, entries: list[Entry]) -> list[Fault]:
    """What `archief.toml` says of days, seasons or tows that no list has: mistyped ones."""
    days = {_day_of(entry.row) for entry in entries}
    seasons = {entry.season for entry in entries}
    tows = {entry.tow_id for entry in entries}
    idle = [
        *(("set_aside", str(one.date)) for one in profiles.set_aside if one.date not in days),
        *(
            ("log_replaced", str(one.date))
            for one in profiles.log_replaced
            if one.date.year not in seasons
        ),
        *(("plan", tow) for plan in profiles.plan for tow in plan.tows if tow not in tows),
        *(
            (name, f"{first}:{last}")
            for name, (first, last) in profiles.season_ranges
            if not any(first <= season <= last for season in seasons)
        ),
    ]
    message = say("[[{table}]] is for {what}, and no tow list has that: is it mistyped?")
    return [
        Fault(PROFILE_FILE, None, None, "idle_setting", say(message, table=table, what=what))
        for table, what in idle
    ]
