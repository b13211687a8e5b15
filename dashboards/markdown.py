"""Documents written in Markdown, for pages and for paper."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Final

from markdown_it import MarkdownIt
from markdown_it.token import Token
from markupsafe import Markup

_SCROLLED: Final = '<div class="scroll" tabindex="0">'
"""A table may be wider than a phone: it scrolls in a box of its own, also by keyboard."""

_READER = MarkdownIt("commonmark", {"html": False}).enable("table")


def to_html(text: str, links: Mapping[str, str]) -> Markup:
    """A document as HTML, its headings one level down: a page has a title of its own.

    Diagrams are left out: to draw them takes a script of megabytes.

    Args:
        text: the document; HTML in it is shown, not obeyed.
        links: for addresses in it, where they lead; a link to anything else becomes plain text.
    """
    tokens = [token for token in _READER.parse(text) if token.info != "mermaid"]
    for token in tokens:
        if token.type in ("heading_open", "heading_close"):
            token.tag = f"h{int(token.tag[1:]) + 1}"
        _lead(token.children or (), links)
    html = _READER.renderer.render(tokens, _READER.options, {})
    scrolled = html.replace("<table>", f"{_SCROLLED}<table>").replace("</table>", "</table></div>")
    return Markup(scrolled)  # noqa: S704 - escaped


def _lead(tokens: Iterable[Token], links: Mapping[str, str]) -> None:
    """Lets links lead to pages; links are not nested."""
    plain = False
    for token in tokens:
        if token.type == "link_open":
            target = links.get(str(token.attrs["href"]))
            plain = target is None
            token.attrs = {} if target is None else {"href": target}
        if token.type in ("link_open", "link_close") and plain:
            token.tag = "span"


def to_blocks(text: str) -> list[dict[str, Any]]:
    """A document as plain data for a template of paper.

    Returns:
        Per block its `kind`: heading (with `level`), paragraph, or table (with `rows` of cells);
        texts are lists of runs with `text`, `strong` and `code`.
    """
    return list(_blocks(_READER.parse(text)))


def _blocks(tokens: Iterable[Token]) -> Iterator[dict[str, object]]:
    level = 0
    rows: list[list[object]] = []
    for token in tokens:
        if token.type == "heading_open":
            level = int(token.tag[1:])
        elif token.type == "table_open":
            rows = []
        elif token.type == "tr_open":
            rows.append([])
        elif token.type == "table_close":
            yield {"kind": "table", "rows": rows}
            rows = []
        elif token.type == "inline" and rows:
            rows[-1].append(_runs(token))
        elif token.type == "inline":
            kind = {"kind": "heading", "level": level} if level else {"kind": "paragraph"}
            yield kind | {"runs": _runs(token)}
            level = 0


def _runs(inline: Token) -> list[dict[str, object]]:
    spans, strong = [], False
    for token in inline.children or ():
        if token.type in ("strong_open", "strong_close"):
            strong = token.type == "strong_open"
        elif token.type in ("softbreak", "hardbreak"):
            spans.append({"text": " ", "strong": strong, "code": False})
        elif token.content:
            spans.append(
                {"text": token.content, "strong": strong, "code": token.type == "code_inline"}
            )
    return spans
