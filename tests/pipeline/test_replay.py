"""Races replayed under a register: the presentation's example, ranks, fatigue, current, penalty."""

import datetime as dt

import numpy as np
import polars as pl
import pytest

from pipeline.crews import STANDARD_CREWS, TIME_ON_TIME
from pipeline.curve import cw, s_of_b
from pipeline.errors import MissingKnowledgeError
from pipeline.register.replay import RaceRules, compare_winners, race_changes, replay

DAY = dt.date(2015, 6, 6)
PLAIN = RaceRules(fatigue="none")


def register(*lines):
    """Lines of (boat, A, B), eight men, that counted on the day, towed for 2.35 m/s."""
    schema = {"fsn_no": pl.String, "a_kg_m": pl.Float64, "b_m_s": pl.Float64}
    found = pl.DataFrame(lines, schema=schema, orient="row")
    b = found["b_m_s"].fill_null(np.inf).to_numpy()
    return found.with_columns(
        rowers=8,
        crew_class=pl.lit("H"),
        empty_thwart=pl.lit(""),
        tow_id=pl.lit(None, pl.String),
        tow_date=dt.date(2013, 3, 1),
        valid_until=dt.date(2018, 12, 31),
        declared_speed_m_s=2.35,
        cw_kg_m=pl.Series(cw(found["a_kg_m"].to_numpy(), s_of_b(b), 2.35)).fill_nan(None),
    )


def results(*rows):
    """Results of (boat, time [s]), with the current [m] and the penalty [W] where there are."""
    names = ("rowing_time_s", "stream_m", "penalty_w")
    schema = {"fsn_no": pl.String, **dict.fromkeys(names, pl.Float64)}
    whole = [(boat, *numbers, *(3 - len(numbers)) * [None]) for boat, *numbers in rows]
    return pl.DataFrame(whole, schema=schema, orient="row").with_columns(
        race=pl.lit("HT"),
        race_date=DAY,
        rowers=8,
        crew_class=pl.lit("H"),
        empty_thwart=pl.lit(None, pl.String),
        distance_m=18400.0,
    )


def power(a, b, speed):
    return float(cw(a, s_of_b(b), speed) * speed**3 / 8)


def test_the_example_of_the_presentation():
    """18.4 km in 2:10:25 with A 31.6, B 4.44 and 8 rowers: v 2.35 m/s, at which it is 71.21 W."""
    found = replay(register(("X", 31.6, 4.44)), results(("X", 7825)), PLAIN).row(0, named=True)
    assert f"{found['speed_m_s']:.2f}" == "2.35"
    assert f"{found['power_w']:.2f}" == "71.38"
    assert f"{power(31.6, 4.44, 2.35):.2f}" == "71.21"


def test_fatigue_favours_the_slower_crew_by_79_over_77_at_three_hours_against_two():
    two = register(("FAST", 30.0, 5.0), ("SLOW", 30.0, 5.0))
    rows = results(("FAST", 7200), ("SLOW", 10800))
    corrected = replay(two, rows, RaceRules(fatigue="known"))
    plain = replay(two, rows, PLAIN)
    ratio = (corrected["power_w"] / plain["power_w"]).to_list()
    assert ratio == pytest.approx([1.0, 0.79 / 0.77])


def test_outside_the_known_points_fatigue_is_refused_or_extended_by_name():
    one = register(("X", 30.0, 5.0))
    rows = results(("X", 5000))
    with pytest.raises(MissingKnowledgeError, match="2 to 3 h"):
        replay(one, rows, RaceRules(fatigue="known"))
    assert replay(one, rows, RaceRules(fatigue="extend"))["fatigue_factor"].item() == 1.0


def test_a_boat_without_a_curve_has_no_power_and_no_rank():
    held = register(
        ("X", 30.0, 5.0), ("FLAT", 30.0, None), ("LOW", 30.0, 2.0), ("NONE", None, None)
    )
    rows = results(("X", 8000), ("FLAT", 8000), ("LOW", 8000), ("NONE", 8000), ("OUT", 8000))
    found = {r["fsn_no"]: r for r in replay(held, rows, PLAIN).iter_rows(named=True)}
    assert found["FLAT"]["power_w"] == pytest.approx(30.0 * 2.3**3 / 8)
    assert found["LOW"]["remark"] == "speed_not_below_b"
    assert found["NONE"]["remark"] == found["OUT"]["remark"] == "not_in_register"
    assert [found[b]["rank"] for b in ("X", "FLAT", "LOW", "NONE", "OUT")] == [
        1,
        2,
        None,
        None,
        None,
    ]


def test_places_are_compared_among_crews_that_both_registers_rank():
    """B0 wins in the old register alone and B1 in the new one alone: nobody else moves."""
    boats = [f"B{i}" for i in range(6)]
    rows = results(*((boat, 8000) for boat in boats))
    lines = [(boat, 40.0 - i, 5.0) for i, boat in enumerate(boats)]
    old = replay(register(lines[0], *lines[2:]), rows, PLAIN)
    new = replay(register(*lines[1:]), rows, PLAIN)
    found = {r["fsn_no"]: r for r in race_changes(old, new).iter_rows(named=True)}
    places = ("old_rank", "new_rank", "podium_changed")
    assert [[found[b][p] for p in places] for b in boats] == [
        [None] * 3, [None] * 3, [1, 1, False], [2, 2, False], [3, 3, False], [4, 4, False]
    ]  # fmt: skip
    assert found["B0"]["old_power_w"] > found["B2"]["old_power_w"]
    winners = compare_winners(old, new, pl.DataFrame()).row(0, named=True)
    assert (winners["old_winner"], winners["new_winner"]) == ("B2", "B2")


# Which line counts


def dated(boat, a, day, thwart=""):
    """A line of a tow on a day, with its five years."""
    return register((boat, a, 5.0)).with_columns(
        pl.lit(day).alias("tow_date"),
        pl.lit(dt.date(day.year + 5, 12, 31)).alias("valid_until"),
        pl.lit(thwart).alias("empty_thwart"),
    )


def test_a_race_is_computed_with_the_line_that_counted_on_its_day():
    """Towed in 2012 and, after the race of June 2015, again in 2016; Y only then; Z long ago."""
    history = pl.concat(
        [
            dated("X", 30.0, dt.date(2012, 3, 1)),
            dated("X", 40.0, dt.date(2016, 3, 1)),
            dated("Y", 30.0, dt.date(2016, 3, 1)),
            dated("Z", 30.0, dt.date(2009, 3, 1)),
        ]
    )
    found = replay(history, results(("X", 8000), ("Y", 8000), ("Z", 8000)), PLAIN)
    assert found["power_w"].to_list() == [pytest.approx(power(30.0, 5.0, 2.3)), None, None]
    assert found["remark"].to_list() == ["", "no_line_that_day", "no_line_that_day"]
    later = results(("X", 8000)).with_columns(race_date=dt.date(2016, 6, 4))
    assert replay(history, later, PLAIN)["power_w"].item() == pytest.approx(power(40.0, 5.0, 2.3))


@pytest.mark.parametrize(
    ("speed", "remark"),
    [(0.849, "beyond_curve"), (0.851, ""), (1.149, ""), (1.151, "beyond_curve")],
)
def test_a_speed_where_the_curve_does_not_hold_is_marked(speed, remark):
    """Cw-kromme 2015: from 85 to 115 % of the declared speed, here 2.35 m/s."""
    found = replay(register(("X", 30.0, 5.0)), results(("X", 18400.0 / (speed * 2.35))), PLAIN)
    assert found["remark"].item() == remark
    assert found["power_w"].item() == pytest.approx(power(30.0, 5.0, speed * 2.35))


@pytest.mark.parametrize(
    ("thwarts", "given", "chosen"),
    [
        (("", "3"), None, 30.0),
        (("", "3"), "3", 40.0),
        (("3",), None, 30.0),
        (("3", "5"), None, "thwart_not_given"),
        (("3", "5"), "5", 40.0),
        (("3",), "4", "no_line_that_day"),
    ],
)
def test_a_curve_counts_only_with_its_thwart_free(thwarts, given, chosen):
    """Sleepproef 2017, "Bemanning"."""
    history = pl.concat(
        dated("X", a, dt.date(2013, 3, 1), thwart)
        for a, thwart in zip((30.0, 40.0), thwarts, strict=False)
    )
    rows = results(("X", 8000)).with_columns(empty_thwart=pl.lit(given, pl.String))
    found = replay(history, rows, PLAIN).row(0, named=True)
    if isinstance(chosen, str):
        assert (found["power_w"], found["remark"]) == (None, chosen)
    else:
        assert found["power_w"] == pytest.approx(power(chosen, 5.0, 2.3))


# Who wins


def ensemble(**of_tow):
    """Members of tows: the given values of Cw."""
    rows = [
        {"tow_id": tow, "member": member, "cw_kg_m": value}
        for tow, values in of_tow.items()
        for member, value in enumerate(values, 1)
    ]
    return pl.DataFrame(
        rows, schema={"tow_id": pl.String, "member": pl.Int16, "cw_kg_m": pl.Float64}
    )


def lines_with_tows(*lines):
    """Lines of (boat, A, B, tow)."""
    tows = [line[3] for line in lines]
    return register(*(line[:3] for line in lines)).with_columns(pl.Series("tow_id", tows))


def winners_of(old, new, members, rows):
    found = compare_winners(replay(old, rows, PLAIN), replay(new, rows, PLAIN), members)
    return found.row(0, named=True)


def test_how_likely_another_wins_is_counted_in_the_members():
    """X is 4 % heavier; in one of four members it is lighter than Y."""
    rows = results(("X", 7600), ("Y", 7600))
    lines = lines_with_tows(("X", 31.2, 5.0, "x"), ("Y", 30.0, 5.0, "y"))
    x, y = lines["cw_kg_m"]
    members = ensemble(x=[x, x, x, 0.9 * x], y=[y, y, y, y])
    found = winners_of(lines, lines, members, rows)
    assert (found["old_winner"], found["new_winner"]) == ("X", "X")
    assert not found["winner_changed"]
    assert found["change_probability"] == pytest.approx(0.25)


def test_a_penalty_does_not_follow_cw():
    """In the member both lose the same watts, whatever Cw is."""
    rows = results(("X", 7600, 0.0, 20.0), ("Y", 7600))
    lines = lines_with_tows(("X", 34.0, 5.0, "x"), ("Y", 30.0, 5.0, "y"))
    x, y = lines["cw_kg_m"]
    even = winners_of(lines, lines, ensemble(x=[1.1 * x], y=[1.1 * y]), rows)
    higher = winners_of(lines, lines, ensemble(x=[1.6 * x], y=[1.1 * y]), rows)
    assert (even["old_winner"], even["change_probability"]) == ("Y", 0.0)
    assert higher["change_probability"] == 1.0


def test_where_nothing_can_be_counted_nothing_is_said():
    rows = results(("X", 7600), ("Y", 7600))
    both = lines_with_tows(("X", 31.2, 5.0, "x"), ("Y", 30.0, 5.0, "y"))
    assert winners_of(both, both, ensemble(), rows)["change_probability"] is None
    of_y = ensemble(y=[both["cw_kg_m"][1]])
    found = winners_of(both.filter(fsn_no="X"), both.filter(fsn_no="Y"), of_y, rows)
    said = ("old_winner", "new_winner", "winner_changed", "change_probability")
    assert [found[name] for name in said] == [None, None, False, None]


TIMED = STANDARD_CREWS.with_columns(handicap=pl.lit(TIME_ON_TIME))
"""Classes that race on corrected time; the usual power of a man is 80 W."""


def find_speed(a, power_w):
    """Speed at a power per rower of eight, of a boat whose Cw is A at every speed."""
    return (8 * power_w / a) ** (1 / 3)


def test_corrected_time_is_the_time_rowed_times_the_speed_of_the_boat_over_that_of_the_fastest():
    lines = register(("FAST", 30.0, None), ("SLOW", 45.0, None))
    found = replay(lines, results(("FAST", 7200), ("SLOW", 7800)), PLAIN, TIMED)
    allowance = find_speed(45.0, 80.0) / find_speed(30.0, 80.0)
    corrected = dict(found.select("fsn_no", "corrected_time_s").rows())
    assert corrected == pytest.approx({"FAST": 7200.0, "SLOW": 7800.0 * allowance})
    assert dict(found.select("fsn_no", "rank").rows()) == {"SLOW": 1, "FAST": 2}


def test_current_and_penalty_come_off_the_corrected_time():
    lines = register(("X", 30.0, None), ("Y", 30.0, None))
    rows = results(("X", 7200), ("Y", 7200, 920.0, 8.0))
    corrected = dict(replay(lines, rows, PLAIN, TIMED).select("fsn_no", "corrected_time_s").rows())
    by_penalty = find_speed(30.0, 80.0) / find_speed(30.0, 88.0)
    assert corrected["X"] == pytest.approx(7200 * by_penalty)
    assert corrected["Y"] == pytest.approx(7200 / 0.95)


def test_only_the_classes_with_that_handicap_race_on_corrected_time():
    only_women = TIMED.filter(crew_class="D")
    classes = pl.concat([STANDARD_CREWS.filter(crew_class="H"), only_women])
    lines = register(("X", 30.0, 5.0))
    both = pl.concat([lines, lines.with_columns(crew_class=pl.lit("D"))])
    rows = results(("X", 7200))
    rows = pl.concat([rows, rows.with_columns(crew_class=pl.lit("D"))])
    found = replay(both, rows, PLAIN, classes)
    timed = dict(found.select("crew_class", pl.col("corrected_time_s").is_not_null()).rows())
    assert timed == {"H": False, "D": True}
    assert found["rank"].to_list() == [1, 1]


def test_a_new_register_changes_places_on_corrected_time_and_gives_no_chance():
    rows = results(("X", 7200), ("Y", 7300))
    old = replay(register(("X", 30.0, None), ("Y", 30.0, None)), rows, PLAIN, TIMED)
    new = replay(register(("X", 30.0, None), ("Y", 36.0, None)), rows, PLAIN, TIMED)
    changes = race_changes(old, new)
    moved = changes.select("fsn_no", "old_rank", "new_rank").rows()
    assert sorted(moved) == [("X", 1, 2), ("Y", 2, 1)]
    assert changes["old_corrected_time_s"].sort().to_list() == [7200.0, 7300.0]
    members = pl.DataFrame({"tow_id": ["t"], "member": [0], "cw_kg_m": [30.0]})
    winners = compare_winners(old, new, members).row(0, named=True)
    assert (winners["old_winner"], winners["new_winner"]) == ("X", "Y")
    assert winners["change_probability"] is None


def test_a_boat_without_a_line_has_no_corrected_time():
    found = replay(register(("X", 30.0, None)), results(("X", 7200), ("Z", 7000)), PLAIN, TIMED)
    row = found.filter(fsn_no="Z").row(0, named=True)
    assert (row["corrected_time_s"], row["rank"], row["remark"]) == (None, None, "not_in_register")
