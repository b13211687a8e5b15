"""The site in a real browser, opened from disk: no error, no request, everything works.

Needs Chromium. Where it is not installed the tests are skipped, except in CI (`HERIJK_CI` set),
where that is a failure, and pictures go to `ci-output/`.
"""

import csv
import io
import re
import subprocess
import sys

import pytest

from dashboards.addresses import boat_path, edition_page, race_path, type_path
from dashboards.guides import GUIDES
from dashboards.language import Language
from dashboards.site import STATIC
from pipeline.messages import LANGUAGES
from pipeline.tables.display import get_column
from tests.architecture.repository import ROOT, read
from tests.dashboards.browser import IN_CI, NEEDED, WIDTHS, barriers, picture, too_wide
from tests.dashboards.conftest import ATTACK, EDITIONS, FORMULA
from warehouse.queries.views import Views

pytestmark = NEEDED

NOT_SIDEWAYS = {"wide": ".scroll", "desktop": "figure", "phone": ".scroll:has(.cards)"}
"""What fits its box: a phone shows lines of the register as cards, and other tables sideways."""
KINDS = ["index", "register", "boats", "types", "seasons", "changes", "years", "quality", "about",
         "words", GUIDES[0], "boat", "type", "race", "edition"]  # fmt: skip
"""A page of each kind."""
DRAFT = "concept-as-published"
CW = {
    language: Language(language).say(get_column("cw_kg_m").title).replace("\N{SOFT HYPHEN}", "")
    for language in LANGUAGES
}
"""The title of the column of Cw."""


@pytest.fixture
def visit(page, site):
    """Opens a page of the site, with everything that is folded."""

    def go(path):
        page.goto((site / path).as_uri())
        page.evaluate("document.querySelectorAll('details').forEach(d => { d.open = true; })")
        return page

    return go


@pytest.fixture(scope="module")
def paths(store, attacked):
    """The pages of a kind of which there are many."""
    with Views(store) as views:
        return {
            "boat": boat_path(attacked),
            "edition": edition_page(EDITIONS[-1]),
            "type": type_path(views.type_names()[0]),
            "race": race_path(*views.race_days()[0]),
        }


def shown(page):
    """The rows of the first table that are seen."""
    return page.locator(".table").first.locator("tbody tr:visible")


def editions_of_rows(page):
    """The editions of each row that the first table shows."""
    rows = shown(page).evaluate_all("rows => rows.map(row => row.parentElement.dataset.edition)")
    return [row.split("|") for row in rows]


def heads(page):
    """The titles of the columns of the first table, without marks of where a word may break."""
    titles = page.locator(".table").first.locator("th").all_text_contents()
    return [title.replace("\N{SOFT HYPHEN}", "") for title in titles]


def head(page, title):
    return page.locator(".table").first.locator("th").nth(heads(page).index(title))


def cw_cells(page):
    """The cells of Cw in the register that are seen."""
    place = heads(page).index(CW[page.locator("html").get_attribute("lang")])
    return page.locator(".table").first.locator(f"tbody tr:visible td:nth-child({place + 1})")


def choose(page, name, value):
    page.locator(f"select[name={name}]").select_option(value)


def downloaded(page, link):
    with page.expect_download() as caught:
        link.click()
    return caught.value


def rows_in(download):
    text = download.path().read_text("utf-8-sig")
    return list(csv.DictReader(io.StringIO(text), delimiter=";"))


@pytest.mark.parametrize("name", KINDS)
def test_every_page_opens_draws_and_keeps_nobody_out(visit, paths, name):
    """CI alone looks for barriers at every width; a phone shows all that a wide screen does."""
    path = paths.get(name, f"{name}.html")
    for folder, language in (("en/", "en"), ("", "nl")):
        page = visit(folder + path)
        for width, size in WIDTHS.items():
            page.set_viewport_size(size)
            assert too_wide(page, NOT_SIDEWAYS[width]) == []
            picture(page, f"{name}-{language}-{width}")
    for width, size in WIDTHS.items():
        if IN_CI or width == "phone":
            page.set_viewport_size(size)
            assert barriers(page) == []


def test_a_page_is_in_one_language_and_leads_to_the_other(visit):
    page = visit("register.html")
    choose(page, "edition", DRAFT)
    assert page.locator("h1").inner_text() == "Register"
    assert "Zoek" in page.locator(".tools").first.inner_text()
    assert "," in cw_cells(page).first.inner_text()
    page.get_by_role("link", name="English").click()
    page.wait_for_url("**/en/register.html*")
    assert "Search" in page.locator(".tools").first.inner_text()
    assert "," not in cw_cells(page).first.inner_text()
    assert page.locator("select[name=edition]").input_value() == DRAFT


@pytest.mark.parametrize("misspell", [str, lambda name: name[:4] + name[5:]])
def test_the_search_finds_a_boat_without_its_accents_and_misspelt(visit, store, misspell):
    with Views(store) as views:
        boats = views.table("boats").select("name", "fsn_no").rows()
    name, fsn_no = next(b for b in boats if "é" in b[0])
    page = visit("quality.html")
    page.locator("header input").fill(misspell(name.lower().replace("é", "e")))
    page.locator(f"header ul a[href$='{boat_path(fsn_no)}']").click()
    page.wait_for_url(f"**/{boat_path(fsn_no)}*")


def test_a_phone_shows_numbers_without_scrolling_aside(visit):
    page = visit("register.html")
    page.set_viewport_size(WIDTHS["phone"])
    cells = shown(page).locator("td:visible").all_inner_texts()
    assert any(re.fullmatch(r"\d+,\d\d", text) for text in cells)
    assert too_wide(page, ".scroll:has(.cards)") == []


def test_search_sort_and_edition(visit):
    page = visit("register.html")
    lines = shown(page).count()
    name = shown(page).nth(1).locator("td").first.inner_text()
    search = page.locator(".tools [type=search]").first
    search.fill(name)
    assert 0 < shown(page).count() < lines
    assert name in shown(page).first.inner_text()
    search.fill("")
    for direction in (1, -1):
        head(page, CW["nl"]).get_by_role("button").click()
        cells = [float(t.replace(",", ".")) for t in cw_cells(page).all_inner_texts() if t]
        assert cells == sorted(cells, reverse=direction < 0)
    assert head(page, CW["nl"]).get_attribute("aria-sort") == "descending"
    said = page.locator("[data-said=register]")
    assert said.bounding_box()["x"] >= 0
    choose(page, "edition", DRAFT)
    assert all(DRAFT in names for names in editions_of_rows(page))
    assert said.bounding_box()["x"] < 0  # it tells of the edition that was shown
    page.emulate_media(media="print")
    assert page.locator("select[name=edition]").is_visible()


def test_races_follow_the_edition(visit, paths):
    page = visit(paths["race"])
    choose(page, "to_edition", EDITIONS[1])
    rows = shown(page).evaluate_all("rows => rows.map(row => row.parentElement.dataset.to_edition)")
    assert rows
    assert all(EDITIONS[1] in row.split("|") for row in rows)


def test_a_table_downloads_what_it_shows_and_a_name_is_no_formula(visit):
    page = visit("boats.html")  # names of today; an edition keeps its own
    rows = rows_in(downloaded(page, page.locator(".csv").first))
    assert len(rows) == shown(page).count()
    assert any("," in cell for row in rows for name, cell in row.items() if "[m/s]" in name)
    assert {FORMULA.replace("=", "'="), ATTACK} <= {row["Naam"] for row in rows}


def test_choosing_a_method_changes_the_cuts_and_the_runs(visit, attacked):
    page = visit(boat_path(attacked))
    for part in (".traces svg[role=img] g", "tbody[data-tow_id][data-method]"):
        seen = f"{part}:visible"
        choose(page, "method", "rebased-2015")
        before = page.locator(seen).evaluate_all("parts => parts.map(part => part.outerHTML)")
        choose(page, "method", "as-published")
        after = page.locator(seen).evaluate_all("parts => parts.map(part => part.outerHTML)")
        assert before, part
        assert before != after, part


def test_traces_are_loaded_when_they_are_seen(visit, attacked):
    page = visit(boat_path(attacked))
    traces = page.locator(".traces:visible img").first
    traces.scroll_into_view_if_needed()
    page.wait_for_function(
        "image => image.complete && image.naturalWidth > 0", arg=traces.element_handle()
    )


def test_everything_is_reached_by_keyboard(visit):
    page = visit("register.html")
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.className") == "skip"
    head(page, "Naam").get_by_role("button").focus()
    page.keyboard.press("Enter")
    assert head(page, "Naam").get_attribute("aria-sort") == "ascending"


def test_the_pictures_of_the_readme_can_be_taken(site, tmp_path):
    """In a process of its own: Playwright runs once in a process."""
    draw = ROOT / "docs" / "pictures" / "draw.py"
    subprocess.run([sys.executable, draw, site / "en", tmp_path], check=True, timeout=120)
    shown = set(re.findall(r"docs/pictures/(\S+\.png)", read("README.md")))
    assert {file.name for file in tmp_path.iterdir()} == shown
    for folder in (tmp_path, draw.parent):
        assert all(0 < (folder / name).stat().st_size < 1_000_000 for name in shown)


REPORT = """<!doctype html><html lang="nl" data-root="">
<p hidden data-ended="2026-05-01T22:00Z">oud</p><script src="site.js"></script></html>"""


@pytest.mark.parametrize(("day", "is_old"), [("2026-05-02", False), ("2026-05-04", True)])
def test_a_report_says_that_it_is_old_where_no_night_followed(page, tmp_path, day, is_old):
    (tmp_path / "site.js").write_text((STATIC / "site.js").read_text("utf-8"), "utf-8")
    report = tmp_path / "latest.html"
    report.write_text(REPORT, encoding="utf-8")
    page.clock.set_fixed_time(day)
    page.goto(report.as_uri())
    assert page.locator("[data-ended]").is_visible() == is_old
