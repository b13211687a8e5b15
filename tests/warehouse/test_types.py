"""Which boat or type a name stands for, and what differs between two types."""

import pytest

from pipeline.errors import MissingKnowledgeError
from warehouse.queries.types import choose_type, find_boat, find_type_differences, read_type_facts
from warehouse.queries.views import Views


@pytest.fixture(scope="module")
def views(built):
    with Views(built.store) as views:
        yield views


def judge(slope, verdict):
    """A type under a method: one quantity with this slope over weight and verdict, no eras."""
    unknown = dict.fromkeys(("tow_speed_slope", "tow_speed_slope_lo", "tow_speed_slope_hi"))
    return [{"quantity": "b_m_s", "verdict": verdict} | unknown | slope], []


def slope(value, half):
    return {
        "weight_slope": value,
        "weight_slope_lo": value - half,
        "weight_slope_hi": value + half,
    }


def test_types_differ_where_their_slopes_lie_further_apart_than_both_intervals():
    def differ(*slopes):
        return find_type_differences(*(judge(one, "open") for one in slopes))

    # One follows weight and in the other no trend is seen: no difference by that alone.
    assert differ(slope(1.0, 0.9), slope(0.5, 0.9)) == []
    assert differ(slope(1.0, 0.3), slope(0.5, 0.3)) == ["b_m_s weight_kg"]
    assert differ(slope(1.0, 0.3), slope(0.5, 0.41)) == []


def test_types_differ_by_a_verdict_only_where_both_have_one():
    same = slope(0.0, 1.0)
    equal, differ, unclear = (judge(same, verdict) for verdict in ("equal", "differ", "open"))
    assert find_type_differences(equal, differ) == ["b_m_s verdict"]
    assert find_type_differences(equal, unclear) == []
    assert find_type_differences(equal) == []


@pytest.mark.parametrize("name", ["Kuikensloep", "kuikensloep", " KUIKEN SLOEP "])
def test_a_type_is_found_whatever_its_case_and_blanks(views, name):
    assert find_boat(views, name) is None
    assert choose_type(views, name) == "Kuikensloep"


def test_an_unknown_name_lists_the_types_and_a_boat(views):
    with pytest.raises(MissingKnowledgeError) as error:
        choose_type(views, "Pollux")
    for expected in (*views.table("boats")["boat_type"].drop_nulls(), "'Pollux'", "FSN1"):
        assert expected in str(error.value)


def test_facts_of_a_type_count_its_boats_and_tows(views):
    boats = views.table("boats").filter(boat_type="Kuikensloep")
    tows = views.table("tows").join(boats, on="fsn_no", how="semi")
    facts = read_type_facts(views, "Kuikensloep")
    assert (facts["n_boats"], facts["n_tows"]) == (boats.height, tows.height)
    assert facts["n_towed"] == tows["fsn_no"].n_unique()
    assert facts["lightest_kg"] == tows["weight_kg"].min()
