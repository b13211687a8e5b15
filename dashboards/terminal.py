"""A document as text for a terminal: its blocks below each other, tables drawn by rich."""

import re
import shutil
import sys
import textwrap
from collections.abc import Collection, Iterator, Sequence
from typing import Final, NamedTuple, Self

from rich.console import Console
from rich.table import Table

from dashboards.reading import Block, read_blocks
from pipeline.messages import tell

MAX_PROSE_WIDTH: Final = 110
"""Largest number of characters on a line of prose."""

UNLIMITED_WIDTH: Final = 1000
"""Characters on a line of a table that is not for a terminal."""

MIN_HEADING_WIDTH: Final = 9
"""Characters that a title may take however narrow its column is."""

MIN_TEXT_WIDTH: Final = 16
"""Characters of a column of texts before they are broken over several lines."""

BOLD, GREEN, YELLOW, RED = "1", "32", "33", "31"
"""Codes of ANSI for the look of a text."""

COLOUR_BY_VERDICT: Final = {
    **dict.fromkeys(("good", "equal"), GREEN),
    **dict.fromkeys(("look", "open"), YELLOW),
    **dict.fromkeys(("tow_again", "differ"), RED),
}
"""Colour of a statement, by the code of its verdict; the words say the same."""

INDENT: Final = "  "
NOTHING: Final = "-"
"""What an empty cell of a table shows."""

NUMBER: Final = re.compile(r"[-+\u2212]?[0-9]+([.,][0-9]+)?(\u00a0[%sN])?|-")
"""A cell that is aligned to the right."""


def to_text(
    html: str, *, folded: bool = False, width: int | None = None, coloured: bool = False
) -> str:
    """Return a document as text.

    Args:
        html: the document.
        folded: whether to write what is folded on its page, too.
        width: characters on a line; as many as the terminal has when left out.
        coloured: whether headings are bold and verdicts have a colour, by codes of ANSI.
    """
    if width is None:
        is_terminal = sys.stdout.isatty()
        width = shutil.get_terminal_size().columns if is_terminal else UNLIMITED_WIDTH
    parts = []
    for block in read_blocks(html, folded=folded):
        text = _write(block, width)
        parts.append(_colour(block, text) if coloured else text)
    return re.sub(r"\n{3,}", "\n\n", "\n".join(parts)).strip("\n")


def _colour(block: Block, text: str) -> str:
    """Return the lines of a block in bold or in a colour, where it is a heading or a verdict."""
    verdict = block.said.partition(" ")[2]
    code = BOLD if block.kind == "heading" else COLOUR_BY_VERDICT.get(verdict)
    if code is None:
        return text
    return "\n".join(f"\x1b[{code}m{line}\x1b[0m" if line else "" for line in text.split("\n"))


def _write(block: Block, width: int) -> str:
    """Return a block as lines; a picture is nothing."""
    prose_width = min(MAX_PROSE_WIDTH, width)
    lines: list[str] = []
    if block.kind == "heading":
        rule = {1: "=", 2: "-"}.get(block.level, "") * len(block.text)
        lines = [f"\n{block.text}", rule] if rule else [f"\n{block.text}"]
    elif block.kind == "paragraph":
        lines = _wrap(block.text, prose_width)
    elif block.kind == "code":
        lines = [textwrap.indent(block.text, INDENT), ""]
    elif block.kind == "terms":
        for name, text in block.rows:
            lines += _wrap(f"{name}: {text}", prose_width, INDENT)
    elif block.kind == "table" and block.look != "steps":
        lines = [_draw_table(block, width), ""]
    elif block.kind == "columns":
        lines = [_write(one, width) for part in block.parts for one in part]
    return "\n".join(lines)


def _wrap(text: str, width: int, indent: str = "") -> list[str]:
    """Return a text as lines; names of files and commands stay whole."""
    return textwrap.wrap(
        text, width, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False
    )


class Column(NamedTuple):
    """A column of a table: its name, that on one or more lines, its cells, and its width."""

    name: str
    title: str
    cells: Sequence[str]
    width: int
    min_width: int

    @classmethod
    def from_cells(cls, column: Sequence[str]) -> Self:
        """Return the column of a name and the cells below it; a number or word is never broken."""
        name = column[0]
        cells = [cell or NOTHING for cell in column[1:]]
        widest = max(map(len, cells), default=0)
        longest_word = max(map(len, " ".join(cells).split(" ")))
        lines = textwrap.wrap(name, max(MIN_HEADING_WIDTH, widest), break_long_words=False)
        of_title = max(map(len, lines), default=0)
        min_width = max(longest_word, min(widest, MIN_TEXT_WIDTH), of_title)
        return cls(name, "\n".join(lines), cells, max(widest, of_title), min_width)


def _draw_table(block: Block, width: int) -> str:
    """Return a table as lines, columns of numbers to the right.

    Where not all columns fit, some are left out, and named below the table.
    """
    columns = list(map(Column.from_cells, zip(*block.rows, strict=True)))
    own_width = width - len(INDENT)
    fitting, left_out = _choose_columns(columns, block.not_narrow, own_width)
    table = Table(box=None, pad_edge=False, header_style="", collapse_padding=True)
    title_height = max(column.title.count("\n") for column in fitting)
    for column, column_width in zip(fitting, _fit_widths(fitting, own_width), strict=True):
        table.add_column(
            "\n" * (title_height - column.title.count("\n")) + column.title,
            justify="right" if all(map(NUMBER.fullmatch, column.cells)) else "left",
            overflow="fold",
            width=column_width,
        )
    for cells in zip(*(column.cells for column in fitting), strict=True):
        table.add_row(*cells)
    lines = [*_print(table, own_width)]
    if left_out:
        names = ", ".join(column.name for column in left_out)
        text = tell("Left out for want of room, see --wide: {}", names)
        lines += textwrap.wrap(text, width, initial_indent=INDENT, subsequent_indent=INDENT)
    return "\n".join(lines)


def _choose_columns(
    columns: Sequence[Column], not_narrow: Collection[int], width: int
) -> tuple[list[Column], list[Column]]:
    """Return the columns that fit on a line, each with a blank between, and those left out.

    Left out are, from the last on, first those that a phone does not show, then others; one stays.
    """
    places = range(len(columns))
    candidates = sorted(places, key=lambda place: (place in not_narrow, place))
    taken = sum(column.min_width + 1 for column in columns) - 1
    while len(candidates) > 1 and taken > width:
        taken -= columns[candidates.pop()].min_width + 1
    fitting: list[Column] = []
    left_out: list[Column] = []
    for place, column in enumerate(columns):
        (fitting if place in candidates else left_out).append(column)
    return fitting, left_out


def _fit_widths(columns: Sequence[Column], width: int) -> list[int]:
    """Return how wide columns are on a line, the widest narrowed first, to its least."""
    widths = [column.width for column in columns]
    least = [column.min_width for column in columns]
    while sum(widths) + len(widths) - 1 > width and widths != least:
        spare = [own - low for own, low in zip(widths, least, strict=True)]
        candidates = [place for place, room in enumerate(spare) if room > 0]
        widths[max(candidates, key=widths.__getitem__)] -= 1
    return widths


def _print(table: Table, width: int) -> Iterator[str]:
    console = Console(width=width, markup=False, highlight=False)
    with console.capture() as captured:
        console.print(table)
    for line in captured.get().splitlines():
        yield f"{INDENT}{line.rstrip()}"
