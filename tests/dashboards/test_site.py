"""The site: every page, escaped, alone, and the same bytes from the same tables."""

import base64
import hashlib
import json
import math
import re
import zlib
from concurrent.futures import ThreadPoolExecutor

import polars as pl
import pytest

from dashboards import labels
from dashboards.guides import GUIDES
from dashboards.html import as_json
from dashboards.site.boats import boat_pages
from dashboards.site.cells import CODES, KEPT
from dashboards.site.columns import DRAWN, json_by, json_of
from dashboards.site.downloads import SHEETS
from dashboards.site.pages import MENU, method_names, shared_pages
from dashboards.site.parts import (
    boat_path,
    default_method,
    edition_page,
    race_path,
    type_path,
)
from dashboards.site.races import _winner
from dashboards.site.render import build_pages, build_site
from dashboards.site.slides import slides_page
from dashboards.speech import Speech
from pipeline.tables.schemas import TABLES
from tests.dashboards.conftest import ATTACK, EDITIONS
from tests.dashboards.test_answer import LINE
from tests.texts import said
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
    paths = boats | {f"{name}.html" for name in (*MENU, *GUIDES)}
    paths |= {edition_page(edition) for edition in EDITIONS}
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
    assert not any(ATTACK in text for text in texts_of(site))
    for name in ("due.html", boat_path(attacked)):
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


def test_same_tables_same_bytes_whoever_draws_the_pictures(store, site):
    before = hashes(site)
    with ThreadPoolExecutor(1) as other:
        build_site(store, other)
    assert hashes(site) == before


def test_a_number_on_a_page_is_the_warehouse_s(site, built):
    line = built.table("register").filter(pl.col("cw_kg_m").is_not_null()).row(0, named=True)
    text = (site / boat_path(line["fsn_no"])).read_text("utf-8")
    shown = f"{line['cw_kg_m']:.2f}".replace(".", ",")
    assert f"data-v={line['cw_kg_m']:.{KEPT}g}>{shown}" in text


def held(file):
    """What a page's script holds: data of charts and rows of tables, as `site.js` reads it."""
    packed = file.read_text("utf-8").removeprefix('window.HERIJK_DATA = "').removesuffix('";\n')
    return json.loads(zlib.decompress(base64.b64decode(packed)))


def texts_of(site):
    """Every page, and its rows of tables that are not shown at first."""
    for file in pages(site):
        yield file.read_text("utf-8")
    for file in site.glob("data/**/*.js"):
        for tables in held(file)["rows"].values():
            yield from tables.values()


def rows_of(site, page, table):
    """The rows of a table that are shown at first, and the others."""
    text = (site / page).read_text("utf-8").partition(f'data-table="{table}"')[2]
    first = re.search(r"<tbody>(.*?)</tbody>", text, re.DOTALL)[1]
    more = re.match(r'[^>]* data-more="([^"]+)"', text)
    script = site / "data" / page.replace(".html", ".js")
    return first, held(script)["rows"]["nl"][more[1]] if more else ""


def keys_of(site, page, table):
    """What selectors choose rows of a table by, of those shown at first and of the others."""
    text = (site / page).read_text("utf-8")
    keys = json.loads(re.search(rf'data-table="{table}".*?data-keys=\'([^\']*)\'', text)[1])
    return [
        [keys[int(place)] for place in re.findall(r"<tr data-k=(\d+)>", rows)]
        for rows in rows_of(site, page, table)
    ]


def test_a_browser_lays_out_only_the_edition_that_is_chosen(site, store):
    first, others = ([e for (e,) in keys] for keys in keys_of(site, "register.html", "register"))
    with Views(store) as views:
        editions = views.register()["edition"].to_list()
    assert set(first) == {EDITIONS[-1]}
    assert EDITIONS[-1] not in others
    assert sorted([*first, *others]) == sorted(editions)


def headings(page):
    """The headings of each table of a page."""
    text = page.read_text("utf-8")
    for head in re.findall(r"<thead>.*?</thead>", text, re.DOTALL):
        cells = re.findall(r"<th .*?</th>", head, re.DOTALL)
        yield [re.sub(r"<[^>]+>|[\u00ad\u200b]", "", cell).strip() for cell in cells]


def test_no_two_numbers_of_a_table_go_by_one_name_and_none_is_a_logarithm(site):
    tables = [names for page in pages(site) for names in headings(page)]
    assert len(tables) > 100
    assert [names for names in tables if len(set(names)) < len(names)] == []
    assert not any(re.search(r"\bln\b", name) for names in tables for name in names)
    of_pages = [str(text) for file, text in said() if file.startswith("dashboards")]
    assert [text for text in of_pages if re.search(r"\bln\b|logarit", text)] == []


def test_power_that_repeats_cw_is_not_shown_beside_it(site):
    """At one speed both change by the same factor: the note says so, once."""
    (changes,) = [names for names in headings(site / "changes.html") if "Cw nieuw / oud" in names]
    assert not any("Vermogen" in name for name in changes)
    assert "vermogen verandert evenveel" in (site / "changes.html").read_text("utf-8")


def test_a_race_page_says_among_how_many_it_compares():
    rows = pl.DataFrame(
        {"name": ["A", "B", "C"], "race": "R", "race_date": "2025-06-04",
         "old_power_w": [70.0, None, 60.0], "new_power_w": [69.0, 80.0, 61.0],
         "old_rank": [1, None, 2], "new_rank": [1, None, 2]}
    )  # fmt: skip
    text = _winner(Speech("nl"), "H", rows, {("R 2025-06-04", "H"): 0.1})
    assert "maar 2 van de 3 ploegen" in text
    assert "wint A, net als eerst" in text
    assert "Kans" not in text


def test_every_crew_stands_on_the_due_list_once_a_method(site, store):
    with Views(store) as views:
        due = views.table("due_list")
    first, others = keys_of(site, "due.html", "due_list")
    assert sorted(method for (method,) in [*first, *others]) == sorted(due["method"])


def test_a_log_s_factors_are_shown_as_often_as_the_table_has_them(site, store):
    with Views(store) as views:
        links, steps = views.table("season_links"), views.table("season_steps")
    for name, frame in (("season_links", links), ("season_steps", steps)):
        assert "".join(rows_of(site, "corrections.html", name)).count("<tr") == frame.height > 0


def test_a_column_and_a_code_on_a_page_have_a_text(store, site):
    with Views(store) as views:
        methods = method_names(views)
        pages_made = [
            *(page for make in shared_pages(views).values() for page in make()),
            *(make() for _, make in boat_pages(views, methods)),
            slides_page(views, methods),
        ]
    tables = [t for page in pages_made for s in page.sections for t in s.tables]
    drawn = {
        column
        for file in site.glob("data/**/*.js")
        for name, frames in held(file)["charts"].items()
        if name != "said"  # sentences above charts
        for frame in frames
        for column in frame
    }
    columns = drawn.union(*(table.columns for table in tables))
    assert columns - labels.COLUMNS.keys() <= {"page"}  # a link, not shown
    codes = {
        code
        for table in tables
        for column in CODES.intersection(table.columns)
        for value in table.frame[column].drop_nulls().unique()
        for code in (value.split(",") if isinstance(value, str) else value)
    }
    assert "accepted" in codes
    words = {code for code in codes if re.fullmatch(r"[a-z_]+", code)}
    assert words - labels.CODES.keys() == set()


def test_every_table_has_a_meaning(store):
    with Views(store) as views:
        assert set(views.table("contents")["table"]) <= TABLES.keys()


def test_nothing_half_made_is_left(store, tmp_path, monkeypatch):
    monkeypatch.setattr("dashboards.site.render.boat_pages", lambda *_: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        build_pages(store, tmp_path / "site")
    assert list(tmp_path.iterdir()) == []


def test_a_failing_build_leaves_the_old_site(store, site, monkeypatch):
    before = hashes(site)
    monkeypatch.setattr("dashboards.site.render.shared_pages", lambda _: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        build_site(store)
    assert hashes(site) == before


def test_a_table_that_is_empty_has_no_section(site, built):
    assert built.table("quarantine").height == 0
    assert 'data-table="quarantine"' not in (site / "quality.html").read_text("utf-8")


@pytest.mark.parametrize(
    ("fsn_no", "path"), [("FSN101", "boats/FSN101.html"), ("../x", r"boats/-x-\w{8}\.html")]
)
def test_a_boat_s_file_stays_in_its_folder(fsn_no, path):
    assert re.fullmatch(path, boat_path(fsn_no))


def test_the_default_method_is_shown_first():
    assert default_method(["as-published", "rebased", "rebased-2015"]) == "rebased"
    assert default_method(["concept-rebased", "concept-x"]) == "concept-rebased"
    assert default_method(["a", "b"]) == "b"


def test_a_curve_s_line_goes_through_its_declared_point(store):
    with Views(store) as views:
        lines, curves = views.table("curve_points"), views.curves().drop_nulls("cw_kg_m")
    both = lines.join(curves, on=["method", "tow_id"], suffix="_declared").filter(
        (pl.col("speed_m_s") - pl.col("declared_speed_m_s")).abs() < 1e-9
    )
    assert both.height == curves.height
    assert (both["cw_kg_m"] / both["cw_kg_m_declared"] - 1.0).abs().max() < 1e-12


def warehouse_numbers(store):
    """Every column of numbers of every table."""
    with Views(store) as views:
        frames = [views.table(name) for name in views.row_counts()]
        frames.append(views.run_points())  # angles from ahead
        frames.append(line_changes(views))  # of `pipeline.register.changes`, as `diff` has it
    columns = [column for frame in frames for column in frame.iter_columns()]
    return pl.concat([c.drop_nulls().rename("") for c in columns if c.dtype == pl.Float64]).unique()


def test_every_number_in_a_table_of_a_page_stands_in_the_warehouse(store, site):
    known = {f"{value:.{KEPT}g}" for value in warehouse_numbers(store)}
    shown = {v for text in texts_of(site) for v in re.findall(r"<td data-v=([^>]+)>", text)}
    assert len(shown) > 1000
    assert shown - known == set()


def test_every_number_in_a_chart_stands_in_the_warehouse(store, site):
    known = set(warehouse_numbers(store).round_sig_figs(DRAWN))
    shown = set()
    for file in sorted(site.glob("data/**/*.js")):
        for name, frames in held(file)["charts"].items():
            columns = [v for f in frames for v in f.values() if name != "traces"]
            for values in columns:
                shown |= {v for v in values if isinstance(v, float)}
    assert len(shown) > 1000
    assert shown - known == set()


def test_rows_of_many_pages_are_written_as_those_of_one():
    frame = pl.DataFrame(
        {
            "fsn_no": ["b", "a", "b"],
            "cw_kg_m": [27.123456, math.nan, None],
            "method": [["rebased"], [], ["as-published", "rebased"]],
            "name": ['"</script>\n', "Tréwes", "\u2028"],
            "used": [True, None, False],
        }
    )
    texts = json_by(frame, "fsn_no")
    assert list(texts) == ["b", "a"]
    for fsn_no, text in texts.items():
        assert text == json_of(frame.filter(fsn_no=fsn_no).drop("fsn_no"))
    assert json.loads(texts["b"]) == {
        "cw_kg_m": [27.123, None],
        "method": [["rebased"], ["as-published", "rebased"]],
        "name": ['"</script>\n', "\u2028"],
        "used": [True, False],
    }
    assert json.loads(texts["a"])["cw_kg_m"] == [None]


def test_traces_are_those_of_the_warehouse_to_the_digits_of_a_chart(store, site, attacked):
    with Views(store) as views:
        seconds = views.table("trace_seconds")
        tows = views.table("tows").filter(pl.col("fsn_no") == attacked)
    mine = seconds.join(tows, on="tow_id", how="semi", maintain_order="left")
    traces = held(site / "data" / boat_path(attacked).replace(".html", ".js"))["charts"]["traces"][
        0
    ]
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


def test_what_is_shown_first_is_among_what_there_is():
    drafts = ["concept-as-published", "concept-corrected-2013"]
    assert newest_edition([*drafts, "2026-1"], "concept-as-published") == "2026-1"
    assert newest_edition(drafts, "concept-as-published") == "concept-as-published"
    assert newest_edition(drafts, "concept-rebased") == "concept-corrected-2013"
