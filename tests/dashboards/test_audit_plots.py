"""The plots beside an audit: whole SVG files that say what they are and fetch nothing."""

import re
import shutil
from xml.etree import ElementTree as ET

import duckdb
import pytest

from dashboards import audit_plots
from dashboards.audit_plots import file_name, write_audit_plots
from warehouse.queries.audit import audit
from warehouse.store.store import Store

SVG = "{http://www.w3.org/2000/svg}"


def drawn(store, folder, *names):
    report = audit(store, names)
    files = write_audit_plots(store, report, folder, "nl")
    return {path.stem: path.read_text("utf-8") for path in (*files, folder / "index.html")}


@pytest.fixture(scope="module")
def type_plots(built, tmp_path_factory):
    """Plots of a type that has a shift of its own; the small archive is too small for one."""
    root = tmp_path_factory.mktemp("plots")
    shutil.copytree(built.data, root / "data")
    store = Store(root / "data")
    with duckdb.connect(store.database) as db:
        db.execute("DELETE FROM era_shifts")
        db.execute(
            "INSERT INTO era_shifts BY NAME SELECT 'as-published' AS method, 'Kuikensloep' AS "
            "boat_type, '2009-2011' AS era, 9 AS n, 0.87 AS shift_ratio, 0.85 AS lo, 0.9 AS hi, "
            "true AS apart, '' AS reason"
        )
    return drawn(store, root / "plots", "Kuikensloep", "Kromhoutwhaler")


def words(svg):
    return [text.text for text in ET.fromstring(svg).iter(f"{SVG}text")]  # noqa: S314 - our own


def test_a_type_has_its_plots_before_and_after_correction(type_plots):
    captions = {"a_weight": "A tegen gewicht", "b_speed": "B tegen opgegeven snelheid"}
    for figure, caption in captions.items():
        said = words(type_plots[figure])
        assert f"{caption} · Kuikensloep, Kromhoutwhaler" in said
        assert {"zoals gepubliceerd", "regels van 2015"} <= set(said)
    assert "Wijkt een tijdvak af? · Kuikensloep" in words(type_plots["eras-Kuikensloep"])
    assert {"eras-Kuikensloep", "repeats", "index"} <= type_plots.keys()


def test_a_plot_says_of_what_it_is_and_leads_nowhere_else(type_plots):
    *plots, _ = type_plots
    assert re.findall(r'src="([^"]+)\.svg"', type_plots["index"]) == plots
    for name in plots:
        svg = type_plots[name]
        said = words(svg)
        assert any("· Kuikensloep" in text for text in said), name
        assert any(text.startswith("GESIMULEERD") for text in said), name
        assert "href=" not in svg
        assert svg.count("http") == svg.count("http://www.w3.org/")


def test_a_boats_plots_single_it_out_in_its_type(built, tmp_path):
    newest = built.table("compared_tows").filter(
        "newest", boat_type="Kuikensloep", method="rebased-2015"
    )
    plots, others = (drawn(built.store, tmp_path, newest["fsn_no"][i]) for i in (0, -1))
    name = "cw_standard_weight"
    assert plots[name] != others[name]
    assert {"history", name} <= plots.keys()
    unknown = drawn(built.store, tmp_path, "unknown")
    assert not [name for name in unknown if name.startswith("b_weight")]  # it has no rows


def test_a_name_becomes_a_file_name():
    assert file_name("Kromhout whaler/../x") == "Kromhout-whaler-x"


def test_repeats_are_drawn_in_the_same_order_each_time(built, tmp_path, monkeypatch):
    rows = {}

    def keep(plot, *_):
        rows[plot.figure] = plot.rows.select("method", "fsn_no").rows()
        return tmp_path / plot.figure

    monkeypatch.setattr(audit_plots, "_write", keep)
    write_audit_plots(built.store, audit(built.store, ["Kuikensloep"]), tmp_path, "en")
    assert len(set(rows["repeats"])) > 2
    assert rows["repeats"] == sorted(rows["repeats"])
