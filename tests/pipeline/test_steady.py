"""The steady window: what is cut and why, on runs made of blocks with known disturbances."""

from collections.abc import Sequence

import numpy as np
import polars as pl
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pipeline.arrays import FloatArray
from pipeline.blocks.run_blocks import RunBlocks
from pipeline.steps.window import Windows, find_steady_windows, take_whole_runs
from pipeline.tables.keys import HAND_COLUMNS

SECONDS = 50
SAMPLES = 20
Hand = tuple[int, int, str] | None


class Run:
    """A run in means of each second: 2.5 m/s, 250 N, wind of 4 m/s, and a little noise."""

    def __init__(self, seconds: int = SECONDS, seed: int = 1) -> None:
        rng = np.random.default_rng(seed)
        self.speed = 2.5 + rng.normal(0, 0.003, seconds)
        self.force = 250 + rng.normal(0, 1.0, seconds)
        self.wind_x = 4 + rng.normal(0, 0.1, seconds)
        self.wind_y = rng.normal(0, 0.1, seconds)


def blocks_of(runs: Sequence[Run], hand: Sequence[Hand] | None = None) -> RunBlocks:
    shape = (len(runs), max(len(run.speed) for run in runs))

    def stacked(rows: Sequence[FloatArray]) -> FloatArray:
        array = np.zeros(shape)
        for row, values in zip(array, rows, strict=True):
            row[: len(values)] = values * SAMPLES
        return array

    sums = {
        "log1_v": stacked([run.speed for run in runs]),
        "force": stacked([run.force for run in runs]),
        "wind_x": stacked([run.wind_x for run in runs]),
        "wind_y": stacked([run.wind_y for run in runs]),
        "wind_v": stacked([np.hypot(run.wind_x, run.wind_y) for run in runs]),
    }
    frame = pl.DataFrame({"tow_id": ["t"] * len(runs), "run": range(1, len(runs) + 1)})
    if hand is not None:
        given = [(None, None, None) if window is None else window for window in hand]
        names = list(HAND_COLUMNS.values())
        schema = dict(zip(names, (pl.Int16(), pl.Int16(), pl.String()), strict=True))
        frame = frame.hstack(pl.DataFrame(given, schema=schema, orient="row"))
    return RunBlocks(frame, stacked([np.ones(len(run.speed)) for run in runs]), sums)


def window_of(run: Run) -> tuple[int, int, str]:
    found = find_steady_windows(blocks_of([run]))
    assert found.exists[0]
    return int(found.start_s[0]), int(found.end_s[0]), found.reasons[0]


def test_a_clean_run_is_kept_whole():
    assert window_of(Run()) == (0, SECONDS, "")


@pytest.mark.parametrize("backwards", [False, True])
def test_a_ramp_is_cut_with_its_tail(backwards: bool):
    run = Run()
    run.speed[:8] -= np.linspace(0.3, 0.04, 8)
    if backwards:
        run.speed = run.speed[::-1]
    start, end, reason = window_of(run)
    cut, kept = (SECONDS - end, start) if backwards else (start, SECONDS - end)
    assert 8 <= cut <= 14
    assert (kept, reason) == (0, "speed_drift")


@pytest.mark.parametrize(
    ("channel", "size", "code"), [("force", 60, "force_peak"), ("wind_y", 5, "gust")]
)
def test_a_peak_near_an_end_is_cut_and_one_in_the_middle_cannot_be(
    channel: str, size: float, code: str
):
    early, middle = Run(), Run()
    getattr(early, channel)[4:7] += size
    getattr(middle, channel)[24:26] += size
    start, end, reason = window_of(early)
    assert 7 <= start <= 9
    assert (end, reason) == (SECONDS, code)
    start, end, _ = window_of(middle)
    assert start < 24
    assert end > 26


def test_ends_that_differ_are_cut_though_no_ramp_or_peak_is_seen():
    run = Run()
    run.wind_x += np.tile([1.0, -1.0], SECONDS // 2)
    run.wind_x[-6:] += 2.0
    start, end, reason = window_of(run)
    assert (start, reason) == (0, "ends_differ")
    assert 42 <= end < SECONDS


def test_wind_and_force_that_rise_are_cut_to_equal_ends_or_said_by_how_much():
    dropping, rising, stronger = Run(), Run(), Run()
    dropping.wind_x[:8] += 1.6
    rising.wind_x += np.linspace(0, 4, SECONDS)
    stronger.force *= np.linspace(0.8, 1.2, SECONDS)
    found = find_steady_windows(blocks_of([dropping, rising, stronger]))
    over = found.ends_ratio
    assert over[0] <= 1.0
    assert found.start_s[0] >= 5
    assert found.wind_rise_m_s[1] == pytest.approx(over[1])
    assert 1.8 < over[1] < 2.2  # of the shortest window, 30 s: 4 * 25 / 49
    assert 0.17 < found.force_rise_ratio[2] < 0.22  # 0.4 * 25 / 49
    assert over[2] == pytest.approx(found.force_rise_ratio[2] / 0.1)


@settings(max_examples=40, deadline=None)
@given(st.integers(1, 48), st.integers(1, 4), st.integers(0, 99))
def test_seconds_without_samples_are_left_out_and_cut_nothing(at: int, gone: int, seed: int):
    blocks = blocks_of([Run(seed=seed)])
    lost = slice(at, min(at + gone, 49))
    sums = {name: values.copy() for name, values in blocks.sums.items()}
    n = blocks.n.copy()
    for values in (n, *sums.values()):
        values[:, lost] = 0.0
    found = find_steady_windows(RunBlocks(blocks.runs, n, sums))
    assert (found.start_s[0], found.end_s[0]) == (0, SECONDS)


def assert_none(found: Windows, run: int = 0) -> None:
    assert not found.exists[run]
    assert not found.mask[run].any()
    assert found.start_s[run] == found.end_s[run] == 0


@pytest.mark.parametrize("rise", [0.5, 0.8])
def test_speed_that_rises_all_the_time_leaves_no_window(rise: float):
    run = Run()
    run.speed += np.linspace(-rise / 2, rise / 2, SECONDS)
    found = find_steady_windows(blocks_of([run]))
    assert_none(found)
    assert found.reasons[0] != ""


def test_a_run_shorter_than_the_minimum_has_no_window_but_may_count_whole():
    runs = blocks_of([Run(0), Run(29), Run(30), Run()])
    found, whole = find_steady_windows(runs), take_whole_runs(runs)
    assert_none(found, run=1)
    assert found.end_s.tolist() == [0, 0, 30, SECONDS]
    assert_none(whole, run=0)
    assert (whole.end_s.tolist(), set(whole.reasons)) == ([0, 29, 30, SECONDS], {""})


disturbed = st.tuples(
    st.integers(0, 2**20),
    st.integers(0, 60),
    st.lists(
        st.tuples(
            st.sampled_from(["speed", "force", "wind_x", "wind_y"]),
            st.integers(0, 59),
            st.integers(1, 20),
            st.floats(-3, 3),
        ),
        max_size=4,
    ),
)
SIZES = {"speed": 0.1, "force": 30.0, "wind_x": 2.0, "wind_y": 2.0}


def disturbed_run(draw: tuple[int, int, list[tuple[str, int, int, float]]]) -> Run:
    seed, seconds, disturbances = draw
    run = Run(seconds, seed)
    for channel, start, length, size in disturbances:
        getattr(run, channel)[start : start + length] += size * SIZES[channel]
    return run


@settings(max_examples=60, deadline=None)
@given(st.lists(disturbed, min_size=1, max_size=5))
def test_a_window_is_contiguous_inside_the_run_and_never_too_short(
    draws: list[tuple[int, int, list[tuple[str, int, int, float]]]],
):
    runs = [disturbed_run(draw) for draw in [*draws, (0, 60, [])]]
    blocks = blocks_of(runs)
    found = find_steady_windows(blocks)
    second = np.arange(blocks.seconds)
    between = (second >= found.start_s[:, None]) & (second < found.end_s[:, None])
    assert np.array_equal(found.mask, between)
    assert not (found.mask & (blocks.n == 0)).any()
    length = found.mask.sum(axis=1)
    assert ((length == 0) | (length >= 30)).all()
    assert np.array_equal(found.exists, length > 0)
    whole = length == (blocks.n > 0).sum(axis=1)
    assert all(reason == "" for reason, kept in zip(found.reasons, whole, strict=True) if kept)


def test_a_window_given_by_hand_holds_whatever_the_rule_would_cut_if_it_is_long_enough():
    peaked = Run()
    peaked.force[4:6] += 60
    by_hand = [(0, 45, "zwaan"), None, (5, 34, "kort"), (5, 35, "net")]
    blocks = blocks_of([peaked, Run(), Run(), Run()], by_hand)
    found = find_steady_windows(blocks)
    assert found.start_s.tolist() == [0, 0, 0, 5]
    assert found.end_s.tolist() == [45, SECONDS, 0, 35]
    assert found.reasons == ("by_hand: zwaan", "", "by_hand: kort", "by_hand: net")
    assert take_whole_runs(blocks).end_s.tolist() == 4 * [SECONDS]
