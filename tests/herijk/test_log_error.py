"""Logs of seasons from an archive of files: a season without repeats, one set aside, a new log.

Boats of 2009 got other numbers, so that none of them was towed again; every day of 2010 is set
aside; a log was replaced in 2011.
"""

import re

import polars as pl
import pytest

from herijk.simulate import WorldSettings, simulate_world
from herijk.simulate.archive_writer import write_simulated_archive
from pipeline.method.reading import read_shipped_method
from tests.tables import fill_database
from tests.warehouse.edition_bench import EditionBench

SETTINGS = WorldSettings((2009, 2010, 2011, 2014, 2015, 2016), 5, 20, seed=6)
METHOD = "rebased"


def renumbered(text):
    return text.replace("FSN", "FSN9")


def both_numbers(text):
    return text + "".join(renumbered(text).splitlines(keepends=True)[1:])


def last_two_in_april(text):
    return re.sub(r"(?m)^(2011-00[45].)[\d-]+", r"\g<1>2011-04-01", text)


EDITS = {
    "sleeplijsten/sleeplijst_2009.csv": renumbered,
    "sloepregister/sloependata.csv": both_numbers,
    "sleeplijsten/sleeplijst_2011.csv": last_two_in_april,
}


@pytest.fixture(scope="module")
def hard(tmp_path_factory):
    root = tmp_path_factory.mktemp("hard")
    bench, world = EditionBench(root / "archive", root / "data"), simulate_world(SETTINGS)
    write_simulated_archive(bench.archive, world)
    for path, change in EDITS.items():
        file = bench.archive / path
        file.write_bytes(change(file.read_bytes().decode("cp1252")).encode("cp1252"))
    with (bench.archive / "archief.toml").open("a", encoding="utf-8") as toml:
        for day in {tow.day for tow in world.tows if tow.season == 2010}:
            toml.write(f'\n[[set_aside]]\ndate = {day}\nreason = "storm"\n')
        toml.write('\n[[log_replaced]]\ndate = 2011-04-01\nlog = "log1"\nreason = "worn"\n')
    bench.rebuild((read_shipped_method(METHOD),))
    asked = ("log_factors", "season_links", "season_diagnosis")
    tables = {name: bench.store.read(name, METHOD) for name in asked}
    tables |= {name: bench.store.read(name) for name in ("tows", "methods")}
    fill_database(bench.store, tables)
    return bench


def test_where_the_log_of_each_season_is_known_from(hard):
    """Without repeats it is what is prescribed; seasons that are set aside cost no other."""
    factors = hard.store.read("log_factors", METHOD)
    assert dict(factors.select("season", "source").rows()) == {
        2009: "prescribed", 2011: "estimated", 2014: "gps", 2015: "gps", 2016: "gps",
    }  # fmt: skip
    assert factors.filter(season=2009).select("factor", "lo").row(0) == (1.06, None)
    curves = hard.store.read("curves", METHOD).filter(season=2009)
    assert curves["cw_kg_m"].null_count() < curves.height


def test_each_part_of_a_season_has_its_factor_and_its_tows_use_it(hard):
    links = hard.store.read("season_links", METHOD).filter(season=2011)
    assert links["part"].to_list() == [0, 1]
    tows = hard.store.read("tows").filter(season=2011)
    known = hard.store.read("tow_instruments", METHOD).select("tow_id").unique()
    points = hard.store.read("run_points", METHOD).join(known, on="tow_id", how="semi")
    used = points.drop_nulls("speed_factor").join(tows, on="tow_id")
    found = used.group_by("log1_part").agg(pl.col("speed_factor").unique()).sort("log1_part")
    assert found["speed_factor"].explode().to_list() == pytest.approx(links["factor"].to_list())


def test_the_command_says_what_is_not_known(hard, herijk):
    status, out, err = herijk("seasons", "--data", hard.data)
    assert (status, err) == (0, "")
    for said in ("SIMULATED", r"2009 +1\.0600 +- +- +prescribed", "No sound tow in 2010",
                 r"2011 +2 +1\.\d{4}", "Level of each season"):  # fmt: skip
        assert re.search(said, out), said
