"""The federation's archive of plain files: the only place that reads it.

`index_archive` says what is there, `read_tow_samples` and `judge_in_files` read one tow.
Everything that cannot be used becomes a `Fault` with a reason code; the format and the codes are
described in `docs/archive.md`.
"""

from herijk.warehouse.archive.faults import DefectiveFileError, Fault, fault_from
from herijk.warehouse.archive.hashes import FileHashes
from herijk.warehouse.archive.index import ArchiveIndex, index_archive
from herijk.warehouse.archive.plausibility import judge_in_files
from herijk.warehouse.archive.profile import Profiles, SeasonProfile, SetAside
from herijk.warehouse.archive.published import read_published_registers, read_races
from herijk.warehouse.archive.samples import read_samples, read_tow_samples
from herijk.warehouse.archive.windows import outside_run

__all__ = [
    "ArchiveIndex",
    "DefectiveFileError",
    "Fault",
    "FileHashes",
    "Profiles",
    "SeasonProfile",
    "SetAside",
    "fault_from",
    "index_archive",
    "judge_in_files",
    "outside_run",
    "read_published_registers",
    "read_races",
    "read_samples",
    "read_tow_samples",
]
