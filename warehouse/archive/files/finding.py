"""Where the archive's files are: folders, lists, samples, and what is neither.

No path leads outside the archive.
"""

import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath
from typing import Final

from pipeline.errors import MissingKnowledgeError
from pipeline.messages import say
from warehouse.archive.faults import DefectiveFileError
from warehouse.archive.files.list_kinds import LIST_KINDS, ListKind
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


def list_files(root: Path, kind: ListKind, named: Mapping[str, str]) -> list[ArchiveFile]:
    """The lists of a kind; season 0 where the name does not tell it.

    Hidden files are left out. The order is that of the names.

    Raises:
        MissingKnowledgeError: one is a folder, a pipe or a link to nothing.

    Args:
        root: the archive.
        kind: which lists.
        named: what other files, sheets and folders stand for, by their path (`[files]`).
    """
    matches = [(e, m) for e in _entries_of(root, kind.folder) if (m := _match_list(kind, e.name))]
    for entry, _ in matches:
        if not entry.is_file():
            raise MissingKnowledgeError("{} is no file; remove it, or put the file there", entry)
    files = [_archive_file(root, entry, int(match[1] or 0)) for entry, match in matches]
    for path, name, season in _named(named):
        file = root / split_sheet(path)[0]
        if name == kind.name and file.is_file():
            files.append(replace(_archive_file(root, file, season), path=path))
    return sorted(files, key=lambda file: file.path)


def _match_list(kind: ListKind, name: str) -> re.Match[str] | None:
    stem, dot, suffix = name.rpartition(".")
    is_list = (dot + suffix).casefold() in LIST_SUFFIXES
    return re.fullmatch(kind.pattern, stem, re.IGNORECASE) if is_list else None


def _named(named: Mapping[str, str]) -> Iterator[tuple[str, str, int]]:
    """Gives path, kind and season (0 for none) of what `[files]` names."""
    for path, stands_for in sorted(named.items()):
        if match := STANDS_FOR.fullmatch(stands_for):
            yield path, match[1], int(match[2] or 0)


def list_sample_files(root: Path, named: Mapping[str, str]) -> list[ArchiveFile]:
    """All samples files: `meetdata_<jaar>/<meetfile>` with a suffix of samples.

    Those in a folder of their own, `meetdata_<jaar>/<meetfile>/`, come too. Season 0 are those of
    a folder without a year.
    """
    return [
        _archive_file(root, entry, season)
        for season, folder in _sample_folders(root, named)
        for entry in _files_of_tows(folder)
        if sample_suffix(entry.name)
        and _path_in(root, entry) not in named
        and not _NOT_OURS.fullmatch(entry.name)
    ]


def list_strangers(root: Path, named: Mapping[str, str]) -> list[str]:
    """The files and folders of an archive that nobody reads, relative to it."""
    folders = {kind.folder: _find_folder(root, kind.folder) for kind in LIST_KINDS}
    strangers = [
        entry
        for name, folder in folders.items()
        for entry in _entries(folder)
        if not any(_match_list(k, entry.name) for k in LIST_KINDS if k.folder == name)
    ]
    sample_folders = {folder for _, folder in _sample_folders(root, named)}
    for folder in sample_folders:
        strangers += [entry for entry in _files_of_tows(folder) if not sample_suffix(entry.name)]
    known = {*folders.values(), *sample_folders, *(root / split_sheet(path)[0] for path in named)}
    strangers += [
        entry
        for entry in _entries(root)
        if entry not in known and entry.name.casefold() != PROFILE_FILE
    ]
    opened = [inner for entry in strangers for inner in _opened(entry, known)]
    return [_path_in(root, e) for e in opened if not _NOT_OURS.fullmatch(e.name)]


def _opened(entry: Path, known: set[Path]) -> list[Path]:
    """An entry, or what is in it where something in it is known under `[files]`."""
    if entry in known:
        return []
    if not any(path.is_relative_to(entry) for path in known):
        return [entry]
    return [inner for child in _entries(entry) for inner in _opened(child, known)]


def _path_in(root: Path, entry: Path) -> str:
    return entry.relative_to(root).as_posix()


def _sample_folders(root: Path, named: Mapping[str, str]) -> Iterator[tuple[int, Path]]:
    for entry in _entries(root):
        match = re.fullmatch(rf"{SAMPLES}(?:[ _-]*([0-9]{{4}}))?", entry.name, re.IGNORECASE)
        if match and entry.is_dir():
            yield int(match[1] or 0), entry
    for path, name, season in _named(named):
        if name == SAMPLES and (root / path).is_dir():
            yield season, root / path


def _files_of_tows(folder: Path) -> Iterator[Path]:
    for entry in _entries(folder):
        if entry.is_dir() and not entry.is_symlink():
            yield from _entries(entry)
        else:
            yield entry


def _entries_of(root: Path, folder: str) -> list[Path]:
    return _entries(_find_folder(root, folder))


def _find_folder(root: Path, name: str) -> Path:
    """A folder, however its name is capitalised."""
    alike = [entry for entry in _entries(root) if entry.name.casefold() == name]
    return alike[0] if alike else root / name


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


def list_profile(root: Path) -> list[ArchiveFile]:
    """`archief.toml`, where it is there."""
    path = root / PROFILE_FILE
    return [_archive_file(root, path, 0)] if path.is_file() else []


def _archive_file(root: Path, entry: Path, season: int) -> ArchiveFile:
    inside = _is_inside(root, entry) and entry.is_file()
    return ArchiveFile(entry.relative_to(root).as_posix(), entry, season, inside)


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
