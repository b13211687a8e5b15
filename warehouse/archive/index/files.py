"""The files of an archive: which are not read or not there, their hashes, and which rows mean."""

from collections import defaultdict
from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass, replace
from pathlib import Path

import polars as pl

from pipeline.errors import MissingKnowledgeError
from pipeline.messages import say
from pipeline.tables.declare import dy
from pipeline.tables.frames import frame_of
from pipeline.tables.lake import ListedFiles
from warehouse.archive.faults import DefectiveFileError, Fault, fault_from
from warehouse.archive.files.finding import STRANGER, ArchiveFile, list_misnamed, outside_archive
from warehouse.archive.files.hashes import hash_of_parts, hash_of_sheet
from warehouse.archive.files.list_kinds import BOATS, TOWS
from warehouse.archive.files.names import (
    BOATS_FILE,
    PACKED,
    PARTS,
    SAMPLES,
    SPREADSHEETS,
    as_one_run,
    kind_of,
    match_key,
    split_sheet,
)
from warehouse.archive.sheets.cells import WrongError
from warehouse.archive.sheets.extent import sheets_of
from warehouse.archive.spelling.text import fold, fold_word, shorten


def missing_lists(root: Path, files: Iterable[ArchiveFile]) -> list[Fault]:
    """What is not there of that without which nothing can be read.

    Raises:
        MissingKnowledgeError: there is no archive.
    """
    if not root.is_dir():
        raise MissingKnowledgeError(
            "There is no archive at {}: expected a folder with {}, sleeplijsten/ and "
            "meetdata_<jaar>/.",
            root,
            BOATS_FILE,
        )
    there = {file.kind for file in files}
    lacking = []
    if BOATS.name not in there:
        lacking.append(
            (BOATS_FILE, say("there is no list of boats: {path} is expected.", path=BOATS_FILE))
        )
    if TOWS.name not in there:
        path = "sleeplijsten/sleeplijst_<jaar>.csv"
        lacking.append((path, say("there is no list of tows: {path} is expected.", path=path)))
    return [Fault(path, None, None, "missing_list", said) for path, said in lacking]


def strangers(root: Path, files: Iterable[ArchiveFile], ignore: Collection[str]) -> list[Fault]:
    """What lies in the archive and is not read."""
    message = say("The name of '{name}' has letters that cannot be read; give it another name.")
    misnamed = [
        Fault(path, None, None, "unrecognised_file", say(message, name=path))
        for path in list_misnamed(root)
    ]
    return misnamed + [
        Fault(file.path, None, None, "unrecognised_file", _about_stranger(root, file.path))
        for file in files
        if file.kind == STRANGER and fold(file.path) not in ignore
    ]


def _about_stranger(root: Path, path: str) -> str:
    """The sentence about what is not read."""
    kind = Path(path)
    if kind.suffix.lower() in PACKED:
        return say("'{path}' is not read: it is packed. Unpack it in its folder.", path=path)
    return say(
        "'{path}' is not read: it has another name than the archive's files. Say what it is under "
        "[files] in archief.toml, or put it under ignore.",
        path=path,
        inside=_lists_inside(root, path),
    )


def _lists_inside(root: Path, path: str) -> list[str]:
    """The first files in a folder, each of which can be a list."""
    inner = sorted(file for file in (root / path).rglob("*") if not file.is_dir())
    return [file.relative_to(root).as_posix() for file in inner[:3]]


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


FilesByName = dict[tuple[int, str], list[SamplesFile]]
"""Samples files by season and the name they answer to."""
Named = tuple[int, str]
"""The season of a row and the name of a samples file in it."""


def names_of_files(rows: pl.DataFrame) -> list[Named]:
    """The names of samples files in the rows, each once."""
    first, second = (rows.select("season", name=key) for key in ("file", "second_file"))
    return pl.concat([first, second]).drop_nulls().unique(maintain_order=True).rows()


def without_own_folder(name: str, season: int) -> str:
    r"""Return `snol 8h 2014` of `E:\slepen\meetdata_2014\snol 8h 2014` in the list of 2014.

    So the federation's tool shows a file (presentation 2015, "Meetfile"). Other paths stay.
    """
    folder, _, own = name.replace("\\", "/").rpartition("/")
    return own if fold(folder.rpartition("/")[2]) == fold(f"{SAMPLES}_{season}") else name


def files_by_name(samples: Iterable[ArchiveFile], names: Iterable[Named]) -> FilesByName:
    """The samples by season and the name they answer to.

    Files that are a run each answer together to what their names have in common, unless a row
    names one of them by itself. Sheets of workbooks answer to a name that no file has.
    """
    named = {(season, match_key(without_own_folder(name, season))) for season, name in names}
    by_name: FilesByName = defaultdict(list)
    by_run: dict[tuple[int, str], dict[int, list[ArchiveFile]]] = defaultdict(dict)
    for file in samples:
        key = (file.season, match_key(file.full_path.name))
        by_name[key].append(SamplesFile((file,)))
        run = as_one_run(file.full_path.name)
        if run is not None and key not in named:
            tow = run[0] or fold_word(file.full_path.parent.name)
            by_run[file.season, tow].setdefault(run[1], []).append(file)
    for key, runs in by_run.items():
        if key not in by_name and all(len(files) == 1 for files in runs.values()):
            by_name[key].append(SamplesFile(tuple(runs[run][0] for run in sorted(runs))))
    lacking = {key for year, key in named if not {(year, key), (0, key)} & by_name.keys()}
    for file in samples if lacking else ():
        is_book = file.inside and kind_of(file.full_path) in SPREADSHEETS
        for sheet in sheets_of(file.full_path) if is_book else ():
            if match_key(sheet) in lacking:
                by_name[file.season, match_key(sheet)].append(_sheet_in(file, sheet))
    return by_name


def files_meant(name: str, season: int, by_name: FilesByName) -> list[SamplesFile]:
    """The files a name in a list can mean; a name with its extension is more precise.

    Of a workbook it can name a sheet: `proeven.xlsx#snol 8h`; alone where no file has its name.
    """
    name = without_own_folder(name, season)
    key, (own, sheet) = match_key(name), split_sheet(name)
    alike = by_name.get((season, key)) or by_name.get((0, key), [])
    exact = [file for file in alike if fold_word(file.parts[0].full_path.name) == fold_word(own)]
    meant = exact if len(exact) == 1 or sheet else alike
    return [_sheet_in(file.parts[0], sheet) for file in meant] if sheet else meant


def _sheet_in(book: ArchiveFile, sheet: str) -> SamplesFile:
    full = book.full_path.with_name(f"{book.full_path.name}#{sheet}")
    return SamplesFile((replace(book, path=f"{book.path}#{sheet}", full_path=full),))


def not_listed(
    names: Iterable[Named],
    samples: Iterable[ArchiveFile],
    unread_seasons: Collection[int],
    by_name: FilesByName,
) -> list[Fault]:
    """A fault for each samples file no row names, in seasons whose list could be read.

    Rows that are set aside for another reason name their files all the same.
    """
    named = {
        split_sheet(part.path)[0]
        for season, name in names
        for year in (season, 0)
        for file in by_name.get((year, match_key(without_own_folder(name, season))), [])
        for part in file.parts
    }
    faults = []
    for file in samples:
        if file.path in named:
            continue
        if not file.inside:
            faults.append(fault_from(outside_archive(file.path), file.path))
        elif not {*unread_seasons} & {file.season, 0} and (file.season or not unread_seasons):
            message = say("No row of a tow list names this file.")
            faults.append(Fault(file.path, None, None, "samples_not_listed", message))
    return faults


def the_file(name: str, season: int, by_name: FilesByName) -> SamplesFile:
    """The one file that a name in a list means.

    Raises:
        WrongError: there is none, or more than one.
        DefectiveInputError: it lies outside the archive.
    """
    own = without_own_folder(name, season)
    values = {"name": shorten(own), "folder": f"meetdata_{season}/"}
    if "/" in own or "\\" in own or own.startswith(".."):
        text = say("'{name}' is a path; only the name of a file in {folder} can be given here.")
        raise WrongError(text, "path_outside_archive", **values)
    candidates = files_meant(name, season, by_name)
    if not candidates:
        text = say("there is no file '{name}' in {folder}.")
        raise WrongError(text, "samples_missing", **values)
    if len(candidates) > 1:
        text = say("'{name}' can be any of {found}.")
        found = ", ".join(f"'{file.parts[0].full_path.name}'" for file in candidates)
        raise WrongError(text, "ambiguous_file", **values, found=found)
    outside = [part for part in candidates[0].parts if not part.inside]
    if outside:
        raise outside_archive(outside[0].path)
    return candidates[0]


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
