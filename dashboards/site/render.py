"""From pages to files: HTML with the tables, data for the charts, and what all pages share.

Every page is made once per language, in Dutch at the root and in English under `en/`; the data of
its charts, and the rows of its tables that are not shown at first, once, as a script beside them.
"""

import base64
import datetime as dt
import zlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cache, partial
from pathlib import Path
from typing import Final, TypedDict

import jinja2

from dashboards import fonts, labels
from dashboards.addresses import boat_path, race_path, type_path
from dashboards.html import as_json, environment
from dashboards.site.boats import boat_pages
from dashboards.site.cells import Cells
from dashboards.site.charts import charts_script, page_json, stills, vega_bundle
from dashboards.site.glossary import TERMS, Glossed
from dashboards.site.pages import method_names, shared_pages
from dashboards.site.parts import Page
from dashboards.site.prose import copy_sheets
from dashboards.site.start import MENU
from dashboards.speech import Speech
from pipeline.messages import LANGUAGES
from warehouse.queries.views import Views
from warehouse.store.files import write_folder_beside
from warehouse.store.store import Store
from warehouse.store.unforeseen import Border, border

HERE: Final = Path(__file__).parent
QUICK: Final = 4
"""How hard data are deflated: a tenth larger than by default, in half the time."""
OWN_FILES: Final = ("site.css", "site.js")
FOLDERS: Final = {"nl": "", "en": "en/"}
"""Where the pages of each language lie within the site."""

IN_GLOSSARY: Final = {
    "crew_class": "crew_class",
    "a_kg_m": "a",
    "b_m_s": "b",
    "cw_kg_m": "cw",
    "e_n": "e_n",
}
"""The term of the glossary that a column holds."""

POLICY: Final = "; ".join(
    (
        "default-src 'none'",
        "script-src 'self' file:",
        "style-src 'self' file: 'unsafe-inline'",
        "img-src 'self' file: data:",
        "font-src data:",
        "base-uri 'none'",
        "form-action 'none'",
    )
)
"""What a browser lets a page load: the site's own files and nothing else; no eval, no connection.
`file:` because to some browsers a page from disk is no `'self'`; inline styles are Vega's; the font
is in the style sheet, because some browsers keep fonts of another folder from such a page."""


Each = Callable[[Callable[[str], list[str]], Sequence[str]], Iterable[list[str]]]
"""Does a piece of work for each of these: one after the other, as `map` does, or side by side."""
SHARED: Final = "shared"
"""What is made once for the pages of all languages."""


class BuiltPages(TypedDict):
    """What was built: number of files, their bytes, and what Herijk itself failed on."""

    files: int
    bytes: int
    failed: list[str]


def build_site(store: Store, each: Each = map) -> BuiltPages:
    """Make all pages from the database and swap them in."""
    return build_pages(store, store.root / "site", each=each)


def build_pages(
    store: Store,
    target: Path,
    as_of: dt.date | None = None,
    bordered: Border | None = None,
    each: Each = map,
) -> BuiltPages:
    """Make all pages in a folder, as of a day; what stood in the folder is replaced.

    Args:
        store: the data folder.
        target: the folder.
        as_of: the day on which lines count as valid; the last that the archive knows if left out.
        bordered: goes round the making of each page; by default a page that fails is left out.
        each: see `Each`.
    """
    with write_folder_beside(target) as beside:
        work = partial(_write_part, store, beside, as_of, bordered, target.parent == store.root)
        failed = sorted({what for part in each(work, PARTS) for what in part})
        copy_sheets(store, beside)
        written = [f for f in beside.rglob("*") if f.is_file()]
        size = sum(f.stat().st_size for f in written)
    return {"files": len(written), "bytes": size, "failed": failed}


PARTS: Final = (LANGUAGES[1], SHARED, LANGUAGES[0])
"""What is made by itself: the pages of each language, and what all pages share."""


def _write_part(
    store: Store,
    folder: Path,
    as_of: dt.date | None,
    bordered: Border | None,
    by_reports: bool,
    part: str,
) -> list[str]:
    """Write the pages of one language with the data of all, or what all pages share.

    Returns:
        The pages on which Herijk itself failed.
    """
    failed: list[str] = []
    bordered = bordered or partial(border, store.root, failed=failed)
    with Views(store, as_of) as views:
        if part == SHARED:
            files = shared_files() | {"find.js": _search_script(views)}
        else:
            _write_pages(bordered, views, folder, by_reports, part)
            files = charts_file(part)
        for name, text in files.items():
            _put(folder / "static" / name, text)
    return failed


def shared_files() -> dict[str, str]:
    """Styles and scripts that pages of all languages share, by name."""
    return {
        **{name: (HERE / "static" / name).read_text(encoding="utf-8") for name in OWN_FILES},
        "font.css": fonts.style_sheet(),
        "vega.js": vega_bundle(),
    }


def charts_file(language: str) -> dict[str, str]:
    """The script with the figures in one language, by its name."""
    return {f"charts-{language}.js": charts_script(language)}


def _write_pages(
    border: Border, views: Views, folder: Path, by_reports: bool, language: str
) -> None:
    """Write every page in a language."""
    edition, methods = Edition(views, language), method_names(views)
    for name, make in shared_pages(views, by_reports).items():
        with border(f"pages {name}"):
            for page in make():
                with border(f"page {page.path}"):
                    _write_page(folder, page, edition)
    with border("pages of boats"):
        for fsn_no, make_page in boat_pages(views, methods):
            with border(f"page {fsn_no}"):
                _write_page(folder, make_page(), edition)


def _write_page(folder: Path, page: Page, edition: "Edition") -> None:
    _put(folder / edition.address(page), edition.html(page))
    if page.data and edition.speech.language == LANGUAGES[0]:  # the same in every language
        _put(folder / _data_path(page), _data_script(page))


def _put(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


@cache
def _template() -> jinja2.Template:
    """The template of every page: to compile it takes as long as a few pages."""
    names = {"policy": POLICY, "menu": MENU, "SIMULATED": labels.SIMULATED}
    return environment(HERE / "templates", **names).get_template("page.html.j2")


class Edition:
    """The pages in one language."""

    def __init__(self, views: Views, language: str, cells: type[Cells] = Cells) -> None:
        self.speech = Speech(language)
        self.about = views.about()
        self._comments = _by_column(views.comments()) if language == "en" else {}
        self._cells = cells(self.speech)
        self._names = {
            "_": self.speech.text,
            "column_text": labels.column,
            "unbroken": labels.unbroken,
            "speech": self.speech,
            "meaning": self._meaning,
            "about": self.about,
        }

    def _meaning(self, table: str, column: str) -> str | None:
        """What a column means, shown when the pointer is over its heading."""
        term = IN_GLOSSARY.get(column)
        said = self._comments.get(f"{table}.{column}") or self._comments.get(column)
        return said or (self.speech.say(TERMS[term][1]) if term else None)

    def address(self, page: Page) -> str:
        """Where the page lies within the site."""
        return FOLDERS[self.speech.language] + page.path

    def html(self, page: Page) -> str:
        """The page; one of the menu with its first chart as a picture, to be seen at once."""
        language = self.speech.language
        site = page.site or "../" * self.address(page).count("/")
        other = next(name for name in LANGUAGES if name != language)
        return _template().render(
            **self.names(page),
            stills=stills(page, language) if page.data and "/" not in page.path else {},
            site=site,
            root=(site + FOLDERS[language]) if page.site else page.root,
            other=other,
            other_page=page.others.get(other) or f"{site}{FOLDERS[other]}{page.path}",
            data_path=_data_path(page) if page.data else "",
        )

    def names(self, page: Page) -> dict[str, object]:
        """What a template has to know to show the sections of a page."""
        return self._names | {
            "page": page,
            "glossed": Glossed(self.speech),
            "rows_of": partial(self._cells.rows, page),
            "language": self.speech.language,
        }


def _data_path(page: Page) -> str:
    """The script with the data of a page, shared by its languages."""
    return f"data/{page.path.removesuffix('.html')}.js"


def _data_script(page: Page) -> str:
    """What charts draw, by name, as a script: a page from disk may load no JSON.

    It is deflated: of 1,020 tows 3.8 MB instead of 22, and the site 27 MB of the 40 it may have.
    """
    packed = base64.b64encode(zlib.compress(page_json(page).encode(), QUICK))
    return f'window.HERIJK_DATA = "{packed.decode("ascii")}";\n'


def _search_script(views: Views) -> str:
    """What the search on every page looks through: boats, types and races, with their pages."""
    return f"window.HERIJK_FIND = {as_json(list(_findable(views)))};\n"


def _findable(views: Views) -> Iterator[list[str]]:
    boats = views.table("boats").sort("fsn_no")
    for fsn_no, ht_no, name, boat_type in boats.select(
        "fsn_no", "ht_no", "name", "boat_type"
    ).rows():
        yield [f"{name} · {fsn_no}", f"{ht_no or ''} {boat_type or ''}", boat_path(fsn_no)]
    for boat_type in views.type_names():
        yield [boat_type, "", type_path(boat_type)]
    for race, day in views.race_days():
        yield [f"{race} {day}", "", race_path(race, day)]


def _by_column(comments: dict[str, str]) -> dict[str, str]:
    """The meaning of a column by its table and name; by its name alone where all tables agree."""
    meanings: dict[str, set[str]] = {}
    for name, text in comments.items():
        meanings.setdefault(name.split(".", 1)[1], set()).add(text)
    return comments | {name: min(texts) for name, texts in meanings.items() if len(texts) == 1}
