"""Charts: one picture of each kind, whole, named, and no wider than what it holds."""

import re
from xml.etree import ElementTree as ET

import polars as pl
import pytest

from dashboards import charts
from dashboards.language import Language
from dashboards.pictures import make_standalone
from dashboards.plot import LegendEntry, Plot, fit_scale

NL = Language("nl")
SVG = "{http://www.w3.org/2000/svg}"
METHODS = ["as-published", "rebased"]
SEASONS = pl.DataFrame(
    [
        {"method": method, "season": season, "factor": 1.01 + 0.01 * place, "lo": 1.0, "hi": None}
        for place, method in enumerate(METHODS)
        for season in (2009, 2010)
    ]
)
CURVE = pl.DataFrame(
    [
        {"kind": "line", "speed_m_s": 2.2, "cw_kg_m": 30.0, "cw_lo_kg_m": 29.0, "cw_hi_kg_m": 31.0},
        {"kind": "line", "speed_m_s": 2.6, "cw_kg_m": 32.0, "cw_lo_kg_m": 31.0, "cw_hi_kg_m": 33.0},
        {"kind": "point", "speed_m_s": 2.4, "cw_kg_m": 31.0, "run": 1, "direction": 1,
         "used": True},
        {"kind": "point", "speed_m_s": 2.5, "cw_kg_m": 33.0, "run": 4, "direction": -1,
         "used": False},
        {"kind": "declared", "speed_m_s": 2.4, "cw_kg_m": 31.0, "cw_lo_kg_m": 30.0,
         "cw_hi_kg_m": 32.0, "interval": "runs_alone"},
    ],
    infer_schema_length=None,
).with_columns(method=pl.lit("rebased"))  # fmt: skip
TOWS = pl.DataFrame(
    [
        {"method": method, "crew_class": crew, "label": f"Vlet 8{crew} 2014", "page": "#",
         "weight_kg": 800.0 + place, "b_m_s": b, "b_lo_m_s": 4.0, "b_hi_m_s": None,
         "interval": "complete", "beyond_curve": False, "cw_outside": b > 12}
        for method in METHODS
        for place, (crew, b) in enumerate([("H", 4.2), ("H", 4.4), ("H", 4.5), ("D", 4.6),
                                           ("D", 4.7), ("H", 4.9), ("D", 13.0)])
    ]
)  # fmt: skip
LINES = pl.DataFrame(
    [
        {"method": method, "quantity": "b_m_s", "explaining": "weight_kg", "crew_class": "H",
         "x": x, "y": 4.5, "lo": 4.3, "hi": 4.7}
        for method in METHODS
        for x in (800.0, 806.0)
    ]
)  # fmt: skip
GAINS = pl.DataFrame(
    [("Vlet", "FSN1", 8, "H", 20.0, False), ("A<b", "FSN2", 6, "D", -35.0, True)],
    schema=["name", "fsn_no", "rowers", "crew_class", "gain_in_two_hours_s", "exceeds_interval"],
    orient="row",
)
CHANGES = pl.DataFrame(
    [("rebased", 2009, 0.88, 0.86, 0.9), ("rebased", 2014, 0.99, 0.98, 1.0)],
    schema=["method", "season", "median_ratio", "lowest_ratio", "highest_ratio"],
    orient="row",
)
ANSWER = {
    "old_cw_kg_m": 24.0, "old_cw_lo_kg_m": 23.3, "old_cw_hi_kg_m": 24.7, "old_log_known": False,
    "cw_kg_m": 23.2, "cw_lo_kg_m": 22.7, "cw_hi_kg_m": 23.8, "new_log_known": True,
    "peers": [24.1, 24.5],
}  # fmt: skip
SECONDS = pl.DataFrame(
    {"run": [1, 1, 2, 2], "second": [0, 1, 0, 1], "speed_m_s": [2.4, 2.5, 2.6, 2.5],
     "gps_m_s": [None, 2.4, 2.5, 2.5], "force_n": [200.0, 210.0, 220.0, 215.0],
     "wind_m_s": [3.0, 3.1, 2.9, 3.3]}
)  # fmt: skip
CUTS = pl.DataFrame(
    [{"run": 1, "window_start_s": 0.5, "window_end_s": 1.0, "reason": "",
      "cut_reason": "speed_drift,gust"}]
)  # fmt: skip
DRAWN = {
    "groups": lambda: charts.draw_groups(
        NL, SEASONS, "season", "factor", ("lo", "hi"), "Logfactor", with_one=True
    ),
    "curves": lambda: charts.draw_curves(NL, CURVE, "Weerstandskromme"),
    "scatter": lambda: charts.draw_scatter(
        NL, TOWS, LINES, "b_m_s", ("b_lo_m_s", "b_hi_m_s"), "weight_kg", "B tegen gewicht"
    ),
    "seasons": lambda: charts.draw_seasons(NL, CHANGES, "Seizoenen"),
    "number": lambda: charts.draw_number(NL, ANSWER, "Getal"),
    "gains": lambda: charts.draw_gains(NL, GAINS, "Tijd"),
    "trace lines": lambda: charts.trace_lines(SECONDS),
    "trace frame": lambda: charts.trace_frame(NL, SECONDS, [("", CUTS)], "Metingen"),
}


def pictures(markup):
    found = re.findall(r"<svg.*?</svg>", str(markup))
    return [ET.fromstring(make_standalone(one)) for one in found]  # noqa: S314


def words(markup):
    return [text.text for svg in pictures(markup) for text in svg.iter(f"{SVG}text")]


@pytest.mark.parametrize("kind", DRAWN)
def test_a_picture_is_whole_and_every_mark_lies_in_it(kind):
    for svg in pictures(DRAWN[kind]()):
        width, height = map(float, svg.get("viewBox").split()[2:])
        is_named = bool(svg.get("aria-label"))
        assert is_named != (svg.get("aria-hidden") == "true")
        for text in svg.iter(f"{SVG}text"):
            assert 0 <= float(text.get("x")) <= width
            assert 0 <= float(text.get("y")) <= height


@pytest.mark.parametrize("kind", DRAWN)
def test_a_picture_stays_as_it_was(kind, snapshot):
    text = re.sub(r"(<(path|text|g|rect|svg|a)\b)", r"\n\1", str(DRAWN[kind]()))
    snapshot(f"chart-{kind.replace(' ', '-')}", text.strip() + "\n")


def test_axes_have_units_and_numbers_in_the_language():
    shown = words(DRAWN["scatter"]())
    assert "B [m/s]" in shown
    assert "Gewicht [kg]" in shown
    assert any(re.fullmatch(r"\d,\d+", text) for text in shown)


def test_a_boat_far_from_the_others_does_not_pull_the_scale():
    """One B of 13 is marked at the edge, with its name; the others keep the room they need."""
    shown = words(DRAWN["scatter"]())
    ticks = [float(t.replace(",", ".")) for t in shown if re.fullmatch(r"\d,\d+", t)]
    assert 4.2 >= min(ticks) > 3.0
    assert max(ticks) < 6.0
    assert "Vlet 8D 2014" in shown


def test_one_legend_names_the_methods_that_are_drawn():
    shown = words(DRAWN["groups"]())
    assert [text for text in shown if text in ("zoals gepubliceerd", "herijkt")] == [
        "zoals gepubliceerd", "herijkt",
    ]  # fmt: skip


def inks_of_tips(picture):
    """Return what pointing at each mark shows, with the colour of the mark or its group."""
    found = []

    def walk(element, ink):
        ink = element.get("stroke", ink)
        for child in element:
            if child.tag.endswith("title"):
                found.append((child.text, ink))
            walk(child, ink)

    walk(ET.fromstring(str(picture)), "")  # noqa: S314 - our own picture
    return found


def test_a_method_of_one_s_own_is_drawn_and_changes_no_other_s_colour():
    own = SEASONS.with_columns(method=pl.lit("a-method"))

    def inks(rows):
        drawn = charts.draw_groups(NL, rows, "season", "factor", ("lo", "hi"), "x")
        tips = inks_of_tips(drawn)
        return {re.search("Methode: ([^,]+)", tip)[1]: ink for tip, ink in tips}

    alone, both = inks(SEASONS), inks(pl.concat([SEASONS, own]))
    assert set(both) == {*alone, "a-method"}
    assert {name: both[name] for name in alone} == alone
    assert len(set(both.values())) == len(both)


def test_a_bar_that_leaves_the_log_out_is_dashed():
    assert str(DRAWN["curves"]()).count('stroke-dasharray="3 3"') == 1
    complete = CURVE.with_columns(interval=pl.lit("complete"))
    assert 'stroke-dasharray="3 3"' not in str(charts.draw_curves(NL, complete, "x"))


def test_methods_share_the_axes_of_a_curve_and_are_named_by_their_colour():
    older = CURVE.with_columns(pl.col("cw_kg_m") + 2, method=pl.lit("as-published"))
    both = charts.draw_curves(NL, pl.concat([older, CURVE]), "x")
    assert {"heen", "terug", "zoals gepubliceerd", "herijkt"} <= set(words(both))
    assert "herijkt" not in words(DRAWN["curves"]())
    dots = {tip: ink for tip, ink in inks_of_tips(both) if tip.startswith("run 1:")}
    assert list(dots) == ["run 1: 2,40 m/s, 33,00 kg/m", "run 1: 2,40 m/s, 31,00 kg/m"]
    assert len(set(dots.values())) == 2


def test_a_trace_says_why_it_was_cut_and_a_name_is_escaped():
    shown = words(DRAWN["trace frame"]())
    assert any("vlaag" in text for text in shown)
    assert "A<b" not in str(DRAWN["gains"]())
    assert "A&lt;b 6D: \N{MINUS SIGN}35 s" in str(DRAWN["gains"]())


def test_nothing_known_gives_no_picture():
    assert charts.draw_gains(NL, GAINS.clear(), "x") == ""
    assert charts.draw_groups(NL, SEASONS.clear(), "season", "factor", ("lo", "hi"), "x") == ""


@pytest.mark.parametrize(
    ("values", "ticks"),
    [
        ([1.0, 2.0], [1.0, 1.5, 2.0]),
        ([0.0, 41.0], [0, 10, 20, 30, 40]),
        ([5.0], None),
    ],
)
def test_ticks_are_round_numbers_within_the_scale(values, ticks):
    scale = fit_scale(values, 0, 100)
    assert all(scale.low <= tick <= scale.high for tick in scale.ticks)
    assert ticks is None or scale.ticks == pytest.approx(ticks)
    assert scale(scale.low) == 0
    assert scale(10 * scale.high) == 100


def test_a_legend_too_long_for_a_line_has_more_of_them():
    legend = [LegendEntry.from_kind("een lange naam van een methode", kind) for kind in range(4)]
    plot = Plot(NL, legend=legend)
    (svg,) = pictures(plot.to_svg("x"))
    rows = {text.get("y") for text in svg.iter(f"{SVG}text")}
    assert len(rows) > 1
    assert plot.top > Plot(NL).top
