"""The hashes of all files that were looked at, each file once."""

from collections.abc import Callable, Iterable
from pathlib import Path

from pipeline.messages import say
from pipeline.tables.declare import dy
from pipeline.tables.frames import frame_of
from pipeline.tables.lake import ListedFiles
from warehouse.archive.faults import DefectiveFileError
from warehouse.archive.files.finding import ArchiveFile
from warehouse.archive.files.hashes import hash_of_parts, hash_of_sheet
from warehouse.archive.files.names import split_sheet
from warehouse.archive.index.tow_files import SamplesFile

Hashes = dict[str, tuple[str, int] | DefectiveFileError]
"""SHA-256 and size in bytes of a file, or why it cannot be read, by its path in the archive."""


def hash_files(files: Iterable[ArchiveFile], hash_file: Callable[[Path], str]) -> Hashes:
    """The hashes of the files that lie inside the archive."""
    return {file.path: _hash(file, hash_file) for file in files if file.inside}


def _hash(
    file: ArchiveFile, hash_file: Callable[[Path], str]
) -> tuple[str, int] | DefectiveFileError:
    path = Path(split_sheet(str(file.full_path))[0])
    try:
        return hash_file(path), path.stat().st_size
    except OSError as error:
        text = say(
            "'{name}' cannot be read or unpacked: {error}.", name=file.path, error=error.strerror
        )
        return DefectiveFileError("unreadable_file", text, None, file.path)


def hash_samples(file: SamplesFile, hashes: Hashes) -> str:
    """The hash of samples, which is noted too; of several files one of their hashes.

    Raises:
        DefectiveFileError: `unreadable_file`.
    """
    known = []
    for part in file.parts:
        book, sheet = split_sheet(part.path)
        found = hashes[book]
        if isinstance(found, DefectiveFileError):
            raise found
        known.append((hash_of_sheet(found[0], sheet), found[1]))
        hashes[part.path] = known[-1]
    sha256 = hash_of_parts([sha256 for sha256, _ in known])
    hashes[file.path] = sha256, sum(size for _, size in known)
    return sha256


def as_files(hashes: Hashes) -> dy.DataFrame[ListedFiles]:
    """Every file that was read."""
    read = ((path, *h) for path, h in sorted(hashes.items()) if isinstance(h, tuple))
    return frame_of(ListedFiles, read)
