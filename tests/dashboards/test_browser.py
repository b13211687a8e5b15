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
from dashboards.site.pages import MENU
from dashboards.site.start import ABOUT

from dashboards.addresses import boat_path, edition_page, race_path, type_path
from dashboards.guides import GUIDES
from tests.architecture.repository import ROOT, read
from tests.dashboards.browser import (
    IN_CI,
    NEEDED,
    WIDTHS,
    barriers,
    draw_all,
    picture,
    too_wide,
)
from tests.dashboards.conftest import ATTACK, EDITIONS, FORMULA
from warehouse.queries.views import Views

pytestmark = NEEDED

ON_A_WIDE_SCREEN = ".chart, [data-table]:not([data-table=register], .values *) > .scroll"
NOT_SIDEWAYS = {"wide": ON_A_WIDE_SCREEN, "desktop": ON_A_WIDE_SCREEN, "phone": ".chart.drawn"}
"""What fits its box: not the register, whose lines may have long words, nor, on a phone, tables and
the picture that stands in for a chart."""
KINDS = ["index", *MENU, *ABOUT, GUIDES[0], "boat", "type", "race", "edition"]
"""A page of each kind."""
DRAFT = "concept-as-published"


@pytest.fixture
def visit(page, site):
    """Opens a page of the site, with everything that is folded."""

    def go(path):
        page.goto((site / path).as_uri())
        page.evaluate("document.querySelectorAll('.fold').forEach(d => { d.open = true; })")
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


def shown(page, table):
    return page.locator(f"[data-table={table}] tbody tr:visible")


def keys_shown(page, table):
    """What selectors choose by, of the rows that a table shows."""
    return page.locator(f"[data-table={table}]").evaluate(
        "table => [...new Set([...table.querySelectorAll('tbody tr:not([hidden])')]"
        ".map(r => r.dataset.k))].map(place => JSON.parse(table.dataset.keys)[place])"
    )


def cw_cells(page):
    """The cells of Cw in the register that are seen."""
    heads = page.locator("[data-table=register] th")
    place = heads.evaluate_all("heads => heads.findIndex(h => h.dataset.c === 'cw_kg_m')")
    return page.locator(f"[data-table=register] tbody tr:visible td:nth-child({place + 1})")


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
    """CI alone draws the charts of the English page, and looks for barriers at every width.

    The charts are those of the Dutch page; a phone shows all that a wide screen does, and cards.
    """
    path = paths.get(name, f"{name}.html")
    for folder, language in (("en/", "en"), ("", "nl")):
        page = visit(folder + path)
        if language == "nl" or IN_CI:
            draw_all(page)
        for width, size in WIDTHS.items():
            page.set_viewport_size(size)
            assert too_wide(page, NOT_SIDEWAYS[width]) == []
            assert page.locator(".broken").count() == 0
            picture(page, f"{name}-{language}-{width}")
    for width, size in WIDTHS.items():
        if IN_CI or width == "phone":
            page.set_viewport_size(size)
            assert barriers(page) == []


def test_a_page_is_in_one_language_and_leads_to_the_other(visit):
    page = visit("register.html")
    choose(page, "edition", DRAFT)
    assert page.locator("h1").inner_text() == "Register"
    assert "Zoek" in page.locator("[data-table=register] .tools").inner_text()
    assert "," in cw_cells(page).first.inner_text()
    page.get_by_role("link", name="English").click()
    page.wait_for_url("**/en/register.html*")
    assert "Search" in page.locator("[data-table=register] .tools").inner_text()
    assert "," not in cw_cells(page).first.inner_text()
    assert page.locator("select[name=edition]").input_value() == DRAFT


def test_the_search_finds_a_boat_without_its_accents(visit, store):
    with Views(store) as views:
        boats = views.table("boats").select("name", "fsn_no").rows()
    name, fsn_no = next(b for b in boats if "é" in b[0])
    page = visit("quality.html")
    page.locator(".find input").fill(name.lower().replace("é", "e"))
    page.locator("#found a", has_text=fsn_no).click()
    page.wait_for_url(f"**/{boat_path(fsn_no)}*")


def test_a_phone_shows_numbers_without_scrolling_aside(visit):
    page = visit("register.html")
    page.set_viewport_size(WIDTHS["phone"])
    cells = page.locator("[data-table=register] tbody td:visible").all_inner_texts()
    assert any(re.fullmatch(r"\d+,\d\d", text) for text in cells)
    assert too_wide(page, "[data-table=register] .scroll") == []


def test_search_sort_and_edition(visit):
    page = visit("register.html")
    lines = shown(page, "register").count()
    name = shown(page, "register").nth(1).locator("td").first.inner_text()
    page.locator("[data-table=register] .search").fill(name)
    assert 0 < shown(page, "register").count() < lines
    assert name in shown(page, "register").first.inner_text()
    page.locator("[data-table=register] .search").fill("")
    for direction in (1, -1):
        page.locator("th[data-c=cw_kg_m] button").click()
        cells = [float(t.replace(",", ".")) for t in cw_cells(page).all_inner_texts() if t]
        assert cells == sorted(cells, reverse=direction < 0)
    assert page.locator("th[data-c=cw_kg_m]").get_attribute("aria-sort") == "descending"
    assert page.locator("#register .headline").is_visible()
    choose(page, "edition", DRAFT)
    assert keys_shown(page, "register") == [[DRAFT]]
    # It tells of the edition that was shown.
    assert not page.locator("#register .headline").is_visible()
    page.emulate_media(media="print")
    assert page.locator("select[name=edition]").is_visible()


def test_races_follow_the_edition(visit, paths):
    page = visit(paths["race"])
    choose(page, "to_edition", EDITIONS[1])
    assert shown(page, "race_changes").count() > 0
    assert keys_shown(page, "race_changes") == [[EDITIONS[1]]]


def test_a_table_downloads_what_it_shows_and_a_name_is_no_formula(visit):
    page = visit("boats.html")  # names of today; an edition keeps its own
    rows = rows_in(downloaded(page, page.locator("[data-table=due_list] .csv")))
    assert len(rows) == shown(page, "due_list").count()
    assert any("," in cell for row in rows for name, cell in row.items() if "[m/s]" in name)
    assert {FORMULA.replace("=", "'="), ATTACK} <= {row["Naam"] for row in rows}


def test_a_chart_can_be_read_and_downloaded(visit, attacked, built):
    page = visit(boat_path(attacked))
    figure = page.locator("figure[data-figure=budget]")
    figure.scroll_into_view_if_needed()
    figure.locator(".drawn svg.marks").wait_for()
    figure.locator(".values > summary").press("Enter")
    chosen = {n: page.locator(f"select[name={n}]").input_value() for n in ("tow_id", "method")}
    budget = built.table("uncertainty_budget").filter(**chosen)
    rows = figure.locator(".values tbody tr")
    rows.first.wait_for()
    assert rows.count() == budget.height > 0
    assert "spreiding van de runs" in figure.locator(".values tbody").inner_text()
    assert len(rows_in(downloaded(page, figure.locator(".csv")))) == budget.height
    figure.locator(".chart summary").click()
    for kind in ("svg", "png"):
        picture_of = downloaded(page, figure.get_by_role("link", name=kind.upper()))
        assert picture_of.suggested_filename == f"budget.{kind}"


def test_choosing_a_method_changes_the_curve(visit, attacked):
    page = visit(boat_path(attacked))
    draw_all(page)
    figure = "figure[data-figure=resistance_curve]"
    chart = page.locator(f"{figure} .chart.drawn")
    chart.locator("svg.marks").wait_for()
    before = chart.inner_html()
    choose(page, "method", "as-published")
    page.wait_for_function(
        f"old => document.querySelector('{figure} .chart').innerHTML !== old", arg=before
    )
    assert "zoals gepubliceerd" in page.locator(f"{figure} .picked").inner_text()


TWO_FRAMES = "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"


def test_dragging_over_the_scatter_fills_the_list_and_a_point_leads_to_its_boat(visit):
    from playwright.sync_api import expect  # noqa: PLC0415 - not needed when skipped

    page = visit("types.html")
    chart = page.locator("figure[data-figure=b_weight]").first
    chart.scroll_into_view_if_needed()  # drawn when it comes into view
    chart.locator(".drawn svg.marks").wait_for()
    boats = shown(page, "type_boats").count()
    area = chart.locator(".role-scope .background").first.bounding_box()
    page.mouse.move(area["x"] + 15, area["y"] + 15)
    page.mouse.down()
    page.mouse.move(area["x"] + area["width"] / 2, area["y"] + area["height"] - 15, steps=5)
    page.mouse.up()
    page.locator(".clear").wait_for()
    assert 0 < shown(page, "type_boats").count() < boats
    page.evaluate(TWO_FRAMES)  # Vega tells of the last movement late; nobody clicks as quickly
    page.locator(".clear").click()
    expect(shown(page, "type_boats")).to_have_count(boats)
    chart.locator("svg .mark-symbol.role-mark path").first.click(force=True)
    page.wait_for_url("**/boats/*.html")
    assert page.locator(".answer .headline").count() >= 1


def test_everything_is_reached_by_keyboard(visit):
    page = visit("register.html")
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.className") == "skip"
    page.locator("th[data-c=name] button").focus()
    page.keyboard.press("Enter")
    assert page.locator("th[data-c=name]").get_attribute("aria-sort") == "ascending"
    assert page.locator("table:not(:has(caption))").count() == 0


def test_the_pictures_of_the_readme_can_be_taken(site, tmp_path):
    """In a process of its own: Playwright runs once in a process."""
    draw = ROOT / "docs" / "pictures" / "draw.py"
    subprocess.run([sys.executable, draw, site / "en", tmp_path], check=True, timeout=120)
    shown = set(re.findall(r"docs/pictures/(\S+\.png)", read("README.md")))
    assert {file.name for file in tmp_path.iterdir()} == shown
    for folder in (tmp_path, draw.parent):
        assert all(0 < (folder / name).stat().st_size < 1_000_000 for name in shown)
