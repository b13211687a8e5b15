"""The workbench in a real browser: no error, no request elsewhere, and the last change wins.

Needs Chromium, like the tests of the site.
"""

import pytest

from dashboards.language import Language
from pipeline.method.reading import parse_method
from tests.conftest import METHODS
from tests.dashboards.browser import NEEDED, WIDTHS, barriers, picture, too_wide

pytestmark = NEEDED


@pytest.fixture
def page(url, page):
    """The open workbench; its server ends after the page, which may still load scripts."""
    page.goto(url)
    settle(page)
    return page


def settle(page):
    """Waits for the answer; not by a function, as the page forbids the eval that this takes."""
    page.locator("html:not([aria-busy])").wait_for(state="attached")


def field(page, name):
    return page.locator(f"[name='{name}']")


def change(page, name, value):
    """Types a number and leaves the field."""
    field(page, name).fill(str(value))
    field(page, name).press("Tab")
    settle(page)


def median(page):
    return page.locator(".figures dd").nth(5).inner_text()


def expected_median(workbench, **query):
    ratio = workbench.compare_drafts(workbench.read_address(query)).summary()["median_ratio"]
    return Language("nl").write_change(ratio)


def test_it_opens_draws_everything_and_keeps_nobody_out(page):
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.className") == "skip"
    assert page.get_by_role("form", name="Keuzes").is_visible()
    assert page.locator("fieldset:not(:has(> legend))").count() == 0
    assert "GESIMULEERD" in page.locator(".simulated").inner_text()
    assert page.locator("svg[role=img][aria-label]").count() >= 4
    for width, size in WIDTHS.items():
        page.set_viewport_size(size)
        assert too_wide(page, "figure") == []
        picture(page, f"workbench-{width}")
    assert barriers(page) == []


def test_print_shows_whole_tables_and_which_methods_they_compare(page):
    page.emulate_media(media="print")
    cut = (
        "[...document.querySelectorAll('.scroll')].filter(b => b.scrollHeight > b.clientHeight + 1)"
    )
    assert page.evaluate(f"{cut}.map(b => [b.ariaLabel, b.scrollHeight, b.clientHeight])") == []
    assert page.locator("[name=base]").is_visible()
    assert page.locator("[name=against]").is_visible()
    assert not page.locator("#options").is_visible()


def test_a_number_that_is_typed_changes_all_boats_until_all_is_reset(page, workbench):
    before = median(page)
    assert before == expected_median(workbench) == Language("nl").write_change(1)
    change(page, "wind.side", 0.5)
    query = {"wind.side": "0.5"}
    assert median(page) == expected_median(workbench, **query) != before
    assert "0,2 → 0,5" in page.locator("#changed").inner_text()
    page.locator("#changed a").click()
    settle(page)
    assert median(page) == before


def test_of_two_quick_changes_the_last_wins(page, workbench):
    values = [0.4, 0.6, 0.8, 1.0, 1.2]
    page.evaluate(
        """(values) => { const field = document.querySelector("[name='wind.side']");
        for (const value of values) { field.value = value;
          field.dispatchEvent(new Event("change", { bubbles: true })); } }""",
        values,
    )
    settle(page)
    assert median(page) == expected_median(workbench, **{"wind.side": str(values[-1])})


def test_a_change_is_shared_as_a_link(page, workbench):
    change(page, "wind.side", 1)
    (boat,) = workbench.history.tows["fsn_no"].mode(maintain_order=True).head(1)
    field(page, "boat").select_option(boat)
    settle(page)
    field(page, "against").select_option(METHODS[-1])
    settle(page)
    field(page, "tow_id").select_option(index=1)
    shown, link, tow = median(page), page.url, field(page, "tow_id").input_value()
    page.goto("about:blank")
    page.goto(link)
    assert median(page) == shown
    assert field(page, "against").input_value() == METHODS[-1]
    assert field(page, "tow_id").input_value() == tow
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
    boat = page.locator(".table").first.get_by_role("link", name="FSN").nth(2)
    number = boat.inner_text()
    boat.click()
    page.locator(f"[name=boat] option[value='{number}'][selected]").wait_for(state="attached")
    assert page.locator("#boat tbody tr").count() >= 2


def test_it_speaks_two_languages_of_the_same_question(page):
    change(page, "wind.side", 0.5)
    shown = median(page)
    page.get_by_role("link", name="English").click()
    page.get_by_role("heading", name="The register").wait_for()
    assert median(page) == shown.replace(",", ".")


def test_a_method_is_saved_once(page, workbench):
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
    path = workbench.known.folder / "lagere-grens.toml"
    assert str(path) in page.locator("#saved").inner_text()
    method = parse_method(path.read_text(encoding="utf-8"), str(path))
    assert method.get_steps(2014).wind.side == 1.5
    assert (method.title, method.description) == ("Lagere grens", "Een proef.")
    page.locator("#save").click()
    page.locator("#refused:not(:empty)").wait_for()
    assert "lagere-grens.toml" in page.get_by_role("alert").inner_text()
    page.goto(f"{page.url.split('?')[0]}?base=lagere-grens")
    assert field(page, "wind.side").input_value() == "1.5"
