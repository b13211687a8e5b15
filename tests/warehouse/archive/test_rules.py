"""Each rule on a run fires where it should, and a sound run breaks none."""

import numpy as np
import pytest

from warehouse.archive.faults import DefectiveFileError
from warehouse.archive.judgement import SPARE, Judgement, Run
from warehouse.archive.plausibility import (
    RULES,
    apply_rules,
    clipped_percent,
    held_s,
    leave_out_stuck_gps,
    mean,
)
from warehouse.archive.plausibility import _check_whole_tow as check_mix_ups

RATE_HZ = 20
TOW = {"tow_id": "2015-001"}
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
    return Run(number, 0, RATE_HZ, intended_m_s, 50.0, channels | changed)


def judged(*runs: Run) -> Judgement:
    """Runs of a tow of which nothing was said yet."""
    return Judgement(TOW, lambda row: ("a.csv", row + 2), len(runs), list(runs))


BREAKS = {
    held_s: lambda values, rule: np.where(np.arange(1000) < 25 * RATE_HZ, values[0], values),
    clipped_percent: lambda values, rule: np.minimum(values, np.float32(235)),
    mean: lambda values, rule: values * (
        -1 if rule.reason_code == "negative_force" else 100 if rule.channel == "force" else 10
    ),
}  # fmt: skip
"""How what is measured comes out of its limits: a rule that measures something else needs one."""


def test_a_sound_run_breaks_no_rule():
    judgement = judged(sound())
    apply_rules(judgement, judgement.runs[0])
    assert not judgement.faults


@pytest.mark.parametrize("rule", RULES, ids=lambda r: f"{r.channel} {r.measure.__name__}")
def test_each_rule_costs_the_run_or_the_spare_channel(rule):
    run = sound()
    low, high = rule.limits.times(SPEED_M_S, SPEED_M_S)
    assert low <= rule.measure(run, rule.channel)[0] < high
    values = BREAKS[rule.measure](run.channels[rule.channel], rule).astype(np.float32)
    judgement = judged(sound(**{rule.channel: values}))
    run = judgement.runs[0]
    apply_rules(judgement, run)
    (fault,) = judgement.faults
    assert fault.reason_code == rule.reason_code
    if rule.channel in SPARE:
        assert (fault.lost, judgement.runs) == ("seconds", [run])
        assert np.isnan(run.channels[rule.channel]).all()
    else:
        assert (fault.lost, judgement.runs) == ("run", [])


def gps_lost(*runs: tuple[float, float]) -> list[int]:
    """Runs that lose their GPS, by intended speed and what it holds; 0 is one that moves."""
    steady = []
    for number, (intended, held) in enumerate(runs, start=1):
        channels = {"log1": np.full(1000, intended, np.float32)}
        if held:
            channels["gps"] = np.full(1000, held, np.float32)
        steady.append(sound(number, intended, **channels))
    judgement = judged(*steady)
    leave_out_stuck_gps(judgement)
    lost = [run.number for run in judgement.runs if np.isnan(run.channels["gps"]).all()]
    assert [fault.run for fault in judgement.faults] == lost
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
    check_mix_ups(judged(*runs))
    judgement = judged(*(sound(run.number, **changed(run.channels)) for run in runs))
    with pytest.raises(DefectiveFileError) as error:
        check_mix_ups(judgement)
    assert error.value.reason_code == code
