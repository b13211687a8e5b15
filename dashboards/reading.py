"""A document read as blocks: headings, paragraphs, tables and pictures, for terminal and paper.

What is not chosen on the page is left out, and what is folded unless it is asked for.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from html import escape
from html.parser import HTMLParser
from typing import Final

from dashboards.pictures import make_standalone

SKIPPED_TAGS: Final = ("head", "header", "form", "footer", "button", "summary", "nav")
"""Parts of a page that say nothing elsewhere."""

SKIPPED_CLASSES: Final = ("links", "skip", "tools", "screen")
"""Classes of such parts."""

NOT_NARROW: Final = "p"
"""Class of cells that a phone does not show."""

HEADING_LEVELS: Final = {"h1": 1, "h2": 2, "h3": 3, "h4": 4}
TEXT_TAGS: Final = (*HEADING_LEVELS, "p", "aside", "figcaption", "li", "dt", "dd", "pre")
"""Elements that hold a text."""

CELL_TAGS: Final = ("td", "th")
UNENDED_TAGS: Final = (*CELL_TAGS, "tr")
"""Elements that may lack an end tag, as HTML allows: long tables save a tenth of a page by it."""

VOID_TAGS: Final = ("meta", "link", "input", "br", "hr", "img")
STYLES: Final = {"strong": "strong", "b": "strong", "code": "code"}
"""Elements within a text that are set otherwise."""

HARD_BREAKS: Final = re.compile("[\u00ad\u200b]")
BLANKS: Final = re.compile(r"[ \n]+")


@dataclass
class Block:
    """A part of a document.

    Attributes:
        kind: `heading`, `paragraph`, `code`, `terms`, `table`, `picture`, `columns` or `break` of
            a page.
        text: of a heading, paragraph or code; of a picture the SVG.
        runs: the same text in parts of one style: pairs of style and text.
        level: of a heading.
        look: classes of the element.
        caption: of a picture.
        about: what a statement is about: a boat and crew, a type, an edition.
        said: the kind of a statement and the code of its verdict.
        rows: of a table, the titles first; of terms, pairs of name and text.
        not_narrow: of a table, places of the columns that a phone does not show.
        parts: of columns, the blocks of each.
    """

    kind: str
    text: str = ""
    runs: list[tuple[str, str]] = field(default_factory=list)
    level: int = 0
    look: str = ""
    caption: str = ""
    about: str = ""
    said: str = ""
    rows: list[list[str]] = field(default_factory=list)
    not_narrow: set[int] = field(default_factory=set)
    parts: "list[list[Block]]" = field(default_factory=list)


def read_blocks(html: str, *, folded: bool = False) -> list[Block]:
    """Return the blocks of a document; a heading with nothing below it is left out.

    Args:
        html: the document.
        folded: whether to read what the page folds, too.
    """
    reader = _Reader(folded)
    reader.feed(html)
    return list(_drop_empty(reader.blocks))


def _drop_empty(blocks: list[Block]) -> Iterator[Block]:
    """Yield blocks without tables that have no rows, and without headings of nothing."""
    kept = [block for block in blocks if block.kind != "table" or len(block.rows) > 1]
    followed_by = [*kept[1:], Block("heading", level=1)]
    for block, following in zip(kept, followed_by, strict=False):
        is_heading = block.kind == "heading" and following.kind == "heading"
        if not is_heading or following.level > block.level or block.level == 1:
            yield block


class _Reader(HTMLParser):
    """Collects the blocks of a document."""

    def __init__(self, folded: bool) -> None:
        super().__init__()
        self.blocks: list[Block] = []
        self._page = self.blocks
        self._folded = folded
        self._left_out: list[str] = []  # open elements of a part that is left out
        self._attributes: dict[str, str | None] = {}
        self._runs: list[tuple[str, str]] = []
        self._style = ""
        self._about = ""
        self._svg = ""
        self._open_cell = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Begin an element, or a part that is left out."""
        own = dict(attrs)
        if self._svg or tag == "svg":
            self._svg += self.get_starttag_text() or ""
        elif self._left_out:
            self._left_out += [tag] if tag not in (*VOID_TAGS, *UNENDED_TAGS) else []
        elif self._is_left_out(tag, own):
            self._left_out = [] if tag in VOID_TAGS else [tag]
        else:
            self._about = own.get("data-about") or self._about
            self._begin(tag, own)

    def _is_left_out(self, tag: str, own: dict[str, str | None]) -> bool:
        classes = (own.get("class") or "").split()
        is_title_of_fold = tag == "summary" and self._folded
        return (
            "hidden" in own
            or any(name in SKIPPED_CLASSES for name in classes)
            or (tag == "details" and not self._folded)
            or (tag in SKIPPED_TAGS and not is_title_of_fold)
        )

    def _begin(self, tag: str, own: dict[str, str | None]) -> None:
        look = own.get("class") or ""
        first = look.partition(" ")[0]
        if first in ("columns", "column") or tag == "hr":
            self._begin_layout(first, look)
        elif tag in ("table", "dl"):
            self.blocks.append(Block("table" if tag == "table" else "terms", look=look))
        elif tag in UNENDED_TAGS:
            self._end_cell()
            if tag == "tr":
                self.blocks[-1].rows.append([])
            else:
                self._open_cell = tag
                self._runs, self._attributes = [], own
        elif tag in STYLES:
            self._style = STYLES[tag]
        elif tag == "br":
            self._runs.append((self._style, " "))
        elif tag in TEXT_TAGS:
            self._runs, self._attributes = [], own

    def _begin_layout(self, first: str, look: str) -> None:
        """Begin columns or one of them; a rule ends columns, and perhaps the page."""
        if first == "columns":
            self._page.append(Block("columns", look=look))
        elif first == "column":
            self.blocks = []
            self._page[-1].parts.append(self.blocks)
        else:
            self.blocks = self._page
            if look == "page":
                self.blocks.append(Block("break"))

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Take a whole element: a part of a picture, or one that holds nothing."""
        if self._svg:
            self._svg += self.get_starttag_text() or ""
        else:
            super().handle_startendtag(tag, attrs)

    def handle_endtag(self, tag: str) -> None:
        """End an element."""
        if self._svg:
            self._svg += f"</{tag}>"
            if tag == "svg":
                self._add_picture()
        elif self._left_out:
            if tag == self._left_out[-1]:
                self._left_out.pop()
        elif tag in STYLES:
            self._style = ""
        elif tag in (*UNENDED_TAGS, "thead", "tbody", "table"):
            self._end_cell()
        elif tag in TEXT_TAGS:
            self._add_text(tag)

    def _end_cell(self) -> None:
        """Take the text of the cell that is open, if one is."""
        if self._open_cell:
            self._add_text(self._open_cell)
            self._open_cell = ""

    def _add_text(self, tag: str) -> None:
        runs = [(style, HARD_BREAKS.sub("", text)) for style, text in self._runs]
        self._runs = []
        if tag == "pre":
            text = "".join(part for _, part in runs)
            self.blocks.append(Block("code", text.strip("\n")))
            return
        runs = _squeeze(runs)
        text = "".join(part for _, part in runs)
        if tag in CELL_TAGS:
            row = self.blocks[-1].rows[-1]
            if tag == "th" and NOT_NARROW in (self._attributes.get("class") or "").split():
                self.blocks[-1].not_narrow.add(len(row))
            row.append(text)
        elif tag == "dt":
            self.blocks[-1].rows.append([text, ""])
        elif tag == "dd":
            row = self.blocks[-1].rows[-1]
            row[1] = f"{row[1]} {text}".strip()
        elif text:
            level = HEADING_LEVELS.get(tag, 0)
            self.blocks.append(
                Block(
                    kind="heading" if level else "paragraph",
                    text=f"- {text}" if tag == "li" else text,
                    runs=[("", "- "), *runs] if tag == "li" else runs,
                    level=level,
                    look=self._attributes.get("class") or "",
                    about=self._about,
                    said=self._attributes.get("data-said") or "",
                )
            )

    def handle_data(self, data: str) -> None:
        """Take a text."""
        if self._svg:
            self._svg += escape(data)
        elif not self._left_out:
            self._runs.append((self._style, data))

    def _add_picture(self) -> None:
        """Add a picture; one in a table is a part of it, one without a caption an ornament."""
        caption = re.search(r'aria-label="([^"]*)"', self._svg)
        is_in_table = bool(self.blocks) and self.blocks[-1].look == "steps"
        if not self._left_out and not is_in_table:
            shown = caption[1] if caption else ""
            self.blocks.append(Block("picture", make_standalone(self._svg), caption=shown))
        self._svg = ""


def _squeeze(runs: list[tuple[str, str]]) -> list[tuple[str, str]]:
    """Return runs with single blanks, and none at either end."""
    squeezed: list[tuple[str, str]] = []
    after_blank = True
    for style, text in runs:
        short = BLANKS.sub(" ", text)
        if after_blank:
            short = short.lstrip(" ")
        if short:
            squeezed.append((style, short))
            after_blank = short.endswith(" ")
    if squeezed:
        style, text = squeezed[-1]
        squeezed[-1] = (style, text.rstrip(" "))
    return squeezed
