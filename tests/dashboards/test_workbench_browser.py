"""The workbench in a real browser: no error, no request elsewhere, and the last change wins.

Needs Chromium, like the tests of the site.
"""

import pytest

from dashboards.workbench.bench import Base, Bench, Question
from pipeline.method.definition import Steps, parse_method
from tests.conftest import METHODS
from tests.dashboards import test_browser as site
from tests.dashboards.conftest import served
from warehouse.queries.history import History
from warehouse.store.store import Store

pytestmark = site.pytestmark

IDLE = "document.documentElement.dataset.seconds && document.documentElement.ariaBusy !== 'true'"


@pytest.fixture(scope="module")
def bench(built, tmp_path_factory):
    """A workbench that saves into a folder of its own."""
    return Bench(Store(tmp_path_factory.mktemp("workbench")), History.of(built.store))


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
        page.wait_for_function(IDLE)
        yield page
        page.evaluate("localStorage.clear()")
    assert faults == []


def is_own(address_asked, url):
    return address_asked.startswith((url, "data:", "blob:"))


def draw_all(page):
    """Draws what is out of view too, as printing does."""
    page.evaluate("window.dispatchEvent(new Event('beforeprint'))")
    page.wait_for_function(
        "[...document.querySelectorAll('figure')].every(f => f.querySelector('svg[role=img]'))"
    )


def option(page, name, place=0):
    return page.locator(f"[data-option='{name}']").nth(place)


def set_number(page, name, value):
    option(page, name).get_by_role("spinbutton").fill(str(value))


def median(page):
    return page.locator("#median_cw dd").inner_text()


def expected_median(bench, **changes):
    """The median that the bench itself gives, with the default base and comparison."""
    base = Base(name=bench.start()["base"])
    steps = tuple(
        Steps.model_validate(r["steps"] | {k: r["steps"][k] | v for k, v in changes.items()})
        for r in bench.base(base)["ranges"]
    )
    asked = Question(base=base, steps=steps, against=bench.start()["against"], boat="")
    return f"{bench.answer(asked)['summary']['median_ratio']:.4f}".replace(".", ",")


def test_it_opens_and_draws_everything(page):
    pictures = site.Pictures(page, "workbench")
    assert "GESIMULEERD" in page.locator(".simulated").inner_text()
    draw_all(page)
    assert page.locator("figure").count() == page.locator("figure svg[role=img]").count() > 0
    for width, size in site.WIDTHS.items():
        page.set_viewport_size(size)
        assert page.evaluate("document.documentElement.scrollWidth") <= size["width"]
        assert site.scrolled(page, ".chart, .scroll" if width == "desktop" else ".chart") == []
        pictures.whole(width)
    for size in site.WIDTHS.values():
        page.set_viewport_size(size)
        assert site.barriers(page) == []


def test_print_shows_whole_tables_and_which_methods_they_compare(page):
    page.emulate_media(media="print")
    draw_all(page)
    cut = "[...document.querySelectorAll('.scroll')].filter(b => b.scrollHeight > b.clientHeight)"
    assert page.evaluate(f"{cut}.length") == 0
    assert page.locator("#base").is_visible()
    assert page.locator("#against").is_visible()
    assert not page.locator("#steps").is_visible()


def test_a_share_of_one_has_decimals_like_the_others(page):
    page.locator("[data-table=reproducibility]").scroll_into_view_if_needed()
    column = page.locator("[data-table=reproducibility] tbody td:nth-child(7)")
    column.first.wait_for()
    texts = [text for text in column.all_inner_texts() if text]
    assert texts
    assert [text for text in texts if "," not in text] == []


def test_a_slider_moved_by_keyboard_changes_all_boats(page, bench):
    before = median(page)
    assert before == expected_median(bench)
    slider = option(page, "wind.side").get_by_role("slider")
    slider.focus()
    page.keyboard.press("PageDown")
    page.wait_for_function(IDLE)
    value = float(slider.input_value())
    assert value < 0.2
    after = expected_median(bench, wind={"side": value})
    assert median(page) == after != before
    assert " → " in page.locator("#changed").inner_text()
    page.locator("#reset").click()
    page.wait_for_function(IDLE)
    assert median(page) == before


def test_of_two_quick_changes_the_last_wins(page, bench):
    asked = []
    page.on("request", lambda r: asked.append(r.url) if r.url.endswith("/answer") else None)
    for side in (0.4, 0.6, 0.8, 1.0, 1.2):
        set_number(page, "wind.side", side)
    page.wait_for_function(IDLE)
    assert median(page) == expected_median(bench, wind={"side": 1.2})
    assert 1 <= len(asked) <= 5


def test_a_change_is_shared_as_a_link(page, bench):
    set_number(page, "wind.side", 1)
    page.wait_for_function(IDLE)
    page.locator("#against").select_option(METHODS[-1])
    page.wait_for_function(IDLE)
    page.locator("#last").select_option("2009")
    page.wait_for_function(IDLE)
    shown, link = median(page), page.url
    page.goto("about:blank")
    page.goto(link)
    page.wait_for_function(IDLE)
    assert median(page) == shown
    assert page.locator("#against").input_value() == METHODS[-1]
    assert page.locator("#tows").input_value() == "2009"
    assert "→ 1" in page.locator("#changed").inner_text()


def test_a_change_of_one_season_is_of_that_season(page):
    page.locator("details.seasons").first.locator("summary").first.click()
    season = page.get_by_role("group", name="2009-2011")
    season.get_by_role("radio", name="voorgeschreven").check()
    page.wait_for_function(IDLE)
    assert "geschat → voorgeschreven (2009-2011)" in page.locator("#changed").inner_text()
    assert option(page, "speed.correction").locator(".mixed").is_visible()


def test_what_cannot_be_is_said_and_what_can_be_goes_on(page):
    before = median(page)
    set_number(page, "wind.side", 9)
    alert = page.get_by_role("alert")
    alert.wait_for()
    assert "Coëfficiënt van opzij mag hoogstens zijn 2." in alert.inner_text()
    wrong = option(page, "wind.side").get_by_role("spinbutton")
    assert wrong.get_attribute("aria-invalid") == "true"
    assert median(page) == before
    set_number(page, "wind.side", 0.2)
    page.wait_for_function(IDLE)
    assert not alert.is_visible()


def test_a_method_that_leaves_tows_without_a_curve_is_shown(page):
    set_number(page, "runs.highest_target_ratio", 1.0)
    page.wait_for_function(IDLE)
    assert page.locator("#count_removed dd").inner_text() != "0"


def test_a_line_leads_to_the_boat(page):
    boat = page.locator("[data-table=register] .to-boat").nth(2)
    number = boat.inner_text()
    boat.click()
    page.wait_for_function(IDLE)
    assert page.locator("#boat").input_value() == number
    assert page.locator("[data-table=boat_curves] tbody tr").count() >= 2


def test_ends_that_are_typed_list_the_boats_inside(page):
    """By keyboard, as dragging does; Esc clears them, and a boat of the list is shown above."""
    figure = page.locator("figure[data-figure=b_weight]")
    figure.scroll_into_view_if_needed()
    figure.get_by_label("Gewicht [kg], van").press_sequentially("1000")
    boats = figure.locator(".brush .to-boat")
    boats.first.wait_for()
    boat = boats.first.inner_text()
    assert 0 < boats.count() < page.locator("#boat option").count()
    boats.first.press("Enter")
    assert page.locator("#boat").input_value() == boat
    figure.get_by_label("Gewicht [kg], van").press("Escape")
    page.wait_for_function("!document.querySelector('.brush .to-boat')")
    assert figure.locator(".clear").is_hidden()


def test_it_speaks_two_languages(page):
    assert page.locator("#state").inner_text().startswith("40 proeven")
    page.get_by_role("button", name="English").click()
    page.wait_for_function("document.querySelector('figure svg').textContent.includes('Boats')")
    assert "The register" in page.locator("#results").inner_text()
    assert "," not in median(page)


def test_every_control_has_a_name_for_who_cannot_see_it(page):
    nameless = page.evaluate(
        "[...document.querySelectorAll('input, select, textarea')].filter(e =>"
        " !e.labels?.length && !e.ariaLabel && !document.getElementById("
        "e.getAttribute('aria-labelledby'))).length"
    )
    assert nameless == 0
    assert page.locator("fieldset:not(:has(> legend))").count() == 0
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.className") == "skip"


def test_a_method_is_saved_once_and_downloaded(page, bench):
    set_number(page, "wind.side", 1.5)
    page.locator(".save > summary").click()
    page.locator("#name").fill("lagere-grens")
    page.locator("#title").fill("Lagere grens")
    page.locator("#reason").fill("Een proef.")
    page.locator("#save").click()
    page.locator("#saved code").wait_for()
    path = bench.known.folder / "lagere-grens.toml"
    assert str(path) in page.locator("#saved").inner_text()
    method = parse_method(path.read_text(encoding="utf-8"), str(path))
    assert method.for_season(2014).wind.side == 1.5
    assert (method.title, method.description) == ("Lagere grens", "Een proef.")
    with page.expect_download() as caught:
        page.locator("#download").click()
    assert caught.value.path().read_text("utf-8") == path.read_text("utf-8")
    page.locator("#save").click()
    assert "lagere-grens.toml" in page.get_by_role("alert").inner_text()
    page.locator("#base").select_option("lagere-grens")
    page.wait_for_function(IDLE)
    assert option(page, "wind.side").get_by_role("spinbutton").input_value() == "1.5"


def test_a_method_file_is_opened(page, tmp_path):
    file = tmp_path / "mijn.toml"
    file.write_text(
        'name = "x"\ntitle = "X"\nextends = "rebased"\n[steps]\nwind = { side = 0.9 }\n'
    )
    page.locator("#open").set_input_files(file)
    page.wait_for_function(IDLE)
    page.wait_for_function(
        "document.querySelector('[data-option=\"wind.side\"] [type=number]').value === '0.9'"
    )
    file.write_text("name =")
    page.locator("#open").set_input_files([])
    page.locator("#open").set_input_files(file)
    page.get_by_role("alert").wait_for()
    assert "mijn.toml" in page.get_by_role("alert").inner_text()
