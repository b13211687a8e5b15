"""A document: a template filled with what a query found, in one language, as plain HTML.

There is one template per subject. Its HTML is the page of the site; `terminal` and `paper` read it,
so that what a document says is told once. Texts are English and marked by `_`, `say` or `mark`; a
value is written as its column is everywhere.
"""

import json
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Final, TypeAlias

import polars as pl
from markupsafe import Markup, escape

from dashboards import charts, words
from dashboards.addresses import (
    boat_path,
    boat_sheet,
    edition_page,
    race_path,
    race_sheets,
    trace_path,
    type_path,
)
from dashboards.language import Language, write_duration
from dashboards.markdown import get_title, to_html
from dashboards.templates import get_template
from pipeline.messages import LANGUAGES, Sentence, format_probability, ngettext, pgettext
from pipeline.method.options import find_basis
from pipeline.method.writing import range_text
from pipeline.tables.display import get_column

WIDE_COLUMNS: Final = re.compile(
    "reason|causes|message|decision|candidates|confused_with|remark|flags|explanation|checks|doubted"
)
"""Columns of texts that may take several lines."""

HASHES: Final = ("sha256", "method_hash", "content_hash", "seal")
HASH_LENGTH: Final = 12
"""Number of characters of a hash that a table shows."""

UNIT_AFTER_NUMBER: Final = re.compile(r"(?<=\d) (?=(?:%|kg/m|m/s|kg|W|N|s)(?:\W|$))")

Rows: TypeAlias = pl.DataFrame | Sequence[Mapping[str, Any]]

_GLOBALS: Final = {
    "boat_path": boat_path,
    "type_path": type_path,
    "race_path": race_path,
    "boat_sheet": boat_sheet,
    "race_sheets": race_sheets,
    "edition_page": edition_page,
    "pgettext": pgettext,
    "ngettext": ngettext,
    "mark": str,
    "to_html": to_html,
    "get_heading": get_title,
    "write_duration": write_duration,
    "write_chance": format_probability,
    "find_basis": find_basis,
    "write_range": range_text,
    "SIMULATED": words.SIMULATED,
    "FAILED_CHECKS": words.FAILED_CHECKS,
    "to_json": json.dumps,
}
"""What every template can use besides the methods of its document and its language."""

_OF_DOCUMENT: Final = (
    "say",
    "table",
    "draw",
    "draw_each",
    "draw_traces",
    "show_when",
    "language",
    "root",
)
_OF_LANGUAGE: Final = (
    "name_code",
    "name_method",
    "name_crew",
    "name_edition",
    "name_option",
    "name_choice",
    "get_title",
    "get_unit",
    "write_seasons",
    "write",
    "write_number",
    "write_percent",
    "write_change",
    "write_day",
    "write_plain",
)


class Document:
    """What a template can say, list, draw and choose.

    Args:
        language: of everything that is said.
        root: the way from the page to the first page of its language.
        chosen: what each selector of the page says at first. A selector without a choice shows
            everything, with what it would choose by as a column of its own.
        pictures: whether charts can be shown.
        link: gives the address that a value of a column leads to, by both; empty for none. Pages of
            the site when left out.
    """

    def __init__(
        self,
        language: Language,
        root: str = "",
        chosen: Mapping[str, str] | None = None,
        *,
        pictures: bool = True,
        link: Callable[[str, Any], str] | None = None,
    ) -> None:
        self.language = language
        self.root = root
        self.chosen = dict(chosen or {})
        self.pictures = pictures
        self._link = link or self._link_to_page

    def render(self, template: str, **data: Any) -> str:
        """Return the document as HTML."""
        return get_template(f"{template}.html.j2").render(self.get_names() | data)

    def get_names(self) -> dict[str, Any]:
        """Return the names that every template can use."""
        of_document = {name: getattr(self, name) for name in _OF_DOCUMENT}
        of_language = {name: getattr(self.language, name) for name in _OF_LANGUAGE}
        chosen = {"_": self.text, "chosen": self.chosen}
        return _GLOBALS | of_document | of_language | chosen

    # -- Texts ------------------------------------------------------------------------------------

    def text(self, text: str, row: Mapping[str, Any] | None = None, /, **values: Any) -> Markup:
        """Return a text with values filled in, in which numbers and units stay on one line."""
        filled = self.language.fill_in(text, row, **values)
        return Markup(UNIT_AFTER_NUMBER.sub("\u00a0", filled))  # noqa: S704 - was escaped

    def say(
        self,
        text: str,
        row: Mapping[str, Any] | None = None,
        /,
        kind: str = "",
        verdict: str = "",
        **values: Any,
    ) -> Markup:
        """Return a statement: a paragraph that says of what kind it is, and the code of a verdict.

        Args:
            text: see `text`.
            row: values by column.
            kind: the code of what the statement is about.
            verdict: the code of a verdict in it, as a query gives it.
            values: go before those of the row.
        """
        said = self.text(text, row, **values)
        return Markup('<p data-said="{}">{}</p>').format(f"{kind} {verdict}".strip(), said)

    # -- What is chosen on the page ---------------------------------------------------------------

    def show_when(self, values: Mapping[str, Sequence[str]]) -> Markup:
        """Return attributes of a part that is shown where selectors say one of these values."""
        attributes, hidden = "", ""
        for name, own in values.items():
            attributes += f' data-{name}="{escape("|".join(own))}"'
            choice = self.chosen.get(name)
            if choice and choice not in own:
                hidden = " hidden"
        return Markup(attributes + hidden)  # noqa: S704 - was escaped

    # -- Charts -----------------------------------------------------------------------------------

    def draw(self, chart: str, *given: Any, **settings: Any) -> Markup:
        """Return a chart of `charts` by the name of its function."""
        if not self.pictures:
            return Markup()
        drawn: Markup = getattr(charts, chart)(self.language, *given, **settings)
        return drawn

    def draw_each(self, chart: str, rows: pl.DataFrame, follows: str, *given: Any) -> Markup:
        """Return a chart for each choice of a selector.

        Args:
            chart: see `draw`.
            rows: of all choices.
            follows: the column that the selector chooses by.
            given: what else the function takes.
        """
        if not self.pictures:
            return Markup()
        parts = []
        for own in rows.partition_by(follows, maintain_order=True):
            when = self.show_when({follows: [str(own[follows][0])]})
            parts.append(Markup("<div{}>{}</div>").format(when, self.draw(chart, own, *given)))
        return Markup("\n").join(parts)

    def draw_traces(
        self, seconds: pl.DataFrame, points: pl.DataFrame, caption: str, site_root: str
    ) -> Markup:
        """Return the traces of each tow, with what every method leaves out of them.

        The lines are a picture of their own, which both languages share and a browser loads when it
        is shown.

        Args:
            seconds: rows of `trace_seconds` of tows.
            points: rows of `run_points` of the same.
            caption: of the picture.
            site_root: the way to the first page of the site.
        """
        if not self.pictures:
            return Markup()
        parts = []
        for (tow_id,), own in seconds.partition_by(
            "tow_id", as_dict=True, maintain_order=True
        ).items():
            windows = [
                (self.show_when({"method": [str(method)]}), of_method)
                for (method,), of_method in points.filter(tow_id=tow_id)
                .partition_by("method", as_dict=True, maintain_order=True)
                .items()
            ]
            frame = charts.trace_frame(self.language, own, windows, caption)
            part = Markup('<div class="traces"{}><img loading="lazy" alt="" src="{}">{}</div>')
            when = self.show_when({"tow_id": [str(tow_id)]})
            parts.append(part.format(when, site_root + trace_path(str(tow_id)), frame))
        return Markup("\n").join(parts)

    # -- Tables -----------------------------------------------------------------------------------

    def table(
        self,
        rows: Rows,
        columns: str,
        *,
        follows: str = "",
        search: bool = False,
        cards: bool = False,
        heads: Mapping[str, str] | None = None,
    ) -> Markup:
        """Return rows as a table; nothing where there are none.

        Args:
            rows: by the names of the columns of the tables.
            columns: those shown, where they say something; what follows a bar is not on phones.
            follows: columns that selectors choose by; rows are shared between values of the last.
            search: whether the table has a search box.
            cards: whether a phone shows each row as a card.
            heads: other titles.
        """
        frame = rows if isinstance(rows, pl.DataFrame) else _to_frame(rows)
        if frame.is_empty():
            return Markup()
        narrow = columns.partition("|")[0].split()
        chosen_by = follows.split()
        shown = [name for name in chosen_by if not self.chosen.get(name)]
        wanted = [*shown, *columns.replace("|", " ").split()]
        names = [name for name in dict.fromkeys(wanted) if _says_something(frame[name])]
        titles = {name: get_column(name).title for name in names} | dict(heads or {})
        head, cells, looks = [], [], []
        for place, name in enumerate(names, start=1):
            is_on_phones = "|" not in columns or name in narrow or name in shown
            look = _choose_look(frame[name], is_on_phones)
            title = self.language.say(titles[name])
            head.append((look, title))
            looks += [f"{one}{place}" for one in look.split()]
            about = frame["fsn_no"] if name == "name" and "fsn_no" in frame.columns else None
            cells.append(self._write_cells(frame[name], about))
        lines = map("".join, zip(*cells, strict=True))
        made = get_template("table.html.j2").render(
            heads=head,
            looks=" ".join(looks),
            groups=self._group_rows(frame, chosen_by, lines),
            search=search,
            cards=cards,
            _=self.text,
        )
        return Markup(made)  # noqa: S704 - of escaped parts

    def _group_rows(
        self, frame: pl.DataFrame, follows: Sequence[str], lines: Iterable[str]
    ) -> list[tuple[Markup, list[str]]]:
        """Return rows by what selectors show of them: the attributes of each group, and its rows.

        Groups that are alike for several values of the last selector are there once; one whose
        choice is shown in a column of its own is shared with no other.
        """
        groups: dict[tuple[str, ...], list[str]] = {}
        if not follows:
            return [(Markup(), list(lines))]
        for key, line in zip(frame.select(follows).iter_rows(), lines, strict=True):
            groups.setdefault(tuple(map(str, key)), []).append(line)
        shared: dict[tuple[Any, ...], list[str]] = {}
        for key, own in groups.items():
            shared.setdefault((key[:-1], tuple(own)), []).append(key[-1])
        chosen = []
        for (first, own), last in shared.items():
            values = {name: [one] for name, one in zip(follows, first, strict=False)}
            chosen.append((self.show_when(values | {follows[-1]: last}), list(own)))
        return chosen

    def _write_cells(self, cells: pl.Series, about: pl.Series | None) -> list[str]:
        """Return the cells of a column.

        Args:
            cells: the column.
            about: the number of the boat that each cell names, if it does.
        """
        known: dict[str, Markup] = {}  # the same text comes often

        def write(value: Any) -> Markup:
            if not isinstance(value, str):
                return self._write_cell(cells.name, value)
            if value not in known:
                known[value] = self._write_cell(cells.name, value)
            return known[value]

        if about is None:
            return [f"<td>{write(value)}" for value in cells.to_list()]
        written = []
        for name, boat in zip(cells.to_list(), about.to_list(), strict=True):
            link = _write_link(self._link("fsn_no", boat), write(name)) if name else ""
            written.append(f"<td>{link}")
        return written

    def _write_cell(self, name: str, value: Any) -> Markup:
        if isinstance(value, Markup):
            return value
        address = self._link(name, value)
        if address:
            return _write_link(address, value)
        if name == "messages":  # in Dutch and in English
            return escape(value[LANGUAGES.index(self.language.tag)])
        if name in HASHES:
            return escape((value or "")[:HASH_LENGTH])
        if name == "boat_type":
            return escape(self.language.name_code(value or ""))
        return escape(self.language.write(name, value))

    def _link_to_page(self, name: str, value: Any) -> str:
        """Return the way to the page about the value of a column; empty where there is none."""
        if name == "fsn_no" and value:
            return self.root + boat_path(value)
        if name == "boat_type" and value not in (None, "", "unknown", "all"):
            return self.root + type_path(value)
        return ""


def _write_link(address: str, text: str) -> Markup:
    """Return a text that leads to an address, if there is one."""
    return Markup('<a href="{}">{}</a>').format(address, text) if address else escape(text)


def _to_frame(rows: Sequence[Mapping[str, Any]]) -> pl.DataFrame:
    """Return rows as a frame; a value that is HTML or a sentence stays what it is."""
    if not rows:
        return pl.DataFrame()
    names = dict.fromkeys(name for row in rows for name in row)
    series = []
    for name in names:
        values = [row.get(name) for row in rows]
        is_object = any(isinstance(value, Markup | Sentence | dict) for value in values)
        dtype = pl.Object if is_object else None
        series.append(pl.Series(name, values, dtype=dtype, strict=False))
    return pl.DataFrame(series)


def _choose_look(cells: pl.Series, is_on_phones: bool) -> str:
    """Return the classes of a column: `t` a text, `w` also of several lines, `p` not on phones."""
    looks = []
    if not cells.dtype.is_numeric() or cells.name == "direction":
        looks.append("t")
        if WIDE_COLUMNS.search(cells.name):
            looks.append("w")
    if not is_on_phones:
        looks.append("p")
    return " ".join(looks)


def _says_something(cells: pl.Series) -> bool:
    """Return whether a column holds anything but nothing, no, and empty texts and lists."""
    return any(
        value is not None and value is not False and value not in ("", [])
        for value in cells.to_list()
    )
