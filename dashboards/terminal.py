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


def to_text(html: str, *, folded: bool = False) -> str:
    """Return a document as text; what is folded on its page only where that is asked for."""
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
        lines = [_draw_table(block.rows, width), ""]
    elif block.kind == "columns":
        lines = [_write(one, width) for part in block.parts for one in part]
    return "\n".join(lines)


def _wrap(text: str, width: int, indent: str = "") -> list[str]:
    """Return a text as lines; names of files and commands stay whole."""
    return textwrap.wrap(
        text, width, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False
    )


def _draw_table(rows: list[list[str]], width: int) -> str:
    """Return a table as lines, columns of numbers to the right."""
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
        )
    for row in shown:
        table.add_row(*row)
    return "\n".join(_print(table, width - len(INDENT)))


def _print(table: Table, width: int) -> Iterator[str]:
    console = Console(width=width, markup=False, highlight=False)
    with console.capture() as captured:
        console.print(table)
    for line in captured.get().splitlines():
        yield f"{INDENT}{line.rstrip()}"
