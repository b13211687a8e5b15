"""What the parts of a vote make of the register: what comes from which method."""

import polars as pl
import pytest

from pipeline.register.register import LINE
from warehouse.derive.votes import replace_curves

PROPOSED = "concept-rebased-2015"
RACE = ("race", "race_date", *LINE)


def select_ends(lines):
    """The rows of the combination that nothing is on in, and of the one that everything is."""
    on = pl.col("combination").str.count_matches("+", literal=True)
    nothing = lines.filter(combination="none")
    return nothing, lines.filter(pl.col("combination") != "none").filter(on == on.max())


def test_with_everything_on_lines_and_places_are_those_of_the_draft(built):
    changes = built.table("register_changes").filter(to_edition=PROPOSED)
    _, everything = select_ends(built.table("vote_lines"))
    both = everything.join(changes, on=LINE, how="full", coalesce=True, suffix="_draft")
    assert both.height == changes.height > 0
    assert both["cw_ratio"].to_list() == pytest.approx(both["cw_ratio_draft"].to_list(), rel=1e-12)
    races = built.table("race_changes").filter(to_edition=PROPOSED)
    _, everything = select_ends(built.table("vote_races"))
    placed = everything.join(races, on=RACE, suffix="_draft")
    assert placed.height == everything.height > 0
    assert placed["new_rank"].to_list() == placed["new_rank_draft"].to_list()
    assert placed["old_rank"].to_list() == placed["old_rank_draft"].to_list()


def test_with_nothing_on_nobody_gains(built):
    nothing, _ = select_ends(built.table("vote_lines"))
    assert nothing["gain_in_two_hours_s"].drop_nulls().abs().max() < 1e-6
    nothing, _ = select_ends(built.table("vote_races"))
    assert nothing["new_rank"].equals(nothing["old_rank"])


def test_only_races_of_the_last_season_count(built):
    listed = built.store.read("listed_races")["race_date"]
    assert set(built.table("vote_races")["race_date"].dt.year()) == {listed.max().year}


CURVES = pl.DataFrame(
    {
        "tow_id": ["sound", "no curve now", "no curve by the method", "rejected by a check"],
        "status": ["flagged", "accepted", "rejected", "rejected"],
        "a_kg_m": [20.0, 20.0, None, 20.0],
        "b_m_s": [4.0, 4.0, None, 4.0],
        "cw_kg_m": [30.0, 30.0, None, 30.0],
        "cw_best_kg_m": [33.0, 33.0, None, 33.0],
        "cw_lo_kg_m": [29.0, 29.0, None, 29.0],
        "cw_hi_kg_m": [31.0, 31.0, None, 31.0],
        "cw_best_lo_kg_m": [32.0, 32.0, None, 32.0],
        "cw_best_hi_kg_m": [34.0, 34.0, None, 34.0],
    }
)


def test_a_tow_counts_where_it_has_a_curve_and_no_check_of_the_method_rejects_it():
    tows = ["sound", "no curve by the method", "rejected by a check"]
    computed = pl.DataFrame(
        {"tow_id": tows, "a_kg_m": [10.0] * 3, "b_m_s": [None, 3.0, 3.0], "cw_kg_m": [15.0] * 3},
        schema_overrides={"b_m_s": pl.Float64},
    )
    found = replace_curves(CURVES, computed)
    assert dict(found.select("tow_id", "status").rows()) == {
        "sound": "accepted",
        "no curve now": "rejected",
        "no curve by the method": "accepted",
        "rejected by a check": "rejected",
    }
    sound = found.row(0, named=True)
    assert (sound["cw_kg_m"], sound["b_m_s"], sound["cw_lo_kg_m"]) == (15.0, None, None)
    assert sound["cw_best_kg_m"] == pytest.approx(16.5)
