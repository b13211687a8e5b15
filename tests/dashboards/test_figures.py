"""Figures draw the columns they name, with units, whatever the frame holds."""

import json
import re
from functools import cache

import polars as pl
import pytest

from dashboards import drawn
from dashboards.figures import FIGURES
from dashboards.labels import code
from pipeline.messages import speaker

FRAME = pl.DataFrame({"kind": ["line"], "method": ["rebased"], "cw_kg_m": [30.0]})
UNITS = {"_kg_m": "kg/m", "_m_s": "m/s", "_kg": "kg", "_n": "N", "_deg": "deg", "_s": "s"}


def encodings(part):
    """Every encoding in a specification, however deep."""
    if isinstance(part, dict):
        if "encoding" in part:
            yield part["encoding"]
        for value in part.values():
            yield from encodings(value)
    elif isinstance(part, list):
        for value in part:
            yield from encodings(value)


@cache
def english(name):
    """The specification of a figure, whose texts are English."""
    return FIGURES[name](FRAME, speaker("en")).to_dict()


def axes(spec):
    return [e[c] for e in encodings(spec) for c in ("x", "y") if "field" in e.get(c, {})]


@pytest.mark.parametrize("name", FIGURES)
def test_a_figure_has_axes_with_units_whatever_the_data(name):
    shown = axes(english(name))
    assert shown
    for axis in shown:
        field = axis["field"].removesuffix("_seen")
        unit = next((u for ending, u in UNITS.items() if field.endswith(ending)), None)
        if unit is not None and axis.get("title"):
            assert f"[{unit}]" in axis["title"], axis
    other = pl.DataFrame({"kind": ["point"], "method": ["x<y"], "cw_kg_m": [None]})
    again = FIGURES[name](other, speaker("en")).to_dict(validate=False)
    assert bare(again) == bare(english(name))


def bare(spec):
    """A specification as text, without its data."""
    (placeholder,) = spec["datasets"]
    left = {key: part for key, part in spec.items() if key != "datasets"}
    return json.dumps(left).replace(placeholder, "rows")


def svg(name, frame):
    return drawn.svg(drawn.specification(name, "nl"), frame, "nl")


def test_a_boat_far_from_the_others_does_not_pull_the_scale():
    """One B of 13 is marked at the edge, with its value; the others keep the room they need."""
    bends = [4.2, 4.4, 4.5, 4.6, 4.7, 4.9, 13.0]
    rows = [
        {"method": "rebased", "boat_type": "a", "fsn_no": str(i), "b_m_s": b, "weight_kg": 500 + i}
        for i, b in enumerate(bends)
    ]
    texts = re.findall(r">([^<>]+)<", svg("b_weight", pl.DataFrame(rows)))
    assert "\u25b4 13" in texts
    ticks = [float(t.replace(",", ".")) for t in texts if re.fullmatch(r"\d,\d+", t)]
    assert 4.2 >= min(ticks) > 3.0
    assert max(ticks) < 6.0


METHODS = {
    "season_change": {"season": 2010, "median_ratio": 0.9, "lowest_ratio": 0.8, "highest_ratio": 1},
    "repeats": {"season": 2012, "season_before": 2010, "cw_ratio": 1.1, "page": "#"},
    "curves_compared": {"kind": "point", "speed_m_s": 2.5, "cw_kg_m": 30.0, "run": 1, "used": True},
}


@pytest.mark.parametrize("name", METHODS)
def test_one_legend_names_the_methods_that_are_drawn(name):
    methods = ["as-published", "werkbank"]
    picture = svg(name, pl.DataFrame([METHODS[name] | {"method": m} for m in methods]))
    labels = re.findall(r'role-legend-label"[^>]*>\s*<text[^>]*>([^<]+)<', picture)
    assert labels == ["zoals gepubliceerd", "werkbank"]
    assert picture.count(">Methode<") == 1


def test_a_method_of_one_s_own_is_drawn_and_changes_no_other_s_colour():
    shipped = pl.DataFrame([METHODS["season_change"] | {"method": "rebased"}])
    points = {}
    for own in ([], [shipped.with_columns(method=pl.lit("a-method"))]):
        points[len(own)] = re.findall(
            r'method: ([\w-]+);[^>]*roledescription="point"[^>]*fill="([^"]+)"',
            svg("season_change", pl.concat([shipped, *own])),
        )
    assert [method for method, _ in points[1]] == ["rebased", "a-method"]
    assert points[0][0] == points[1][0]
    assert len({colour for _, colour in points[1]}) == 2


@pytest.mark.parametrize("name", ["history", "resistance_curve"])
def test_a_bar_that_leaves_the_log_out_is_dashed(name):
    text = json.dumps(drawn.specification(name, "nl"))
    assert "datum.interval == 'runs_alone'" in text


def test_a_trace_says_why_it_was_cut():
    trace = {"kind": "trace", "run": 1, "second": 0, "speed_m_s": 2.5, "force_n": 300.0}
    window = {"kind": "window", "run": 1, "window_start_s": 5.0, "window_end_s": 40.0}
    frame = pl.DataFrame([trace, window | {"cut_reason": "speed_drift,gust"}])
    picture = svg("traces", frame)
    for reason in ("speed_drift", "gust"):
        assert reason not in picture
        assert f">{code(reason).spoken('nl')}<" in picture


def test_an_archive_of_a_thousand_tows_can_be_drawn():
    many = pl.DataFrame({"kind": ["tow"] * 6000, "method": "rebased", "weight_kg": 1000.0})
    (rows,) = FIGURES["type_cw_weight"](many, speaker("en")).to_dict()["datasets"].values()
    assert len(rows) == 6000
