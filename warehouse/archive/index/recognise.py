"""What a file or folder of another name can be: by the columns of its header.

A guess for a person to look at: `check` proposes it under `[files]`, and nothing is read by it.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from itertools import islice
from pathlib import Path
from typing import Final

from pipeline.errors import DefectiveInputError
from warehouse.archive.files.contents import read_bytes, read_start
from warehouse.archive.files.list_kinds import BOATS, LIST_KINDS
from warehouse.archive.files.names import (
    LIST_SUFFIXES,
    SAMPLES,
    SPREADSHEETS,
    kind_of,
    sample_suffix,
)
from warehouse.archive.limits import LIST_MAX_BYTES
from warehouse.archive.profile.season import SAMPLE_COLUMNS
from warehouse.archive.samples.labview import is_labview
from warehouse.archive.sheets.sheet import Sheet, read_sheets, sheets_of_workbook
from warehouse.archive.spelling.columns import Column
from warehouse.archive.spelling.likeness import likeness
from warehouse.archive.spelling.wording import Wording

MOST_FILES: Final = 2000
"""Files of a folder of another name that are looked at; photographs can be many."""

FEWEST_COLUMNS: Final = 3
"""How many columns must have names that are known."""

_YEAR: Final = re.compile(r"(?<![0-9])((?:19|20)[0-9]{2})(?![0-9])")


def recognised(root: Path, path: str) -> Iterator[tuple[str, str]]:
    """Gives what a file, or what lies in a folder, can stand for, by path.

    Args:
        root: the archive.
        path: a file or folder in it.
    """
    full = root / path
    folders: set[Path] = set()
    for file in _files_under(full):
        if any(folder in file.parents for folder in folders):
            continue
        relative, kinds = file.relative_to(root).as_posix(), _recognised_kinds(file)
        if full != file and SAMPLES in kinds.values():
            folder = _folder_of_season(full, file)
            folders.add(folder)
            yield folder.relative_to(root).as_posix(), _with_year(SAMPLES, folder.name)
            continue
        for sheet, kind in kinds.items():
            place = f"{relative}#{sheet}" if len(kinds) > 1 else relative
            if kind != SAMPLES:
                yield place, _list_of_year(kind, sheet, file.stem)


def _recognised_kinds(file: Path) -> Mapping[str, str]:
    """The kind of each sheet; that of the file, without a name, where they are alike."""
    if kind_of(file) in {".tdms", ".lvm", ".parquet"} or _is_labview(file):
        return {"": SAMPLES}
    is_list, is_samples = file.suffix.casefold() in LIST_SUFFIXES, bool(sample_suffix(file.name))
    columns_of = {kind.name: kind.columns for kind in LIST_KINDS if is_list}
    columns_of |= {SAMPLES: SAMPLE_COLUMNS} if is_samples else {}
    best: dict[str, tuple[int, str]] = {}
    for kind, columns in columns_of.items():
        wanted = Wording().with_names(columns)
        for sheet in _sheets_of(file, wanted):
            score = _named(tuple(sheet.header), wanted)
            if score > best.get(sheet.name, (0, ""))[0]:
                best[sheet.name] = score, kind
    kinds = {sheet: kind for sheet, (_, kind) in best.items()}
    different = set(kinds.values())
    return {"": different.pop()} if len(different) == 1 else kinds


def _is_labview(file: Path) -> bool:
    if not sample_suffix(file.name):
        return False
    try:
        return is_labview(read_start(file, 1 << 14)[:200].decode(errors="replace"))
    except DefectiveInputError:
        return False


def _sheets_of(file: Path, columns: Sequence[Column]) -> list[Sheet]:
    """The sheets of a workbook, or the start of a text as one; none of what is neither."""
    suffix = file.suffix.casefold()
    try:
        if suffix in SPREADSHEETS:
            return list(sheets_of_workbook(read_bytes(file, LIST_MAX_BYTES), columns))
        if suffix in LIST_SUFFIXES or sample_suffix(file.name):
            return read_sheets(read_start(file, 1 << 14), columns)
    except DefectiveInputError:
        return []
    return []


def _files_under(full: Path) -> list[Path]:
    """A file, or the first files in a folder; links are left out."""
    if full.is_symlink():
        return []
    if full.is_file():
        return [full]
    inner = (file for file in sorted(full.rglob("*")) if file.is_file())
    return [file for file in islice(inner, MOST_FILES) if not file.is_symlink()]


def _folder_of_season(top: Path, file: Path) -> Path:
    """The outermost folder of a samples file whose name has a year, else the top."""
    inside = [parent for parent in file.parents if parent.is_relative_to(top)]
    dated = [folder for folder in inside if _YEAR.search(folder.name)]
    return dated[-1] if dated else inside[-1]


def _list_of_year(kind: str, *names: str) -> str:
    """A kind of list with the year in the first of these names that has one."""
    if kind == BOATS.name:
        return kind
    dated = (_with_year(kind, name) for name in names)
    return next((name for name in dated if name != kind), kind)


def _with_year(kind: str, name: str) -> str:
    years = set(_YEAR.findall(name))
    return f"{kind}_{years.pop()}" if len(years) == 1 else kind


@lru_cache(1000)
def _named(header: tuple[str, ...], columns: tuple[Column, ...]) -> int:
    """How many cells of a header are names of columns, less the columns it lacks."""
    cells = [cell for cell in header if cell.strip()]
    named = sum(any(likeness(cell, column) > 0 for column in columns) for cell in cells)
    lacking = [c for c in columns if c.required and not any(likeness(x, c) > 0 for x in cells)]
    return named - len(lacking) if named >= FEWEST_COLUMNS else 0
