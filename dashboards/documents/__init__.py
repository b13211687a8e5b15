"""Documents for paper: certificates and proposals, as PDF.

Python gathers texts and numbers; the templates lay them out and hold no words. Typst sets them with
the font of the pages, so that a document is the same on every machine.
"""

import json
from functools import cache
from pathlib import Path
from typing import Any, Final

import typst

from dashboards import fonts

TEMPLATES: Final = Path(__file__).parent / "templates"
EPOCH: Final = 0
"""The date that a PDF carries: the same input gives the same bytes."""


@cache
def _compiler(template: str) -> typst.Compiler:
    return typst.Compiler(
        TEMPLATES / template, root=TEMPLATES, font_paths=[fonts.FOLDER], ignore_system_fonts=True
    )


def pdf(template: str, content: dict[str, Any]) -> bytes:
    """A document of this content."""
    inputs = {"content": json.dumps(content, ensure_ascii=False, default=str)}
    made = _compiler(template).compile(format="pdf", sys_inputs=inputs, timestamp=EPOCH)
    assert isinstance(made, bytes), "a PDF is one file"  # noqa: S101 - Typst's type is wider
    return made
