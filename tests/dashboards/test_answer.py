"""What is said of a boat, a race, an edition, a type: the texts of each case lie in `said.txt`."""

import datetime as dt
import json

import polars as pl
import pytest

from dashboards.document import Document
from dashboards.language import Language, write_duration
from dashboards.queries.boats import describe_answer, measure_bars
from dashboards.queries.pages import sum_up_changes, sum_up_class
from dashboards.queries.types import choose_decimals
from dashboards.reading import read_blocks
from dashboards.templates import get_template

NL, EN = Language("nl"), Language("en")
LINE = {
    "fsn_no": "FSN106", "name": "Tréwes", "boat_type": "Vlet", "rowers": 8, "crew_class": "D",
    "edition": "2026-1", "from_edition": "concept-as-published", "change": "changed",
    "cw_kg_m": 31.01, "cw_lo_kg_m": 30.52, "cw_hi_kg_m": 31.51, "cw_ratio": 0.967,
    "old_cw_kg_m": 32.07, "declared_speed_m_s": 2.31, "old_declared_speed_m_s": 2.31,
    "causes": '[{"cause": "method", "step": "temperature", "factor": 0.97},'
    ' {"cause": "method", "step": "wind", "factor": 0.9969}]',
    "objection": {"to": "", "until": None, "grounds": ""},
    "gain_in_two_hours_s": -79.2, "exceeds_interval": False, "old_log_known": True,
    "new_log_known": True, "old_type_place": 3, "new_type_place": 2, "type_size": 5,
    "status": "valid", "flags": [], "tow_date": dt.date(2017, 3, 10),
    "valid_until": dt.date(2022, 12, 31),
    "tow_id": "2017-1", "old_tow_id": "2015-1", "old_tow_date": dt.date(2015, 3, 12),
    "altered": True, "new_power_w": 84.4,
    "season": 2017, "season_before": 2013, "moved_ratio": 1.021, "best_moved_ratio": 1.004,
    "cw_best_kg_m": 31.2, "cw_best_lo_kg_m": 30.9, "cw_best_hi_kg_m": 31.5, "own_weight": 0.74,
    "log_source": "estimated", "log_factor": 1.04, "log_lo": 1.03, "log_hi": 1.05,
    "tow_speed_m_s": 2.25, "speed_reason": "brought_down", "verification_code": "ABCDEFGHIJ",
    "predicted_cw_kg_m": 30.4, "predicted_lo_kg_m": 28.6, "predicted_hi_kg_m": 32.3,
    "predicted_speed_m_s": 2.3, "cw_there_kg_m": 30.9, "disagrees": False,
}  # fmt: skip
OTHERWISE = {
    "longer in a race": {"gain_in_two_hours_s": 79.2},
    "beyond the uncertainty": {"exceeds_interval": True},
    "not known whether beyond": {"exceeds_interval": None},
    "a log without a known error": {"new_log_known": False, "log_source": "none"},
    "an old log without a known error": {"old_log_known": False},
    "terms of an objection": {"objection": {
        "to": "de commissie, meten@example.org", "until": dt.date(2026, 5, 31),
        "grounds": "gegevens die niet kloppen"}},
    "not altered": {"altered": False},
    "two tows on one day": {"old_tow_date": LINE["tow_date"]},
    "one tow, beyond": {"exceeds_interval": True, "old_tow_id": LINE["tow_id"]},
    "one tow, within": {"exceeds_interval": False, "old_tow_id": LINE["tow_id"]},
    "expired": {"status": "expired", "cw_kg_m": None, "cw_ratio": None},
    "another declared speed": {
        "old_declared_speed_m_s": 2.40, "old_cw_kg_m": 28.92, "cw_kg_m": 29.98, "cw_ratio": 1.041,
    },
    "no best estimate": {"cw_best_kg_m": None},
    "no tow before": {"best_moved_ratio": None, "season_before": None},
    "a log that read too high": {"log_factor": 0.98, "log_lo": 0.97, "log_hi": 0.99},
    "a log known by dGPS": {"log_source": "gps"},
    "not as the others predict": {"cw_there_kg_m": 35.2, "disagrees": True},
    "nothing predicted": {"predicted_cw_kg_m": None},
}  # fmt: skip
"""What differs from the line above."""
RACE = {
    "race": "Spiegelrace", "race_date": dt.date(2018, 6, 4), "race_size": 35, "old_rank": 12,
    "new_rank": 11,
}  # fmt: skip
NOT_PLACED = {
    "from_edition": "2015-1", "to_edition": "2026-1", "old_remark": "no_line_that_day",
    "new_remark": "", "old_rank": None, "new_rank": None,
}  # fmt: skip
FAULT = {
    "instrument": "force_zero", "season": 2017, "p_fault": 0.3, "size": 4.2, "unit": "N",
    "size_lo": -1.0, "size_hi": 9.4, "shown_by": None,
}  # fmt: skip


def call(template, macro, *given, language=NL):
    """The statements that a macro of a template makes: kind and verdict, and text."""
    names = Document(language).get_names()
    html = getattr(get_template(f"{template}.html.j2").make_module(names), macro)(*given)
    return [(block.said, block.text) for block in read_blocks(str(html))]


def answer(line, races=(), faults=(), language=NL):
    found = describe_answer(line, list(races), list(faults))
    macros = ("number_of", "reasons_of", "certainty_of")
    return [one for macro in macros for one in call("answer", macro, found, language=language)]


def told(statements):
    return [
        f"{said.partition(' ')[0]}/{said.partition(' ')[2]}: {text}" for said, text in statements
    ]


def changes(exceeds):
    """Lines of an edition by whether each changed beyond its uncertainty."""
    causes = '[{"cause": "printed", "factor": 0.97}]' if None in exceeds else "[]"
    line = {
        "from_edition": "2014-1", "to_edition": "2015-1", "change": "changed",
        "old_log_known": False, "new_log_known": True, "causes": causes,
    }  # fmt: skip
    rows = [line | {"exceeds_interval": one} for one in exceeds]
    lines = pl.DataFrame(rows, schema_overrides={"exceeds_interval": pl.Boolean})
    return call("statements", "changed", sum_up_changes(lines))


def race(first_s, new_ranks):
    """The winners among two crews; a race of less than two hours stretches the rule of fatigue."""
    rows = [("Look", first_s, 1, new_ranks[0]), ("Vlet", 7400.0, 2, new_ranks[1])]
    schema = ("name", "rowing_time_s", "old_rank", "new_rank")
    frame = pl.DataFrame(rows, schema=schema, orient="row").with_columns(
        crew_class=pl.lit("H"), old_power_w=1.0, new_power_w=1.0, new_corrected_time_s=None
    )
    return call("race_parts", "winners", [sum_up_class(frame, None)])


TYPE_ROW = {
    "quantity": "b_m_s", "standard_speed_m_s": 2.6, "n": 11, "n_boats": 10, "spread_ratio": 0.03,
    "spread_lo": 0.01, "spread_hi": 0.05, "error_ratio": 0.02, "farthest": "FSN105",
    "farthest_ratio": 0.91, "farthest_ratio_lo": 0.85, "farthest_ratio_hi": 0.97,
    "rest_verdict": "equal", "difference_that_matters": 0.1, "repeat_pairs": 40, "outside": [],
}  # fmt: skip


def equality(verdict, **differs):
    row = TYPE_ROW | {"verdict": verdict} | differs
    none = pl.DataFrame(schema={"fsn_no": pl.String, "candidates": pl.List(pl.String)})
    return call("type_parts", "judge", {"verdicts": [row], "outside": none, "boat_names": {}})


def slope(verdict, value, low, high):
    ends = {"weight_slope": value, "weight_slope_lo": low, "weight_slope_hi": high}
    row = ends | {"weight_r2": None, "weight_n": 9, "n": 9, "weight_verdict": verdict}
    row["weight_decimals"] = choose_decimals(row, "weight")
    names = Document(NL).get_names()
    return str(get_template("type_parts.html.j2").make_module(names).slope(row, "weight"))


def test_of_a_race_on_corrected_time_nothing_is_said_of_fatigue():
    frame = pl.DataFrame(
        {
            "name": ["A", "B"], "crew_class": "H", "rowing_time_s": 3600.0,
            "old_power_w": 70.0, "new_power_w": 70.0, "old_rank": [1, 2], "new_rank": [2, 1],
        }
    )  # fmt: skip
    by_power = sum_up_class(frame.with_columns(new_corrected_time_s=None), None)
    by_time = sum_up_class(frame.with_columns(new_corrected_time_s=3500.0), None)
    kinds = [
        [kind for kind, _ in call("race_parts", "winners", [found])]
        for found in (by_power, by_time)
    ]
    assert kinds == [["winner another", "fatigue"], ["winner another"]]


def of_many():
    """What is said in each case that is about more than one boat."""
    for exceeds in ([None, None], [False, None], [True, False]):
        yield "an edition", exceeds, changes(exceeds)
    for case in ((7300.0, (1, 2)), (7300.0, (2, 1)), (6060.0, (1, 2)), (6060.0, (2, 1))):
        yield "a race", case, race(*case)
    ranked = {
        "name": ["A", "B", "C"], "crew_class": "H", "rowing_time_s": 7300.0,
        "old_power_w": [70.0, None, 60.0], "new_power_w": [69.0, 80.0, 61.0],
        "old_rank": [1, None, 2], "new_rank": [1, None, 2], "new_corrected_time_s": None,
    }  # fmt: skip
    found = call("race_parts", "winners", [sum_up_class(pl.DataFrame(ranked), 0.1)])
    yield "a race", "one not placed", found
    for verdict in ("equal", "differ", "open", "few_boats"):
        yield "equality of a type", verdict, equality(verdict)
    yield "equality of a type", "one stands out", equality("differ", outside=["FSN105"])
    yield "equality of a type", "no upper bound", equality("open", spread_hi=None)
    for line in (
        ("rises", 0.0123, 0.0101, 0.0149), ("falls", -0.025, -0.04, -0.01),
        ("open", 0.0, -0.14, 0.14), ("few_boats", None, None, None),
    ):  # fmt: skip
        yield f"a slope, {line[0]}", line, [("", slope(*line))]


def cases():
    """The answer about the line in both languages, and what another line's adds to it or lacks."""
    usual = told(answer(LINE, [RACE]))
    yield "the line, in English", [text for _, text in answer(LINE, [RACE], language=EN)]
    yield "the line, in Dutch", usual
    others = {name: answer(LINE | other, [RACE]) for name, other in OTHERWISE.items()}
    others["a race without two places"] = answer(LINE, [RACE | NOT_PLACED])
    for verdict in ("fault", "cannot be told"):
        faults = [FAULT | {"verdict": verdict}]
        others[f"an instrument: {verdict}"] = answer(LINE, [RACE], faults)
    alone = FAULT | {"verdict": "cannot be told", "shown_by": "FSN101"}
    others["an instrument, or the boat"] = answer(LINE, [RACE], [alone])
    for name, other in others.items():
        found = told(other)
        lacks = [f"- {one}" for one in usual if one not in found]
        yield name, lacks + [one for one in found if one not in usual]
    for about, case, said in of_many():
        yield f"{about}: {case}", [text for _, text in said]


def test_what_is_said(snapshot):
    blocks = ("\n".join((f"# {name}", *lines)) for name, lines in cases())
    snapshot("said", "\n\n".join(blocks).replace("\u00a0", " ") + "\n")


def test_the_picture_has_a_bar_for_every_cause_and_a_mark_for_both_numbers():
    old, temperature, wind, new = measure_bars(LINE)
    assert "width" not in old  # a bar for a number would have to begin at zero
    assert "width" not in new
    assert max(temperature["factor"], wind["factor"]) < 1
    assert temperature["start"] + temperature["width"] == pytest.approx(old["start"])
    assert wind["start"] + wind["width"] == pytest.approx(temperature["start"])
    assert 0 < new["start"] < old["start"] < 100


def test_the_picture_ends_at_the_new_number_though_small_causes_have_no_bar():
    causes = json.dumps([{"cause": "tow", "factor": 0.9674}, {"cause": "code", "factor": 0.9996}])
    bars = measure_bars(LINE | {"causes": causes})
    assert len(bars) == 3
    assert bars[-1]["cw_kg_m"] == pytest.approx(31.01, abs=0.005)


@pytest.mark.parametrize(("seconds", "shown"), [(6911.0, "1:55:11"), (599.6, "0:10:00")])
def test_a_time_rowed_is_in_hours(seconds, shown):
    assert write_duration(seconds) == shown


def test_codes_in_a_text_are_in_the_language_of_the_page():
    codes = {"candidates": ["length", "askew"]}
    assert EN.fill_in("{candidates}", codes) == "unusual length; perhaps pulled askew"
    assert NL.fill_in("{candidates}", codes) != EN.fill_in("{candidates}", codes)
