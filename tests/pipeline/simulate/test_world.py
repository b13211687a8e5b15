"""Schedule and truth of a whole world: linked by repeats, reproducible, season by season."""

from collections import Counter, defaultdict
from dataclasses import replace

import numpy as np
import pytest

from herijk.simulate import Defects, WorldSettings, simulate_world


def none(season):
    return Defects()


@pytest.fixture(scope="module")
def world():
    return simulate_world(WorldSettings(rate_hz=20))


def seasons_of_crews(world):
    seasons = defaultdict(list)
    for tow in world.tows:
        seasons[tow.boat.fsn_no, tow.crew_class].append(tow.season)
    return seasons


def test_every_season_has_its_tows_and_ids_are_unique(world):
    assert set(Counter(t.season for t in world.tows).values()) == {24}
    assert len({t.tow_id for t in world.tows}) == 240
    assert len({(t.season, t.samples_name) for t in world.tows}) == 240


@pytest.mark.parametrize("tows_per_season", [2, 3, 24])
def test_repeat_tows_link_all_seasons(tows_per_season):
    world = simulate_world(WorldSettings(tows_per_season=tows_per_season))
    linked = {2009}
    crews = list(seasons_of_crews(world).values())
    for _ in world.settings.seasons:
        for seasons in crews:
            if linked.intersection(seasons):
                linked.update(seasons)
    assert linked == set(world.settings.seasons)


def test_a_season_is_the_same_whichever_others_are_asked_for(world):
    alone = simulate_world(WorldSettings(seasons=(2014,)))
    longer = simulate_world(WorldSettings(seasons=tuple(range(2009, 2022))))
    of_2014 = tuple(t for t in world.tows if t.season == 2014)
    assert alone.tows == of_2014
    assert tuple(t for t in longer.tows if t.season == 2014) == of_2014


def test_without_defects_a_boat_never_changes():
    world = simulate_world(WorldSettings(defects=none))
    cw = defaultdict(set)
    for tow in world.tows:
        cw[tow.boat.fsn_no, tow.crew_class].add(tow.truth.cw_at_15c_kg_m)
        assert tow.truth.cw_at_tow_temperature_kg_m == tow.truth.cw_at_15c_kg_m
        assert tow.truth.log_factor == tow.truth.askew_ratio == 1.0
        assert (tow.truth.altered, tow.altered_reported, tow.fast_run) == (False,) * 3
    assert {len(values) for values in cw.values()} == {1}


def test_ageing_alone_raises_cw_at_its_rate():
    aged = simulate_world(
        WorldSettings(defects=lambda s: replace(Defects(), ageing_per_year=0.005))
    )
    fresh = simulate_world(WorldSettings(defects=none))
    for old, new in zip(aged.tows, fresh.tows, strict=True):
        ratio = old.truth.cw_at_15c_kg_m / new.truth.cw_at_15c_kg_m
        years = old.season - 2009
        # The still-air part, some 3 %, does not age.
        assert ratio - 1 == pytest.approx(1.005**years - 1, rel=0.05, abs=1e-12)


def test_alterations_change_cw_and_about_half_is_reported():
    defects = replace(Defects(), alteration_share=1.0, alteration_sd=0.08)
    world = simulate_world(WorldSettings(defects=lambda s: replace(defects, unreported_share=0.5)))
    cw, changes = {}, []
    for tow in world.tows:
        crew = (tow.boat.fsn_no, tow.crew_class)
        assert tow.truth.altered == (crew in cw)
        if crew in cw:
            changes.append(np.log(tow.truth.cw_at_15c_kg_m / cw[crew]))
        cw[crew] = tow.truth.cw_at_15c_kg_m
    # 150 changes: the standard error of an sd is 6 %.
    assert np.std(changes) == pytest.approx(0.08, rel=0.2)
    reported = np.mean([t.altered_reported for t in world.tows if t.truth.altered])
    assert 0.35 < reported < 0.65
