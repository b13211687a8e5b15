"""Where the archive's files are, and reading their bytes within bounds.

Knows folder names, safe paths and compression; not what stands in a file.
"""

import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import IO, Final

import pyarrow as pa  # type: ignore[import-untyped]

from herijk.pipeline.errors import DefectiveInputError
from herijk.warehouse.archive.faults import DefectiveFileError
from herijk.warehouse.archive.limits import check_rows
from herijk.warehouse.archive.text import fold_name

BOATS_FILE: Final = "sloepregister/sloependata.csv"
TOW_LIST_PATTERN: Final = r"sleeplijst_([0-9]{4})\.csv"
WINDOWS_PATTERN: Final = r"vensters_([0-9]{4})\.csv"
REGISTER_PATTERN: Final = r"sloepregister_([0-9]{4})\.csv"
RACES_PATTERN: Final = r".+_([0-9]{4})\.csv"
SAMPLE_SUFFIXES: Final = (".csv.gz", ".csv.zst", ".csv", ".parquet")
"""A tow of 300,000 samples is 12 MB of text."""

_CHUNK_BYTES: Final = 1 << 20
_COMPRESSION: Final = {".gz": "gzip", ".zst": "zstd"}


@dataclass(frozen=True)
class ArchiveFile:
    """A file of the archive.

    Attributes:
        path: posix path relative to the archive.
        full_path: where it is.
        season: the year in its name or in the name of its folder.
        inside: it lies in the archive and not, through a link, outside.
    """

    path: str
    full_path: Path
    season: int
    inside: bool


def list_files(root: Path, folder: str, name_pattern: str) -> list[ArchiveFile]:
    """Return the files of a folder whose name matches; group 1 of the pattern is the season.

    Hidden files are left out. The order is that of the names.
    """
    pattern = re.compile(name_pattern, re.IGNORECASE)
    matches = ((entry, pattern.fullmatch(entry.name)) for entry in _entries(root / folder))
    return [
        _archive_file(root, entry, int(match[1]))
        for entry, match in matches
        if match is not None and (entry.is_file() or entry.is_symlink())
    ]


def list_sample_files(root: Path) -> list[ArchiveFile]:
    """Return all samples files: `meetdata_<jaar>/<meetfile>` with a suffix of samples."""
    return [
        _archive_file(root, entry, season)
        for season, folder in _sample_folders(root)
        for entry in _entries(folder)
        if sample_suffix(entry.name) and (entry.is_file() or entry.is_symlink())
    ]


def list_strangers(root: Path, folder: str, known_pattern: str) -> list[str]:
    """Return the CSV files of a folder whose name does not match, relative to the archive."""
    pattern = re.compile(known_pattern, re.IGNORECASE)
    return [
        entry.relative_to(root).as_posix()
        for entry in _entries(root / folder)
        if entry.name.casefold().endswith(".csv") and not pattern.fullmatch(entry.name)
    ]


def _sample_folders(root: Path) -> Iterator[tuple[int, Path]]:
    for entry in _entries(root):
        match = re.fullmatch(r"meetdata_([0-9]{4})", entry.name, re.IGNORECASE)
        if match and entry.is_dir():
            yield int(match[1]), entry


def _entries(folder: Path) -> list[Path]:
    if not folder.is_dir():
        return []
    return sorted(entry for entry in folder.iterdir() if not entry.name.startswith("."))


def _archive_file(root: Path, entry: Path, season: int) -> ArchiveFile:
    inside = entry.resolve().is_relative_to(root.resolve()) and entry.is_file()
    return ArchiveFile(entry.relative_to(root).as_posix(), entry, season, inside)


def sample_suffix(name: str) -> str:
    """Return the suffix of a samples file, in lower case; empty when it is none."""
    folded = name.casefold()
    return next((suffix for suffix in SAMPLE_SUFFIXES if folded.endswith(suffix)), "")


def match_key(name: str) -> str:
    """Return the name of a samples file for comparing: folded, without suffix."""
    folded = fold_name(name)
    return folded.removesuffix(sample_suffix(folded)).strip()


def path_inside(root: Path, relative: str) -> Path:
    """Return the full path of a file of the archive.

    Raises:
        DefectiveInputError: `path_outside_archive`.
    """
    pure = PurePosixPath(relative)
    full = root / pure
    if pure.is_absolute() or ".." in pure.parts or not _is_inside(root, full):
        raise outside_archive(relative)
    return full


def _is_inside(root: Path, full: Path) -> bool:
    return full.resolve().is_relative_to(root.resolve())


def outside_archive(relative: str) -> DefectiveFileError:
    """Return the error for a path that leaves the archive."""
    return DefectiveFileError(
        "path_outside_archive",
        f"'{relative}' leads outside the archive, where nothing is read.",
        None,
        relative,
    )


def read_bytes(path: Path, max_bytes: int) -> bytes:
    """Return the content of a file, unpacked when it is `.gz` or `.zst`.

    It is unpacked in pieces and never beyond `max_bytes`, so a small file that unpacks to
    gigabytes does no harm.

    Raises:
        DefectiveInputError: `too_large`, `samples_missing` or `unreadable_file`.
    """
    compression = _COMPRESSION.get(path.suffix.casefold())
    try:
        with path.open("rb") as raw:
            if compression is None:
                content = raw.read(min(os.fstat(raw.fileno()).st_size, max_bytes) + 1)
            else:
                content = _unpack(raw, compression, max_bytes)
    except FileNotFoundError as error:
        raise DefectiveInputError(
            "samples_missing", f"'{path.name}' is not there any more."
        ) from error
    except (OSError, pa.ArrowException) as error:
        raise DefectiveInputError(
            "unreadable_file", f"'{path.name}' cannot be read or unpacked: {error}."
        ) from error
    if len(content) > max_bytes:
        raise too_large(path, max_bytes)
    check_rows(content)
    return content


def _unpack(raw: IO[bytes], compression: str, max_bytes: int) -> bytes:
    pieces: list[bytes] = []
    size = 0
    with pa.CompressedInputStream(pa.PythonFile(raw, mode="r"), compression) as stream:
        while size <= max_bytes and (piece := stream.read(_CHUNK_BYTES)):
            pieces.append(piece)
            size += len(piece)
    return b"".join(pieces)


def too_large(path: Path, max_bytes: int) -> DefectiveInputError:
    """Return the error for a file that holds more than `max_bytes`."""
    return DefectiveInputError(
        "too_large",
        f"'{path.name}' holds more than {max_bytes / 1e6:.0f} MB, unpacked; "
        "a samples file is about 12 MB.",
    )
