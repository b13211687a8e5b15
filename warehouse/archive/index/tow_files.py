"""Which samples files a row of a tow list means."""

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import replace

from pipeline.messages import say
from warehouse.archive.faults import Fault, fault_from
from warehouse.archive.files.finding import ArchiveFile, outside_archive
from warehouse.archive.files.names import SAMPLES, as_one_run, match_key, split_sheet
from warehouse.archive.index.hashed_files import Hashes
from warehouse.archive.index.tow_rows import Entry, SamplesFile
from warehouse.archive.spelling.text import fold, fold_word, shorten

FilesByName = dict[tuple[int, str], list["SamplesFile"]]
"""Samples files by season and the name they answer to."""


def names_of_files(entry: Entry) -> list[str]:
    """The names of the files in a row."""
    cells = (entry.row.optional_text(key) for key in ("file", "second_file"))
    return [_without_own_folder(cell, entry.season) for cell in cells if cell is not None]


def _without_own_folder(name: str, season: int) -> str:
    r"""Return `snol 8h 2014` of `E:\slepen\meetdata_2014\snol 8h 2014` in the list of 2014.

    So the federation's tool shows a file (presentation 2015, "Meetfile"). Other paths stay.
    """
    folder, _, own = name.replace("\\", "/").rpartition("/")
    return own if fold(folder.rpartition("/")[2]) == fold(f"{SAMPLES}_{season}") else name


def files_by_name(sample_files: Iterable[ArchiveFile], entries: Iterable[Entry]) -> FilesByName:
    """The samples by season and the name they answer to.

    Files that are a run each answer together to what their names have in common, unless a row
    names one of them by itself.
    """
    named = {(entry.season, match_key(name)) for entry in entries for name in names_of_files(entry)}
    by_name: FilesByName = defaultdict(list)
    by_run: dict[tuple[int, str], dict[int, list[ArchiveFile]]] = defaultdict(dict)
    for file in sample_files:
        key = (file.season, match_key(file.full_path.name))
        by_name[key].append(SamplesFile((file,)))
        run = as_one_run(file.full_path.name)
        if run is not None and key not in named:
            tow = run[0] or fold_word(file.full_path.parent.name)
            by_run[file.season, tow].setdefault(run[1], []).append(file)
    for key, runs in by_run.items():
        if key not in by_name and all(len(files) == 1 for files in runs.values()):
            by_name[key].append(SamplesFile(tuple(runs[run][0] for run in sorted(runs))))
    return by_name


def files_meant(name: str, season: int, by_name: FilesByName) -> list[SamplesFile]:
    """The files a name in a list can mean; a name with its extension is more precise.

    Of a workbook it can name a sheet: `proeven.xlsx#snol 8h`.
    """
    key, (own, sheet) = match_key(name), split_sheet(name)
    alike = by_name.get((season, key)) or by_name.get((0, key), [])
    exact = [file for file in alike if fold_word(file.parts[0].full_path.name) == fold_word(own)]
    meant = exact if len(exact) == 1 or sheet else alike
    return [_sheet_in(file.parts[0], sheet) for file in meant] if sheet else meant


def _sheet_in(book: ArchiveFile, sheet: str) -> SamplesFile:
    full = book.full_path.with_name(f"{book.full_path.name}#{sheet}")
    return SamplesFile((replace(book, path=f"{book.path}#{sheet}", full_path=full),))


def not_listed(
    entries: Iterable[Entry],
    sample_files: list[ArchiveFile],
    unread_seasons: set[int],
    by_name: FilesByName,
) -> list[Fault]:
    """A fault for each samples file no row names, in seasons whose list could be read.

    Rows that are set aside for another reason name their files all the same.
    """
    named = {
        part.path
        for entry in entries
        for name in names_of_files(entry)
        for season in (entry.season, 0)
        for file in by_name.get((season, match_key(name)), [])
        for part in file.parts
    }
    faults = []
    for file in sample_files:
        if file.path in named:
            continue
        if not file.inside:
            faults.append(fault_from(outside_archive(file.path), file.path))
        elif not unread_seasons & {file.season, 0} and (file.season or not unread_seasons):
            message = say("No row of a tow list names this file.")
            faults.append(Fault(file.path, None, None, "samples_not_listed", message))
    return faults


def find_files(entry: Entry, by_name: FilesByName, hashes: Hashes) -> None:
    """Finds the samples of a row and notes them in its tow."""
    entry.files = [_find_file(entry, name, by_name) for name in names_of_files(entry)]
    first, second = entry.files[0], entry.files[1] if len(entry.files) > 1 else None
    entry.tow |= {
        "samples_path": first.path,
        "samples_sha256": hashes.add_samples(first),
        "second_path": second.path if second else None,
        "second_sha256": hashes.add_samples(second) if second else None,
        "list_path": entry.list_path,
        "list_line": entry.row.line,
    }


def _find_file(entry: Entry, name: str, by_name: FilesByName) -> SamplesFile:
    values = {"name": shorten(name), "folder": f"meetdata_{entry.season}/"}
    if "/" in name or "\\" in name or name.startswith(".."):
        message = say("'{name}' is a path; only the name of a file in {folder} can be given here.")
        raise entry.row.fault(say(message, **values), "path_outside_archive")
    candidates = files_meant(name, entry.season, by_name)
    if not candidates:
        message = say("there is no file '{name}' in {folder}.", **values)
        raise entry.row.fault(message, "samples_missing")
    if len(candidates) > 1:
        names = ", ".join(f"'{file.parts[0].full_path.name}'" for file in candidates)
        message = say("'{name}' can be any of {found}.", name=shorten(name), found=names)
        raise entry.row.fault(message, "ambiguous_file")
    outside = [part for part in candidates[0].parts if not part.inside]
    if outside:
        raise outside_archive(outside[0].path)
    return candidates[0]
