"""`herijk seasons` on archives that are hard: few boats, a season without repeats, one set aside.

The archive has five tows per season, about twenty boats. Those of 2009 got other numbers, so that
no boat of that season was ever towed again; every day of 2010 is set aside; a log was replaced in
2011; one boat was made 15 % heavier to tow after 2011, and nobody said so.
"""

import re
from collections.abc import Callable
from dataclasses import replace

import polars as pl
import pytest
from scipy.stats import norm

from herijk.simulate import World, WorldSettings, simulate_world
from herijk.simulate.archive_writer import write_simulated_archive
from pipeline.method.definition import shipped_method
from tests.warehouse.edition_bench import EditionBench
from warehouse.derive.database import build_database

SEASONS = (2009, 2010, 2011, 2014, 2015, 2016)
SETTINGS = WorldSettings(SEASONS, tows_per_season=5, rate_hz=20, seed=6)
METHOD = "rebased"


@pytest.fixture(scope="module")
def hard(tmp_path_factory) -> EditionBench:
    root = tmp_path_factory.mktemp("hard")
    bench = EditionBench(root / "archive", root / "data")
    world = _one_boat_heavier(simulate_world(SETTINGS))
    write_simulated_archive(bench.archive, world)
    _edit(bench, "sleeplijsten/sleeplijst_2009.csv", _renumbered)
    _edit(bench, "sloepregister/sloependata.csv", _with_renumbered)
    _edit(bench, "sleeplijsten/sleeplijst_2011.csv", _last_two_in_april)
    days = sorted({tow.day for tow in world.tows if tow.season == 2010})
    with (bench.archive / "archief.toml").open("a", encoding="utf-8") as toml:
        toml.writelines(f'\n[[set_aside]]\ndate = {day}\nreason = "storm"\n' for day in days)
        toml.write('\n[[log_replaced]]\ndate = 2011-04-01\nlog = "log1"\nreason = "worn"\n')
    bench.rebuild((shipped_method(METHOD),))
    asked = ("log_factors", "season_links", "season_steps", "season_diagnosis")
    about = pl.DataFrame({"key": ["simulated"], "value": ["true"]})
    tables = {name: bench.store.read(name, METHOD) for name in asked}
    tables["tows"] = bench.store.read("tows")
    build_database(bench.store.database, tables | {"about": about})
    return bench


def _one_boat_heavier(world: World) -> World:
    before = {t.boat.fsn_no for t in world.tows if t.season == 2011}
    after = {t.boat.fsn_no for t in world.tows if t.season >= 2014}
    boat = min(before & after)
    tows = [
        replace(t, hull=replace(t.hull, condition=1.15 * t.hull.condition))
        if t.boat.fsn_no == boat and t.season >= 2014
        else t
        for t in world.tows
    ]
    return replace(world, tows=tuple(tows))


def _edit(bench: EditionBench, path: str, change: Callable[[str], str]) -> None:
    file = bench.archive / path
    file.write_bytes(change(file.read_bytes().decode("cp1252")).encode("cp1252"))


def _renumbered(text: str) -> str:
    return text.replace("FSN", "FSN9")


def _with_renumbered(text: str) -> str:
    """The boats, and each again under its other number."""
    return text + "".join(_renumbered(text).splitlines(keepends=True)[1:])


def _last_two_in_april(text: str) -> str:
    return re.sub(r"(?m)^(2011-00[45].)[\d-]+", r"\g<1>2011-04-01", text)


def seasons(bench: EditionBench) -> dict[int, dict]:
    return {row["season"]: row for row in bench.store.read("log_factors", METHOD).to_dicts()}


def test_a_season_without_repeats_is_not_determined_and_uses_what_is_prescribed(hard):
    row = seasons(hard)[2009]
    assert (row["source"], row["factor"], row["lo"]) == ("prescribed", 1.06, None)
    links = hard.store.read("season_links", METHOD).filter(pl.col("season") == 2009)
    assert links["source"].to_list() == ["not determined"]
    curves = hard.store.read("curves", METHOD).filter(pl.col("season") == 2009)
    assert curves["cw_kg_m"].null_count() < curves.height


def test_a_season_that_is_set_aside_leaves_the_others_as_they_are(hard):
    assert 2010 not in seasons(hard)
    others = {season: row["source"] for season, row in seasons(hard).items() if season != 2009}
    assert others == {2011: "estimated", 2014: "gps", 2015: "gps", 2016: "gps"}


def test_few_boats_give_wide_intervals_that_hold_the_truth(hard):
    """The factor of a season is the mean of those of its tows, of which one says too little."""
    used = hard.store.read("tow_instruments", METHOD)["tow_id"]
    tows = {tow.tow_id: tow.truth.log_factor for tow in simulate_world(SETTINGS).tows}
    truth = [factor for tow, factor in tows.items() if tow[:4] == "2011" and tow in used]
    row = seasons(hard)[2011]
    middle, half = (row["hi"] + row["lo"]) / 2, (row["hi"] - row["lo"]) / 2
    # One draw of twenty lies outside a 95 % interval, one of a thousand outside this.
    assert abs(sum(truth) / len(truth) - middle) < half * norm.ppf(0.9995) / norm.ppf(0.975)
    assert row["hi"] - row["lo"] > 0.02  # 24 tows per season give about 0.014


def test_each_part_of_a_season_has_its_factor_and_its_tows_use_it(hard):
    links = hard.store.read("season_links", METHOD).filter(pl.col("season") == 2011)
    assert links["part"].to_list() == [0, 1]
    known = hard.store.read("tow_instruments", METHOD).select("tow_id").unique()
    points = (
        hard.store.read("run_points", METHOD)
        .join(hard.store.read("tows"), on="tow_id")
        .join(known, on="tow_id", how="semi")
    )
    used = points.filter(pl.col("season") == 2011).drop_nulls("speed_factor")
    found = used.group_by("log1_part").agg(pl.col("speed_factor").unique()).sort("log1_part")
    assert found["speed_factor"].explode().to_list() == pytest.approx(links["factor"].to_list())


def test_the_command_says_what_is_not_known(hard, herijk):
    status, out, err = herijk("seasons", "--data", hard.data)
    assert (status, err) == (0, "")
    assert "SIMULATED" in out
    assert re.search(r"2009 +1\.0600 +- +- +prescribed", out)
    assert "No sound tow in 2010" in out
    assert re.search(r"2011 +2 +1\.\d{4}", out)
    assert re.search(r"step is of", out)
