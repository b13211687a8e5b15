"""The federation's archive of plain files: the only place that reads it.

`index_archive` says what is there, `read_tow_samples` and `judge_samples` read one tow.
Everything that cannot be used becomes a `Fault` with a reason code; the format and the codes are
described in `docs/archive.md`.
"""

from warehouse.archive.faults import Failure, Fault, make_fault
from warehouse.archive.files import FileHashes
from warehouse.archive.index import ArchiveIndex, index_archive, list_archive_files
from warehouse.archive.list_rules import read_published_registers, read_races
from warehouse.archive.plausibility import judge_samples
from warehouse.archive.profile import Profiles, SeasonProfile
from warehouse.archive.samples import read_tow_samples

__all__ = [
    "ArchiveIndex",
    "Failure",
    "Fault",
    "FileHashes",
    "Profiles",
    "SeasonProfile",
    "index_archive",
    "judge_samples",
    "list_archive_files",
    "make_fault",
    "read_published_registers",
    "read_races",
    "read_tow_samples",
]
