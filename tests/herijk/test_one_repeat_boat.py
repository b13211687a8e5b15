"""The first repeat tow of a towing day, with a force that is off: both explanations are named.

The other boats of the last season got other numbers, so that one boat alone was towed before.
"""

import re

import pytest

from herijk.simulate import Defects, WorldSettings, simulate_world
from herijk.simulate.archive_writer import write_simulated_archive
from pipeline.method.reading import read_shipped_method
from tests.tables import fill_database
from tests.warehouse.edition_bench import EditionBench
from warehouse.queries.assess import assess

pytestmark = pytest.mark.more

SETTINGS = WorldSettings(
    seasons=(2011, 2012, 2014, 2015, 2016, 2017),
    tows_per_season=6,
    rate_hz=20,
    seed=6,
    defects=Defects.clean,
)
METHOD = read_shipped_method("rebased")
OFF = 1.15
ASKED = ("log_factors", "season_links", "season_diagnosis")


def _line(tow):
    return tow.boat.fsn_no, tow.rowers, tow.crew_class


@pytest.fixture(scope="module")
def towed(tmp_path_factory):
    """An archive with one repeat tow in 2017, and that tow; its Cw as it is and with the force."""
    root = tmp_path_factory.mktemp("one-repeat")
    bench, world = EditionBench(root / "archive", root / "data"), simulate_world(SETTINGS)
    write_simulated_archive(bench.archive, world)
    before = {_line(tow) for tow in world.tows if tow.season < 2017}
    last = [tow for tow in world.tows if tow.season == 2017]
    repeat = next(tow for tow in last if _line(tow) in before)
    number = repeat.boat.fsn_no
    for path in ("sleeplijsten/sleeplijst_2017.csv", "sloepregister/sloependata.csv"):
        file = bench.archive / path
        header, *rows = file.read_bytes().decode("cp1252").splitlines(keepends=True)
        new = [row.replace("FSN", "FSN9") for row in rows if number not in row]
        own = [row for row in rows if "sloependata" in path or number in row]
        file.write_bytes("".join([header, *own, *new]).encode("cp1252"))
    bench.rebuild((METHOD,))
    sound = bench.store.read("curves", METHOD.name).filter(tow_id=repeat.tow_id)["cw_kg_m"][0]
    bench.change_force(repeat.tow_id, lambda newtons: OFF * newtons)
    bench.rebuild((METHOD,))
    tables = {name: bench.store.read(name, METHOD.name) for name in ASKED}
    tables |= {name: bench.store.read(name) for name in ("tows", "methods")}
    fill_database(bench.store, tables)
    return bench, repeat, sound


def test_the_number_is_as_measured_and_its_interval_holds_the_old_one(towed):
    bench, repeat, sound = towed
    curve = bench.store.read("curves", METHOD.name).filter(tow_id=repeat.tow_id)
    assert curve["cw_kg_m"][0] == pytest.approx(OFF * sound, rel=0.02)
    for estimate in ("cw", "cw_best"):
        low, high = (curve[f"{estimate}_{end}_kg_m"][0] for end in ("lo", "hi"))
        assert low < sound < OFF * sound < high


def test_assess_has_both_explanations_among_what_to_look_at(towed):
    bench, repeat, _ = towed
    found = assess(bench.store, bench.archive, repeat.tow_id, METHOD)
    assert "instrument_or_boat" in {check["check"] for check in found.checks}


def test_seasons_names_the_boat_and_both_explanations(towed, herijk):
    bench, repeat, _ = towed
    status, out, err = herijk("seasons", "--data", bench.data)
    assert (status, err) == (0, "")
    shown = f"2017 +1 +scale of the load cell +cannot be told .*{repeat.boat.fsn_no} +boat altered"
    assert re.search(shown, out)
    status, out, _ = herijk("seasons", "--data", bench.data, "--json")
    assert status == 0
    assert f'"shown_by": "{repeat.boat.fsn_no}"' in out
