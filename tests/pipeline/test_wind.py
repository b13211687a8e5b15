"""Wind: air parts by the two formulas, averaging, and the searched coefficients."""

import math

import numpy as np
import polars as pl
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pipeline.blocks.run_blocks import RunBlocks, WindowSums, stack_blocks
from pipeline.blocks.sums import block_sums
from pipeline.channels import SAMPLE_SCHEMA
from pipeline.steps.wind import (
    AirParts,
    average_terms,
    compute_air_parts,
    find_nearest_coefficients,
)

FRONT, SIDE = np.array([3.26]), np.array([9.0])
SPEED = 2.5


def blocks_of(wind_m_s, angle_deg, seconds=4, rate_hz=5) -> RunBlocks:
    n = seconds * rate_hz
    wind, angle = (pl.Series(np.broadcast_to(x, n)) for x in (wind_m_s, angle_deg))
    samples = pl.DataFrame({"wind_speed_m_s": wind, "wind_angle_deg": angle}).with_columns(
        run=1, log1_m_s=SPEED, log2_m_s=SPEED, gps_m_s=None, force_n=250.0
    )
    blocks = block_sums(samples.select(list(SAMPLE_SCHEMA)).cast(dict(SAMPLE_SCHEMA)), rate_hz)
    of_tow = blocks.with_columns(tow_id=pl.lit("t"))
    return stack_blocks(of_tow, of_tow.select("tow_id", "run").unique())


def parts(blocks: RunBlocks, model: str) -> AirParts:
    mean = WindowSums(blocks, blocks.n > 0).mean
    return compute_air_parts(
        np.array([model == "oblique"]), lambda n: mean(f"log1_{n}"), FRONT, SIDE
    )


@given(wind=st.floats(0.1, 12.0), angle=st.floats(0.0, 359.9))
def test_both_formulas_written_out(wind, angle):
    a = math.radians(float(np.float32(angle)))
    w = float(np.float32(wind))
    sign = math.copysign(1.0, math.cos(a))
    along2 = (w * math.cos(a)) ** 2
    blocks = blocks_of(wind, angle)
    head = parts(blocks, "head").total(np.array([0.5]), np.array([0.7]), 0.2)[0]
    cvt = 0.5 if sign > 0 else 0.7
    assert head * SPEED**2 == pytest.approx(1.225 / 2 * 3.26 * cvt * along2 * sign, abs=1e-9)
    oblique = parts(blocks, "oblique").total(np.array([0.5]), np.array([0.5]), 0.2)[0]
    area = 3.26 * abs(math.cos(a)) * 0.5 + 9.0 * abs(math.sin(a)) * 0.2
    assert oblique * SPEED**2 == pytest.approx(1.225 / 2 * area * along2 * sign, abs=1e-9)


def test_averaging_goes_round_north_and_keeps_the_speed_of_a_jittering_wind():
    angles = np.tile([350.0, 0.0, 10.0, 0.0, 0.0], 4)
    terms = average_terms(blocks_of(6.0, angles), 3)
    assert terms["head_ahead"] == pytest.approx(np.full((1, 4), 36.0), rel=1e-6)
    assert terms["head_behind"] == pytest.approx(np.zeros((1, 4)), abs=1e-12)
    assert terms["side"] == pytest.approx(np.zeros((1, 4)), abs=1e-4)


def test_coefficients_that_are_searched_stay_between_0_and_1():
    air = AirParts(
        np.array([4.0, 4.0, 4.0, 0.5, 0.0]), np.array([0.0, 0.0, 0.0, -2.0, 0.0]), np.zeros(5)
    )
    ahead, behind = find_nearest_coefficients(air, np.array([2.0, 9.0, -1.0, -1.0, 3.0]))
    assert ahead.tolist() == [0.5, 1.0, 0.0, 0.0, 0.0]
    assert behind.tolist() == [0.0, 0.0, 0.0, 0.5, 0.0]


@given(air=st.floats(1.0, 5.0), share=st.floats(0.01, 0.99), other=st.floats(-1e-6, -1e-9))
def test_a_coefficient_that_suffices_leaves_none_to_the_other(air, share, other):
    # What is left is rounding, and divided by a breath of wind it was anything from 0 to 1.
    parts = AirParts(np.array([air]), np.array([other]), np.zeros(1))
    ahead, behind = find_nearest_coefficients(parts, np.array([share * air]))
    assert ahead[0] == pytest.approx(share)
    assert behind[0] == 0.0
