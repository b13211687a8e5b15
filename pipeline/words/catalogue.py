"""Texts of pages and documents, in Dutch and English, in one table by key.

A code of the warehouse (a status, a flag, a step) has a line too; a code without one is shown as
it is. Names of boats, methods and editions are data and never translated.
"""

from collections.abc import Callable, Mapping
from functools import cache
from typing import Final, TypeAlias

from pipeline.words.answers import ANSWERS
from pipeline.words.codes import CODES
from pipeline.words.columns import COLUMNS
from pipeline.words.documents import DOCUMENTS
from pipeline.words.pages import PAGES
from pipeline.words.report import REPORT
from pipeline.words.sentences import LANGUAGE, LANGUAGES
from pipeline.words.slides import SLIDES

Say = Callable[[str], str]
"""Gives the text of a key in one language."""

Words: TypeAlias = Mapping[str, tuple[str, str]]
"""Texts in Dutch and English by key."""

WORDS: Final[Words] = PAGES | ANSWERS | DOCUMENTS | SLIDES | REPORT | COLUMNS | CODES


def both(key: str, words: Words = WORDS) -> tuple[str, str]:
    """A text in Dutch and English; a code or column without one stands for itself."""
    known = words.get(key)
    if known is None and "." not in key:
        raise KeyError(key)
    bare = key.split(".", 1)[-1]
    return known or (bare, bare)


def unbroken(heading: str) -> str:
    """A heading without the places where it may be broken."""
    return heading.replace("\u00ad", "").replace("\u200b", "")


@cache
def speaker(language: str) -> Say:
    """The texts of one language."""
    place = LANGUAGES.index(language)
    return lambda key: both(key)[place]


def code(name: str) -> str:
    """A code of the tables in words, in the language of this command."""
    return speaker(LANGUAGE.get())(f"code.{name}")
