"""A row of a tow list on its way to becoming a tow."""

from dataclasses import dataclass, field

from pipeline.errors import DefectiveInputError
from pipeline.tables.row import Row
from warehouse.archive.faults import place
from warehouse.archive.files.finding import ArchiveFile
from warehouse.archive.files.names import PARTS
from warehouse.archive.profile.definition import Profiles
from warehouse.archive.profile.plan import Plan
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
