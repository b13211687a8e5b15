"""The quick look for a stuck instrument overlooks no stretch that the whole search finds."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from warehouse.archive.faults import Fault
from warehouse.archive.plausibility.run import Run
from warehouse.archive.plausibility.whole_runs import (
    _longest_hold,
    _may_hold,
    without_stuck_gps,
)


@given(values=st.lists(st.integers(0, 2), min_size=2, max_size=80), samples=st.integers(2, 30))
def test_a_stretch_is_never_overlooked(values, samples):
    channel = np.array(values, np.float32)
    assert _longest_hold(channel)[1] < samples or _may_hold(channel, samples)


def test_a_channel_that_moves_is_not_searched():
    assert not _may_hold(np.arange(100, dtype=np.float32), 10)


def runs(*spoken: tuple[float, float]) -> list[Run]:
    """Steady runs by intended speed and what the GPS holds; 0 is one that moves."""
    log, moving = np.full(500, 2.4, np.float32), np.linspace(2.3, 2.5, 500, dtype=np.float32)
    return [
        Run(
            *("2015-001", number, "a.csv", 1, 10, intended, 50.0),
            {"log1": log, "gps": log * 0 + held if held else moving},
        )
        for number, (intended, held) in enumerate(spoken, start=1)
    ]


def without_gps(*spoken: tuple[float, float]) -> list[int]:
    faults: list[Fault] = []
    kept = without_stuck_gps(runs(*spoken), faults)
    lost = [run.number for run in kept if np.isnan(run.channels["gps"]).all()]
    assert len(faults) == len(lost)
    return lost


def test_a_gps_frozen_from_one_run_on_is_lost_of_all_of_these():
    assert without_gps((2.2, 0), (2.4, 0), (2.6, 2.43), (2.2, 2.43), (2.4, 2.43), (2.6, 2.43)) == [
        3, 4, 5, 6,
    ]  # fmt: skip


def test_a_gps_that_holds_another_value_at_each_speed_may_be_right():
    assert without_gps((2.2, 2.2), (2.4, 2.4), (2.2, 2.2), (2.4, 2.4)) == []
