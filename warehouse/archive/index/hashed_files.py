"""The hashes of all files that were looked at, each file once."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path

from pipeline.errors import DefectiveInputError
from pipeline.messages import say
from pipeline.tables.declare import dy
from pipeline.tables.frames import frame_of
from pipeline.tables.lake import ListedFiles
from warehouse.archive.faults import DefectiveFileError, Fault, fault_from
from warehouse.archive.files.finding import ArchiveFile, list_files
from warehouse.archive.files.hashes import hash_of_parts, hash_of_sheet
from warehouse.archive.files.list_kinds import LIST_KINDS
from warehouse.archive.files.names import PROFILE_FILE, split_sheet
from warehouse.archive.index.tow_files import SamplesFile


class Hashes:
    """The hashes of the files looked at, each file once."""

    def __init__(self, hash_file: Callable[[Path], str]) -> None:
        self._hash_file = hash_file
        self.rows: dict[str, tuple[str, int]] = {}

    def add(self, path: str, full_path: Path) -> str:
        """The hash of a file, which is noted as looked at.

        Raises:
            DefectiveInputError: `unreadable_file`.
        """
        if path not in self.rows:
            try:
                size = Path(split_sheet(str(full_path))[0]).stat().st_size
                self.rows[path] = (hash_of_sheet(self._hash_file, full_path), size)
            except OSError as error:
                raise DefectiveFileError(
                    "unreadable_file",
                    say(
                        "'{name}' cannot be read or unpacked: {error}.",
                        name=path,
                        error=error.strerror,
                    ),
                    None,
                    path,
                ) from error
        return self.rows[path][0]

    def add_samples(self, file: SamplesFile) -> str:
        """The hash of samples, of several files one of their hashes."""
        sha256 = hash_of_parts([self.add(part.path, part.full_path) for part in file.parts])
        self.rows[file.path] = (sha256, sum(self.rows[part.path][1] for part in file.parts))
        return sha256

    def frame(self) -> dy.DataFrame[ListedFiles]:
        """Every file looked at."""
        rows = [(path, *self.rows[path]) for path in sorted(self.rows)]
        return frame_of(ListedFiles, rows)


def hash_lists(root: Path, named: Mapping[str, str], hashes: Hashes) -> list[Fault]:
    """Hash the profile and every list; return a fault for each that cannot be read."""
    if (root / PROFILE_FILE).is_file():
        hashes.add(PROFILE_FILE, root / PROFILE_FILE)
    lists = (file for kind in LIST_KINDS for file in list_files(root, kind, named))
    return list(hash_files(lists, hashes))


def hash_files(files: Iterable[ArchiveFile], hashes: Hashes) -> Iterator[Fault]:
    """Hash the files that lie inside the archive; give a fault for each that cannot be read."""
    for file in files:
        try:
            if file.inside:
                hashes.add(file.path, file.full_path)
        except DefectiveInputError as error:
            yield fault_from(error, file.path)
