"""The workbench in a real browser: no error, no request elsewhere, and the last change wins.

Needs Chromium, like the tests of the site.
"""

import pytest

from dashboards.speech import Speech
from dashboards.workbench.bench import Bench
from pipeline.method.definition import parse_method
from tests.conftest import METHODS
from tests.dashboards import test_browser as site
from tests.dashboards.conftest import served
from warehouse.queries.history import History
from warehouse.store.store import Store

pytestmark = site.pytestmark


@pytest.fixture(scope="module")
def bench(built, tmp_path_factory):
    """A workbench that saves into a folder of its own."""
    folder = tmp_path_factory.mktemp("workbench")
    (folder / "warehouse.duckdb").symlink_to(built.store.database)
    return Bench(Store(folder), History.of(built.store))


@pytest.fixture(scope="module")
def url(bench):
    with served(bench) as address:
        yield address


@pytest.fixture(scope="module")
def browser(url):
    """A browser of this module; the archive is built before its event loop runs."""
    assert site.CHROMIUM is not None, "CI has to test in a browser: install the package chromium"
    from playwright.sync_api import sync_playwright  # noqa: PLC0415 - not needed when skipped

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=site.CHROMIUM, args=site.FLAGS, ignore_default_args=site.HIDDEN_BARS
        )
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def context(browser):
    """One for all tests, so that the browser reads the scripts once."""
    with browser.new_context(accept_downloads=True, viewport=site.WIDTHS["desktop"]) as context:
        yield context


@pytest.fixture
def page(context, url):
    """The open workbench; what it should not do makes the test fail."""
    faults = []
    with context.new_page() as page:
        page.set_default_timeout(30_000)
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.on("console", lambda m: faults.append(m.text) if m.type == "error" else None)
        page.on("request", lambda r: None if is_own(r.url, url) else faults.append(r.url))
        page.goto(url)
        settle(page)
        yield page
    assert faults == []


def is_own(address_asked, url):
    return address_asked.startswith((url, "data:", "blob:"))


def settle(page):
    """Waits for the answer; not by a function, as the page forbids the eval that this takes."""
    page.locator("html:not([aria-busy])").wait_for(state="attached")


def draw_all(page):
    """Draws what is out of view too, as printing does."""
    page.evaluate("window.dispatchEvent(new Event('beforeprint'))")
    page.locator("figure:not(:has(svg[role=img])) .chart").first.wait_for(state="detached")


def field(page, name):
    return page.locator(f"[name='{name}']")


def change(page, name, value):
    """Types a number and leaves the field."""
    field(page, name).fill(str(value))
    field(page, name).press("Tab")
    settle(page)


def median(page):
    return page.locator("#overview .figures dd").nth(5).inner_text()


def expected_median(bench, **query):
    ratio = bench.scenario(bench.asked(query)).summary()["median_ratio"]
    return Speech("nl").per_cent(ratio)


def test_it_opens_and_draws_everything(page):
    pictures = site.Pictures(page, "workbench")
    assert "GESIMULEERD" in page.locator(".simulated").inner_text()
    draw_all(page)
    assert page.locator("figure").count() == page.locator("figure svg[role=img]").count() > 0
    for width, size in site.WIDTHS.items():
        page.set_viewport_size(size)
        assert page.evaluate("document.documentElement.scrollWidth") <= size["width"]
        assert site.scrolled(page, ".chart") == []
        pictures.whole(width)
        assert site.barriers(page) == []


def test_print_shows_whole_tables_and_which_methods_they_compare(page):
    page.emulate_media(media="print")
    draw_all(page)
    cut = (
        "[...document.querySelectorAll('.scroll')].filter(b => b.scrollHeight > b.clientHeight + 1)"
    )
    assert page.evaluate(f"{cut}.map(b => [b.ariaLabel, b.scrollHeight, b.clientHeight])") == []
    assert page.locator("[name=base]").is_visible()
    assert page.locator("[name=against]").is_visible()
    assert not page.locator("#options").is_visible()


def test_a_number_that_is_typed_changes_all_boats_until_all_is_reset(page, bench):
    before = median(page)
    assert before == expected_median(bench) == Speech("nl").per_cent(1)
    change(page, "wind.side", 0.5)
    query = {"wind.side": "0.5"}
    assert median(page) == expected_median(bench, **query) != before
    assert "0,2 → 0,5" in page.locator("#changed").inner_text()
    page.locator("#changed a").click()
    settle(page)
    assert median(page) == before


def test_of_two_quick_changes_the_last_wins(page, bench):
    values = [0.4, 0.6, 0.8, 1.0, 1.2]
    page.evaluate(
        """(values) => { const field = document.querySelector("[name='wind.side']");
        for (const value of values) { field.value = value;
          field.dispatchEvent(new Event("change", { bubbles: true })); } }""",
        values,
    )
    settle(page)
    assert median(page) == expected_median(bench, **{"wind.side": str(values[-1])})


def test_a_change_is_shared_as_a_link(page, bench):
    change(page, "wind.side", 1)
    (boat,) = bench.history.tows["fsn_no"].mode(maintain_order=True).head(1)
    field(page, "boat").select_option(boat)
    settle(page)
    for name, value in (("against", METHODS[-1]), ("tows", "newest")):
        field(page, name).select_option(value)
        settle(page)
    page.locator("[name=tow]").select_option(index=1)
    shown, link, tow = median(page), page.url, page.locator("[name=tow]").input_value()
    page.goto("about:blank")
    page.goto(link)
    assert median(page) == shown
    assert field(page, "against").input_value() == METHODS[-1]
    assert field(page, "tows").input_value() == "newest"
    assert field(page, "tow").input_value() == tow
    assert "→ 1" in page.locator("#changed").inner_text()


def test_a_change_of_one_season_is_of_that_season(page):
    field(page, "at").select_option("2009")
    settle(page)
    field(page, "speed.correction.2009").select_option("prescribed")
    settle(page)
    assert "geschat → voorgeschreven (2009\u20132011)" in page.locator("#changed").inner_text()
    field(page, "at").select_option("")
    settle(page)
    assert field(page, "speed.correction").locator("option:checked").inner_text() == "verschilt"


def test_what_cannot_be_is_said_and_what_can_be_goes_on(page):
    before = median(page)
    change(page, "wind.side", 9)
    alert = page.get_by_role("alert")
    assert "Coëfficiënt van opzij moet tussen" in alert.inner_text()
    assert median(page) == before
    change(page, "wind.side", 0.2)
    assert alert.inner_text() == ""


def test_a_line_leads_to_the_boat(page):
    boat = page.locator("[data-table=register] td a").nth(2)
    number = boat.inner_text()
    boat.click()
    page.locator(f"[name=boat] option[value='{number}'][selected]").wait_for(state="attached")
    assert page.locator("[data-table=boat_curves] tbody tr").count() >= 2


def test_it_speaks_two_languages_of_the_same_question(page):
    change(page, "wind.side", 0.5)
    shown = median(page)
    page.get_by_role("link", name="English").click()
    page.get_by_role("heading", name="The register").wait_for()
    assert median(page) == shown.replace(",", ".")


def test_every_control_has_a_name_for_who_cannot_see_it(page):
    nameless = page.evaluate(
        "[...document.querySelectorAll('input, select, textarea')].filter(e =>"
        " !e.labels?.length && !e.ariaLabel).length"
    )
    assert nameless == 0
    assert page.locator("fieldset:not(:has(> legend))").count() == 0
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.className") == "skip"
    page.evaluate("document.querySelectorAll('main figure').forEach(one => one.remove())")
    assert site.barriers(page) == []
    assert page.get_by_role("form", name="Keuzes").is_visible()


def test_a_method_is_saved_once(page, bench):
    change(page, "wind.side", 1.5)
    page.locator(".save > summary").click()
    for name, value in (
        ("name", "lagere-grens"),
        ("title", "Lagere grens"),
        ("reason", "Een proef."),
    ):
        page.locator(f"#{name}").fill(value)
    page.locator("#save").click()
    page.locator("#saved").wait_for()
    path = bench.known.folder / "lagere-grens.toml"
    assert str(path) in page.locator("#saved").inner_text()
    method = parse_method(path.read_text(encoding="utf-8"), str(path))
    assert method.for_season(2014).wind.side == 1.5
    assert (method.title, method.description) == ("Lagere grens", "Een proef.")
    page.locator("#save").click()
    page.locator("#refused:not(:empty)").wait_for()
    assert "lagere-grens.toml" in page.get_by_role("alert").inner_text()
    page.goto(f"{page.url.split('?')[0]}?base=lagere-grens")
    assert field(page, "wind.side").input_value() == "1.5"
