"""A document as text for a terminal: its blocks below each other, tables drawn by rich."""

import re
import shutil
import sys
import textwrap
from collections.abc import Iterator
from typing import Final

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

INDENT: Final = "  "
NOTHING: Final = "-"
"""What an empty cell of a table shows."""

NUMBER: Final = re.compile(r"[-+\u2212]?[0-9]+([.,][0-9]+)?(\u00a0[%sN])?|-")
"""A cell that is aligned to the right."""


def to_text(html: str, *, folded: bool = False, width: int | None = None) -> str:
    """Return a document as text.

    Args:
        html: the document.
        folded: whether to write what is folded on its page, too.
        width: characters on a line; as many as the terminal has when left out.
    """
    if width is None:
        is_terminal = sys.stdout.isatty()
        width = shutil.get_terminal_size().columns if is_terminal else UNLIMITED_WIDTH
    parts = [_write(block, width) for block in read_blocks(html, folded=folded)]
    return re.sub(r"\n{3,}", "\n\n", "\n".join(parts)).strip()


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


def _draw_table(block: Block, width: int) -> str:
    """Return a table as lines; where it is too wide, without the columns that a phone leaves out.

    A line below it then names those. Numbers and words stay whole: what is still too wide is for
    the terminal to wrap.
    """
    own_width = width - len(INDENT)
    least = _measure_least_width(block.rows)
    left_out = block.not_narrow if least > own_width else set()
    rows = [[cell for place, cell in enumerate(row) if place not in left_out] for row in block.rows]
    lines = _draw_rows(rows, max(own_width, _measure_least_width(rows)))
    if left_out:
        titles = ", ".join(block.rows[0][place] for place in sorted(left_out))
        note = tell("Too wide for this terminal: {}. A file or a pager shows them.", titles)
        lines += _wrap(f"{INDENT}{note}", width, INDENT)
    return "\n".join(lines)


def _measure_least_width(rows: list[list[str]]) -> int:
    """Return the characters that a table needs where only words and numbers stay whole."""
    columns = zip(*rows, strict=True)
    return sum(1 + max(_measure_longest_word(cell) for cell in column) for column in columns)


def _measure_longest_word(text: str) -> int:
    return max(map(len, text.split(" ")), default=0)


def _draw_rows(rows: list[list[str]], width: int) -> list[str]:
    """Return a table as lines of at most this width, columns of numbers to the right."""
    titles, *body = rows
    table = Table(box=None, pad_edge=False, header_style="", collapse_padding=True)
    shown = [[cell or NOTHING for cell in row] for row in body]
    for title, cells in zip(titles, zip(*shown, strict=True), strict=True):
        title_width = max(MIN_HEADING_WIDTH, *map(len, cells))
        is_number = all(map(NUMBER.fullmatch, cells))
        table.add_column(
            "\n".join(textwrap.wrap(title, title_width, break_long_words=False)),
            justify="right" if is_number else "left",
            vertical="bottom",
            overflow="fold",
            min_width=max(map(_measure_longest_word, (title, *cells))),
        )
    for row in shown:
        table.add_row(*row)
    return list(_print(table, width))


def _print(table: Table, width: int) -> Iterator[str]:
    console = Console(width=width, markup=False, highlight=False)
    with console.capture() as captured:
        console.print(table)
    for line in captured.get().splitlines():
        yield f"{INDENT}{line.rstrip()}"
