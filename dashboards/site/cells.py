"""Cells of tables in one language: numbers, codes in words, links and hashes."""

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, Final

import polars as pl
from markupsafe import Markup, escape

from dashboards import labels
from dashboards.addresses import boat_path, type_path
from dashboards.site.parts import Page, Table, is_chosen
from dashboards.speech import Speech, duration
from dashboards.statements.edition import cause_name
from pipeline.messages import LANGUAGES

DIGITS: Final = (
    ("_kg_m", 2), ("_m_s", 2), ("_deg", 0), ("_kg", 0), ("_w", 1), ("_s", 0), ("cw_sd", 2),
    ("_m", 2), ("step_sd", 4), ("_sd", 1), ("dof", 1), ("before_percent", 3), ("after_percent", 3),
    ("_percent", 1), ("size", 1), ("size_lo", 1),
    ("size_hi", 1), ("_1pct", 2), ("_2pct", 2), ("cw_ratio", 3),
)  # fmt: skip
"""Decimals shown by the ending of a column's name; 4 otherwise."""

CODES: Final = {
    *("status", "flags", "reason", "cut_reason", "change", "source", "step", "component", "code"),
    *("quantity", "explaining", "within", "severity", "check", "shared", "kind", "scope"),
    *("old_remark", "new_remark", "choice"),
    *("option", "speed_reason", "cause", "log", "flag", "what", "outcome", "reason_code", "lost"),
    *("instrument", "verdict", "confused_with"),
}
"""Columns that hold codes of the warehouse, shown as words."""

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
            digits = next((d for ending, d in DIGITS if name.endswith(ending)), 4)
            values = [math.nan if v is None else v for v in column.to_list()]
            return [f"<td>{text}</td>" for text in self.speech.numbers(values, digits)]
        if column.dtype.is_integer() and name != "direction":
            return [f"<td>{'' if v is None else v}</td>" for v in column.to_list()]
        empty = "<td class=t></td>"
        return [empty if v is None else self._text(name, root, v) for v in hashable(column)]

    def _shower(self, name: str, root: str) -> Show:
        """How values of a column are shown."""
        if name in ("fsn_no", "influence_boat"):
            return lambda value: Markup('<a href="{}{}">{}</a>').format(
                root, boat_path(value), value
            )
        if name == "boat_type":
            return lambda value: self._type(value, root)
        named = {
            "messages": self._message,
            "direction": lambda value: self.text(labels.code(f"direction.{value}")),
            "causes": self._causes,
            "candidates": lambda names: Markup(", ").join(
                self.text(labels.candidate(name)) for name in names
            ),
            "tows": lambda value: self.text(labels.code(value)),
            "unit": lambda value: self._plain("" if value == "1" else value),
            **dict.fromkeys(("sha256", "content_hash", "method_hash", "seal"), _hash),
            **dict.fromkeys(METHODS, lambda value: self.text(labels.method(value))),
            **dict.fromkeys(EDITIONS, self._edition),
            **dict.fromkeys(CODES, self._code),
        }
        return named.get(name, self._plain)

    def _edition(self, value: str) -> Markup:
        return escape(self.speech.edition(value))

    def _type(self, value: str, root: str) -> Markup:
        if value in ("unknown", "all"):
            return self.text(labels.code(value))
        return Markup('<a href="{}{}">{}</a>').format(root, type_path(value), value)

    def _plain(self, value: object) -> Markup:
        if isinstance(value, bool):
            return self.text("yes" if value else "no")
        return escape(value)

    def _code(self, value: Any) -> Markup:
        """A code, or several with commas or as a list, in words."""
        codes = value.split(",") if isinstance(value, str) else list(value)
        return Markup(", ").join(self.text(labels.code(code)) for code in codes if code)

    def _causes(self, value: str) -> Markup:
        """What a change is attributed to (a method's step by its name), each in per cent."""
        parts = [
            self.text(cause_name(cause)) + f" {self.speech.per_cent(cause['factor'])}"
            for cause in json.loads(value)
        ]
        return Markup("; ").join(parts)

    def _message(self, value: Any) -> Markup:
        """The message in this language, of one in Dutch and one in English."""
        return escape(value[LANGUAGES.index(self.speech.language)])


def hashable(column: pl.Series) -> list[Any]:
    """Its values; lists as tuples."""
    values = column.to_list()
    return [tuple(v) if isinstance(v, list) else v for v in values]


def _hash(value: str) -> Markup:
    return Markup("<code>{}</code>").format(value[:12])
