"""The public library: what it promises, tried as a stranger would."""

import datetime as dt
import doctest

import polars as pl
import pytest

import herijk
from herijk.library import curves, methods
from herijk.simulate import WorldSettings, simulate_tow, simulate_world
from tests.golden.sources import read_table


@pytest.mark.parametrize("module", [curves, methods])
def test_examples_are_true(module):
    tried = doctest.testmod(module)
    assert tried.attempted > 0
    assert tried.failed == 0


def test_everything_promised_is_there():
    for name in herijk.__all__:
        assert getattr(herijk, name) is not None
    with pytest.raises(AttributeError):
        herijk.nothing  # noqa: B018


def test_a_real_drag_without_a_bend_has_no_b():
    rows = read_table("unh_rm2_tare_drag.csv")
    speed = [float(row["tow_speed_m_per_s"]) for row in rows]
    with pytest.warns(herijk.FitWarning, match="no bend"):
        found = herijk.fit(speed, [float(row["tare_drag_N"]) for row in rows])
    assert not found.b_is_determined
    assert found.b.hi is None
    assert found.cw(0.8).lo < found.cw(0.8).value < found.cw(0.8).hi


def test_a_run_at_rest_among_the_points_is_warned_of():
    speed, force = [0.0016, 0.69, 0.89, 0.99], [0.840, 2.354, 3.484, 4.821]
    with (
        pytest.warns(herijk.FitWarning, match=r"at 0.99 m/s lies 62% from the curve"),
        pytest.warns(herijk.FitWarning, match="no bend"),
    ):
        herijk.fit(speed, force)


@pytest.mark.filterwarnings("ignore:the points show no bend")
def test_a_drag_that_grows_with_speed_squared_has_no_b():
    speed = [4.5, 5.0, 5.5, 6.0]
    assert herijk.fit(speed, [12.74 * v * v for v in speed]).b.value is None


def test_a_curve_shows_the_numbers_that_people_know():
    assert repr(herijk.Curve.from_a_b(21.0, 4.0)) == "Curve(a_kg_m=21.0, b_m_s=4.0)"


def test_power_and_speed_are_inverse():
    curve = herijk.Curve.from_a_b(21.0, 4.4)
    assert curve.speed_m_s(curve.power_w(3.1)) == pytest.approx(3.1)


@pytest.mark.parametrize(
    ("speed", "force"), [([3.0, 3.0], [200, 210]), ([3.0], [1, 2]), ([3, -1], [1, 2])]
)
def test_points_without_a_curve_are_refused(speed, force):
    with pytest.raises(herijk.HerijkError):
        herijk.fit(speed, force)


@pytest.mark.parametrize(
    "ask",
    [
        lambda curve: curve.cw_kg_m([3.0, float("nan")]),
        lambda curve: curve.power_w(-3.0),
        lambda curve: curve.speed_m_s(-1.0),
        lambda curve: curve.from_a_b(-20.0, 4.0),
        lambda curve: curve.from_a_b(20.0, 0.0),
    ],
)
def test_what_no_boat_can_have_is_refused(ask):
    with pytest.raises(herijk.HerijkError):
        ask(herijk.Curve.from_a_b(21.0, 4.4))


def test_one_tow_under_a_method(small_world):
    world, tow, samples = small_world
    facts = {
        "tow_date": dt.date(2016, 5, 1),
        "declared_speed_m_s": tow.declared_speed_m_s,
        "waterline_length_m": tow.boat.waterline_length_m,
        "beam_m": tow.boat.beam_m,
        "bow_height_m": tow.boat.bow_height_m,
        "water_temperature_c": tow.water_temperature_c,
    }
    made = herijk.apply_method(
        herijk.method("rebased-2015"), samples, facts, world.settings.rate_hz
    )
    assert made.run_points.height == 6
    assert made.curves["cw_kg_m"][0] == pytest.approx(tow.truth.cw_at_15c_kg_m, rel=0.05)
    with pytest.raises(herijk.HerijkError, match="beam_m"):
        herijk.apply_method(herijk.method("rebased"), samples, {**facts, "beam_m": None}, 100)
    with pytest.raises(herijk.HerijkError, match="sample_rate_hz"):
        herijk.apply_method(herijk.method("rebased"), samples, facts, 0)


@pytest.fixture(scope="module")
def small_world():
    world = simulate_world(WorldSettings((2016,), 1, 100, 3))
    tow = world.tows[0]
    return world, tow, simulate_tow(world, tow)[0]


def test_a_folder_without_a_rebuild_says_so(tmp_path):
    with pytest.raises(herijk.HerijkError, match="herijk rebuild"):
        herijk.open_data(tmp_path)


def test_a_data_folder_as_frames(built):
    folder = herijk.open_data(built.data)
    assert "curves" in folder.tables
    old, new = folder.register("concept-as-published"), folder.register("concept-rebased-2015")
    assert set(herijk.compare_registers(old, new)["change"]) <= {"same", "changed"}
    assert isinstance(folder.table("tows"), pl.DataFrame)
    with pytest.raises(herijk.HerijkError, match="the tables are"):
        folder.table("towz")
    with pytest.raises(herijk.HerijkError, match="there are"):
        folder.register("2099")
