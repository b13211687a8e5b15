"""Documents written in Markdown, as HTML for pages and paper."""

from collections.abc import Iterable, Mapping
from functools import cache
from typing import TYPE_CHECKING, Final

from markupsafe import Markup

from dashboards.guides import GUIDES

if TYPE_CHECKING:
    from markdown_it import MarkdownIt
    from markdown_it.token import Token

_SCROLLED: Final = '<div class="scroll" tabindex="0">'
"""A table may be wider than a phone: it scrolls in a box of its own, also by keyboard."""

LINKS: Final = {f"{name}.md": f"{name}.html" for name in GUIDES}
"""Where links between the documents lead on the site; others become plain text."""


@cache
def _get_reader() -> "MarkdownIt":
    from markdown_it import MarkdownIt  # noqa: PLC0415 - few documents hold Markdown

    return MarkdownIt("commonmark", {"html": False}).enable("table")


def get_title(text: str) -> str:
    """Return the heading with which a document or a section of it begins."""
    return text.partition("\n")[0].lstrip("# ")


def to_html(text: str, levels_down: int = 1) -> Markup:
    """Return a document without its first line.

    HTML in it is shown, not obeyed. Diagrams are left out: a script that draws them is large.

    Args:
        text: the document, in Markdown.
        levels_down: how many levels its headings are lower on the page.
    """
    reader = _get_reader()
    below_title = text.partition("\n")[2]
    tokens = [token for token in reader.parse(below_title) if token.info != "mermaid"]
    for token in tokens:
        if token.type in ("heading_open", "heading_close"):
            token.tag = f"h{int(token.tag[1:]) + levels_down}"
        _redirect_links(token.children or (), LINKS)
    html = reader.renderer.render(tokens, reader.options, {})
    scrolled = html.replace("<table>", f"{_SCROLLED}<table>").replace("</table>", "</table></div>")
    return Markup(scrolled)  # noqa: S704 - escaped


def _redirect_links(tokens: "Iterable[Token]", links: Mapping[str, str]) -> None:
    """Let links lead to pages of the site; links are not nested."""
    is_plain = False
    for token in tokens:
        if token.type == "link_open":
            target = links.get(str(token.attrs["href"]))
            is_plain = target is None
            token.attrs = {} if target is None else {"href": target}
        if token.type in ("link_open", "link_close") and is_plain:
            token.tag = "span"
