"""Where the archive's files are, and reading their bytes within bounds.

Knows folder names, safe paths and compression; not what stands in a file.
"""

import hashlib
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
from herijk.warehouse.archive.messages import say
from herijk.warehouse.archive.text import fold_name

BOATS_FILE: Final = "sloepregister/sloependata.csv"
_LIST: Final = r"\.(?:csv|txt|tsv|xlsx|xlsm|xls|ods)"
BOATS_PATTERN: Final = r"sloependata" + _LIST
TOW_LIST_PATTERN: Final = r"sleeplijst[ _-]*([0-9]{4})" + _LIST
WINDOWS_PATTERN: Final = r"vensters[ _-]*([0-9]{4})" + _LIST
FORCE_CHECKS_PATTERN: Final = r"krachtijkingen[ _-]*([0-9]{4})" + _LIST
LAMPS_PATTERN: Final = r"lampjes[ _-]*([0-9]{4})" + _LIST
REGISTER_PATTERN: Final = r"sloepregister[ _-]*([0-9]{4})" + _LIST
RACES_PATTERN: Final = r".+?[ _-]*([0-9]{4})" + _LIST
TEXT_SUFFIXES: Final = (".csv", ".txt", ".tsv", ".dat", ".asc", ".lvm")
SAMPLE_SUFFIXES: Final = (
    *(text + packed for packed in (".gz", ".zst") for text in TEXT_SUFFIXES),
    *(*TEXT_SUFFIXES, ".parquet", ".tdms"),
)
PARTS: Final = " | "
"""Between the paths of files that are a run each; no file's name can hold it in Windows."""
_NOT_OURS: Final = re.compile(
    r"~\$.*|thumbs\.db|desktop\.ini|readme.*|lees[ _]?mij.*|.*\.tdms_index", re.IGNORECASE
)
_ONE_RUN: Final = re.compile(
    r"(.*?[^0-9])[ _.-]*(?:run|vaart|lauf|r)?[ _.-]*([0-9]{1,2})", re.IGNORECASE
)
PROFILE_FILE: Final = "archief.toml"

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
    matches = ((entry, pattern.fullmatch(entry.name)) for entry in _entries_of(root, folder))
    return [
        _archive_file(root, entry, int(match[1]))
        for entry, match in matches
        if match is not None and (entry.is_file() or entry.is_symlink())
    ]


def list_sample_files(root: Path) -> list[ArchiveFile]:
    """Return all samples files: `meetdata_<jaar>/<meetfile>` with a suffix of samples.

    Those in a folder of their own, `meetdata_<jaar>/<meetfile>/`, come too.
    """
    return [
        _archive_file(root, entry, season)
        for season, folder in _sample_folders(root)
        for entry in _files_of_tows(folder)
        if sample_suffix(entry.name)
    ]


def list_strangers(root: Path) -> list[str]:
    """Return the files of an archive that nobody reads, relative to it."""
    lists = {
        "sleeplijsten": "|".join(
            (TOW_LIST_PATTERN, WINDOWS_PATTERN, FORCE_CHECKS_PATTERN, LAMPS_PATTERN)
        ),
        "sloepregister": f"{BOATS_PATTERN}|{REGISTER_PATTERN}",
        "wedstrijden": RACES_PATTERN,
    }
    found = [
        entry
        for folder, known in lists.items()
        for entry in _entries_of(root, folder)
        if not re.fullmatch(known, entry.name, re.IGNORECASE)
    ]
    for _, folder in _sample_folders(root):
        found += [entry for entry in _files_of_tows(folder) if not sample_suffix(entry.name)]
    known_folders = {*(_find_folder(root, name) for name in lists)}
    known_folders |= {folder for _, folder in _sample_folders(root)}
    found += [
        entry
        for entry in _entries(root)
        if entry not in known_folders and entry.name.casefold() != PROFILE_FILE
    ]
    return [e.relative_to(root).as_posix() for e in found if not _NOT_OURS.fullmatch(e.name)]


def find_boats_file(root: Path) -> str | None:
    """Return the path of the boat list, whatever kind of file it is; None when there is none."""
    found = [
        entry.relative_to(root).as_posix()
        for entry in _entries_of(root, "sloepregister")
        if re.fullmatch(BOATS_PATTERN, entry.name, re.IGNORECASE)
    ]
    return found[0] if found else None


def _sample_folders(root: Path) -> Iterator[tuple[int, Path]]:
    for entry in _entries(root):
        match = re.fullmatch(r"meetdata[ _-]*([0-9]{4})", entry.name, re.IGNORECASE)
        if match and entry.is_dir():
            yield int(match[1]), entry


def _files_of_tows(folder: Path) -> Iterator[Path]:
    for entry in _entries(folder):
        if entry.is_dir() and not entry.is_symlink():
            yield from _entries(entry)
        else:
            yield entry


def _entries_of(root: Path, folder: str) -> list[Path]:
    return _entries(_find_folder(root, folder))


def _find_folder(root: Path, name: str) -> Path:
    """Return a folder, however its name is capitalised."""
    alike = [entry for entry in _entries(root) if entry.name.casefold() == name]
    return alike[0] if alike else root / name


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


def as_one_run(name: str) -> tuple[str, int] | None:
    """Return the tow and the run that the name of a samples file says, None where it says none.

    `snol 8h 2014 run 3.csv`, `snol 8h 2014_3.lvm` and `snol 8h 2014 r03.txt` are run 3 of
    `snol 8h 2014`.
    """
    key = match_key(name)
    match = _ONE_RUN.fullmatch(key)
    if match:
        return match[1].strip(" _.-"), int(match[2])
    number = re.fullmatch(r"(?:run|vaart|lauf|r)?[ _.-]*([0-9]{1,2})", key)
    return ("", int(number[1])) if number else None


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
        say("'{path}' leads outside the archive, where nothing is read.", path=relative),
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
        said = say("'{name}' is not there any more.", name=path.name)
        raise DefectiveInputError("samples_missing", said) from error
    except (OSError, pa.ArrowException) as error:
        said = say("'{name}' cannot be read or unpacked: {error}.", name=path.name, error=error)
        raise DefectiveInputError("unreadable_file", said) from error
    if len(content) > max_bytes:
        raise too_large(path, max_bytes)
    check_rows(content)
    return content


def read_start(path: Path, most: int) -> bytes:
    """Return the first bytes of a file, unpacked, up to a whole line where there is one.

    Raises:
        DefectiveInputError: `unreadable_file`.
    """
    compression = _COMPRESSION.get(path.suffix.casefold())
    try:
        with path.open("rb") as raw:
            if compression is None:
                content = raw.read(most)
            else:
                with pa.CompressedInputStream(pa.PythonFile(raw, mode="r"), compression) as stream:
                    content = stream.read(most)
    except (OSError, pa.ArrowException) as error:
        said = say("'{name}' cannot be read or unpacked: {error}.", name=path.name, error=error)
        raise DefectiveInputError("unreadable_file", said) from error
    is_utf16 = b"\x00" in content[:100]
    return bytes(content if is_utf16 else content[: content.rfind(b"\n") + 1] or content)


def hash_of_parts(hashes: list[str]) -> str:
    """Return one hash of several files from theirs, in their order."""
    return hashlib.sha256("\n".join(hashes).encode()).hexdigest()


def kind_of(path: Path) -> str:
    """Return the suffix of a file as it is unpacked, in lower case: `.csv` of `x.csv.gz`."""
    name = path.name.casefold()
    for packed in _COMPRESSION:
        name = name.removesuffix(packed)
    return name[name.rfind(".") :]


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
        say(
            "'{name}' holds more than {limit:.0f} MB, unpacked; a samples file is about 12 MB.",
            name=path.name,
            limit=max_bytes / 1e6,
        ),
    )
