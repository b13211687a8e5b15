"""The site: every page, escaped, alone, and the same bytes from the same tables."""

import hashlib
import json
import re

import polars as pl
import pytest

from dashboards.site import build_site
from dashboards.site.pages import MENU
from dashboards.site.parts import boat_path, default_method
from dashboards.site.render import as_json
from tests.dashboards.conftest import ATTACK
from warehouse.views import Views


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
    assert names == boats | {f"{name}.html" for name in MENU}


def test_every_page_says_that_it_is_simulated(site):
    assert [f.name for f in pages(site) if "GESIMULEERD" not in f.read_text("utf-8")] == []


def test_names_are_escaped_everywhere(site, attacked):
    escaped = ATTACK.replace("<", "&lt;").replace(">", "&gt;")
    for file in pages(site):
        assert ATTACK not in file.read_text("utf-8"), file
    for name in ("register.html", boat_path(attacked)):
        assert escaped in (site / name).read_text("utf-8")


@pytest.mark.parametrize("text", ["</script>", "<!--", "\u2028", 'a"b', "é"])
def test_json_cannot_close_its_element(text):
    made = as_json([text])
    assert not re.search("<|\u2028|\u2029", made)
    assert json.loads(made) == [text]


def test_no_file_names_an_address(site):
    own = [f for f in site.rglob("*") if f.is_file() and f.name != "vega.js"]
    assert [f.name for f in own if re.search(r"https?://|//[a-z]+\.", f.read_text("utf-8"))] == []


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
    assert f'data-v="{line["cw_kg_m"]:.9g}">{line["cw_kg_m"]:.2f}</td>' in text


def test_nothing_half_made_is_left(store):
    assert [f.name for f in store.root.iterdir() if f.name.startswith(".herijk-")] == []


def test_a_failing_build_leaves_the_old_site(store, site, monkeypatch):
    before = hashes(site)
    monkeypatch.setattr("dashboards.site.render.all_pages", lambda _: 1 / 0)
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
        lines, curves = views.curve_lines(), views.curves().drop_nulls("cw_kg_m")
    both = lines.join(curves, on=["method", "tow_id"], suffix="_declared").filter(
        (pl.col("speed_m_s") - pl.col("declared_speed_m_s")).abs() < 1e-9
    )
    assert both.height == curves.height
    assert (both["cw_kg_m"] / both["cw_kg_m_declared"] - 1.0).abs().max() < 1e-12
    assert both.filter(pl.col("cw_lo_kg_m") > pl.col("cw_kg_m")).is_empty()


def test_traces_are_means_of_every_second(store, built):
    with Views(store) as views:
        traces = views.traces()
    tows = built.table("tows")
    assert set(traces["tow_id"]) == set(tows["tow_id"])
    speeds = traces.join(tows, on="tow_id").select(pl.col("speed_m_s") / "declared_speed_m_s")
    assert speeds.min().item() > 0.5
    assert speeds.max().item() < 1.5
