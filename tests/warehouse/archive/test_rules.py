"""Each rule on a run fires where it should, and a sound run breaks none."""

import numpy as np
import pytest

from warehouse.archive.faults import DefectiveFileError, Fault
from warehouse.archive.plausibility.mix_ups import check_mix_ups, without_other_units
from warehouse.archive.plausibility.rules import RUN_RULES, apply_rules, without_stuck_gps
from warehouse.archive.plausibility.run import SPARE, Run

RATE_HZ = 20
TOW = {
    "tow_id": "2015-001",
    "samples_path": "a.csv",
    "second_path": None,
    "sample_rate_hz": RATE_HZ,
}
SPEED_M_S = 2.4


def sound(number: int = 1, intended_m_s: float = SPEED_M_S, **changed: np.ndarray) -> Run:
    """A run of 50 s that nothing is wrong with, but for the channels that are given."""
    rng, rows = np.random.default_rng(number), 50 * RATE_HZ
    usual = {
        "log1": (intended_m_s, 0.03),
        "log2": (intended_m_s, 0.03),
        "gps": (intended_m_s, 0.02),
        "force": (40 * intended_m_s**2, 40),
        "wind_speed": (4, 0.3),
        "wind_angle": (180, 15),
    }
    channels = {key: rng.normal(*of, rows).astype(np.float32) for key, of in usual.items()}
    return Run(TOW, number, 0, intended_m_s, 50.0, channels | changed)


def broken(measure: str, channel: str, code: str) -> Run:
    """A run that breaks one rule: stuck, clipped, turned round, or with a mean that cannot be."""
    values = sound().channels[channel].copy()
    if measure == "held":
        values[: 25 * RATE_HZ] = values[0]
    elif measure == "clipped_percent":
        values = np.minimum(values, np.float32(235))
    elif code == "negative_force":
        values = -values
    else:
        values *= 100 if channel == "force" else 10
    return sound(**{channel: values})


def test_a_sound_run_breaks_no_rule():
    faults: list[Fault] = []
    run = sound()
    assert apply_rules(run, faults) is run
    assert not faults


@pytest.mark.parametrize("rule", RUN_RULES, ids=lambda r: f"{r.channel} {r.measure} {r.limits}")
def test_each_rule_costs_the_run_or_the_spare_channel(rule):
    faults: list[Fault] = []
    kept = apply_rules(broken(rule.measure, rule.channel, rule.reason_code), faults)
    assert [fault.reason_code for fault in faults] == [rule.reason_code]
    if rule.channel in SPARE:
        assert faults[0].lost == "seconds"
        assert kept is not None
        assert np.isnan(kept.channels[rule.channel]).all()
    else:
        assert faults[0].lost == "run"
        assert kept is None


def gps_lost(*runs: tuple[float, float]) -> list[int]:
    """Runs that lose their GPS, by intended speed and what it holds; 0 is one that moves."""
    steady = []
    for number, (intended, held) in enumerate(runs, start=1):
        channels = {"log1": np.full(1000, intended, np.float32)}
        if held:
            channels["gps"] = np.full(1000, held, np.float32)
        steady.append(sound(number, intended, **channels))
    faults: list[Fault] = []
    kept = without_stuck_gps(steady, faults)
    lost = [run.number for run in kept if np.isnan(run.channels["gps"]).all()]
    assert [fault.run for fault in faults] == lost
    return lost


@pytest.mark.parametrize(
    ("runs", "lost"),
    [
        ([(2.2, 0), (2.4, 0), (2.6, 2.43), (2.2, 2.43), (2.4, 2.43), (2.6, 2.43)], [3, 4, 5, 6]),
        ([(2.2, 2.2), (2.4, 2.4), (2.2, 2.2), (2.4, 2.4)], []),
    ],
    ids=["frozen from one run on", "another value at each speed"],
)
def test_a_gps_that_holds_one_value_is_stuck_only_where_the_speed_differed(runs, lost):
    assert gps_lost(*runs) == lost


@pytest.mark.parametrize(("times", "unit"), [(3.6, "km/h"), (1.9438, "kn"), (0.53, "another unit")])
def test_a_column_in_another_unit_is_lost_once_for_all_runs(times, unit):
    runs = [sound(number, speed) for number, speed in enumerate((2.2, 2.4, 2.6), start=1)]
    runs = [
        sound(run.number, run.intended_m_s, log2=run.channels["log2"] * np.float32(times))
        for run in runs
    ]
    faults: list[Fault] = []
    kept, gone = without_other_units(runs, faults)
    assert gone == ["log2"]
    assert np.isnan([run.statistics["log2"].mean for run in kept]).all()
    assert [(fault.run, unit in fault.message) for fault in faults] == [(None, True)]


@pytest.mark.parametrize(
    ("changed", "code"),
    [
        (lambda c: {"log1": c["wind_speed"] * 2, "wind_speed": c["log1"]}, "swapped_columns"),
        (lambda c: {"log2": c["gps"].repeat(20)[:1000], "gps": c["log2"]}, "swapped_columns"),
        (lambda c: {"force": -c["force"]}, "negative_force"),
        (lambda c: {key: 3.6 * c[key] for key in ("log1", "log2", "gps")}, "speed_unit"),
    ],
    ids=["wind of 8 m/s as log1", "a receiver as log2", "force turned", "km/h"],
)
def test_a_mix_up_costs_the_tow_and_sound_runs_have_none(changed, code):
    runs = [sound(number) for number in (1, 2, 3)]
    check_mix_ups(runs)
    mixed = [sound(run.number, **changed(run.channels)) for run in runs]
    with pytest.raises(DefectiveFileError) as error:
        check_mix_ups(without_other_units(mixed, [])[0])
    assert error.value.reason_code == code
