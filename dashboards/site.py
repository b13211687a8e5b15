"""The site of plain files: every document as a page in two languages, swapped in whole.

It can be read from disk and loads nothing else: charts are in the pages, scripts choose and sort.
A new page is a template, a query, and a line in `list_pages`.
"""

import datetime as dt
import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Final, TypedDict

from dashboards import charts, fonts
from dashboards.addresses import (
    INSPECTIONS,
    boat_path,
    edition_page,
    race_path,
    trace_path,
    type_path,
)
from dashboards.markdown import get_title
from dashboards.page import list_folders, render_page
from dashboards.paper import make_pdf
from dashboards.queries import boats, inspections, methods, pages, types, votes
from dashboards.queries.results import Data, Results
from warehouse.queries.views import Views
from warehouse.store.editions import NOTICE, NOTICE_EN, get_edition_path, list_edition_names
from warehouse.store.files import write_folder_beside
from warehouse.store.store import Store
from warehouse.store.unforeseen import Border, border

STATIC: Final = Path(__file__).parent / "static"

DOWNLOADS: Final = "downloads"
NOTICES: Final = {"nl": (NOTICE, "bericht.pdf"), "en": (NOTICE_EN, "notice.pdf")}
"""The notice of an edition in each language, and the PDF of it that the site offers."""

N_PARTS: Final = 2
"""Parts in which pages are made side by side."""

Each = Callable[[Callable[[int], list[str]], Sequence[int]], Iterable[list[str]]]
"""Does a piece of work for each of these: one after the other, as `map` does, or side by side."""


@dataclass(frozen=True)
class Page:
    """A page of the site.

    Attributes:
        path: where it lies within the pages of its language.
        template: its name.
        query: gives what the page shows.
    """

    path: str
    template: str
    query: Callable[[], Data]


class BuiltPages(TypedDict):
    """What was built: number of files, their bytes, and what Herijk itself failed on."""

    files: int
    bytes: int
    failed: list[str]


def list_pages(results: Results) -> Iterator[Page]:
    """Yield every page of the site."""
    yield Page("index.html", "start", partial(pages.read_start, results))
    yield Page("register.html", "register", partial(pages.read_register, results))
    yield Page("boats.html", "due", partial(pages.read_due_list, results))
    yield Page("types.html", "types", partial(types.read_types, results))
    yield Page("seasons.html", "seasons", partial(pages.read_seasons, results))
    yield Page("changes.html", "changes", partial(pages.read_changes, results))
    if results.vote_switches:
        yield Page(votes.PAGE, "proposal_parts", partial(votes.read_parts, results))
    yield Page("years.html", "years", partial(pages.read_years, results))
    yield Page("quality.html", "quality", partial(pages.read_quality, results))
    yield Page(INSPECTIONS, "inspections", partial(inspections.read_inspections, results))
    yield Page("about.html", "about", dict)
    yield Page("words.html", "words", dict)
    if "crew_names" not in results.views.about():  # the guide tells of the Dutch federation
        yield Page("audit.html", "guide", partial(pages.read_guide, "audit"))
    for name in results.methods:
        path = methods.get_method_page(results, name)
        yield Page(path, "method", partial(methods.read_method, results, name))
    for name in results.views.table("editions")["edition"]:
        yield Page(edition_page(name), "edition", partial(pages.read_edition_page, results, name))
    for fsn_no in results.views.table("boats")["fsn_no"]:
        yield Page(boat_path(fsn_no), "boat", partial(boats.read_boat, results, fsn_no))
    if results.views.has("compared_tows"):
        for name in results.views.type_names():
            yield Page(type_path(name), "type", partial(types.read_type, results, name))
    for race, day in results.views.race_days():
        yield Page(race_path(race, day), "race", partial(pages.read_race, results, race, day))


def build_site(
    store: Store,
    target: Path | None = None,
    as_of: dt.date | None = None,
    bordered: Border | None = None,
    each: Each = map,
) -> BuiltPages:
    """Make all pages and swap them in.

    Args:
        store: the data folder.
        target: the folder of the site; `site` in the data folder when left out. What stood in it is
            replaced.
        as_of: the day on which lines count as valid; the last that the archive knows if left out.
        bordered: goes round the making of each page; by default a page that fails is left out.
        each: see `Each`.
    """
    folder = target or store.root / "site"
    has_reports = folder.parent == store.root
    with write_folder_beside(folder) as beside:
        work = partial(_write_part, store, beside, as_of, bordered, has_reports)
        failed = sorted({what for part in each(work, range(N_PARTS)) for what in part})
        files = [file for file in beside.rglob("*") if file.is_file()]
        size = sum(file.stat().st_size for file in files)
    return {"files": len(files), "bytes": size, "failed": failed}


def _write_part(
    store: Store,
    folder: Path,
    as_of: dt.date | None,
    bordered: Border | None,
    has_reports: bool,
    part: int,
) -> list[str]:
    """Write one of every so many pages; the first part has what all share, too.

    Returns:
        The pages on which Herijk itself failed.
    """
    failed: list[str] = []
    round_one = bordered or partial(border, store.root, failed=failed)
    with Views(store, as_of) as views:
        results, about = Results(views), views.about()
        for page in list(list_pages(results))[part::N_PARTS]:
            with round_one(f"page {page.path}"):
                data = page.query() | {"has_reports": has_reports}
                for language, of_language in list_folders(about).items():
                    html = render_page(page.path, page.template, data, language, about)
                    _write(folder / of_language / page.path, html)
                if page.template == "boat":
                    _write_traces(folder, data)
        if part == 0:
            _write_shared_files(folder, views)
            _write_downloads(folder, store)
    return failed


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def _write_traces(folder: Path, boat: Data) -> None:
    """Write a picture of the traces of each tow of a boat, which both languages show."""
    seconds = boat["drawn"]["seconds"]
    for (tow_id,), own in seconds.partition_by("tow_id", as_dict=True, maintain_order=True).items():
        _write(folder / trace_path(str(tow_id)), charts.trace_lines(own))


def _write_shared_files(folder: Path, views: Views) -> None:
    """Write styles, scripts, and what the search on every page looks through."""
    for file in STATIC.iterdir():
        if not file.name.startswith("workbench"):
            _write(folder / "static" / file.name, file.read_text("utf-8"))
    _write(folder / "static" / "font.css", fonts.style_sheet())
    found = json.dumps(list(_list_findable(views)), ensure_ascii=False).replace("<", "\\u003c")
    _write(folder / "static" / "find.js", f"window.FIND = {found};\n")


def _list_findable(views: Views) -> Iterator[list[Any]]:
    """Yield what the search finds: what is shown, by what else it is found, and its page."""
    for row in views.table("boats").sort("fsn_no").to_dicts():
        more = f"{row['ht_no'] or ''} {row['boat_type'] or ''}"
        name = f"{row['name'] or ''} · {row['fsn_no']}"
        yield [name, more, boat_path(row["fsn_no"])]
    for name in views.type_names():
        yield [name, "", type_path(name)]
    for race, day in views.race_days():
        yield [f"{race} {day}", "", race_path(race, day)]


def _write_downloads(folder: Path, store: Store) -> None:
    """Copy the sheets of every edition, byte for byte, and set its notices as PDF."""
    for name in list_edition_names(store):
        source, target = get_edition_path(store, name), folder / DOWNLOADS / name
        target.mkdir(parents=True)
        for sheet in pages.SHEETS:
            (target / sheet).write_bytes((source / sheet).read_bytes())
        for language, (notice, paper) in NOTICES.items():
            text = (source / notice).read_text("utf-8")
            title = get_title(text)
            page = {"title": title, "text": text}
            made = make_pdf("notice", [page], language, title, simulated=False)
            (target / paper).write_bytes(made)
