"""The whole method against a straightforward computation per sample, and what must not matter."""

import math
from dataclasses import replace
from datetime import date

import numpy as np
import polars as pl
import pytest
from polars.testing import assert_frame_equal

from herijk.simulate import WorldSettings, simulate_tow, simulate_world
from pipeline.blocks.run_blocks import stack_blocks
from pipeline.blocks.sums import block_sums
from pipeline.blocks.tows import Tows
from pipeline.method.reading import read_shipped_method
from pipeline.recompute.facts import add_expected_mass, add_expected_water
from pipeline.recompute.recompute import recompute
from pipeline.steps.target import is_above_target
from tests.pipeline.methods import method
from tests.worlds import Measured, find_tows_without_gps, measure, run_rows, tow_rows, without_wind

SETTINGS = WorldSettings((2010, 2012, 2015), 10, 20, 11)
RHO = 1.225


@pytest.fixture(scope="module")
def measured() -> Measured:
    return measure(SETTINGS)


# An implementation of `rebased-2015` of its own: sample by sample, tow by tow, no blocks. Only
# the choice of windows is taken as given; it has its own tests.


def oracle_run(samples: list[dict], tow: dict, factor: float) -> dict[str, float]:
    front = tow["beam_m"] * tow["bow_height_m"] + 0.5
    side = tow["waterline_length_m"] * tow["bow_height_m"] + 1.0
    speeds, gross, net = [], [], []
    for s in samples:
        v = s["log1_m_s"] * factor
        angle = math.radians(s["wind_angle_deg"])
        along = s["wind_speed_m_s"] * math.cos(angle)
        area = front * abs(math.cos(angle)) * 0.5 + side * abs(math.sin(angle)) * 0.2
        air = math.copysign(RHO / 2 * area * along**2, along)
        speeds.append(v)
        gross.append(s["force_n"] / v**2)
        net.append((s["force_n"] - air) / v**2)
    n = len(samples)
    cw = math.fsum(net) / n + RHO / 2 * front * 0.5
    mean = math.fsum(gross) / n
    sd = math.sqrt(math.fsum((g - mean) ** 2 for g in gross) / n)
    return {"speed_m_s": math.fsum(speeds) / n, "gross_cw_kg_m": mean, "cw_kg_m": cw, "cw_sd": sd}


def oracle_calibration(runs: dict[int, list[dict]], season: int) -> float:
    if season < 2014:
        return 1.0
    ways = {"gps_m_s": [], "log1_m_s": []}
    for channel, found in ways.items():
        for numbers in ((1, 2, 3), (4, 5, 6)):
            of_runs = [
                math.fsum(s[channel] for s in runs[k]) / len(runs[k]) for k in numbers if k in runs
            ]
            found.append(math.fsum(of_runs) / len(of_runs))
    return math.fsum(ways["gps_m_s"]) / math.fsum(ways["log1_m_s"])


def oracle_curve(points: list[dict], cap_m_s: float) -> tuple[float, float]:
    """A and s = 1/B^2 by Gauss-Newton in A and s, with B no larger than the cap."""
    v2 = np.array([p["speed_m_s"] for p in points]) ** 2
    cw = np.array([p["cw_kg_m"] for p in points])
    a, s = cw.mean(), 0.0
    for _ in range(200):
        g = 1 / (1 - s * v2)
        jacobian = np.stack([g, a * v2 * g**2], axis=1)
        step = np.linalg.lstsq(jacobian, cw - a * g, rcond=None)[0]
        a, s = a + step[0], s + step[1]
    least = 1 / cap_m_s**2
    if s < least:
        s = least
        g = 1 / (1 - s * v2)
        a = (g @ cw) / (g @ g)
    return a, s


@pytest.fixture(scope="module")
def rebased(measured):
    return recompute(read_shipped_method("rebased-2015"), measured.tows, measured.blocks)


@pytest.mark.parametrize("season", SETTINGS.seasons)
def test_rebased_2015_equals_a_computation_sample_by_sample(rebased, season):
    world = simulate_world(SETTINGS)
    compared = 0
    for simulated in world.tows:
        if simulated.season != season:
            continue
        tow = tow_rows(world).filter(tow_id=simulated.tow_id).row(0, named=True)
        points = rebased.run_points.filter(tow_id=simulated.tow_id).sort("run").rows(named=True)
        samples = simulate_tow(world, simulated)[0]
        windows = {}
        for p in points:
            if p["window_start_s"] is not None:
                rows = samples.filter(run=p["run"]).rows(named=True)
                first, last = (
                    int(p[f"window_{end}_s"] * SETTINGS.rate_hz) for end in ("start", "end")
                )
                windows[p["run"]] = rows[first:last]
        known = 1.06 if season <= 2011 else 1.0
        means = {
            run: math.fsum(s["log1_m_s"] for s in rows) / len(rows) for run, rows in windows.items()
        }
        targets = {p["run"]: p["target_speed_ratio"] * tow["declared_speed_m_s"] for p in points}
        levels = sorted(mean / targets[run] for run, mean in means.items())
        limit = 1.15 * tow["declared_speed_m_s"] * levels[(len(levels) - 1) // 2]
        used = {run: rows for run, rows in windows.items() if means[run] <= limit}
        assert [p["run"] for p in points if p["used"]] == list(used)
        both_ways = {1, 2, 3} & used.keys() and {4, 5, 6} & used.keys()
        if not both_ways:
            continue
        factor = known * oracle_calibration(windows, season)
        expected = {run: oracle_run(rows, tow, factor) for run, rows in used.items()}
        for p in points:
            for name, value in expected.get(p["run"], {}).items():
                assert p[name] == pytest.approx(value, rel=1e-9), (simulated.tow_id, name)
        curve = rebased.curves.filter(tow_id=simulated.tow_id).row(0, named=True)
        if curve["status"] == "rejected":
            assert len(used) < 4
            continue
        cap = 3 * 1.25 * math.sqrt(tow["waterline_length_m"])
        a, s = oracle_curve(list(expected.values()), cap)
        assert curve["a_kg_m"] == pytest.approx(a, rel=1e-9)
        assert curve["b_m_s"] == pytest.approx(s**-0.5, rel=1e-9)
        cw = a / (1 - s * tow["declared_speed_m_s"] ** 2)
        assert curve["cw_kg_m"] == pytest.approx(cw, rel=1e-9)
        compared += 1
    assert compared >= 3


# What must not matter


def shuffled(measured: Measured) -> Measured:
    """The same tows, renamed nowhere, but read in another order."""
    world = simulate_world(SETTINGS)
    frames = [
        block_sums(simulate_tow(world, tow)[0], SETTINGS.rate_hz).select(
            pl.lit(tow.tow_id).alias("tow_id"), pl.all()
        )
        for tow in reversed(world.tows)
    ]
    runs = run_rows(measured.tows).sample(fraction=1.0, shuffle=True, seed=2)
    tows = measured.tows.sample(fraction=1.0, shuffle=True, seed=3)
    return replace(measured, tows=tows, blocks=stack_blocks(pl.concat(frames), runs))


def test_the_order_of_tows_and_runs_does_not_matter(measured, rebased):
    other = shuffled(measured)
    again = recompute(read_shipped_method("rebased-2015"), other.tows, other.blocks)
    for table in ("run_points", "curves", "log_factors"):
        left, right = (getattr(made, table) for made in (rebased, again))
        key = [c for c in ("tow_id", "season", "run") if c in left.columns]
        assert_frame_equal(left.sort(key), right.sort(key), check_exact=True)


@pytest.mark.parametrize("name", ["as-published", "rebased-2015"])
def test_a_tow_does_not_depend_on_the_other_tows(measured, name):
    chosen = read_shipped_method(name)
    together = recompute(chosen, measured.tows, measured.blocks)
    for tow_id in measured.tows["tow_id"].sample(4, seed=1):
        mine = measured.tows.filter(tow_id=tow_id)
        alone = recompute(chosen, mine, measured.blocks)
        for table in ("run_points", "curves"):
            both = getattr(together, table).filter(tow_id=tow_id)
            # What a tow is compared with are other tows: that may change its flags, never a number.
            judged = [c for c in ("status", "flags") if c in both.columns]
            one = getattr(alone, table).drop(judged)
            assert_frame_equal(one, both.drop(judged), check_exact=True)


# Runs that do not count


def without_runs(measured: Measured, tow_id: str, runs: list[int]) -> Measured:
    chosen = measured.blocks.runs.with_columns(
        selected=~((pl.col("tow_id") == tow_id) & pl.col("run").is_in(runs))
    )
    return replace(measured, blocks=replace(measured.blocks, runs=chosen))


@pytest.mark.parametrize(
    ("left_out", "status"),
    [([6], None), ([1, 6], None), ([1, 2, 6], "rejected"), ([4, 5, 6], "rejected")],
)
def test_a_curve_needs_four_runs_and_both_ways(measured, left_out, status):
    tow_id = measured.tows["tow_id"][0]
    fewer = without_runs(measured, tow_id, left_out)
    made = recompute(method(), fewer.tows, fewer.blocks)
    curve = made.curves.filter(tow_id=tow_id).row(0, named=True)
    assert (curve["status"] == "rejected") == (status == "rejected")
    assert curve["runs_used"] == 6 - len(left_out)
    few = made.assessments.filter(tow_id=tow_id, check="few_runs")
    assert few["flagged"].to_list() == [True]
    assert ("no_curve" in curve["flags"]) == (status == "rejected")
    if status == "rejected":
        assert curve["cw_kg_m"] is None
        assert curve["a_kg_m"] is None
    reasons = made.run_points.filter(tow_id=tow_id).filter(~pl.col("used"))
    assert reasons["run"].to_list() == left_out
    assert set(reasons["reason"]) == {"not_selected"}


@pytest.mark.parametrize(("out", "dropped"), [(1.1495, False), (1.155, True)])
def test_runs_out_and_back_stay_or_go_together(measured, out, dropped):
    batch = Tows.from_frames(measured.tows, measured.blocks)
    intended = batch.get_of_runs("declared_speed_m_s") * batch.target_speed_ratio
    top = batch.target_speed_ratio == 1.1
    towed = np.where(batch.direction > 0, out, 1.1608) / 1.1
    everything = np.ones(len(batch.tow), dtype=bool)
    too_fast = is_above_target(batch, intended * np.where(top, towed, 1.0), everything, 1.15)
    assert np.array_equal(too_fast, top & dropped)


def test_calibration_is_over_all_runs_also_those_too_fast_to_count(measured):
    calibration = '{ rule = "gps_per_tow" }'
    whole, cut = (
        recompute(
            method(calibration=calibration, runs=f"{{ highest_target_ratio = {ratio} }}"),
            measured.tows,
            measured.blocks,
        ).curves.filter(season=2015)
        for ratio in (1.5, 1.05)
    )
    assert (cut["runs_used"] < whole["runs_used"]).all()
    factors = cut["calibration_factor"].to_list()
    assert factors == pytest.approx(whole["calibration_factor"].to_list(), rel=1e-12)


def test_without_gps_nothing_is_calibrated_and_the_tow_says_so(measured):
    made = recompute(method(calibration='{ rule = "gps_per_tow" }'), measured.tows, measured.blocks)
    early = made.run_points.join(measured.tows.filter(season=2010), on="tow_id", how="semi")
    assert set(early["reason"]) == {"not_calibrated"}
    assert set(made.curves.filter(season=2010)["status"]) == {"rejected"}
    assert made.curves.filter(season=2015)["status"].is_in(["accepted", "flagged"]).all()


def test_a_tow_without_gps_gets_the_factor_of_its_log_from_the_other_tows(measured):
    marked = (measured.tows["tow_id"].is_in(["2015-001", "2015-004", "2015-007"])).to_numpy()
    world = find_tows_without_gps(measured, marked)
    made, with_gps = (
        recompute(read_shipped_method("rebased"), w.tows, w.blocks) for w in (world, measured)
    )
    assert made.curves["cw_kg_m"].null_count() == 0
    both = made.curves.join(with_gps.curves, on="tow_id", suffix="_with").filter(pl.Series(marked))
    assert both["calibration_factor"].null_count() == 3
    assert both.select(pl.col("cw_kg_m_with").is_between("cw_lo_kg_m", "cw_hi_kg_m").all()).item()
    assert (both["cw_kg_m"] / both["cw_kg_m_with"]).to_numpy() == pytest.approx(1.0, abs=0.03)
    assert made.log_factors["season"].to_list() == [2010, 2012, 2015]
    assert made.log_factors["source"][2] == "gps"


def test_of_wind_that_nobody_measured_the_mean_of_the_others_is_taken_off(measured):
    lost = (measured.tows["season"] == 2012).to_numpy()
    world = without_wind(measured, lost)
    made = recompute(read_shipped_method("rebased"), world.tows, world.blocks)
    net = pl.col("air_cw_kg_m").mean() / pl.col("still_air_cw_kg_m").mean() - 1.0
    ratio = made.run_points.filter("used").group_by("tow_id", maintain_order=True).agg(net=net)
    told = ratio.join(world.tows, on="tow_id").select("net", "wind_measured")
    others = told.filter("wind_measured")["net"]
    assert told.filter(~pl.col("wind_measured"))["net"].to_numpy() == pytest.approx(others.mean())
    wind = made.uncertainty_budget.filter(component="wind").join(world.tows, on="tow_id")
    still = made.run_points.filter("used").group_by("tow_id").agg(pl.mean("still_air_cw_kg_m"))
    rows = wind.filter(~pl.col("wind_measured")).join(still, on="tow_id")
    of_cw = rows.join(made.curves, on="tow_id")
    expected = others.std() * of_cw["still_air_cw_kg_m"] / of_cw["cw_kg_m"]
    assert of_cw["u_ratio"].to_numpy() == pytest.approx(expected.to_numpy())
    assert set(rows["shared"]) == {"single"}


def test_water_that_nobody_measured_is_as_warm_as_other_tows_say(measured):
    rebased = read_shipped_method("rebased")
    lost = (measured.tows["season"] == 2015).to_numpy()
    water = measured.tows["water_temperature_c"]
    tows = measured.tows.with_columns(water_temperature_c=water.set(pl.Series(lost), None))
    said, unsaid = (recompute(rebased, t, measured.blocks) for t in (measured.tows, tows))
    moved = (unsaid.curves["cw_kg_m"] / said.curves["cw_kg_m"]).log().to_numpy()[lost]
    expected = add_expected_water(tows)["expected_water_c"]
    assert moved == pytest.approx(0.003 * (expected - water).to_numpy()[lost], abs=0.003)
    assert expected.to_numpy()[lost] == pytest.approx(np.mean(water.to_numpy()[~lost]), abs=3.0)
    budget = unsaid.uncertainty_budget.filter(component="temperature")
    assert (budget["u_ratio"].to_numpy()[lost] > 0.01).all()


def test_water_is_expected_of_the_nearest_days_that_have_a_record():
    days = ((2014, 3, 1), (2014, 3, 1), (2014, 3, 9), (2016, 3, 2), (2016, 5, 1), (2015, 4, 1))
    water = [4.0, None, None, None, 12.0, None]
    tows = pl.DataFrame({"tow_date": [date(*d) for d in days], "water_temperature_c": water})
    expected = add_expected_water(tows)["expected_water_c"].to_list()
    assert expected == [4.0, 4.0, 4.0, 4.0, 12.0, 8.0]


def test_a_mass_is_expected_of_the_boats_own_tows_then_of_its_type_then_of_its_crew():
    tows = pl.DataFrame(
        {
            "fsn_no": ["a", "a", "a", "b", "c", "d", "e"],
            "boat_type": ["kuiken", "kuiken", "kuiken", "kuiken", "kuiken", "whaler", None],
            "rowers": [8, 8, 8, 8, 8, 8, 6],
            "crew_class": ["H"] * 7,
            "weight_kg": [1000.0, 1100.0, None, 1300.0, None, None, None],
            "crew_weight_kg": [700.0, None, None, 720.0, 740.0, 740.0, 480.0],
        }
    )
    found = add_expected_mass(tows)
    of_type = float(np.median([1000.0, 1100.0, 1300.0]))
    of_six = float(np.median([1000.0, 1100.0, 1300.0])) / 8 * 6
    expected = [1700.0, 1800.0, 1750.0, 2020.0, of_type + 740.0, of_type + 740.0, of_six + 480.0]
    assert found["mass_kg"].to_list() == pytest.approx(expected)
    weighed = [True, False, False, True, False, False, False]
    assert (found["mass_ln_sd"] == 0.0).to_list() == weighed
    among_kuikens = np.std(np.log([1000.0, 1100.0, 1300.0]), ddof=1)
    sd = among_kuikens * of_type / (of_type + 740.0)
    assert found["mass_ln_sd"][4] == pytest.approx(sd)
