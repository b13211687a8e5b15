"""A line for `beoordelingen.csv`: the only file of the archive that Herijk writes, when asked to.

The line is written as the list is: its columns, delimiter, quotes, encoding and line ends. What was
in the list stays as it is, byte for byte. Before anything is shown or written, the new list is read
as a rebuild reads it; a line that would not come back as it was meant is refused.
"""

import csv
import datetime as dt
import io
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from stat import S_IMODE
from typing import Final

import polars as pl

from pipeline.errors import MissingKnowledgeError, UnavailableError
from pipeline.messages import Sentence, say
from warehouse.archive.columns import (
    Column,
    decode_text,
    find_columns,
    find_header,
    split_line,
    split_lines,
)
from warehouse.archive.files import (
    TEXT_SUFFIXES,
    ArchiveFile,
    list_files,
    make_outside_archive_error,
    read_bytes,
)
from warehouse.archive.kinds import ACCEPTANCES, TOWS
from warehouse.archive.list_rules import read_acceptances
from warehouse.archive.lists import LIST_MAX_BYTES, split_runs
from warehouse.archive.profile import Profiles, read_profiles
from warehouse.archive.workbooks import TYPED_AS_TEXT
from warehouse.store.files import sync, write_beside

_UTF16_MARKS: Final = {b"\xff\xfe": "utf-16-le", b"\xfe\xff": "utf-16-be"}


@dataclass(frozen=True)
class Acceptance:
    """A tow that a person accepts after the first assessment.

    Attributes:
        tow_id: the tow.
        towed_on: its day.
        planned_runs: the numbers of its runs.
        accepted_by: who accepts the tow.
        accepted_on: the day.
        redone_runs: runs that were towed again, as a list has them: `1-3,b4`.
        note: why, in the person's words.
        known_checks: codes of the checks that mark the tow.
    """

    tow_id: str
    towed_on: dt.date
    planned_runs: Sequence[int]
    accepted_by: str
    accepted_on: dt.date
    redone_runs: str = ""
    note: str = ""
    known_checks: Sequence[str] = ()

    def to_cells(self) -> dict[str, str]:
        """Return the texts of the line by column; a list has a row on a line, without breaks."""
        return {
            "tow_id": self.tow_id,
            "accepted_on": self.accepted_on.isoformat(),
            "accepted_by": " ".join(self.accepted_by.split()),
            "redone_runs": ",".join(split_runs(self.redone_runs.strip())),
            "explanation": " ".join(self.note.split()),
            "known_checks": ", ".join(self.known_checks),
        }


@dataclass(frozen=True)
class NewLine:
    """A line for the list of acceptances, and the list with it.

    Attributes:
        path: the list, relative to the archive.
        file: where it is.
        header: its header.
        line: the line, without its end.
        before: the content of the list; None where there is no list yet.
        after: the content with the line.
    """

    path: str
    file: Path
    header: str
    line: str
    before: bytes | None
    after: bytes

    def write(self) -> None:
        """Replace the list by the one with the line, at once.

        Raises:
            UnavailableError: it cannot be written, or was changed since it was read.
        """
        try:
            mode = 0o644 if self.before is None else S_IMODE(self.file.stat().st_mode)
            with write_beside(self.file, mode) as beside:
                beside.write_bytes(self.after)
                sync(beside)
                now = self.file.read_bytes() if self.file.exists() else None
                if now != self.before:
                    raise UnavailableError(
                        "{} was changed in the meantime, and nothing was written. Ask again",
                        self.path,
                    )
        except OSError as error:
            raise UnavailableError(
                "{} cannot be written ({}), and nothing was. Ask for the right to it, or add the "
                "line by hand: without --write it is printed",
                self.path,
                error.strerror,
            ) from error


@dataclass(frozen=True)
class _Layout:
    """How the text of a list is written."""

    header: str
    header_line: int
    delimiter: str
    encoding: str
    line_end: str

    def write_row(self, cells: Sequence[str]) -> str:
        """Return a row, with quotes where the header has them or a cell needs them."""
        text = io.StringIO()
        if self.header.startswith('"'):
            writer = csv.writer(text, delimiter=self.delimiter, quoting=csv.QUOTE_ALL)
        else:
            writer = csv.writer(text, delimiter=self.delimiter)
        writer.writerow(cells)
        return text.getvalue().rstrip("\r\n")


def compose_line(root: Path, acceptance: Acceptance) -> NewLine:
    """Return the line for an acceptance, as the list of the archive is written.

    Raises:
        HerijkError: the list is a workbook, or there are several; it lacks a column; or the line
            would be set aside or read back otherwise.
    """
    profiles = read_profiles(root)
    columns = profiles.rename_columns(ACCEPTANCES.columns)
    files = list_files(root, profiles)
    lists = [file for file in files if file.kind == ACCEPTANCES]
    if len(lists) > 1:
        named = ", ".join(file.path for file in lists)
        raise MissingKnowledgeError("there are several lists of acceptances: {}. Keep one", named)
    if not lists:
        path = f"{profiles.find_place(ACCEPTANCES)}.csv"
        target, before = root / path, None
        layout = _choose_layout(files, acceptance.towed_on.year, profiles, columns)
    else:
        path, target = lists[0].path, lists[0].full_path.resolve()
        if not lists[0].inside:
            raise make_outside_archive_error(path)
        if target.suffix.lower() not in TEXT_SUFFIXES:
            raise MissingKnowledgeError(
                "{} is a workbook, to which no line is added. Add the row yourself, or save the "
                "list as CSV",
                path,
            )
        before = read_bytes(target, LIST_MAX_BYTES)
        layout = _find_layout(before, columns)
    row = _fill_row(acceptance.to_cells(), layout, columns, path)
    line = layout.write_row(row)
    text = line + layout.line_end
    if before is None:
        text = layout.header + layout.line_end + text
    elif not before.decode(layout.encoding, errors="replace").endswith(("\n", "\r")):
        text = layout.line_end + text
    try:
        after = (before or b"") + text.encode(layout.encoding)
    except UnicodeEncodeError as error:
        raise MissingKnowledgeError(
            "{!r} cannot be written in {}, the encoding of {}. Leave it out, or save the list as "
            "UTF-8",
            error.object[error.start : error.end],
            layout.encoding,
            path,
        ) from error
    _check_read_back(after, path, acceptance, profiles)
    return NewLine(path, target, layout.header, line, before, after)


def _choose_layout(
    files: Sequence[ArchiveFile], season: int, profiles: Profiles, columns: Sequence[Column]
) -> _Layout:
    """Return the layout of a new list: as the tow list of the season is written, if it is text."""
    delimiter, line_end = ";", "\n"
    for file in files:
        is_text = file.full_path.suffix.lower() in TEXT_SUFFIXES
        if file.kind == TOWS and file.season == season and file.inside and is_text:
            content = read_bytes(file.full_path, LIST_MAX_BYTES)
            found = _find_layout(content, profiles.rename_columns(TOWS.columns))
            delimiter, line_end = found.delimiter, found.line_end
    header = delimiter.join(column.named for column in columns)
    return _Layout(header, 0, delimiter, "utf-8", line_end)


def _find_layout(content: bytes, columns: Sequence[Column]) -> _Layout:
    text, encoding = decode_text(content)
    if encoding == "utf-16":
        encoding = _UTF16_MARKS[content[:2]]
    lines = split_lines(text)
    place, delimiter = find_header(lines, columns)
    line_end = next((end for end in ("\r\n", "\n", "\r") if end in text), "\n")
    return _Layout(lines[place], place + 1, delimiter, encoding.removesuffix("-sig"), line_end)


def _fill_row(
    cells: Mapping[str, str], layout: _Layout, columns: Sequence[Column], path: str
) -> list[str]:
    """Return the cells of the row in the order of the header; columns that nobody reads are empty.

    Raises:
        MissingKnowledgeError: the header has no column for a cell.
    """
    header = split_line(layout.header, layout.delimiter)
    places = find_columns(header, columns, layout.header_line)
    row = [""] * len(header)
    for column in columns:
        cell = cells[column.key]
        if cell and column.key not in places:
            raise MissingKnowledgeError(
                "{} has no column '{}': add it to the header", path, column.header
            )
        if cell.startswith(TYPED_AS_TEXT):  # readers take one off, as spreadsheets do
            cell = TYPED_AS_TEXT + cell
        if cell:
            row[places[column.key].index] = cell
    return row


def _check_read_back(content: bytes, path: str, acceptance: Acceptance, profiles: Profiles) -> None:
    """Raise unless the last line of a list is read as the acceptance that it was made of."""
    tow = {"tow_id": acceptance.tow_id, "tow_date": acceptance.towed_on}
    runs = {"tow_id": acceptance.tow_id, "run": list(acceptance.planned_runs)}
    with tempfile.TemporaryDirectory(prefix="herijk-list-") as folder:
        file = Path(folder, Path(path).name)
        file.write_bytes(content)
        copy = ArchiveFile(path, file, ACCEPTANCES, 0, inside=True)
        found, faults = read_acceptances([copy], profiles, pl.DataFrame(tow), pl.DataFrame(runs))
    cells = acceptance.to_cells()
    meant = {key: cell or None for key, cell in cells.items()} | {
        "accepted_on": acceptance.accepted_on
    }
    text, _ = decode_text(content)
    last_line = len(split_lines(text)) - 1  # behind its end is an empty one
    of_day = found.filter(tow_id=acceptance.tow_id, accepted_on=acceptance.accepted_on)
    if of_day.select(*meant).rows(named=True) == [meant]:
        if of_day["line"][0] != last_line:
            raise MissingKnowledgeError("{} says so already, on line {}", path, of_day["line"][0])
        return
    read = found.filter(line=last_line)
    if read.is_empty():
        own = [fault for fault in faults if fault.line == last_line] or faults
        said = own[0].message if own else say("it would pass for a remark.")
        if isinstance(said, Sentence):  # the line is not in the list yet
            said = said.values.get("what", said)
        raise MissingKnowledgeError("the line would be set aside: {}", said)
    values = read.select(*meant).row(0, named=True)
    key = next(key for key in meant if values[key] != meant[key])
    raise MissingKnowledgeError(
        "'{}' cannot be written in {}: it would be read as '{}'. Word it otherwise",
        cells[key],
        path,
        values[key] or "",
    )
