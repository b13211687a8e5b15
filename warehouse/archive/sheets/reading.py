"""Reading a list: a small table with one header, as a frame of its rows."""

import re
import unicodedata
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Final

import polars as pl

from pipeline.errors import DefectiveInputError
from pipeline.messages import say
from pipeline.tables.frames import dtypes
from warehouse.archive.faults import Fault, fault_from
from warehouse.archive.files.contents import read_bytes
from warehouse.archive.files.finding import ArchiveFile, outside_archive
from warehouse.archive.files.list_kinds import ListKind
from warehouse.archive.files.names import split_sheet
from warehouse.archive.limits import LIST_MAX_BYTES
from warehouse.archive.profile.definition import Profiles
from warehouse.archive.sheets.cells import Reading, Wrong, read_column
from warehouse.archive.sheets.rows import PLACE, Problem, sound_rows
from warehouse.archive.sheets.sheet import Sheet, read_sheets
from warehouse.archive.spelling.columns import (
    Column,
    FoundColumn,
    find_columns,
    nearest_columns,
    unknown_headers,
)
from warehouse.archive.spelling.dates import date_order
from warehouse.archive.spelling.numbers import decimal_mark
from warehouse.archive.spelling.synonyms import CLASSES, NOTHING
from warehouse.archive.spelling.text import fold, fold_word, shorten

CREW: Final = ("rowers", "crew_class")
_CREW: Final = re.compile(r"([0-9]{1,2})\s*([^\W\d_]+)")
"""Rowers and class in one cell: `8H`."""


def read_sound(
    files: Iterable[ArchiveFile], kind: ListKind, profiles: Profiles
) -> tuple[pl.DataFrame, list[Fault]]:
    """The rows of all lists of a kind in which nothing is wrong, and a fault for each other."""
    rows, problems, faults = read_lists(files, kind, profiles)
    return sound_rows(rows, problems, faults), faults


def read_lists(
    files: Iterable[ArchiveFile], kind: ListKind, profiles: Profiles
) -> tuple[pl.DataFrame, list[Problem], list[Fault]]:
    """All lists of a kind as one frame, what is wrong in its rows, and the lists that are not read.

    Args:
        files: those of the archive.
        kind: which lists.
        profiles: how the lists are worded.

    Returns:
        The rows as in `read_list`, with `row` counted over all lists.
    """
    frames = [_no_rows(kind)]
    problems: list[Problem] = []
    faults: list[Fault] = []
    for file in files:
        if file.kind != kind.name:
            continue
        try:
            rows, wrong = read_list(file, kind, profiles, sum(map(len, frames)))
        except BaseException as error:
            faults.append(fault_from(error, file.path))
            continue
        frames.append(rows)
        problems += wrong
    return pl.concat(frames), problems, faults


def read_list(
    file: ArchiveFile, kind: ListKind, profiles: Profiles, first_row: int = 0
) -> tuple[pl.DataFrame, list[Problem]]:
    """The rows of a list of the archive; empty ones are left out.

    Args:
        file: the list.
        kind: which list.
        profiles: how the lists of this archive are worded.
        first_row: number of the first row.

    Returns:
        The number of each `row`, its `PLACE`, `cells` and `headers` as they are written, and the
        values, null where a cell is empty or wrong; and what is wrong, row by row.

    Raises:
        DefectiveInputError: the list as a whole cannot be read, or has a column that nobody knows:
            it can be a misspelt one, and left out in silence would change numbers.
    """
    path = file.path
    if not file.inside:
        raise outside_archive(path)
    data = read_bytes(file.full_path, LIST_MAX_BYTES)
    wanted = profiles.named(kind.columns)
    suffix, sheet_name = file.full_path.suffix.casefold(), split_sheet(path)[1]
    sheets = read_sheets(data, wanted, suffix, sheet_name, profiles.header_lines.get(path))
    cells = {cell.strip() for sheet in sheets for row in sheet.rows for cell in row.fields}
    order = profiles.dates.get(path, profiles.dates.get("*", "")) or date_order(cells)
    told = profiles.decimals.get(path, profiles.decimals.get("*", ""))
    mark = told or decimal_mark(cells)
    frames, problems = [_no_rows(kind)], list[Problem]()
    for sheet in sheets:
        found = _columns_of(sheet, wanted, profiles)
        reading = Reading(found, kind.table, order, mark, bool(told))
        texts = _texts(sheet, kind, found, profiles.words)
        rows, wrong = _read_rows(sheet, kind, reading, texts, first_row)
        where = {"path": pl.lit(path), "season": pl.lit(file.season, pl.Int64)}
        frames.append(rows.with_columns(**where).select(frames[0].columns))
        problems += wrong
        first_row += len(rows)
    return pl.concat(frames), problems


def _no_rows(kind: ListKind) -> pl.DataFrame:
    """The frame of a list without any row."""
    written = pl.Struct({column.key: pl.String for column in kind.columns})
    about = {"row": pl.Int64(), **PLACE, "season": pl.Int64(), "cells": written, "headers": written}
    declared = dtypes(kind.table)
    values = {c.key: declared.get(c.key, pl.String()) for c in kind.columns}
    return pl.DataFrame(schema=about | values)


def _read_rows(
    sheet: Sheet, kind: ListKind, reading: Reading, texts: Mapping[str, pl.Series], first_row: int
) -> tuple[pl.DataFrame, list[Problem]]:
    read = {c.key: read_column(texts[c.key], c, reading) for c in kind.columns}
    headers = {key: c.header for key in texts if (c := reading.columns.get(key))}
    written = [pl.lit(headers.get(key), pl.String).alias(key) for key in texts]
    rows = pl.DataFrame(
        {"line": pl.Series([row.line for row in sheet.rows], dtype=pl.Int64)}
        | {key: values for key, (values, _) in read.items()}
    ).with_columns(
        row=pl.int_range(first_row, first_row + pl.len(), dtype=pl.Int64),
        sheet=pl.lit(sheet.name),
        of_tow=pl.lit(None, pl.String),
        cells=pl.DataFrame(texts).to_struct(),
        headers=pl.struct(written),
    )
    whole = [
        Problem(first_row + i, "", kind.reason_code, row.problem)
        for i, row in enumerate(sheet.rows)
        if row.problem is not None
    ]
    torn = {problem.row for problem in whole}
    of_cells = (
        Problem(first_row + i, key, code or kind.reason_code, text)
        for key, (_, wrong) in read.items()
        if wrong
        for i, (code, text) in _wrong_cells(texts[key], wrong)
        if first_row + i not in torn
    )
    return rows, sorted([*whole, *of_cells], key=lambda problem: problem.row)


def _wrong_cells(cells: pl.Series, wrong: Wrong) -> Iterable[tuple[int, tuple[str | None, str]]]:
    return ((i, wrong[cell]) for i, cell in enumerate(cells) if cell in wrong)


def _texts(
    sheet: Sheet, kind: ListKind, found: Mapping[str, FoundColumn], words: Mapping[str, str]
) -> dict[str, pl.Series]:
    """What is written in each column, trimmed and in words that are known; null for nothing."""
    texts: dict[str, list[str | None]] = {}
    for column in kind.columns:
        place = found[column.key].index if column.key in found else len(sheet.header)
        fields = [
            row.fields[place].strip() if place < len(row.fields) else "" for row in sheet.rows
        ]
        known = column.key in found
        meant = {field: (_meant(field, words) or None) if known else None for field in set(fields)}
        texts[column.key] = [meant[field] for field in fields]
    if {*CREW} <= texts.keys():
        crews = [_crew_apart(*crew) for crew in zip(*(texts[key] for key in CREW), strict=True)]
        texts |= {key: [crew[i] for crew in crews] for i, key in enumerate(CREW)}
    series = {key: pl.Series(key, cells, pl.String) for key, cells in texts.items()}
    if "tow_id" in series:  # 2014/17 would be a folder in names of pages and files
        series["tow_id"] = series["tow_id"].str.replace_all("/", "-", literal=True)
    return series


def _crew_apart(rowers: str | None, crew_class: str | None) -> tuple[str | None, str | None]:
    """Rowers and class; of one cell with both where the class is empty or the same."""
    crew = _crew_in(rowers or "")
    if crew is None:
        return rowers, crew_class
    said = CLASSES.get(fold_word(crew_class or ""))
    is_its_own = crew_class in {None, rowers} or said == CLASSES[fold_word(crew[1])]
    return crew if is_its_own else (rowers, crew_class)


def _meant(cell: str, words: Mapping[str, str]) -> str:
    """What a cell stands for: the archive's own words first, then nothing for `n.v.t.`."""
    folded = fold_word(cell)
    if folded in words:
        return words[folded]
    return "" if folded in NOTHING else unicodedata.normalize("NFC", cell)


def _check_named(sheet: Sheet, known: Collection[int]) -> None:
    """Raises where a column without a name holds something: its header may have been lost."""
    for place, header in enumerate(sheet.header):
        if place in known or fold(header):
            continue
        cells = (row.fields[place].strip() for row in sheet.rows if place < len(row.fields))
        content = next((cell for cell in cells if cell and fold_word(cell) not in NOTHING), None)
        if content is not None:
            said = say(
                "Column {number} has no name and holds '{cell}'. Give it its name; one that is not "
                "needed can be put under ignore in archief.toml.",
                number=place + 1,
                cell=shorten(content),
            )
            raise DefectiveInputError("unknown_column", said, sheet.line)


def _about_unknown(unknown: Iterable[str], free: Sequence[Column]) -> str:
    """The sentence about columns that nobody knows.

    Args:
        unknown: their headers.
        free: the columns that no header has; of each, those with the nearest names are offered.
    """
    near = {header: [c.header for c in nearest_columns(header, free, 0.7)] for header in unknown}
    return say(
        "Column {names} is not known. Correct it, name it under [headers] in archief.toml, or put "
        "it there under ignore.",
        names=", ".join(
            f"'{shorten(header)}'" + (f" ({', '.join(names)}?)" if names else "")
            for header, names in near.items()
        ),
        near=tuple((header, tuple(names)) for header, names in near.items()),
        lacking=tuple(c.header for c in sorted(free, key=lambda c: not c.required)),
    )


def _columns_of(
    sheet: Sheet, wanted: Sequence[Column], profiles: Profiles
) -> dict[str, FoundColumn]:
    """The columns of a list; one that nobody knows is a fault."""
    optional = [replace(column, required=False) for column in wanted]
    places = find_columns(sheet.header, optional, sheet.line)
    strange = [h for h in unknown_headers(sheet.header, places) if fold(h) not in profiles.ignore]
    _check_named(sheet, {column.index for column in places.values()})
    if strange:
        free = [column for column in wanted if column.key not in places]
        raise DefectiveInputError("unknown_column", _about_unknown(strange, free), sheet.line)
    serving = {c.key: places[c.or_else] for c in wanted if c.or_else in places}
    of_both = [places[k] for k in CREW if k in places and _has_crews(sheet, places[k].index)]
    serving |= dict.fromkeys(CREW, of_both[0]) if of_both else {}
    wanted = [replace(c, required=c.required and c.key not in serving) for c in wanted]
    return serving | find_columns(sheet.header, wanted, sheet.line)


def _has_crews(sheet: Sheet, place: int) -> bool:
    cells = (row.fields[place] for row in sheet.rows if place < len(row.fields))
    return any(_crew_in(cell) for cell in cells)


def _crew_in(cell: str) -> tuple[str, str] | None:
    """Rowers and class of `8H`; None of another cell."""
    match = _CREW.fullmatch(cell.strip())
    return (match[1], match[2]) if match and fold_word(match[2]) in CLASSES else None
