"""A document on paper: its blocks set by Typst, with the font of the pages.

The same content gives the same bytes on every machine.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from functools import cache
from pathlib import Path
from typing import Any, Final

import typst

from dashboards import fonts, words
from dashboards.document import Document
from dashboards.language import Language
from dashboards.reading import read_blocks

FOLDER: Final = Path(__file__).parent
EPOCH: Final = 0
"""The date that a PDF carries, in seconds since 1970."""


@cache
def _get_compiler() -> typst.Compiler:
    return typst.Compiler(
        FOLDER / "templates" / "paper.typ",
        root=FOLDER,
        font_paths=[fonts.FOLDER],
        ignore_system_fonts=True,
    )


def make_pdf(
    template: str,
    pages: Sequence[Mapping[str, Any]],
    language: str,
    title: str,
    *,
    simulated: bool,
    footing: str = "",
    about: Mapping[str, str] | None = None,
) -> bytes:
    """Return a document as PDF.

    Args:
        template: its name.
        pages: what a query found; each begins on a page of its own.
        language: `nl` or `en`.
        title: of the file, and at its foot where there is no `footing`.
        simulated: whether its boats are.
        footing: at the foot of every page.
        about: facts about the database.
    """
    spoken = Language(language, about)
    document = Document(spoken)
    mark = spoken.say(words.SIMULATED) if simulated else ""
    blocks = []
    for data in pages:
        html = document.render(template, **data)
        blocks.append(list(map(asdict, read_blocks(html, folded=True))))
    content = {
        "title": title,
        "language": language,
        "simulated": mark,
        "footing": footing or title,
        "pages": blocks,
    }
    inputs = {"content": json.dumps(content, ensure_ascii=False, default=str)}
    made = _get_compiler().compile(format="pdf", sys_inputs=inputs, timestamp=EPOCH)
    assert isinstance(made, bytes), "a PDF is one file"  # noqa: S101 - Typst's type is wider
    return made
