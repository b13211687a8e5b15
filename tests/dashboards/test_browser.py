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
from dashboards.queries.results import Results
from dashboards.queries.votes import PAGE as PARTS
from dashboards.queries.votes import read_parts
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
KINDS = ["index", "register", "boats", "types", "seasons", "changes", "parts", "years",
         "quality", "about", "words", GUIDES[0], "boat", "type", "race", "edition"]  # fmt: skip
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
    page.reload()
    page.get_by_role("link", name="Nederlands").click()
    page.wait_for_url("**/register.html*")
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


def read_gains(page):
    """The seconds of each crew, and the length of its bar, as a page shows them."""
    rows = page.locator(".gains tbody tr")
    texts = rows.evaluate_all("rows => rows.map(row => row.cells[2].textContent)")
    lengths = rows.evaluate_all(
        "rows => rows.map(row => Number(row.querySelector('rect').getAttribute('width')))"
    )
    return [(as_number(text), length) for text, length in zip(texts, lengths, strict=True)]


def as_number(text):
    return int(text.replace("\N{MINUS SIGN}", "-")) if text != "\N{EN DASH}" else None


def read_podiums(page):
    """New place, boat and old place of all who are on a podium that is seen, class by class."""
    rows = page.locator(".podium tbody tr:visible")
    return [
        (as_number(new), boat, as_number(old))
        for new, boat, old in rows.evaluate_all(
            "rows => rows.map(row => [row.cells[0].textContent,"
            " row.querySelector('a').textContent, row.cells[2].textContent.trim()])"
        )
    ]


def list_stored(data, place):
    """What the tables have at the place of a combination, as `read_gains`, `read_podiums`."""
    seconds = [row["seconds"][place] for row in data["crews"]]
    gains = [(one, abs(one or 0)) for one in seconds]
    podiums = []
    for of_class in data["races"][0]["classes"]:
        rows = [(row["new"][place], row["name"], row["old"][place]) for row in of_class["rows"]]
        on_podium = [row for row in rows if row[0] is not None and row[0] <= data["podium"]]
        podiums += sorted(on_podium, key=lambda row: row[0])
    return gains, podiums


def test_a_member_switches_a_part_off_and_sends_the_address(visit, store):
    """Bars and podium become the stored ones at once, and again for whoever opens the address."""
    with Views(store) as views:
        data = read_parts(Results(views))
    page = visit(PARTS)
    switches = page.get_by_role("switch")
    assert switches.count() == len(data["switches"]) > 1
    everything = 2 ** switches.count() - 1
    assert (read_gains(page), read_podiums(page)) == list_stored(data, everything)
    headline = page.locator(".headline:visible").inner_text()
    switches.first.focus()
    page.keyboard.press("Space")
    page.wait_for_url("**#on=*")
    changed = (read_gains(page), read_podiums(page))
    assert changed == list_stored(data, everything - 1) != list_stored(data, everything)
    assert page.locator(".headline:visible").inner_text() != headline
    page.reload()
    assert not switches.first.is_checked()
    assert (read_gains(page), read_podiums(page)) == changed
    page.get_by_role("link", name="English").click()
    page.wait_for_url("**/en/parts.html#on=*")
    assert not switches.first.is_checked()
    assert (read_gains(page), read_podiums(page)) == changed


def test_without_scripts_a_page_shows_the_whole_proposal_and_says_so(context, site, store):
    with Views(store) as views:
        data = read_parts(Results(views))
    with context.browser.new_context(java_script_enabled=False) as without_scripts:
        page = without_scripts.new_page()
        page.goto((site / "en" / PARTS).as_uri())
        assert "Without JavaScript" in page.locator("main").inner_text()
        assert page.get_by_role("switch").first.is_disabled()
        shown = page.locator(".gains tbody tr td:nth-child(3)").all_inner_texts()
    assert [as_number(text) for text in shown] == [row["seconds"][-1] for row in data["crews"]]


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
