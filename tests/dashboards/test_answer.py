"""The owner's answer, in words: each sentence says what its numbers say, and no more."""

import datetime as dt
import json

import polars as pl
import pytest

from dashboards import labels
from dashboards.speech import Speech, duration
from dashboards.statements import Statement, boat_type, due, edition
from dashboards.statements.boat import Answer
from dashboards.statements.race import winners
from pipeline.messages import say

NL, EN = Speech("nl"), Speech("en")
LINE = {
    "fsn_no": "FSN106", "name": "Tréwes", "boat_type": "Vlet", "rowers": 8, "crew_class": "D",
    "edition": "2026-1", "from_edition": "concept-as-published", "change": "changed",
    "cw_kg_m": 31.01, "cw_lo_kg_m": 30.52, "cw_hi_kg_m": 31.51, "cw_ratio": 0.967,
    "old_cw_kg_m": 32.07, "declared_speed_m_s": 2.31, "old_declared_speed_m_s": 2.31,
    "causes": '[{"cause": "method", "step": "temperature", "factor": 0.97},'
    ' {"cause": "method", "step": "wind", "factor": 0.9969}]',
    "gain_in_two_hours_s": -79.2, "exceeds_interval": False, "old_log_known": True,
    "new_log_known": True, "old_type_place": 3, "new_type_place": 2, "type_size": 5,
    "status": "valid", "tow_date": dt.date(2017, 3, 10), "valid_until": dt.date(2022, 12, 31),
    "tow_id": "2017-1", "old_tow_id": "2015-1", "old_tow_date": dt.date(2015, 3, 12),
    "altered": True, "new_power_w": 84.4,
    "season": 2017, "season_before": 2013, "moved_ratio": 1.021, "best_moved_ratio": 1.004,
    "cw_best_kg_m": 31.2, "cw_best_lo_kg_m": 30.9, "cw_best_hi_kg_m": 31.5, "own_weight": 0.74,
    "log_source": "estimated", "log_factor": 1.04, "log_lo": 1.03, "log_hi": 1.05,
    "tow_speed_m_s": 2.25, "speed_reason": "brought_down", "verification_code": "ABCDEFGHIJ",
}  # fmt: skip
RACE = {"race": "Spiegelrace", "race_date": dt.date(2018, 6, 4), "race_size": 35}


def said(speech=NL, races=(), faults=(), **other):
    answer = Answer(LINE | other, races, faults)
    return "\n".join(statement(speech) for statement in answer.statements)


def plain(text):
    return text.replace("\N{NO-BREAK SPACE}", " ")


def test_old_and_new_number_by_how_much_and_why():
    text = said()
    assert "van 32,07 naar 31,01 kg/m: 3,3 % lager" in text
    assert "temperatuur \N{MINUS SIGN}3,0\N{NO-BREAK SPACE}%; wind \N{MINUS SIGN}0,3" in text
    assert "from 32.07 to 31.01 kg/m: 3.3 % lower" in said(EN)


@pytest.mark.parametrize(("seconds", "words"), [(-79.2, "79 s sneller"), (79.2, "79 s langer")])
def test_what_it_is_worth_in_a_race(seconds, words):
    assert words in said(gain_in_two_hours_s=seconds)


@pytest.mark.parametrize(
    ("exceeds", "words"),
    [(True, "is groter dan"), (False, "valt binnen"), (None, "niet te zeggen")],
)
def test_whether_it_exceeds_the_uncertainty(exceeds, words):
    assert words in said(exceeds_interval=exceeds)


def test_an_interval_that_leaves_the_log_out_says_so():
    assert "Met 95 % zekerheid" in said()
    text = said(new_log_known=False, log_source="none")
    assert "95 %" not in text
    assert "de fout van de log komt daar nog bij" in text
    assert "zit de fout van de log niet" in said(old_log_known=False)


def test_two_tows_are_named_and_an_alteration_between_them():
    text = plain(said())
    assert "proef van 12 maart 2015, het nieuwe uit die van 10 maart 2017: daartussen" in text
    assert "als verbouwd" not in said(altered=False)
    assert "Het oude getal" not in said(old_tow_date=LINE["tow_date"])


def test_the_place_in_a_race_is_not_the_place_at_equal_power():
    text = said(races=[RACE | {"old_rank": 12, "new_rank": 11}])
    assert "naar snelheid op plaats 2 van 5 van het type Vlet (dames); dat was 3" in text
    moved = "plaats 11 van de 35 ploegen die in beide edities een plaats hebben; dat was 12"
    assert f"Spiegelrace 4\N{NO-BREAK SPACE}juni\N{NO-BREAK SPACE}2018: {moved}" in text


def test_a_race_in_which_only_one_edition_has_a_line_is_not_compared():
    editions = {"from_edition": "2015-1", "to_edition": "2026-1"}
    remarks = {"old_remark": "no_line_that_day", "new_remark": ""}
    text = said(races=[RACE | editions | remarks | {"old_rank": None, "new_rank": None}])
    assert "geen twee plaatsen te vergelijken (2015-1: op die dag geen geldige regel)" in text
    assert "in beide edities" not in text


def test_valid_comes_with_its_day():
    assert "telt tot en met 31 december 2022" in plain(said())
    assert "telde tot en met 31 december 2022" in plain(
        said(status="expired", cw_kg_m=None, cw_ratio=None)
    )


def test_a_percentage_beside_two_numbers_is_that_of_the_two():
    text = said(old_declared_speed_m_s=2.40, old_cw_kg_m=28.92, cw_kg_m=29.98, cw_ratio=1.041)
    assert "van 28,92 naar 29,98 kg/m: 3,7 % hoger" in text
    assert "2,31 in plaats van 2,40 m/s. Bij de oude snelheid verandert Cw +4,1" in text


def test_two_numbers_of_one_tow_are_held_against_the_old_interval_alone():
    for exceeds, words in ((True, "buiten"), (False, "binnen")):
        text = said(exceeds_interval=exceeds, old_tow_id=LINE["tow_id"])
        assert f"van dezelfde proef; het nieuwe ligt {words} het interval van het oude" in text
        assert "beide getallen samen" not in text


CHANGED = {
    "from_edition": "2014-1", "to_edition": "2015-1", "change": "changed",
    "old_log_known": False, "new_log_known": True,
}  # fmt: skip


@pytest.mark.parametrize(
    ("exceeds", "words"),
    [
        ([None, None], "of dat meer is dan de onzekerheid, is van geen enkele te zeggen"),
        ([False, None], "geen met meer dan de onzekerheid, en van 1 is dat niet te zeggen"),
        ([True, False], "1 met meer dan de onzekerheid."),
    ],
)
def test_unknown_is_neither_none_nor_another_cause(exceeds, words):
    causes = '[{"cause": "printed", "factor": 0.97}]' if None in exceeds else "[]"
    rows = [CHANGED | {"exceeds_interval": e, "causes": causes} for e in exceeds]
    schema = {"exceeds_interval": pl.Boolean}
    text = edition.changes(pl.DataFrame(rows, schema_overrides=schema))(NL)
    assert words in text
    assert ("hoe het gedrukte register is gerekend" in text) == (None in exceeds)
    assert "andere proef" not in text


def test_another_winner_by_a_stretched_curve_of_fatigue_says_so():
    columns = ("name", "rowing_time_s", "old_rank", "new_rank")
    for times, stretched in (((7300.0, 7400.0), False), ((6060.0, 7400.0), True)):
        for ranks in ((1, 2), (2, 1)):
            rows = [("Look", times[0], 1, ranks[0]), ("Vlet", times[1], 2, ranks[1])]
            frame = pl.DataFrame(rows, schema=columns, orient="row").with_columns(
                race=pl.lit("R"), race_date=pl.lit(dt.date(2017, 6, 4)), crew_class=pl.lit("H"),
                old_power_w=1.0, new_power_w=1.0,
            )  # fmt: skip
            text = winners(frame, {})(NL)
            assert ("2 tot 3 uur" in text) == (stretched and ranks == (2, 1))


def test_both_estimates_stand_beside_each_other_where_they_are_known():
    text = said()
    assert "beste schatting uit alle proeven van het archief is 31,20" in text
    assert "rust voor 74 % op deze proef" in text
    assert "beste schatting" not in said(cw_best_kg_m=None)


def test_how_much_of_a_tow_s_move_the_archive_believes():
    text = said(EN)
    assert "Against the tow of 2013 Cw at equal speed is +2.1\N{NO-BREAK SPACE}%" in text
    assert "by the best estimate +0.4\N{NO-BREAK SPACE}%" in text
    assert "Against the tow" not in said(EN, best_moved_ratio=None, season_before=None)


def test_how_far_the_log_of_its_season_was_off():
    assert "log wees in 2017 3,8 % te laag" in said()
    assert "read 2.0 % too high" in said(EN, log_factor=0.98, log_lo=0.97, log_hi=0.99)
    assert "log wees" not in said(log_source="gps")


@pytest.mark.parametrize(
    ("verdict", "words"),
    [("fault", "waarschijnlijk iets mis"), ("cannot be told", "niet te zeggen (kans 30 %)")],
)
def test_what_may_be_wrong_with_the_instruments(verdict, words):
    fault = {"instrument": "force_zero", "season": 2017, "verdict": verdict, "p_fault": 0.3,
             "size": 4.2, "unit": "N"}  # fmt: skip
    text = said(faults=[fault])
    assert words in text
    assert "nulpunt van de krachtmeter" in text


def test_how_to_object_names_boat_and_code():
    assert "noem FSN106 en controlecode ABCDEFGHIJ" in said()


def test_the_waterfall_has_a_bar_for_every_cause_and_a_mark_for_both_numbers():
    old, temperature, wind, new = bars = Answer(LINE, ()).waterfall
    assert [bar.kind for bar in bars] == ["number", "less", "less", "number"]
    assert (old.width, new.width) == (0, 0)  # a bar for a number would have to begin at zero
    assert temperature.start + temperature.width == pytest.approx(old.start)
    assert wind.start + wind.width == pytest.approx(temperature.start)
    assert 0 < new.start < old.start < 100


def test_the_waterfall_ends_at_the_new_number_though_small_causes_have_no_bar():
    causes = json.dumps([{"cause": "tow", "factor": 0.9674}, {"cause": "code", "factor": 0.9996}])
    bars = Answer(LINE | {"causes": causes}, ()).waterfall
    assert len(bars) == 3
    assert bars[-1].value(NL) == "31,01"


@pytest.mark.parametrize(("seconds", "shown"), [(6911.0, "1:55:11"), (599.6, "0:10:00")])
def test_a_time_rowed_is_in_hours(seconds, shown):
    assert duration(seconds) == shown


@pytest.mark.parametrize(
    ("after", "words"), [(0.004606, "loont het niet"), (0.003, "Deze proeven")]
)
def test_tows_that_are_not_worth_it_are_told(after, words):
    choice = pl.DataFrame({"factor_sd_before_ratio": [0.004667], "factor_sd_after_ratio": [after]})
    assert words in due.retow(choice)(NL)


@pytest.mark.parametrize(
    ("equal_possible", "words"),
    [(True, "Geen teken"), (None, "niet te zeggen"), (False, "verschillen in bocht")],
)
def test_a_type_s_verdict(equal_possible, words):
    test = pl.DataFrame({"p_value": [0.3], "equal_possible": [equal_possible], "n": [11]})
    assert words in boat_type.homogeneity(test)(NL)


@pytest.mark.parametrize(
    ("line", "said", "verdict"),
    [
        ((0.0123, 0.0101, 0.0149), "stijgt: 0,012 (0,010 tot 0,015)", "rises"),
        ((-2.5, -4.0, -1.0), "daalt: \u22122,5 (\u22124,0 tot \u22121,0)", "falls"),
        ((0.0, -14.0, 14.0), "geen verband: 0 (\u221214 tot 14)", "none"),
        ((None, None, None), "te weinig sloepen", "not known"),
    ],
)
def test_a_slope_says_which_way_it_goes_with_two_digits_of_its_interval(line, said, verdict):
    slope, low, high = line
    of = {"slope": slope, "slope_lo": low, "slope_hi": high, "explaining": "weight_kg"}
    statement = boat_type.slope(of | {"reason": "few_boats"})
    assert (statement(NL), statement.verdict) == (said, verdict)


def test_words_in_a_list_are_in_the_language_of_the_page():
    why = [labels.candidate("weight"), labels.candidate("askew")]
    listed = Statement("why", say("{why}"), {"why": why})
    assert listed(EN) == "unusual weight; perhaps pulled askew"
    assert listed(NL) == "; ".join(one.spoken("nl") for one in why) != listed(EN)
