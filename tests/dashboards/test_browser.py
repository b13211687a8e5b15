"""The site in a real browser, opened from disk: no error, no request, everything works.

Needs Chromium. Where it is not installed the tests are skipped, except in CI (`HERIJK_CI` set),
where that is a failure, and screenshots go to `ci-output/`.
"""

import csv
import io
import os
import re
import shutil
from itertools import product

import pytest
from axe_playwright_python.sync_playwright import Axe

from dashboards.addresses import boat_path, edition_page, race_path, type_path
from dashboards.guides import GUIDES
from dashboards.site.pages import MENU
from dashboards.site.start import ABOUT
from tests.architecture.repository import ROOT
from tests.dashboards.conftest import ATTACK, EDITIONS, FORMULA
from warehouse.queries.views import Views

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
FLAGS = [
    *("--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-sync"),
    *("--disable-background-networking", "--disable-component-update"),
]
HIDDEN_BARS = ["--hide-scrollbars"]
"""What a browser without a window is told by itself: people's windows have bars."""
SHOTS = ROOT / "ci-output"
WIDE = {"width": 1920, "height": 1080}
"""Looked at in pictures: nothing that fits 1280 is too wide for it."""
WIDTHS = {"desktop": {"width": 1280, "height": 900}, "phone": {"width": 390, "height": 844}}

pytestmark = [
    pytest.mark.more,
    pytest.mark.skipif(
        CHROMIUM is None and "HERIJK_CI" not in os.environ,
        reason="no Chromium on this machine: install the package chromium to run the browser tests",
    ),
]


@pytest.fixture(scope="module")
def browser(site):
    """A browser, started after the site is built and closed with this module.

    Playwright keeps an event loop running in this thread, in which Dagster could not run its own.
    """
    assert (site / "index.html").exists()
    assert CHROMIUM is not None, "CI has to test in a browser: install the package chromium"
    from playwright.sync_api import expect, sync_playwright  # noqa: PLC0415 - not needed when skipped

    expect.set_options(timeout=30_000)  # other tests run beside these
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=CHROMIUM, args=FLAGS, ignore_default_args=HIDDEN_BARS
        )
        yield browser
        browser.close()


class Visitor:
    """A page of the browser that notes what it should not see."""

    def __init__(self, page, site):
        from playwright.sync_api import expect  # noqa: PLC0415 - not needed when skipped

        self.page, self.site, self.faults, self.expect = page, site, [], expect
        page.on("pageerror", lambda error: self.faults.append(str(error)))
        page.on("console", self._said)
        page.on("request", self._asked)
        page.on("dialog", lambda dialog: (self.faults.append("dialog"), dialog.dismiss()))

    def _said(self, message):
        if message.type == "error":
            self.faults.append(message.text)

    def _asked(self, request):
        if not request.url.startswith(("file:", "data:", "blob:")):
            self.faults.append(request.url)

    def open(self, path):
        self.page.goto((self.site / path).as_uri())
        return self.page

    def unfold(self):
        """Opens everything that is folded."""
        self.page.evaluate("document.querySelectorAll('.fold').forEach(d => { d.open = true; })")

    def draw_all(self):
        """Draws charts further down too, as printing does."""
        self.page.evaluate("window.dispatchEvent(new Event('beforeprint'))")
        self.expect(self.page.locator(".chart:not(.drawn)")).to_have_count(0, timeout=30_000)


@pytest.fixture(scope="module")
def context(browser):
    """One for all tests, so that the browser reads the scripts of the site once."""
    with browser.new_context(accept_downloads=True, viewport=WIDTHS["desktop"]) as context:
        yield context


@pytest.fixture
def visitor(context, site):
    with context.new_page() as page:
        visitor = Visitor(page, site)
        page.set_default_timeout(30_000)
        yield visitor
    assert visitor.faults == []


def scrolled(page, boxes):
    """What in these boxes is wider than they are, with a bar at their side as many rows have."""
    return page.evaluate(
        "boxes => [...document.querySelectorAll(boxes)].filter(b => {"
        " if (b.matches('.scroll')) b.style.overflowY = 'scroll';"
        " return b.scrollWidth > b.clientWidth;"
        "}).map(b => b.closest('[data-table], figure').outerHTML.slice(0, 80))",
        boxes,
    )


NOT_SIDEWAYS = {
    "desktop": ".chart, [data-table]:not([data-table=register], .values *) > .scroll",
    "phone": ".chart.drawn",
}
"""What fits its box: not the register, whose lines may have long words, nor, on a phone, tables and
the picture that stands in for a chart."""

KINDS = ["index", *MENU, *ABOUT, GUIDES[0], "boat", "type", "race", "edition"]
"""A page of each kind."""

SERIOUS = {"serious", "critical"}


def barriers(page):
    """What axe-core finds that keeps people out: rule and the first element.

    It takes long over parts that are all alike: of a table it sees a few rows, and a picture, which
    has to have a name, only from outside.
    """
    page.evaluate(
        "document.querySelectorAll('tbody').forEach(body =>"
        " body.replaceChildren(...[...body.rows].slice(0, 3)))"
    )
    page.wait_for_function(
        "!document.querySelector('svg:not([role=img][aria-label], [aria-hidden])')"
    )
    only = {"resultTypes": ["violations"], "preload": False}
    found = Axe().run(page, {"exclude": ["svg"]}, only).response["violations"]
    return [
        f"{rule['id']}: {rule['nodes'][0]['html']} {rule['nodes'][0]['failureSummary']}"
        for rule in found
        if rule["impact"] in SERIOUS
    ]


LOOKS = ("desktop", "phone", "wide", "desktop-dark", "phone-dark", "wide-dark")
FIRST = ("desktop-first", "phone-first")


class Pictures:
    """Pictures of a page in `ci-output/`, for people to look at; taken in CI alone.

    `index.html` beside them leads to all.
    """

    def __init__(self, page, name):
        self.page, self.name, self.taken = page, name, "HERIJK_CI" in os.environ
        if self.taken:
            SHOTS.mkdir(exist_ok=True)
            (SHOTS / "index.html").write_text(index_of_pictures(), encoding="utf-8")

    def at_first(self):
        """The print, and what is seen first."""
        if self.taken:
            self.page.pdf(path=SHOTS / f"{self.name}.pdf", print_background=True)
            for width, size in WIDTHS.items():
                self.page.set_viewport_size(size)
                self.page.screenshot(path=SHOTS / f"{self.name}-{width}-first.png")

    def whole(self, width):
        """The whole page, unfolded, also in the dark."""
        if not self.taken:
            return
        for scheme, ending in (("dark", "-dark"), ("light", "")):
            self.page.emulate_media(color_scheme=scheme)
            path = SHOTS / f"{self.name}-{width}{ending}.png"
            self.page.screenshot(path=path, full_page=True)

    def wide(self):
        """The same on a wide screen."""
        if self.taken:
            self.page.set_viewport_size(WIDE)
            self.whole("wide")


def index_of_pictures():
    """A page with a line per kind of page and language, and in it a link to each picture."""
    lines = []
    for name, language in product(KINDS, ("nl", "en")):
        files = [f"{name}-{language}-{look}.png" for look in (*FIRST, *LOOKS)]
        links = [
            f'<td><a href="{f}">{look}</a>' for f, look in zip(files, (*FIRST, *LOOKS), strict=True)
        ]
        pdf = f'<td><a href="{name}-{language}.pdf">print</a>'
        lines.append(f"<tr><th>{name} {language}{''.join(links)}{pdf}")
    head = "<!doctype html><meta charset=utf-8><title>Herijk</title>"
    return f"{head}<table>{''.join(lines)}</table>"


def shown(page, table):
    return page.locator(f"[data-table={table}] tbody tr:visible")


def keys_shown(page, table):
    """What selectors choose by, of the rows that a table shows."""
    return page.locator(f"[data-table={table}]").evaluate(
        "table => [...new Set([...table.querySelectorAll('tbody tr:not([hidden])')]"
        ".map(r => r.dataset.k))].map(place => JSON.parse(table.dataset.keys)[place])"
    )


def path_of(name, store, attacked):
    """The page of a kind of which there are many, or of the menu."""
    if name == "boat":
        return boat_path(attacked)
    if name == "edition":
        return edition_page(EDITIONS[-1])
    with Views(store) as views:
        if name == "type":
            return type_path(views.type_names()[0])
        if name == "race":
            return race_path(*views.race_days()[0])
    return f"{name}.html"


def fits_at_all_widths(page, pictures):
    """Whatever the width, nothing is wider than its place, and nothing is broken."""
    for width, size in WIDTHS.items():
        page.set_viewport_size(size)
        assert page.evaluate("document.documentElement.scrollWidth") <= size["width"]
        assert scrolled(page, NOT_SIDEWAYS[width]) == []
        assert page.locator(".broken").count() == 0
        pictures.whole(width)
    pictures.wide()


@pytest.mark.parametrize("name", KINDS)
def test_every_page_opens_draws_and_keeps_nobody_out(visitor, store, attacked, name):
    """CI alone draws the charts of the English page, and looks for barriers at both widths.

    The charts are those of the Dutch page; a phone shows all that a wide screen does, and cards.
    """
    path = path_of(name, store, attacked)
    for folder, language in (("en/", "en"), ("", "nl")):
        page = visitor.open(folder + path)
        pictures = Pictures(page, f"{name}-{language}")
        pictures.at_first()
        visitor.unfold()
        if language == "nl" or pictures.taken:
            visitor.draw_all()
        fits_at_all_widths(page, pictures)
    for width, size in WIDTHS.items():
        if pictures.taken or width == "phone":
            page.set_viewport_size(size)
            assert barriers(page) == []


def test_an_attack_is_shown_as_a_name(visitor, attacked):
    page = visitor.open(boat_path(attacked))
    assert page.locator("h1").inner_text() == ATTACK


def cw_cell(page):
    """The cells of Cw in the register."""
    heads = page.locator("[data-table=register] th")
    place = heads.evaluate_all("heads => heads.findIndex(h => h.dataset.c === 'cw_kg_m')")
    return f"td:nth-child({place + 1})"


def test_a_page_is_in_one_language_and_leads_to_the_other(visitor):
    page = visitor.open("register.html")
    page.locator("select[name=edition]").select_option("concept-as-published")
    first = shown(page, "register").first.locator(cw_cell(page))
    assert page.locator("h1").inner_text() == "Register"
    assert "Zoek" in page.locator("[data-table=register] .tools").inner_text()
    assert "," in first.inner_text()
    page.get_by_role("link", name="English").click()
    page.wait_for_url("**/en/register.html*")
    assert "Search" in page.locator("[data-table=register] .tools").inner_text()
    assert "," not in first.inner_text()
    assert page.locator("select[name=edition]").input_value() == "concept-as-published"


def test_the_search_finds_a_boat_without_its_accents(visitor, store):
    with Views(store) as views:
        boats = views.table("boats").select("name", "fsn_no").rows()
    name, fsn_no = next(b for b in boats if "é" in b[0])
    page = visitor.open("quality.html")
    page.locator(".find input").fill(name.lower().replace("é", "e"))
    page.locator("#found a", has_text=fsn_no).click()
    page.wait_for_url(f"**/{boat_path(fsn_no)}*")


def test_a_phone_shows_numbers_without_scrolling_aside(visitor):
    visitor.page.set_viewport_size(WIDTHS["phone"])
    page = visitor.open("register.html")
    cells = page.locator("[data-table=register] tbody td:visible").all_inner_texts()
    assert any(re.fullmatch(r"\d+,\d\d", text) for text in cells)
    assert scrolled(page, "[data-table=register] .scroll") == []


def test_search_sort_and_edition(visitor):
    page = visitor.open("register.html")
    lines = shown(page, "register").count()
    name = shown(page, "register").nth(1).locator("td").first.inner_text()
    page.locator("[data-table=register] .search").fill(name)
    assert 0 < shown(page, "register").count() < lines
    assert name in shown(page, "register").first.inner_text()
    page.locator("[data-table=register] .search").fill("")
    for direction in (1, -1):
        page.locator("th[data-c=cw_kg_m] button").click()
        cells = page.locator(f"[data-table=register] tbody tr:visible {cw_cell(page)}")
        cells = [float(t.replace(",", ".")) for t in cells.all_inner_texts() if t]
        assert cells == sorted(cells, reverse=direction < 0)
    assert page.locator("th[data-c=cw_kg_m]").get_attribute("aria-sort") == "descending"
    assert page.locator("#register .headline").is_visible()
    page.locator("select[name=edition]").select_option("concept-as-published")
    assert keys_shown(page, "register") == [["concept-as-published"]]
    # It tells of the edition that was shown.
    assert not page.locator("#register .headline").is_visible()


def test_a_table_downloads_what_it_shows(visitor):
    page = visitor.open("register.html")
    with page.expect_download() as caught:
        page.locator("[data-table=register] .csv").click()
    text = caught.value.path().read_text("utf-8-sig")
    rows = list(csv.DictReader(io.StringIO(text), delimiter=";"))
    assert len(rows) == shown(page, "register").count()
    assert {"FSN\u2011nr", "A [kg/m]", "B [m/s]"} <= rows[0].keys()
    assert any("," in row["A [kg/m]"] for row in rows)


def test_a_chart_downloads_its_data(visitor, attacked):
    page = visitor.open("en/" + boat_path(attacked))
    visitor.unfold()
    figure = page.locator("figure[data-figure=resistance_curve]")
    figure.scroll_into_view_if_needed()
    figure.locator(".drawn svg.marks").wait_for()
    figure.locator(".values > summary").press("Enter")
    with page.expect_download() as caught:
        figure.locator(".csv").click()
    rows = list(csv.DictReader(io.StringIO(caught.value.path().read_text("utf-8-sig"))))
    tow = page.locator("select[name=tow_id]").input_value()
    assert {row["Tow"] for row in rows} == {tow}
    figure.locator(".chart summary").click()
    for kind in ("svg", "png"):
        with page.expect_download() as caught:
            figure.get_by_role("link", name=kind.upper()).click()
        assert caught.value.suggested_filename == f"resistance_curve.{kind}"


def test_the_uncertainty_can_be_read_without_its_chart(visitor, attacked, built):
    page = visitor.open(boat_path(attacked))
    visitor.unfold()
    figure = page.locator("figure[data-figure=budget]")
    figure.scroll_into_view_if_needed()
    figure.locator(".drawn svg.marks").wait_for()
    figure.locator(".values > summary").press("Enter")
    tow, method = (page.locator(f"select[name={n}]").input_value() for n in ("tow_id", "method"))
    budget = built.table("uncertainty_budget").filter(tow_id=tow, method=method)
    rows = figure.locator(".values tbody tr")
    rows.first.wait_for()
    assert rows.count() == budget.height > 0
    assert "spreiding van de runs" in figure.locator(".values tbody").inner_text()


def test_a_name_is_no_formula_in_a_download(visitor):
    page = visitor.open("boats.html")  # names of today; an edition keeps its own
    with page.expect_download() as caught:
        page.locator("[data-table=due_list] .csv").click()
    text = caught.value.path().read_text("utf-8-sig")
    names = [row["Naam"] for row in csv.DictReader(io.StringIO(text), delimiter=";")]
    assert FORMULA.replace("=", "'=") in names
    assert ATTACK in names


def test_races_follow_the_edition(visitor, store):
    with Views(store) as views:
        race, day = views.race_days()[0]
    page = visitor.open(race_path(race, day))
    page.locator("select[name=to_edition]").select_option(EDITIONS[1])
    assert shown(page, "race_changes").count() > 0
    assert keys_shown(page, "race_changes") == [[EDITIONS[1]]]


def test_choosing_a_method_changes_the_curve(visitor, attacked):
    page = visitor.open(boat_path(attacked))
    visitor.unfold()
    visitor.draw_all()
    chart = page.locator("figure[data-figure=resistance_curve] .chart.drawn")
    chart.locator("svg.marks").wait_for()
    before = chart.inner_html()
    page.locator("select[name=method]").select_option("as-published")
    page.wait_for_function(
        "old => document.querySelector('figure[data-figure=resistance_curve] .chart').innerHTML"
        " !== old",
        arg=before,
    )
    picked = page.locator("figure[data-figure=resistance_curve] .picked").inner_text()
    assert "zoals gepubliceerd" in picked


def test_print_says_what_is_chosen(visitor):
    page = visitor.open("register.html")
    page.locator("select[name=edition]").select_option(EDITIONS[0])
    page.emulate_media(media="print")
    assert page.locator("select[name=edition]").is_visible()


TWO_FRAMES = "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"


def test_dragging_over_the_scatter_fills_the_list_and_a_point_leads_to_its_boat(visitor):
    page = visitor.open("types.html")
    chart = page.locator("figure[data-figure=b_weight]").first
    chart.scroll_into_view_if_needed()  # drawn when it comes into view
    chart.locator(".drawn svg.marks").wait_for()
    boats = shown(page, "type_boats").count()
    area = chart.locator(".role-scope .background").first.bounding_box()
    page.mouse.move(area["x"] + 15, area["y"] + 15)
    page.mouse.down()
    page.mouse.move(area["x"] + area["width"] / 2, area["y"] + area["height"] - 15, steps=5)
    page.mouse.up()
    visitor.expect(page.locator(".clear")).to_be_visible()
    assert 0 < shown(page, "type_boats").count() < boats
    page.evaluate(TWO_FRAMES)  # Vega tells of the last movement late; nobody clicks as quickly
    page.locator(".clear").click()
    visitor.expect(shown(page, "type_boats")).to_have_count(boats)
    chart.locator("svg .mark-symbol.role-mark path").first.click(force=True)
    page.wait_for_url("**/boats/*.html")
    assert page.locator(".answer .headline").count() >= 1


def test_everything_is_reached_by_keyboard(visitor):
    page = visitor.open("register.html")
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.className") == "skip"
    page.locator("th[data-c=name] button").focus()
    page.keyboard.press("Enter")
    assert page.locator("th[data-c=name]").get_attribute("aria-sort") == "ascending"
    assert page.locator("table:not(:has(caption))").count() == 0
