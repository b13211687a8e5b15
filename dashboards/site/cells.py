"""Cells of tables in one language: numbers, codes in words, links and hashes."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, Final

import polars as pl
from markupsafe import Markup, escape

from dashboards import labels
from dashboards.addresses import boat_path, type_path
from dashboards.columns import digits_of, written
from dashboards.site.parts import Page, Table, is_chosen
from dashboards.speech import Speech, duration
from pipeline.messages import LANGUAGES

LONG: Final = {
    *("flags", "cut_reason", "reason", "speed_reason", "causes", "message", "messages", "decision"),
    *("candidates", "name", "confused_with", "old_remark", "new_remark"),
}
"""Columns of texts that may take several lines."""

METHODS: Final = {"method", "from_method", "to_method"}
EDITIONS: Final = {"edition", "from_edition", "to_edition", "previous"}

Show = Callable[[Any], Markup]
Key = tuple[object, ...]


@dataclass(frozen=True)
class Rows:
    """The rows of a table as HTML.

    Attributes:
        html: all rows; those that the selectors do not show at first are hidden.
        keys: the values that selectors choose by; a row has the place of its own.
    """

    html: Markup
    keys: Sequence[Key]


class Cells:
    """Makes rows of tables in one language."""

    def __init__(self, speech: Speech) -> None:
        self.speech = speech
        self.text = speech.text
        self._text = cache(self._made)

    def _made(self, name: str, root: str, value: object) -> str:
        """The cell of a text in a column of this name; the same value comes often."""
        kind = "w" if name in LONG else "t"
        return f"<td class={kind}>{self._shower(name, root)(value)}</td>"

    def rows(self, page: Page, table: Table) -> Rows:
        """The rows of a table on a page."""
        height = table.frame.height
        columns = [hashable(table.frame[name]) for name in table.follows]
        keys: list[Key] = list(zip(*columns, strict=True)) if columns else [()] * height
        distinct = list(dict.fromkeys(keys))
        chosen = [page.chosen.get(name, "") for name in table.follows]
        marks = {
            key: f" data-k={place}{'' if all(map(is_chosen, key, chosen)) else ' hidden'}"
            for place, key in enumerate(distinct)
        }
        boats = [""] * height
        if table.linked:
            boats = [f' data-boat="{escape(number)}"' for number in table.frame["fsn_no"]]
        # Column by column, because the cells of a column are made in one way.
        cells = zip(
            *(self._cells(table.frame[name], page.root) for name in table.shown), strict=True
        )
        rows = zip(map("".join, cells), keys, boats, strict=True)
        lines = (f"<tr{boat}{marks[key]}>{row}</tr>" for row, key, boat in rows)
        return Rows(Markup("\n".join(lines)), distinct)  # noqa: S704 - escaped parts

    def _cells(self, column: pl.Series, root: str) -> Sequence[str]:
        """Cells of a column; a number is what has no class, and text that may be wide is `w`."""
        name = column.name
        if name == "rowing_time_s":
            return [f"<td class=t>{'' if v is None else duration(v)}</td>" for v in column]
        if column.dtype.is_float():
            values = [math.nan if v is None else v for v in column.to_list()]
            return [f"<td>{text}</td>" for text in self.speech.numbers(values, digits_of(name))]
        if column.dtype.is_integer() and name != "direction":
            return [f"<td>{'' if v is None else v}</td>" for v in column.to_list()]
        empty = "<td class=t></td>"
        return [empty if v is None else self._text(name, root, v) for v in hashable(column)]

    def _shower(self, name: str, root: str) -> Show:
        """How values of a column are shown."""
        if name == "fsn_no":
            return lambda value: Markup('<a href="{}{}">{}</a>').format(
                root, boat_path(value), value
            )
        if name == "boat_type":
            return lambda value: self._type(value, root)
        named = {
            "messages": self._message,
            "direction": lambda value: self.text(labels.code(f"direction.{value}")),
            "tows": lambda value: self.text(labels.code(value)),
            "unit": lambda value: escape("" if value == "1" else value),
            **dict.fromkeys(("sha256", "content_hash", "method_hash", "seal"), _hash),
            **dict.fromkeys(METHODS, lambda value: self.text(labels.method(value))),
            **dict.fromkeys(EDITIONS, self._edition),
        }
        return named.get(name, lambda value: escape(written(name, value, self.speech)))

    def _edition(self, value: str) -> Markup:
        return escape(self.speech.edition(value))

    def _type(self, value: str, root: str) -> Markup:
        if value in ("unknown", "all"):
            return self.text(labels.code(value))
        return Markup('<a href="{}{}">{}</a>').format(root, type_path(value), value)

    def _message(self, value: Any) -> Markup:
        """The message in this language, of one in Dutch and one in English."""
        return escape(value[LANGUAGES.index(self.speech.language)])


def hashable(column: pl.Series) -> list[Any]:
    """Its values; lists as tuples."""
    values = column.to_list()
    return [tuple(v) if isinstance(v, list) else v for v in values]


def _hash(value: str) -> Markup:
    return Markup("<code>{}</code>").format(value[:12])
