"""From pages to files: HTML with the tables, data for the charts, and what all pages share."""

import datetime as dt
import json
import shutil
import tempfile
from collections.abc import Callable, Sequence
from functools import cache
from itertools import chain, repeat
from pathlib import Path
from typing import Any, Final

import jinja2
import polars as pl
import vl_convert
from markupsafe import Markup, escape

from herijk.dashboards.figures import FIGURES
from herijk.dashboards.html import as_json, environment, in_both
from herijk.dashboards.site.downloads import copy_sheets
from herijk.dashboards.site.pages import MENU, all_pages
from herijk.dashboards.site.parts import Page, Table, boat_path
from herijk.dashboards.words import LANGUAGES, WORDS, Say, both, speaker
from herijk.warehouse.queries.views import Views
from herijk.warehouse.store.files import TEMPORARY_PREFIX, put_in_place
from herijk.warehouse.store.store import Store

HERE: Final = Path(__file__).parent
OWN_FILES: Final = ("site.css", "site.js")
DIGITS: Final = (
    ("_kg_m", 2), ("_m_s", 2), ("_deg", 0), ("_kg", 0), ("_w", 1), ("_s", 0), ("cw_sd", 2),
    ("_m", 2), ("step_sd", 4), ("_sd", 1), ("dof", 1), ("before_ratio", 6), ("after_ratio", 6),
    ("slope", 5), ("slope_lo", 5), ("slope_hi", 5),
)  # fmt: skip
"""Decimals shown by the ending of a column's name; 4 otherwise."""

POLICY: Final = "; ".join(
    (
        "default-src 'none'",
        "script-src 'self' file:",
        "style-src 'self' file: 'unsafe-inline'",
        "img-src 'self' file: data:",
        "base-uri 'none'",
        "form-action 'none'",
    )
)
"""What a browser lets a page load: the site's own files and nothing else; no eval, no connection.
`file:` because to some browsers a page from disk is no `'self'`; inline styles are Vega's."""

DECIMAL: Final = ","
"""A page is written in Dutch; `site.js` changes numbers where English is chosen."""

KEPT: Final = 7
"""Significant digits in downloads and charts; the database holds all."""

CODES: Final = {
    *("status", "flags", "reason", "cut_reason", "change", "source", "step", "component", "code"),
    *("quantity", "explaining", "candidates", "severity", "check", "shared", "kind", "scope"),
    *("option", "speed_reason", "cause", "log", "flag", "what", "outcome", "lost"),
}
"""Columns that hold codes of the warehouse, shown as words."""


LONG: Final = {
    *("flags", "cut_reason", "reason", "speed_reason", "causes", "message", "meaning", "decision"),
    *("candidates", "name"),
}
"""Columns of texts that may take several lines."""


def build_site(store: Store) -> dict[str, int]:
    """Makes all pages from the database and swaps them in.

    Returns:
        Files and bytes of the site.
    """
    target = store.root / "site"
    beside = Path(tempfile.mkdtemp(prefix=TEMPORARY_PREFIX, dir=store.root))
    try:
        with Views(store) as views:
            _write(views, beside)
        copy_sheets(store, beside)
        written = [f for f in beside.rglob("*") if f.is_file()]
        size = {"files": len(written), "bytes": sum(f.stat().st_size for f in written)}
        beside.chmod(0o755)
        put_in_place(beside, target)
    finally:
        shutil.rmtree(beside, ignore_errors=True)
    return size


def _write(views: Views, folder: Path) -> None:
    static = folder / "static"
    static.mkdir()
    for name in OWN_FILES:
        shutil.copyfile(HERE / "static" / name, static / name)
    (static / "vega.js").write_text(vega_bundle(), encoding="utf-8")
    (static / "charts.js").write_text(chart_specifications(), encoding="utf-8")
    about, comments = views.about(), _by_column(views.comments())
    template = _environment(comments).get_template("page.html.j2")
    (folder / "boats").mkdir()
    for page in all_pages(views):
        text = template.render(page=page, menu=MENU, about=about)
        (folder / page.path).write_text(text, encoding="utf-8")


def render_page(views: Views, page: Page) -> str:
    """A page by itself, for one that lies outside the site."""
    template = _environment(_by_column(views.comments())).get_template("page.html.j2")
    return template.render(page=page, menu=MENU, about=views.about())


def _by_column(comments: dict[str, str]) -> dict[str, str]:
    """The meaning of a column by its table and name; by its name alone where all tables agree."""
    meanings: dict[str, set[str]] = {}
    for name, text in comments.items():
        meanings.setdefault(name.split(".", 1)[1], set()).add(text)
    return comments | {name: min(texts) for name, texts in meanings.items() if len(texts) == 1}


@cache
def vega_bundle() -> str:
    """Vega, Vega-Lite and Vega-Embed in one script, as Altair's own converter ships them."""
    return str(vl_convert.javascript_bundle())


@cache
def chart_specifications() -> str:
    """A script with every figure's Vega-Lite and words in every language, without data."""
    found = {
        language: {
            name: specification(figure, speaker(language)) for name, figure in FIGURES.items()
        }
        for language in LANGUAGES
    }
    words = {language: _words_of_charts(speaker(language)) for language in LANGUAGES}
    return f"window.HERIJK_FIGURES = {as_json(found)};\nwindow.HERIJK_WORDS = {as_json(words)};\n"


def _words_of_charts(say: Say) -> dict[str, str]:
    """Names of columns and codes, yes and no, for the table of a chart; what an empty one says."""
    named = {key: say(key) for key in WORDS if key.startswith(("column.", "code."))}
    return named | {"true": say("yes"), "false": say("no"), "no_values": say("no_values")}


def specification(figure: Callable[..., Any], say: Callable[[str], str]) -> dict[str, Any]:
    """A figure's Vega-Lite with the data left to the page: a dataset called `rows`."""
    # Validating takes as long as all else of a small site; the tests of figures do it.
    spec: dict[str, Any] = figure(pl.DataFrame({"kind": ["x"]}), say).to_dict(validate=False)
    (placeholder,) = spec.pop("datasets")
    spec.pop("$schema")
    text = json.dumps(spec).replace(f'"{placeholder}"', '"rows"')
    return dict(json.loads(text))


def _data(frames: Sequence[pl.DataFrame]) -> Markup:
    """Frames as columns, for a data block (`_column`)."""
    found = [{c.name: _column(c) for c in frame} for frame in frames]
    return Markup(as_json(found))  # noqa: S704 - as_json escapes


def _column(column: pl.Series) -> list[Any] | dict[str, list[Any]]:
    """A list; of texts and of what stays the same for many rows, each value once.

    `runs` then has the place of a value and for how many rows it holds, one pair after the other.
    """
    if column.dtype.is_float():
        return column.round_sig_figs(KEPT).to_list()
    lengths, held = column.rle().struct.unnest().get_columns()
    if column.dtype != pl.String and 2 * len(held) >= len(column):
        return column.to_list()
    values = held.unique(maintain_order=True)
    places = {value: place for place, value in enumerate(values)}
    runs = zip((places[value] for value in held), lengths, strict=True)
    return {"values": values.to_list(), "runs": list(chain.from_iterable(runs))}


def _environment(comments: dict[str, str]) -> jinja2.Environment:
    return environment(
        HERE / "templates",
        policy=POLICY,
        t=_text,
        both=both,
        data=_data,
        rows=_rows,
        is_number=_is_number,
        comments=comments,
    )


def _text(key: str) -> Markup:
    return in_both(both(key))


def _is_number(frame: pl.DataFrame, column: str) -> bool:
    return frame.schema[column].is_numeric()


def _rows(page: Page, table: Table) -> tuple[Markup, Markup]:
    """The rows that the selectors show at first, and all others.

    A browser lays out only the first; `site.js` brings in others when they are chosen.
    """
    frame, follows = table.frame, list(table.follows)
    # Column by column, because the cells of a column are made in one way.
    cells = zip(*(_cells(frame[c], page.root) for c in table.columns), strict=True)
    boats = [_BOAT.format(n) for n in frame["fsn_no"]] if table.linked else repeat("")
    keys = frame.select(follows).rows() if follows else repeat(())

    @cache
    def marked(key: tuple[str, ...]) -> tuple[list[str], str]:
        """Where rows of a key stand, and what they say of it besides their cells."""
        own = dict(zip(follows, key, strict=True))
        is_first = all(page.chosen[name] in ("", value) for name, value in own.items())
        unseen = ((name, value) for name, value in own.items() if name not in table.columns)
        marks = "".join(_FOLLOWED.format(*one) for one in unseen)
        return first if is_first else others, marks

    first: list[str] = []
    others: list[str] = []
    for row, boat, key in zip(cells, boats, keys, strict=False):
        place, marks = marked(key)
        place.append(f"<tr{boat}{marks}>{''.join(row)}</tr>")
    return Markup("\n".join(first)), Markup("\n".join(others))  # noqa: S704 - made of escaped parts


_BOAT = Markup(' data-boat="{}"')
_FOLLOWED = Markup(' data-f-{}="{}"')


def _cells(column: pl.Series, root: str) -> list[Markup]:
    name = column.name
    if column.dtype.is_float():
        digits = next((d for ending, d in DIGITS if name.endswith(ending)), 4)
        return [_number(value, digits) for value in column]
    if column.dtype.is_integer() and name != "direction":
        return [_integer(value) for value in column]
    show = _shower(name, root)
    mark = _LONG if name in LONG else Markup("")

    def made(value: Any) -> Markup:
        return _EMPTY if value is None else _shown(value, show, mark)

    if isinstance(column.dtype, pl.List):
        return [made(value) for value in column]
    of = {value: made(value) for value in column.unique()}
    return [of[value] for value in column]


_SAME_CELL = Markup("<td{}>{}</td>")
"""A cell whose text is its value; others have the value in `data-v`."""
_CELL = Markup('<td{} data-v="{}">{}</td>')
_LONG = Markup(" class=w")
_EMPTY = Markup("<td></td>")


def _number(value: float | None, digits: int) -> Markup:
    if value is None:
        return Markup("<td class=n></td>")
    shown, exact = f"{value:z.{digits}f}", f"{value:.{KEPT}g}"
    mark = "" if shown == exact and digits == 0 else f" data-v={exact}"
    return Markup(f"<td class=n{mark}>{shown.replace('.', DECIMAL)}</td>")  # noqa: S704 - a number


def _integer(value: int | None) -> Markup:
    text = "" if value is None else str(value)
    return Markup(f"<td class=i>{text}</td>")  # noqa: S704 - a number


def _shown(value: Any, show: Callable[[Any], Markup], mark: Markup) -> Markup:
    plain = ", ".join(value) if isinstance(value, pl.Series | list) else str(value)
    shown = show(value)
    if shown == escape(plain):
        return _SAME_CELL.format(mark, shown)
    return _CELL.format(mark, plain, shown)


def _shower(name: str, root: str) -> Callable[[Any], Markup]:
    """How values of a column are shown."""
    if name in ("fsn_no", "influence_boat"):
        return lambda value: Markup('<a href="{}{}">{}</a>').format(root, boat_path(value), value)
    return SHOWERS.get(name, _code if name in CODES else _plain)


def _direction(value: int) -> Markup:
    return _text("out" if value == 1 else "back")


def _type(value: str) -> Markup:
    return _text(f"code.{value}") if value in ("unknown", "all") else _plain(value)


def _unit(value: str) -> Markup:
    return _plain("" if value == "1" else value)


def _hash(value: str) -> Markup:
    return Markup('<code title="{}">{}</code>').format(value, value[:12])


def _plain(value: Any) -> Markup:
    if isinstance(value, bool):
        return _text("yes" if value else "no")
    if isinstance(value, dt.datetime):
        return Markup("{}").format(value.isoformat(" "))
    return Markup("{}").format(value)


def _code(value: Any) -> Markup:
    """A code, or several with commas or as a list, in words."""
    codes = value.split(",") if isinstance(value, str) else list(value)
    return Markup(", ").join(_text(f"code.{code}") for code in codes if code)


def _causes(value: str) -> Markup:
    """What a change is attributed to (a method's step by its name), each with its factor."""
    parts = [
        Markup('{} <span class="n">{}</span>').format(
            _text(f"code.{cause.get('step', cause['cause'])}"),
            f"{cause['factor']:.4f}".replace(".", DECIMAL),
        )
        for cause in json.loads(value)
    ]
    return Markup(" \u00d7 ").join(parts)


def _titles(value: Any) -> Markup:
    """A title in Dutch and one in English."""
    nl, en = value
    return in_both((nl, en))


SHOWERS: Final[dict[str, Callable[[Any], Markup]]] = {
    "titles": _titles,
    "direction": _direction,
    "causes": _causes,
    "boat_type": _type,
    "unit": _unit,
    **dict.fromkeys(("sha256", "content_hash", "method_hash", "seal"), _hash),
}
"""Columns shown in a way of their own."""
