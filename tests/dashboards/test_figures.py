"""Figures draw the columns they name, with units, whatever the frame holds."""

import itertools
import json
import re
from functools import cache

import polars as pl
import pytest
import vl_convert
from altair.utils.schemapi import debug_mode

from dashboards import drawn
from dashboards.figures import FIGURES, png, slides
from dashboards.labels import code
from dashboards.site.specifications import chart_specifications, specification
from dashboards.site.still import still
from pipeline.messages import LANGUAGES, speaker

FRAME = pl.DataFrame({"kind": ["line"], "method": ["rebased"], "cw_kg_m": [30.0]})

AXES = {
    "resistance_curve": {"speed_m_s", "cw_kg_m", "cw_lo_kg_m"},
    "curves_compared": {"speed_m_s", "cw_kg_m", "cw_lo_kg_m"},
    "history": {"tow", "cw_kg_m", "cw_lo_kg_m"},
    "traces": {"second", "cut_from", "speed_m_s", "gps_m_s", "force_n", "wind_m_s"},
    "out_and_back": {"speed_m_s", "cw_kg_m"},
    "wind": {"wind_angle_deg", "wind_m_s"},
    "b_weight": {"weight_kg", "b_m_s"},
    "b_speed": {"declared_speed_m_s", "b_m_s"},
    "a_weight": {"weight_kg", "a_kg_m"},
    "cw_standard_weight": {"weight_kg", "cw_standard_kg_m"},
    "cw_standard_speed": {"declared_speed_m_s", "cw_standard_kg_m"},
    "shared_bend": {"b_m_s", "crew"},
    "eras": {"era", "shift_ratio", "lo"},
    "boats_compared": {"speed_m_s", "cw_kg_m", "cw_lo_kg_m"},
    "budget": {"u_ratio", "component"},
    "race_ranks": {"old_rank", "new_rank"},
    "log_factors": {"season", "factor", "lo"},
    "ladder": {"step", "season"},
    "season_change": {"season", "median_ratio", "lowest_ratio"},
    "options": {"option", "median_ratio", "lo_ratio"},
    "reproducibility": {"scope", "sd_ratio", "lo"},
    "repeats": {"season", "cw_ratio"},
    "components": {"component", "sd_ratio", "lo"},
    "predicted": {"cw_kg_m", "predicted_cw_kg_m"},
    "changes": {"cw_ratio", "time_ratio"},
    "statuses": {"season", "number"},
    "slide_hull_speed": {"waterline_length_m", "b_m_s", "hull_speed_m_s"},
    "slide_towed_at": {"tow_hull_ratio", "boat_type"},
    "slide_raced_beyond": {"power_ratio_raced", "power_ratio_raced_lo", "label"},
    "slide_boat_years": {"speed_m_s", "cw_kg_m", "standard_speed_m_s"},
    "slide_ticks": {"speed_m_s", "cw_curve_kg_m"},
    "slide_tick_effects": {"median_ratio", "lo_ratio", "option"},
    "run_statistics": {"run", "sd_ratio"},
} | {
    f"slide_{y}_{x}": {"x", "y", "seen_lo", slides.QUANTITIES[y][0], slides.EXPLAINING[x]}
    for y in slides.QUANTITIES
    for x in slides.EXPLAINING
}


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
def test_a_figure_draws_its_columns_with_units_whatever_the_data(name):
    shown = axes(english(name))
    assert {axis["field"] for axis in shown} == AXES[name]
    units = {"_kg_m": "kg/m", "_m_s": "m/s", "_kg": "kg", "_n": "N", "_deg": "deg", "_s": "s"}
    for axis in shown:
        unit = next((u for ending, u in units.items() if axis["field"].endswith(ending)), None)
        if unit is not None and axis["title"]:
            assert f"[{unit}]" in axis["title"], axis
    other = pl.DataFrame({"kind": ["point"], "method": ["x<y"], "cw_kg_m": [None]})
    with debug_mode(False):
        again = FIGURES[name](other, speaker("en")).to_dict(validate=False)
    assert bare(again) == bare(english(name))


def bare(spec):
    """A specification as text, without its data."""
    (placeholder,) = spec["datasets"]
    left = {key: part for key, part in spec.items() if key != "datasets"}
    return json.dumps(left).replace(placeholder, "rows")


def test_a_figure_carries_the_rows_it_was_given():
    frame = pl.DataFrame(
        {"kind": ["point", "line"], "speed_m_s": [2.5, 2.6], "cw_kg_m": [30.0, 31.5]}
    )
    spec = FIGURES["resistance_curve"](frame, speaker("en")).to_dict()
    (rows,) = spec["datasets"].values()
    assert rows == frame.to_dicts()


def svg(name, frame):
    return vl_convert.vegalite_to_svg(FIGURES[name](frame, speaker("nl")).to_json())


def test_a_method_of_one_s_own_is_drawn_and_changes_no_other_s_colour():
    ends = {"lowest_ratio": 0.8, "highest_ratio": 1.1, "median_ratio": 0.9, "tows": 3}
    shipped = pl.DataFrame({"season": 2010, "method": "rebased"} | ends)
    points = {}
    for own in ([], [shipped.with_columns(method=pl.lit("a-method"))]):
        picture = svg("season_change", pl.concat([shipped, *own]))
        assert picture.count(">Methode<") == 1
        points[len(own)] = re.findall(
            r'method: ([\w-]+);[^>]*roledescription="point"[^>]*fill="([^"]+)"', picture
        )
    assert [method for method, _ in points[1]] == ["rebased", "a-method"]
    assert points[0][0] == points[1][0]
    assert len({colour for _, colour in points[1]}) == 2


METHODS = {
    "season_change": {"season": 2010, "median_ratio": 0.9, "lowest_ratio": 0.8, "highest_ratio": 1},
    "components": {"scope": "fleet", "component": "boat", "sd_ratio": 0.9, "lo": 0.8, "hi": 1.1},
    "repeats": {"season": 2012, "season_before": 2010, "cw_ratio": 1.1, "page": "#"},
    "curves_compared": {"kind": "point", "speed_m_s": 2.5, "cw_kg_m": 30.0, "run": 1, "used": True},
}


@pytest.mark.parametrize("name", METHODS)
def test_one_legend_names_the_methods_that_are_drawn(name):
    drawn = ["as-published", "werkbank"]
    picture = svg(name, pl.DataFrame([METHODS[name] | {"method": m} for m in drawn]))
    labels = re.findall(r'role-legend-label"[^>]*>\s*<text[^>]*>([^<]+)<', picture)
    assert labels == ["zoals gepubliceerd", "werkbank"]
    assert picture.count(">Methode<") == 1


@pytest.mark.parametrize("name", ["history", "resistance_curve"])
def test_a_bar_that_leaves_the_log_out_looks_other_than_an_interval(name):
    """Bars of a boat's page mean two things, so each is drawn in its own way and named."""
    text = json.dumps(specification(FIGURES[name], speaker("nl")))
    bars = re.findall(r'"strokeDash": ({.*?"title": "Interval".*?})', text)
    assert bars
    for bar in bars:
        assert '"field": "interval"' in bar
        assert '"domain": ["complete", "runs_alone"], "range": [[1, 0], [4, 3]]' in bar
        assert "de fout van de log zit er niet in" in bar


def test_statuses_are_told_apart_in_grey_print():
    spec = FIGURES["statuses"](FRAME, speaker("nl")).to_dict()
    shades = spec["encoding"]["color"]["scale"]["range"]
    greys = sorted(
        0.299 * red + 0.587 * green + 0.114 * blue
        for red, green, blue in (bytes.fromhex(shade[1:]) for shade in shades)
    )
    assert min(b - a for a, b in itertools.pairwise(greys)) > 25  # of 255


def test_a_trace_says_why_it_was_cut():
    trace = {"kind": "trace", "run": 1, "second": 0, "speed_m_s": 2.5, "force_n": 300.0}
    window = {"kind": "window", "run": 1, "window_start_s": 5.0, "window_end_s": 40.0}
    frame = pl.DataFrame([trace, window | {"cut_reason": "speed_drift,gust"}])
    picture = svg("traces", frame)
    for reason in ("speed_drift", "gust"):
        assert reason not in picture
        assert f">{code(reason).spoken('nl')}<" in picture


def test_a_figure_is_also_a_picture():
    frame = pl.DataFrame({"season": [2010], "status": ["accepted"], "number": [3]})
    assert png("statuses", frame, "nl").startswith(b"\x89PNG")


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_picture_is_compiled_once_and_drawn_with_any_rows(language):
    rows = [{"season": season, "status": "accepted", "number": season - 2000} for season in (9, 10)]
    frame = pl.DataFrame(rows)
    spec = chart_specifications(language)["statuses"] | {"datasets": {"rows": rows}}
    bare = re.sub(r' (role|aria-[a-z]+|clip-path|id)="[^"]*"', "", drawn.svg(spec, language))
    picture = still("statuses", frame, language, "a <caption>")
    assert picture.startswith('<svg role="img" aria-label="a &lt;caption&gt;" ')
    assert re.findall(">([^<>]+)<", picture) == re.findall(">([^<>]+)<", bare)
    assert picture.count("<path") == bare.count("<path")


def test_a_code_without_a_text_is_shown_as_it_is():
    assert code("something_new").spoken("nl") == "something_new"


def test_an_archive_of_a_thousand_tows_can_be_drawn():
    many = pl.DataFrame({"kind": ["tow"] * 6000, "method": "rebased", "tow_hull_ratio": 0.7})
    (rows,) = FIGURES["slide_towed_at"](many, speaker("en")).to_dict()["datasets"].values()
    assert len(rows) == 6000
