"""Figures draw the columns they name, with units, whatever the frame holds."""

import json

import polars as pl
import pytest

from dashboards.figures import FIGURES
from dashboards.words import LANGUAGES, WORDS, both, speaker

FRAME = pl.DataFrame({"kind": ["line"], "method": ["rebased"], "cw_kg_m": [30.0]})

AXES = {
    "resistance_curve": {"speed_m_s", "cw_kg_m", "cw_lo_kg_m"},
    "history": {"tow", "cw_kg_m", "cw_lo_kg_m"},
    "traces": {"second", "window_start_s", "speed_m_s", "gps_m_s", "force_n", "wind_m_s"},
    "out_and_back": {"speed_m_s", "cw_kg_m"},
    "wind": {"wind_angle_deg", "wind_m_s"},
    "b_weight": {"weight_kg", "b_m_s"},
    "b_speed": {"declared_speed_m_s", "b_m_s"},
    "cw_weight": {"weight_kg", "cw_kg_m"},
    "cw_speed": {"declared_speed_m_s", "cw_kg_m"},
    "a_weight": {"weight_kg", "a_kg_m"},
    "cw_standard_weight": {"weight_kg", "cw_standard_kg_m"},
    "cw_standard_speed": {"declared_speed_m_s", "cw_standard_kg_m"},
    "shared_bend": {"b_m_s", "crew"},
    "eras": {"era", "shift_ratio", "lo"},
    "log_factors": {"season", "factor", "lo"},
    "ladder": {"step", "season"},
    "season_change": {"season", "median_ratio", "lowest_ratio"},
    "options": {"option", "median_ratio", "lo_ratio"},
    "reproducibility": {"scope", "sd_ratio", "lo"},
    "repeats": {"season", "ln_ratio"},
    "components": {"component", "sd_ratio", "lo"},
    "predicted": {"cw_kg_m", "predicted_cw_kg_m"},
    "changes": {"cw_ratio", "time_ratio"},
    "statuses": {"season", "number"},
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


def axes(spec):
    return [e[c] for e in encodings(spec) for c in ("x", "y") if "field" in e.get(c, {})]


@pytest.mark.parametrize("name", FIGURES)
def test_a_figure_draws_its_columns(name):
    spec = FIGURES[name](FRAME, speaker("en")).to_dict()
    assert {axis["field"] for axis in axes(spec)} == AXES[name]


@pytest.mark.parametrize("name", FIGURES)
def test_an_axis_with_a_unit_in_its_name_has_it_in_its_title(name):
    units = {"_kg_m": "kg/m", "_m_s": "m/s", "_kg": "kg", "_n": "N", "_deg": "deg", "_s": "s"}
    for axis in axes(FIGURES[name](FRAME, speaker("en")).to_dict()):
        unit = next((u for ending, u in units.items() if axis["field"].endswith(ending)), None)
        if unit is not None and axis["title"]:
            assert f"[{unit}]" in axis["title"], axis


@pytest.mark.parametrize("name", FIGURES)
def test_a_specification_does_not_depend_on_the_data(name):
    def bare(frame):
        spec = FIGURES[name](frame, speaker("nl")).to_dict()
        (placeholder,) = spec.pop("datasets")
        return json.dumps(spec).replace(placeholder, "rows")

    other = pl.DataFrame({"kind": ["point"], "method": ["x<y"], "cw_kg_m": [None]})
    assert bare(FRAME) == bare(other)


def test_a_figure_carries_the_rows_it_was_given():
    frame = pl.DataFrame(
        {"kind": ["point", "line"], "speed_m_s": [2.5, 2.6], "cw_kg_m": [30.0, 31.5]}
    )
    spec = FIGURES["resistance_curve"](frame, speaker("en")).to_dict()
    (rows,) = spec["datasets"].values()
    assert rows == frame.to_dicts()


def test_every_text_is_there_in_every_language():
    assert all(len(texts) == len(LANGUAGES) and all(texts) for texts in WORDS.values())


def test_a_code_without_a_text_is_shown_as_it_is():
    assert both("code.something_new") == ("something_new", "something_new")
    with pytest.raises(KeyError):
        both("nosuchtext")
