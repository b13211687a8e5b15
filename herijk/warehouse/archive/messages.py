"""Sentences about the archive, said once in English and in Dutch.

A sentence is made by `say` from its English text with names in braces; `dutch` has the Dutch text
to each, as in gettext. It is a text like any other, and can be said again in the other language.
"""

from collections.abc import Mapping
from typing import Any

from herijk.warehouse.archive.dutch import DUTCH


class Sentence(str):
    """A sentence in English that knows its template and what is filled in.

    Attributes:
        template: the English text with names in braces.
        values: what is in their place; may be sentences themselves.
    """

    __slots__ = ("template", "values")

    template: str
    values: Mapping[str, Any]

    def spoken(self, language: str) -> str:
        """Return the sentence in `en` or `nl`; in English where there is no Dutch."""
        template = DUTCH.get(self.template, self.template) if language == "nl" else self.template
        return template.format(**{k: spoken(v, language) for k, v in self.values.items()})


def say(template: str, **values: Any) -> Sentence:
    """Return the sentence that a template gives with the values filled in.

    What comes from files and libraries is made printable: it goes to terminals and tables.
    """
    shown = {name: _printable(value) for name, value in values.items()}
    sentence = Sentence(template.format(**shown))
    sentence.template, sentence.values = template, shown
    return sentence


def _printable(value: Any) -> Any:
    """Return text or an error as one line without control characters; other values as they are."""
    if isinstance(value, Sentence) or not isinstance(value, str | Exception):
        return value
    line = " ".join(str(value).split())
    return "".join(letter if letter.isprintable() else "?" for letter in line)


def spoken(text: Any, language: str) -> Any:
    """Return a sentence in the language asked for; anything else unchanged."""
    return text.spoken(language) if isinstance(text, Sentence) else text


def innermost(text: str) -> str:
    """Return what a sentence says of its line: the sentence within `Line 3: ...`."""
    while isinstance(text, Sentence) and isinstance(text.values.get("what"), str):
        text = text.values["what"]
    return text
