"""What a file or folder of another name can be: by the columns of its header.

A guess for a person to look at: `check` proposes it under `[files]`, and nothing is read by it.
"""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import lru_cache
from itertools import islice
from pathlib import Path
from typing import Final

from herijk.pipeline.errors import DefectiveInputError
from herijk.warehouse.archive import boats, published, tows, windows
from herijk.warehouse.archive.files import (
    BOAT_LIST,
    LIST_SUFFIXES,
    RACES,
    REGISTERS,
    SAMPLES,
    TOW_LISTS,
    WINDOWS,
    ListKind,
    kind_of,
    read_bytes,
    read_start,
    sample_suffix,
)
from herijk.warehouse.archive.limits import LIST_MAX_BYTES
from herijk.warehouse.archive.lists import Wording, is_like_a_date, is_number
from herijk.warehouse.archive.meaning import FITS, likeness
from herijk.warehouse.archive.profile import SAMPLE_COLUMNS
from herijk.warehouse.archive.recordings import is_labview
from herijk.warehouse.archive.sheets import SPREADSHEETS, Sheet, read_sheets, sheets_of_workbook
from herijk.warehouse.archive.text import Column

MOST_FILES: Final = 2000
"""Of a folder of another name; photographs can be many."""

FEWEST_COLUMNS: Final = 3
"""So many columns must have names that are known, or hold numbers."""

FEWEST_SAMPLES: Final = 50
"""So many rows of numbers must be at the start of a file for it to hold samples."""

_KINDS: Final[tuple[tuple[ListKind, Sequence[Column]], ...]] = (
    (TOW_LISTS, tows.COLUMNS),
    (BOAT_LIST, boats.COLUMNS),
    (WINDOWS, windows.COLUMNS),
    (REGISTERS, published.REGISTER_COLUMNS),
    (RACES, published.RACE_COLUMNS),
)
_YEAR: Final = re.compile(r"(?<![0-9])((?:19|20)[0-9]{2})(?![0-9])")


def recognised(root: Path, path: str) -> Iterator[tuple[str, str]]:
    """Give what a file, or what lies in a folder, can stand for, by path.

    Args:
        root: the archive.
        path: a file or folder in it.
    """
    return _stand_for(root, path, _recognised_kinds)


def guessed(root: Path, path: str) -> Iterator[tuple[str, str]]:
    """Give what files of which nobody knows the words can stand for, by what is in their columns.

    A list with a column of dates can be of tows, one without of boats, and long rows of numbers
    samples.

    Args:
        root: the archive.
        path: a file or folder in it.
    """
    return _stand_for(root, path, lambda file: dict(_guessed_kinds(file)))


def _stand_for(
    root: Path, path: str, kinds_of: Callable[[Path], Mapping[str, str]]
) -> Iterator[tuple[str, str]]:
    """Give what files stand for, given the kinds of each by its sheets; samples as a folder."""
    full = root / path
    folders: set[Path] = set()
    for file in _files_under(full):
        if any(folder in file.parents for folder in folders):
            continue
        relative, kinds = file.relative_to(root).as_posix(), kinds_of(file)
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
    """Return the kind of each sheet; that of the file, without a name, where they are alike."""
    sheets = _kinds_of_sheets(file)
    if len(set(sheets.values())) > 1:
        return sheets
    what = next(iter(sheets.values()), None) or _kind(file)
    return {"": what} if what else {}


def _guessed_kinds(file: Path) -> Iterator[tuple[str, str]]:
    suffix = file.suffix.casefold()
    if suffix not in LIST_SUFFIXES and not sample_suffix(file.name):
        return
    try:
        if suffix in SPREADSHEETS:
            sheets = list(sheets_of_workbook(read_bytes(file, LIST_MAX_BYTES), tows.COLUMNS))
        else:
            sheets = read_sheets(read_start(file, 1 << 14), tows.COLUMNS)
    except DefectiveInputError:
        return
    for sheet in sheets:
        if kind := _kind_by_content(sheet):
            yield sheet.name, kind


def _kind_by_content(sheet: Sheet) -> str | None:
    columns = list(zip(*(row.fields for row in sheet.rows if row.problem is None), strict=False))
    numbers = sum(_mostly(is_number, cells) for cells in columns)
    if numbers < FEWEST_COLUMNS:
        return None
    others = [cells for cells in columns if not _mostly(is_number, cells)]
    if len(sheet.rows) >= FEWEST_SAMPLES and len(others) <= 1:
        return SAMPLES
    has_dates = any(_mostly(is_like_a_date, cells) for cells in columns)
    return (TOW_LISTS if has_dates else BOAT_LIST).stands_for if others else None


def _mostly(is_one: Callable[[str], bool], cells: Sequence[str]) -> bool:
    filled = [cell for cell in map(str.strip, cells) if cell]
    return bool(filled) and sum(map(is_one, filled)) >= FITS * len(filled)


def _files_under(full: Path) -> list[Path]:
    """Return a file, or the first files in a folder; links are left out."""
    if full.is_symlink():
        return []
    if full.is_file():
        return [full]
    inner = (file for file in sorted(full.rglob("*")) if file.is_file())
    return [file for file in islice(inner, MOST_FILES) if not file.is_symlink()]


def _folder_of_season(top: Path, file: Path) -> Path:
    """Return the outermost folder of a samples file whose name has a year, else the top."""
    inside = [parent for parent in file.parents if parent.is_relative_to(top)]
    dated = [folder for folder in inside if _YEAR.search(folder.name)]
    return dated[-1] if dated else inside[-1]


def _list_of_year(kind: str, *names: str) -> str:
    """Return a kind of list with the year in the first of these names that has one."""
    if kind == BOAT_LIST.stands_for:
        return kind
    dated = (_with_year(kind, name) for name in names)
    return next((name for name in dated if name != kind), kind)


def _with_year(kind: str, name: str) -> str:
    years = set(_YEAR.findall(name))
    return f"{kind}_{years.pop()}" if len(years) == 1 else kind


def _kind(file: Path) -> str | None:
    """Return what a file can be: a kind of list, samples, or nothing known."""
    if kind_of(file) in {".tdms", ".lvm", ".parquet"}:
        return SAMPLES
    suffix = file.suffix.casefold()
    try:
        if suffix in SPREADSHEETS:
            return None  # looked at sheet by sheet
        if suffix in LIST_SUFFIXES and (list_kind := _list_kind(file)):
            return list_kind
        if sample_suffix(file.name) and _is_samples(read_start(file, 1 << 14)):
            return SAMPLES
    except DefectiveInputError:
        return None
    return None


def _kinds_of_sheets(file: Path) -> dict[str, str]:
    """Return what each sheet of a workbook can be, for the sheets that can be a list."""
    if file.suffix.casefold() not in SPREADSHEETS:
        return {}
    best: dict[str, tuple[int, str]] = {}
    try:
        data = read_bytes(file, LIST_MAX_BYTES)
        for kind, columns in _KINDS:
            wanted = Wording().with_names(columns)
            for sheet in sheets_of_workbook(data, wanted):
                score = _named(sheet.header, wanted)
                if score > best.get(sheet.name, (0, ""))[0]:
                    best[sheet.name] = score, kind.stands_for
    except DefectiveInputError:
        return {}
    return {sheet: kind for sheet, (_, kind) in best.items()}


def _is_samples(start: bytes) -> bool:
    if is_labview(start[:200].decode(errors="replace")):
        return True
    sheet = read_sheets(start, SAMPLE_COLUMNS)[0]
    return _named(sheet.header, Wording().with_names(SAMPLE_COLUMNS)) > 0


def _list_kind(file: Path) -> str | None:
    """Return the kind of list whose columns a text has most of, if it has enough."""
    data = read_start(file, 1 << 14)
    kinds = {kind.stands_for: columns for kind, columns in _KINDS} | {SAMPLES: SAMPLE_COLUMNS}
    scores = {}
    for kind, columns in kinds.items():
        wanted = Wording().with_names(columns)
        scores[kind] = _named(read_sheets(data, wanted)[0].header, wanted)
    best = max(scores, key=lambda name: scores[name])
    return best if scores[best] > 0 else None


def _named(header: Sequence[str], columns: Sequence[Column]) -> int:
    """Return how many cells of a header are names of columns, less the columns it lacks."""
    return _named_once(tuple(header), tuple(columns))


@lru_cache(1000)
def _named_once(header: tuple[str, ...], columns: tuple[Column, ...]) -> int:
    cells = [cell for cell in header if cell.strip()]
    named = sum(any(likeness(cell, column) > 0 for column in columns) for cell in cells)
    lacking = [c for c in columns if c.required and not any(likeness(x, c) > 0 for x in cells)]
    return named - len(lacking) if named >= FEWEST_COLUMNS else 0
