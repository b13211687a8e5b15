"""The site: every page, escaped, alone, and the same bytes from the same tables."""

import base64
import hashlib
import json
import re
import zlib

import polars as pl
import pytest

from dashboards import labels
from dashboards.addresses import boat_path, edition_page, race_path, type_path
from dashboards.columns import CODES
from dashboards.guides import GUIDES
from dashboards.html import as_json, keep_units
from dashboards.site.boats import boat_pages
from dashboards.site.charts import DRAWN
from dashboards.site.glossary import Glossed
from dashboards.site.pages import MENU, method_names, shared_pages
from dashboards.site.parts import Table
from dashboards.site.prose import SHEETS
from dashboards.site.render import build_pages, build_site
from dashboards.site.start import ABOUT
from dashboards.speech import Speech
from dashboards.statements.boat_type import describe_slope
from pipeline.register.register import default_method
from pipeline.tables.schemas import TABLES
from pipeline.tables.views import VIEWS
from tests.conftest import METHODS
from tests.dashboards.conftest import ATTACK, EDITIONS
from tests.dashboards.test_answer import LINE
from tests.texts import said
from warehouse.derive.database import LAKE_ONLY
from warehouse.queries.answers import answers, line_changes, newest_edition
from warehouse.queries.views import Views
from warehouse.store.store import Store


def pages(site):
    return sorted(site.rglob("*.html"))


def hashes(site):
    return {
        str(f.relative_to(site)): hashlib.sha256(f.read_bytes()).hexdigest()
        for f in sorted(site.rglob("*"))
        if f.is_file()
    }


def test_every_page_is_there(site, built):
    names = {str(f.relative_to(site)) for f in pages(site)}
    boats = {boat_path(fsn_no) for fsn_no in built.table("boats")["fsn_no"]}
    paths = boats | {f"{name}.html" for name in ("index", *MENU, *ABOUT, *GUIDES)}
    paths |= {edition_page(edition) for edition in EDITIONS}
    paths |= {f"method-{name}.html" for name in METHODS if name != default_method(METHODS)}
    with Views(Store(site.parent)) as views:
        paths |= {type_path(name) for name in views.type_names()}
        paths |= {race_path(race, day) for race, day in views.race_days()}
    assert names == paths | {f"en/{path}" for path in paths}


def test_every_page_says_that_it_is_simulated(site):
    marks = {"nl": "GESIMULEERD", "en": "SIMULATED"}
    for file in pages(site):
        language = "en" if file.is_relative_to(site / "en") else "nl"
        assert marks[language] in file.read_text("utf-8"), file


def test_names_are_escaped_everywhere(site, attacked):
    escaped = ATTACK.replace("<", "&lt;").replace(">", "&gt;")
    assert not any(ATTACK in file.read_text("utf-8") for file in pages(site))
    for name in ("boats.html", boat_path(attacked)):
        assert escaped in (site / name).read_text("utf-8")


@pytest.mark.parametrize("text", ["</script>", "<!--", "\u2028", 'a"b', "é"])
def test_json_cannot_close_its_element(text):
    made = as_json([text])
    assert not re.search("<|\u2028|\u2029", made)
    assert json.loads(made) == [text]


def test_an_answer_is_told_all_that_it_says(site):
    with Views(Store(site.parent)) as views:
        columns = answers(views, EDITIONS[-1]).columns
    assert LINE.keys() <= set(columns)


def test_no_file_names_an_address(site):
    own = [
        f for f in site.rglob("*") if f.suffix in {".html", ".css", ".js"} and f.name != "vega.js"
    ]
    texts = {f.name: re.sub(r' xmlns(:\w+)?="[^"]+"', "", f.read_text("utf-8")) for f in own}
    assert [name for name, text in texts.items() if re.search(r"https?://|//[a-z]+\.", text)] == []


def test_links_lead_to_files(site):
    broken = [
        f"{file.name}: {link}"
        for file in pages(site)
        for link in re.findall(r'(?:href|src)="([^"#:]+)"', file.read_text("utf-8"))
        if not (file.parent / link).exists()
    ]
    assert broken == []


def test_same_tables_same_bytes(store, site):
    before = hashes(site)
    build_site(store)
    assert hashes(site) == before


def test_a_number_on_a_page_is_the_warehouse_s(site, built):
    line = built.table("register").filter(pl.col("cw_kg_m").is_not_null()).row(0, named=True)
    text = (site / boat_path(line["fsn_no"])).read_text("utf-8")
    shown = f"{line['cw_kg_m']:.2f}".replace(".", ",")
    assert f"<td>{shown}</td>" in text


def held(file):
    """What a page's script holds: data of charts, as `site.js` reads it."""
    packed = file.read_text("utf-8").removeprefix('window.HERIJK_DATA = "').removesuffix('";\n')
    return json.loads(zlib.decompress(base64.b64decode(packed)))["charts"]


def rows_of(site, page, table):
    """The rows of a table, each with whether it is hidden and what selectors choose it by."""
    text = (site / page).read_text("utf-8").partition(f'data-table="{table}"')[2]
    keys = json.loads(re.search(r"data-keys='([^']*)'", text)[1])
    body = re.search(r"<tbody>(.*?)</tbody>", text, re.DOTALL)[1]
    for row in re.findall(r"<tr[^>]*>", body):
        place = re.search(r"data-k=(\d+)", row)
        yield " hidden" in row, keys[int(place[1])] if place else []


def test_the_edition_that_is_chosen_is_shown_and_the_others_are_hidden(site, store):
    rows = list(rows_of(site, "register.html", "register"))
    with Views(store) as views:
        editions = views.register()["edition"].to_list()
    assert {edition for hidden, (edition,) in rows if not hidden} == {EDITIONS[-1]}
    assert sorted(edition for _, (edition,) in rows) == sorted(editions)


def headings(page):
    """The headings of each table of a page."""
    text = page.read_text("utf-8")
    for head in re.findall(r"<thead>.*?</thead>", text, re.DOTALL):
        cells = re.findall(r"<th .*?</th>", head, re.DOTALL)
        yield [re.sub(r"<[^>]+>|[\u00ad\u200b]", "", cell).strip() for cell in cells]


def test_no_two_numbers_of_a_table_go_by_one_name_and_none_is_a_logarithm(site):
    tables = [names for page in pages(site) for names in headings(page)]
    assert len(tables) > 50
    assert [names for names in tables if len(set(names)) < len(names)] == []
    assert not any(re.search(r"\bln\b", name) for names in tables for name in names)
    of_pages = [str(text) for file, text in said() if file.startswith("dashboards")]
    assert [text for text in of_pages if re.search(r"\bln\b|logarit", text)] == []


def test_power_that_repeats_cw_is_not_shown_beside_it(site):
    """At one speed both change by the same factor: the note says so, once."""
    (changes,) = [names for names in headings(site / "changes.html") if "Cw nieuw / oud" in names]
    assert not any("Vermogen" in name for name in changes)
    assert "vermogen verandert evenveel" in (site / "changes.html").read_text("utf-8")


@pytest.mark.parametrize(
    ("page", "table", "of_all"), [("boats", "due_list", False), ("seasons", "season_links", True)]
)
def test_a_table_is_shown_whole(site, store, page, table, of_all):
    with Views(store) as views:
        rows = views.table(table)
        of_one = rows if of_all else rows.filter(method=default_method(method_names(views)))
    assert len(list(rows_of(site, f"{page}.html", table))) == of_one.height > 0


def test_a_column_and_a_code_on_a_page_have_a_text(store, site):
    with Views(store) as views:
        methods = method_names(views)
        pages_made = [
            *(page for make in shared_pages(views, by_reports=True).values() for page in make()),
            *(make() for _, make in boat_pages(views, methods)),
        ]
    tables = [t for page in pages_made for s in page.sections for t in s.tables]
    drawn = {
        column
        for file in site.glob("data/**/*.js")
        for frames in held(file).values()
        for frame in frames
        for column in frame
    }
    columns = drawn.union(*(table.columns.split() for table in tables))
    assert columns - labels.COLUMNS.keys() <= {"page"}  # a link, not shown
    codes = {
        code
        for table in tables
        for column in CODES.intersection(table.columns.split())
        for value in table.frame[column].drop_nulls().unique()
        for code in (value.split(",") if isinstance(value, str) else value)
    }
    assert "above_target_speed" in codes
    words = {code for code in codes if re.fullmatch(r"[a-z_]+", code)}
    assert words - labels.CODES.keys() == set()


def test_the_types_page_begins_with_the_slopes_of_both_types_by_method(built, site):
    page = (site / "types.html").read_text("utf-8")
    first = page[page.index('id="types-slopes"') : page.index('id="types-charts"')]
    rows = built.table("type_consistency").filter(
        pl.col("boat_type").is_in(["Kuikensloep", "Kromhoutwhaler"]),
        pl.col("method").is_in([METHODS[0], default_method(METHODS)]),
    )
    assert rows.height
    for row in rows.to_dicts():
        assert keep_units(describe_slope(row, "weight")(Speech("nl"))) in first


def test_a_column_without_anything_in_it_is_not_shown():
    frame = pl.DataFrame({"a": [1, None], "b": [None, None], "c": [False, False], "d": ["", ""]})
    assert Table("x", frame, "a b c d").shown == ["a"]
    assert Table("x", frame.clear(), "a b c d").shown == frame.columns


def test_a_failing_build_leaves_nothing_half_made_and_the_old_site(
    store, site, tmp_path, monkeypatch
):
    before = hashes(site)
    monkeypatch.setattr("dashboards.site.render.shared_pages", lambda *_: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        build_pages(store, tmp_path / "site")
    with pytest.raises(ZeroDivisionError):
        build_site(store)
    assert list(tmp_path.iterdir()) == []
    assert hashes(site) == before


def test_a_table_that_is_empty_has_no_section(site, built):
    assert built.table("quarantine").height == 0
    assert 'data-table="quarantine"' not in (site / "quality.html").read_text("utf-8")


@pytest.mark.parametrize(
    ("fsn_no", "path"), [("FSN101", "boats/FSN101.html"), ("../x", r"boats/-x-\w{8}\.html")]
)
def test_a_boat_s_file_stays_in_its_folder(fsn_no, path):
    assert re.fullmatch(path, boat_path(fsn_no))


def test_what_is_shown_first_is_among_what_there_is():
    assert default_method(["as-published", "rebased", "rebased-2015"]) == "rebased"
    assert default_method(["concept-rebased", "concept-x"]) == "concept-rebased"
    assert default_method(["a", "b"]) == "b"
    drafts = ["concept-as-published", "concept-corrected-2013"]
    assert newest_edition([*drafts, "2026-1"], "concept-as-published") == "2026-1"
    assert newest_edition(drafts, "concept-as-published") == "concept-as-published"
    assert newest_edition(drafts, "concept-rebased") == "concept-corrected-2013"


def test_every_number_in_a_chart_stands_in_the_warehouse(store, site):
    with Views(store) as views:
        frames = [views.table(name) for name in (TABLES.keys() | VIEWS.keys()) - {*LAKE_ONLY}]
        frames += [
            views.ask("run_points"),
            line_changes(views),
        ]  # angles from ahead; changes of lines
    columns = [column for frame in frames for column in frame.iter_columns()]
    numbers = pl.concat([c.drop_nulls().rename("") for c in columns if c.dtype == pl.Float64])
    known = set(numbers.unique().round_sig_figs(DRAWN))
    shown = {
        value
        for file in sorted(site.glob("data/**/*.js"))
        for name, frames in held(file).items()
        if name != "traces"
        for frame in frames
        for values in frame.values()
        for value in values
        if isinstance(value, float)
    }
    assert len(shown) > 1000
    assert shown - known == set()


def test_traces_are_those_of_the_warehouse_to_the_digits_of_a_chart(store, site, attacked):
    with Views(store) as views:
        seconds = views.table("trace_seconds")
        tows = views.table("tows").filter(pl.col("fsn_no") == attacked)
    mine = seconds.join(tows, on="tow_id", how="semi", maintain_order="left")
    (traces, _) = held(site / "data" / boat_path(attacked).replace(".html", ".js"))["traces"]
    assert traces["force_n"] == mine["force_n"].round(0).to_list()
    assert traces["speed_m_s"] == mine["speed_m_s"].round(2).to_list()


def test_every_page_forbids_the_network_and_eval(site):
    for file in pages(site):
        policy = re.search(r'Content-Security-Policy" content="([^"]+)"', file.read_text("utf-8"))
        assert policy[1].startswith("default-src &#39;none&#39;")
        assert "eval" not in policy[1]
        assert "http" not in policy[1]


def test_an_edition_is_there_with_its_codes_and_sheets(store, site):
    with Views(store) as views:
        lines = views.table("register").filter(pl.col("edition") == EDITIONS[1])
    assert lines["verification_code"].null_count() == 0
    register = (site / "register.html").read_text("utf-8")
    line = lines.row(0, named=True)
    assert line["verification_code"] in register
    assert line["verification_code"] in (site / boat_path(line["fsn_no"])).read_text("utf-8")
    assert "SKC &lt;8 mei&gt;" in register
    for edition in EDITIONS:
        for name in SHEETS:
            published = store.root / "editions" / edition / name
            assert (site / "downloads" / edition / name).read_bytes() == published.read_bytes()


def test_a_word_of_the_glossary_opens_its_line_where_it_is_first_used():
    glossed = Glossed(Speech("nl"))
    first, again = glossed("Cw <b>bij opgegeven snelheid"), glossed("Cw van 95\u00a0%-interval")
    assert first.count("popovertarget") == 2
    assert "&lt;b&gt;" in first
    assert again.count("popovertarget") == 1
    assert again.startswith("Cw ")
    assert [name for name, *_ in glossed.used] == ["cw", "declared", "interval"]
