"""Where the archive's files are: lists, samples, and what is neither.

No path leads outside the archive.
"""

import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Final

from pipeline.errors import MissingKnowledgeError
from pipeline.messages import say
from warehouse.archive.faults import DefectiveFileError
from warehouse.archive.files.list_kinds import LIST_KINDS
from warehouse.archive.files.names import (
    LIST_SUFFIXES,
    PROFILE_FILE,
    SAMPLES,
    STANDS_FOR,
    sample_suffix,
    split_sheet,
)

_NOT_OURS: Final = re.compile(
    r"~\$.*|thumbs\.db|desktop\.ini|readme.*|lees[ _]?mij.*|.*\.tdms_index", re.IGNORECASE
)
_SAMPLES_FOLDER: Final = re.compile(rf"{SAMPLES}(?:[ _-]*([0-9]{{4}}))?", re.IGNORECASE)
_LIST_FOLDERS: Final = frozenset(kind.folder for kind in LIST_KINDS)
STRANGER: Final = ""
"""Kind of a file or folder that nobody reads."""


@dataclass(frozen=True)
class ArchiveFile:
    """A file of the archive.

    Attributes:
        path: posix path relative to the archive; of a list also with its sheet.
        full_path: where it is.
        kind: the name of a kind of lists, `SAMPLES`, the profile's name, or `STRANGER`.
        season: the year in its name or in the name of its folder; 0 where neither tells it.
        inside: it lies in the archive and not, through a link, outside.
    """

    path: str
    full_path: Path
    kind: str
    season: int
    inside: bool


def files_of(root: Path, named: Mapping[str, str]) -> list[ArchiveFile]:
    """The files of an archive, and the folders in it that nobody reads, by their path.

    Lists are `<folder>/<name>_<jaar>` with a suffix of lists; samples are
    `meetdata_<jaar>/<meetfile>` with a suffix of samples, also in a folder of their own,
    `meetdata_<jaar>/<meetfile>/`. Hidden files are left out.

    Args:
        root: the archive.
        named: what other files, sheets and folders stand for, by their path (`[files]`).

    Raises:
        MissingKnowledgeError: a list is a folder, a pipe or a link to nothing.
    """
    stands_for = {path: m for path, name in named.items() if (m := STANDS_FOR.fullmatch(name))}
    places = _folders(root, stands_for)
    known = {*places, *(root / split_sheet(path)[0] for path in named)}
    found: dict[str, tuple[str, int]] = {}
    for folder, (name, season) in places.items():
        for entry in _files_of_tows(folder) if name == SAMPLES else _entries(folder):
            kind = _kind_in(name, season, entry)
            of_entry = {_path_in(root, entry): kind} if kind else _strangers(root, entry, known)
            found |= {path: of for path, of in of_entry.items() if path not in named}
    for entry in _entries(root):
        is_profile = entry.name.casefold() == PROFILE_FILE
        profile = {entry.name: (PROFILE_FILE, 0)}
        found |= profile if is_profile else _strangers(root, entry, known)
    for path, match in stands_for.items():
        if match[1] != SAMPLES and (root / split_sheet(path)[0]).is_file():
            found[path] = match[1], int(match[2] or 0)
    return [_archive_file(root, path, *found[path]) for path in sorted(found)]


def _folders(root: Path, stands_for: Mapping[str, re.Match[str]]) -> dict[Path, tuple[str, int]]:
    """The folders of lists and of samples, each with its name and season."""
    folders: dict[Path, tuple[str, int]] = {}
    for entry in _entries(root):
        name, match = entry.name.casefold(), _SAMPLES_FOLDER.fullmatch(entry.name)
        if match and entry.is_dir():
            folders[entry] = SAMPLES, int(match[1] or 0)
        elif name in _LIST_FOLDERS and (name, 0) not in folders.values():
            folders[entry] = name, 0
    for path, match in stands_for.items():
        if match[1] == SAMPLES:
            folders[root / path] = SAMPLES, int(match[2] or 0)
    return folders


def _kind_in(folder: str, season: int, entry: Path) -> tuple[str, int] | None:
    """The kind of a file in a folder, and its season; None for a stranger.

    Raises:
        MissingKnowledgeError: it is a list by its name, but it is no file.
    """
    if folder == SAMPLES:
        is_samples = sample_suffix(entry.name) and not _NOT_OURS.fullmatch(entry.name)
        return (SAMPLES, season) if is_samples else None
    stem, dot, suffix = entry.name.rpartition(".")
    for kind in LIST_KINDS if (dot + suffix).casefold() in LIST_SUFFIXES else ():
        match = re.fullmatch(kind.pattern, stem, re.IGNORECASE)
        if kind.folder == folder and match:
            if not entry.is_file():
                raise MissingKnowledgeError(
                    "{} is no file; remove it, or put the file there", entry
                )
            return kind.name, int(match[1] or 0)
    return None


def _strangers(root: Path, entry: Path, known: set[Path]) -> dict[str, tuple[str, int]]:
    """An entry that nobody reads, or what is in it where something in it is known."""
    if entry in known or _NOT_OURS.fullmatch(entry.name):
        return {}
    if not any(path.is_relative_to(entry) for path in known):
        return {_path_in(root, entry): (STRANGER, 0)}
    inner = (_strangers(root, child, known) for child in _entries(entry))
    return {path: kind for found in inner for path, kind in found.items()}


def _path_in(root: Path, entry: Path) -> str:
    return entry.relative_to(root).as_posix()


def _files_of_tows(folder: Path) -> Iterator[Path]:
    for entry in _entries(folder):
        if entry.is_dir() and not entry.is_symlink():
            yield from _entries(entry)
        else:
            yield entry


def _entries(folder: Path) -> list[Path]:
    if not folder.is_dir():
        return []
    return sorted(
        entry
        for entry in folder.iterdir()
        if not entry.name.startswith(".") and _can_be_written(entry.name)
    )


def _can_be_written(name: str) -> bool:
    """Whether a name is text; one made under another encoding can hold bytes that are none."""
    try:
        name.encode()
    except UnicodeEncodeError:
        return False
    return True


def list_misnamed(root: Path) -> list[str]:
    """Files and folders that are not read as their names are not text; `?` marks what is not."""
    misnamed = (
        Path(folder, name)
        for folder, folders, files in os.walk(root)
        for name in (*folders, *files)
        if not _can_be_written(name)
    )
    return sorted(os.fsencode(_path_in(root, path)).decode(errors="replace") for path in misnamed)


def _archive_file(root: Path, path: str, kind: str, season: int) -> ArchiveFile:
    full = root / split_sheet(path)[0]
    return ArchiveFile(path, full, kind, season, _is_inside(root, full) and full.is_file())


def path_inside(root: Path, relative: str) -> Path:
    """The full path of a file of the archive, with its sheet where it has one.

    Raises:
        DefectiveInputError: `path_outside_archive`.
    """
    pure = PurePosixPath(split_sheet(relative)[0])
    if pure.is_absolute() or ".." in pure.parts or not _is_inside(root, root / pure):
        raise outside_archive(relative)
    return root / relative


def _is_inside(root: Path, full: Path) -> bool:
    try:
        return full.resolve().is_relative_to(root.resolve())
    except (RuntimeError, OSError):  # a link to itself
        return False


def outside_archive(relative: str) -> DefectiveFileError:
    """The error for a path that leaves the archive."""
    return DefectiveFileError(
        "path_outside_archive",
        say("'{path}' leads outside the archive, where nothing is read.", path=relative),
        None,
        relative,
    )
