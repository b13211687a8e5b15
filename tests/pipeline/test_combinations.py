"""The parts of a vote: every combination is the method with those steps, and both ends are."""

from itertools import chain

import polars as pl
import pytest

from herijk.simulate import WorldSettings
from pipeline.method.options import STEP_GROUPS, STEP_ORDER
from pipeline.method.reading import parse_method, read_shipped_method
from pipeline.recompute.recompute import recompute
from pipeline.studies.combinations import (
    NOTHING_ON,
    choose_ends,
    compute_combinations,
    find_switches,
    list_combinations,
    name_combination,
    uses_new_instruments,
)
from tests.worlds import find_tows_without_gps, measure

OLD, NEW = read_shipped_method("as-published"), read_shipped_method("rebased")
SWITCHES = list(STEP_GROUPS)
CURVE = ["tow_id", "a_kg_m", "b_m_s", "cw_kg_m"]


@pytest.fixture(scope="module")
def world():
    measured = measure(WorldSettings((2010, 2013, 2016), 6, 20, 11))
    first_of_2016 = measured.tows["tow_id"] == measured.tows.filter(season=2016)["tow_id"][0]
    return find_tows_without_gps(measured, first_of_2016.to_numpy())


@pytest.fixture(scope="module")
def made(world):
    return {method.name: recompute(method, world.tows, world.blocks) for method in (OLD, NEW)}


@pytest.fixture(scope="module")
def combinations(world, made):
    links = {name: one.tow_instruments for name, one in made.items()}
    return compute_combinations(OLD, NEW, world.tows, world.blocks, links)


def select_curves(combinations, *on):
    return combinations.filter(combination=name_combination(on)).select(CURVE).sort("tow_id")


def assert_same(found, curves):
    expected = curves.drop_nulls("cw_kg_m").select(CURVE).sort("tow_id")
    assert found["tow_id"].to_list() == expected["tow_id"].to_list()
    for name in CURVE[1:]:
        assert found[name].to_list() == pytest.approx(expected[name].to_list(), rel=1e-12), name


def test_each_step_is_in_one_of_at_most_four_groups():
    assert sorted(chain.from_iterable(STEP_GROUPS.values())) == sorted(STEP_ORDER)
    assert len(STEP_GROUPS) <= 4


def test_nothing_on_is_the_first_method_and_everything_on_the_proposed_one(combinations, made):
    assert_same(select_curves(combinations), made[OLD.name].curves)
    assert_same(select_curves(combinations, *SWITCHES), made[NEW.name].curves)


def test_every_combination_is_there_once(combinations):
    names = [name_combination(on) for on in list_combinations(SWITCHES)]
    assert combinations["combination"].unique(maintain_order=True).to_list() == names
    assert len(set(names)) == 2 ** len(SWITCHES)
    assert not combinations.select("combination", "tow_id").is_duplicated().any()
    assert find_switches(names) == SWITCHES


def test_what_is_on_is_at_the_bit_of_its_switch():
    for place, on in enumerate(list_combinations(SWITCHES)):
        assert place == sum(2**bit for bit, one in enumerate(SWITCHES) if one in on)


@pytest.mark.parametrize(
    ("group", "options"),
    [
        ("selection", 'window = { rule = "steady" }\nruns = { highest_target_ratio = 1.15 }'),
        (
            "fit",
            'curve = { b = "capped" }\nrun_point = { estimator = "ratio_of_robust_means", '
            'inertia = "end_speeds" }',
        ),
    ],
)
def test_one_switch_is_the_first_method_with_those_options(world, combinations, group, options):
    text = f'name = "x"\ntitle = "x"\nextends = "as-published"\n[steps]\n{options}\n'
    own = recompute(parse_method(text, "x.toml"), world.tows, world.blocks)
    assert_same(select_curves(combinations, group), own.curves)


def test_an_estimated_log_belongs_to_the_switch_of_the_instruments(world, combinations):
    """A tow without GPS has no curve by the first method, and gets one with its estimated log."""
    curves = combinations.group_by("combination").agg(pl.len())
    lacking = curves.filter(pl.col("len") == world.tows.height - 1)["combination"]
    assert set(lacking) == {
        name_combination(on) for on in list_combinations(SWITCHES) if "instruments" not in on
    }


def test_estimates_of_instruments_that_no_switch_applies_belong_to_all_that_is_on():
    assert [uses_new_instruments(on, ["fit"]) for on in ([], ["fit"])] == [False, True]
    assert not uses_new_instruments(["fit"], ["instruments", "fit"])


def test_a_group_that_both_methods_have_alike_is_no_switch(world):
    corrected = read_shipped_method("corrected-2013")
    nothing = recompute(OLD, world.tows, world.blocks).tow_instruments
    links = {OLD.name: nothing, corrected.name: nothing}
    found = compute_combinations(OLD, corrected, world.tows, world.blocks, links)
    assert set(found["combination"]) == {NOTHING_ON, "instruments"}


def test_the_ends_are_the_first_method_and_the_one_that_is_shown_first():
    first_2014 = read_shipped_method("as-published-2014")
    rules_2015 = read_shipped_method("rebased-2015")
    assert choose_ends([OLD, first_2014, NEW, rules_2015]) == (OLD, NEW)
    assert choose_ends([OLD, first_2014, rules_2015]) == (OLD, rules_2015)
    assert choose_ends([OLD, first_2014]) is None
    assert choose_ends([OLD]) is None
