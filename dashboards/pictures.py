"""What a picture of a page needs to stand alone: as a file, or a part of a PDF."""

from typing import Final

from markupsafe import Markup

FONT_SIZE_PX: Final = 12

STANDALONE_LOOKS: Final = (
    'xmlns="http://www.w3.org/2000/svg" fill="currentColor" font-family="Open Sans, sans-serif" '
    f'font-size="{FONT_SIZE_PX}"'
)
"""What a picture needs outside a page; the style sheet of pages says it once for all of theirs."""


def make_standalone(svg: str) -> Markup:
    """Return a picture of a page as a file, or a part of a PDF, can have it."""
    plain = str(svg)  # markup would escape what replaces
    if "xmlns=" not in plain:
        plain = plain.replace("<svg ", f"<svg {STANDALONE_LOOKS} ", 1)
    return Markup(plain)  # noqa: S704 - our own
