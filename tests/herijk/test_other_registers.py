"""docs/other-registers.md, typed in from an empty folder: a league with its own everything."""

import datetime as dt
import re
import subprocess
import tomllib
from html import unescape
from types import SimpleNamespace

import polars as pl
import pytest
from playwright.sync_api import sync_playwright

from tests import league
from tests.architecture.repository import ROOT, read
from tests.conftest import Workbench
from tests.dashboards.browser import CHROMIUM, FLAGS, IN_CI
from tests.herijk.test_snippets import blocks, herijk_lines, shell_lines
from warehouse.archive.profile import parse_profiles

PAGE = "docs/other-registers.md"
DUTCH = ("FSN", "sloep", "Heren", "heren", "Dames", "dames", "Kromhout", "Kuiken", "Nederland")
"""Words of the Dutch federation."""


@pytest.fixture
def typed(herijk, tmp_path, monkeypatch):
    """What the lines of the page print, and the folders that they make."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "docs").symlink_to(ROOT / "docs")
    printed = {}
    for name, *words in shell_lines(PAGE):
        if name == "cp":
            subprocess.run([name, *words], check=True)
            continue
        status, out, err = herijk(*words)
        assert status == 0, (words, err)
        printed[" ".join(words[:2])] = " ".join(out.split())
    data = Workbench(tmp_path / "docs/examples/league/archive", tmp_path / "league-data")
    return SimpleNamespace(printed=printed, data=data, root=tmp_path)


def read_text_of_pages(site):
    """The text of every page, without marks and scripts."""
    found = {}
    for page in site.rglob("*.html"):
        text = re.sub(r"<(style|script)\b.*?</\1>", " ", page.read_text("utf-8"), flags=re.DOTALL)
        found[page.relative_to(site).as_posix()] = unescape(re.sub("<[^>]+>", " ", text))
    return found


@pytest.mark.more
def test_the_page_sets_up_a_register_of_its_own(typed):
    assert (
        "Nothing is wrong in lists and headers. Tows: 7."
        in typed.printed["check docs/examples/league/archive"]
    )
    made = sorted(path.relative_to(typed.root).as_posix() for path in typed.root.rglob("league/*"))
    assert "league/tows" in made
    check_register(typed.data)
    check_races(typed.data)
    check_pages(typed.data)
    check_in_browser(typed.data.data / "site")
    assert "4 rowers, men" in typed.printed["audit CR3"]
    assert "Races on corrected time: 6 results" in typed.printed["compare league-2024"]


def check_register(data):
    """Boats, types, classes and validity are the league's, and Cw is what the hulls have."""
    boats = data.table("boats")
    assert set(boats["fsn_no"]) == {f"CR{number}" for number, *_ in league.FLEET}
    assert set(boats["boat_type"]) == {"Coastal skiff", "Pilot gig"}
    lines = data.table("register").filter(edition="concept-league-2026")
    assert set(lines["crew_class"]) == {"M", "W", "X"}
    assert set(lines["status"]) == {"valid"}
    tows = data.table("tows")
    days = dict(tows.select("tow_id", "tow_date").rows())
    for tow_id, until in lines.select("tow_id", "valid_until").rows():
        assert until == days[tow_id].replace(year=days[tow_id].year + 3)
    line = lines.filter(fsn_no="CR3").row(0, named=True)
    until = f"{line['valid_until'].day} {line['valid_until']:%B %Y}"
    assert f"Solan (CR3) has Cw {line['cw_kg_m']:.2f} kg/m, valid until {until}." in read(PAGE)
    before = data.table("register").filter(edition="concept-league-2024")
    assert set(before["valid_until"]) == {dt.date(2028, 12, 31), dt.date(2029, 12, 31)}
    _, _, towed = league.make_world()
    true = {tow.tow_id: tow.truth.cw_at_15c_kg_m for tow in towed}
    for tow_id, low, high in lines.select("tow_id", "cw_lo_kg_m", "cw_hi_kg_m").rows():
        assert low < true[tow_id] < high, tow_id
    runs = data.table("run_points").filter(method="league-2026")
    assert set(runs["run"]) == {1, 2, 3, 4}
    assert runs["used"].all()


def check_races(data):
    """The lowest corrected time wins, in each class."""
    races = data.table("race_changes").filter(to_edition="concept-league-2026")
    assert races.height == len(league.RESULTS)
    assert races["new_corrected_time_s"].null_count() == 0
    in_order = races.sort("crew_class", "new_rank")
    assert in_order.equals(races.sort("crew_class", "new_corrected_time_s"))
    men = in_order.filter(crew_class="M")
    assert men["fsn_no"].to_list() == ["CR3", "CR21"]
    assert men["rowing_time_s"][0] > men["rowing_time_s"][1]
    assert men["old_rank"].to_list() == [2, 1]
    fastest = pl.col("new_corrected_time_s") == pl.col("rowing_time_s")
    assert races.filter(fastest).select("crew_class").n_unique() == 3  # one keeps its time


def check_pages(data):
    """The site is in English, and has no word of the Dutch federation."""
    pages = read_text_of_pages(data.data / "site")
    assert {"index.html", "register.html", "boats/CR3.html", "method.html"} <= set(pages)
    assert not any(path.startswith(("en/", "nl/")) for path in pages)
    told = {(path, word) for path, text in pages.items() for word in DUTCH if word in text}
    assert told == set()
    assert "mixed crews" in pages["boats/CR22.html"]
    assert "Corrected time" in next(text for path, text in pages.items() if "races/" in path)
    assert "A tow counts for 3 years, to the day." in pages["method.html"]


def check_in_browser(site):
    """What a reader chooses is shown, on a site without a second language."""
    if CHROMIUM is None and not IN_CI:
        return
    faults = []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        page = browser.new_page()
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.goto((site / "register.html").as_uri())
        shown = page.locator("tbody tr:visible td").all_inner_texts()
        page.locator(".selects select").select_option("concept-league-2024")
        chosen = page.locator("tbody tr:visible td").all_inner_texts()
        page.goto((site / "parts.html").as_uri())
        page.locator("[role=switch]").first.uncheck()
        browser.close()
    assert faults == []
    assert shown != chosen
    assert "2028-12-31" in chosen


def test_the_page_says_what_the_example_gives():
    """What the page shows of the profile and of a method is so in the example."""
    text = read(PAGE)
    profile, rule = blocks(PAGE, "toml")
    example = (league.ARCHIVE / "archief.toml").read_text("utf-8")
    own, whole = parse_profiles(profile), parse_profiles(example)
    assert own.crew[0] in whole.crew
    assert (own.number_prefix, own.handicap, own.languages) == (
        whole.number_prefix,
        whole.handicap,
        whole.languages,
    )
    for shown, known in ((own.files, whole.files), (own.words, whole.words)):
        assert shown.items() <= known.items()
    said = tomllib.loads(rule)["register"]
    methods = ROOT / "docs/examples/league/data/methods"
    registers = [tomllib.loads(f.read_text("utf-8"))["register"] for f in methods.glob("*.toml")]
    assert said == {name: value for one in registers for name, value in one.items()}
    assert len(herijk_lines(PAGE)) + text.count("\ncp -r ") == len(list(shell_lines(PAGE)))


def test_the_samples_of_the_example_are_those_that_the_simulator_makes():
    world, _, tows = league.make_world()
    for tow in tows[:2]:
        file = league.ARCHIVE / f"samples_{tow.season}" / f"{league.name_file(tow)}.csv"
        assert league.tabulate_samples(world, tow).write_csv() == file.read_text("utf-8")
