"""How results look as text: a page of sections, in the language of this command.

What a number, a code or a column is called and how it is written is in `dashboards`.
"""

import io
import re
import shutil
import sys
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from math import exp
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from rich.console import Console
from rich.table import Table

from dashboards import labels
from dashboards.columns import written
from dashboards.speech import Speech
from pipeline.messages import LANGUAGE, tell
from pipeline.tables.row import Row

if TYPE_CHECKING:
    from dashboards.statements import Said, Statement

WIDTH: Final = 110
"""Characters on a line of prose."""

UNLIMITED: Final = 1000
"""Characters on a line of a table that is not for a terminal."""

NARROW: Final = 9
"""Characters that a heading may take however narrow its column is."""

CHANGES: Final = {
    *("cw_ratio", "power_ratio", "total", "median_factor", "lowest_factor", "highest_factor"),
    *("cw_effect_ratio", "shift_ratio", "median_power_ratio", "ln_ratio"),
}
"""Columns with new over old, shown as a change in per cent."""

SHARES: Final = re.compile(
    "share|_sd_ratio|^sd_|u_ratio|r2|p_fault|spread_|error_ratio|season_sd|difference_that_matters"
)
"""Columns with a part of a whole, shown in per cent."""

_NUMBER: Final = re.compile(r"[-+\u2212]?[0-9]+([.,][0-9]+)?(\u00a0[%sN])?\*?|-?")
"""A cell that is aligned to the right."""


@dataclass(frozen=True)
class Section:
    """A heading with what belongs below it, in this order; left out where that is nothing.

    Attributes:
        said: statements, a line each.
        about: what they are about, for `--json`.
        lines: other lines of text.
        rows: of a table: values by name of column; of a line of a register also with its `crew`.
        columns: names of the columns shown, with blanks between them.
        heads: headings of this table alone.
        empty: what is said where there is none of these.
        note: what a reader should know of them.
    """

    title: str = ""
    said: "Sequence[Statement]" = ()
    about: str = ""
    lines: Sequence[str] = ()
    rows: Sequence[Row] = ()
    columns: str = ""
    heads: Mapping[str, str] = field(default_factory=dict)
    empty: str = ""
    note: str = ""

    def __str__(self) -> str:
        """The section as text."""
        said = [statement(speech()) for statement in self.said]
        shown = [*said, *self.lines, table(self.rows, self.columns, self.heads)]
        body = list(filter(None, shown)) or [f"  {self.empty}"] * bool(self.empty)
        return "\n".join(filter(None, [self.title, *body, prose(self.note)])) if body else ""


Part: TypeAlias = str | Section
"""What a page is made of: a paragraph, or a section."""


def page(parts: Iterable[Part]) -> str:
    """The parts below each other, without those that are empty."""
    return "\n\n".join(filter(None, map(str, parts)))


def statements(parts: Iterable[Part]) -> "list[Said]":
    """All that is said on a page, below headings and in the cells of tables."""
    return [
        one.said(speech(), about)
        for part in parts
        if isinstance(part, Section)
        for about, said in [(part.about, part.said), *map(_in_cells, part.rows)]
        for one in said
    ]


def _in_cells(row: Row) -> "tuple[str, list[Statement]]":
    """The statements in a row, and what they are about."""
    return row.get("about", ""), [cell for cell in row.values() if callable(cell)]


def marked(simulated: bool) -> str:
    """The first paragraph, where the boats are simulated."""
    return tell(labels.SIMULATED) if simulated else ""


def prose(text: str) -> str:
    """A text on lines that are easily read."""
    return textwrap.fill(text, WIDTH)


def speech() -> Speech:
    """Numbers and names as the language of this command writes them."""
    return Speech(LANGUAGE.get())


def table(rows: Sequence[Row], columns: str, heads: Mapping[str, str] | None = None) -> str:
    """Rows as lines of text, numbers to the right; no text where there are none."""
    if not rows:
        return ""
    drawn = Table(box=None, pad_edge=False, header_style="", collapse_padding=True)
    shown = [with_crew(row) if "rowers" in row else row for row in rows]
    cells = {name: [cell(name, row.get(name)) for row in shown] for name in columns.split()}
    for name, texts in cells.items():
        to_the_right = all(map(_NUMBER.fullmatch, texts))
        heading = labels.unbroken(tell((heads or {}).get(name) or labels.column(name)))
        width = max(NARROW, *map(len, texts))
        drawn.add_column(
            "\n".join(textwrap.wrap(heading, width, break_long_words=False)),
            justify="right" if to_the_right else "left",
            vertical="bottom",
            overflow="fold",
        )
    for line in zip(*cells.values(), strict=True):
        drawn.add_row(*line)
    return _as_text(drawn)


def _as_text(drawn: Table) -> str:
    """As wide as the terminal, or as wide as it needs to be elsewhere."""
    width = shutil.get_terminal_size().columns if sys.stdout.isatty() else UNLIMITED
    console = Console(file=io.StringIO(), width=width - 2, markup=False, highlight=False)
    with console.capture() as captured:
        console.print(drawn)
    return "\n".join(f"  {line.rstrip()}" for line in captured.get().splitlines())


def cell(name: str, value: Any) -> str:
    """A value as it is shown in the column of this name."""
    if value is None:
        return "-"
    if callable(value):  # a statement
        return str(value(speech()))
    if isinstance(value, float) and name in CHANGES:
        return speech().per_cent(exp(value) if name.startswith("ln_") else value)
    if isinstance(value, float) and SHARES.search(name):
        return f"{speech().number(100 * value, 1)}\u00a0%"
    return written(name, value, speech())


def codes(value: str | Iterable[str]) -> str:
    """A code, or several with commas or as a list, in words."""
    return written("flags", value, speech())


def with_crew(row: Row) -> Row:
    """A row with its crew as people write it: 8H."""
    return row | {"crew": f"{row['rowers']}{row['crew_class']}", "name": row.get("name") or "-"}


def place(fault: Row) -> str:
    """Where a fault is: its file, and the line and the tow where these are known."""
    said = fault["line"] is None or fault.get("message", "").startswith(f"Line {fault['line']}:")
    line = "" if said else tell(", line {}", fault["line"])
    tow = "" if fault["tow_id"] is None else tell(" (tow {})", fault["tow_id"])
    return f"{fault['path']}{line}{tow}"


def set_aside(fault: Row, more: str = "") -> str:
    """A line about something that was set aside: where, and what is wrong with it."""
    why = fault["message_nl" if LANGUAGE.get() == "nl" else "message"]
    return f"  {place(fault)}{more}: {why}"
