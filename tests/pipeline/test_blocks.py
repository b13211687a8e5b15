"""Blocks give exactly the means over samples, whatever the rate and the length of the runs."""

import math

import numpy as np
import polars as pl
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pipeline.blocks.run_blocks import SUM_NAMES, WindowSums, stack_blocks
from pipeline.blocks.sums import block_sums
from pipeline.channels import SAMPLE_SCHEMA
from pipeline.errors import BrokenPromiseError

EXACT = 1e-12


def samples_of(lengths: list[int], seed: int = 1, gps: bool = True) -> pl.DataFrame:
    """Runs of so many samples each, with everything in the range of a tow."""
    rng = np.random.default_rng(seed)
    n = sum(lengths)
    values = {
        "run": np.repeat(np.arange(1, len(lengths) + 1), lengths),
        "log1_m_s": rng.uniform(1.5, 3.5, n),
        "log2_m_s": rng.uniform(1.5, 3.5, n),
        "gps_m_s": rng.uniform(1.5, 3.5, n),
        "force_n": rng.uniform(50.0, 900.0, n),
        "wind_speed_m_s": rng.uniform(0.0, 12.0, n),
        "wind_angle_deg": rng.uniform(0.0, 360.0, n),
    }
    frame = pl.DataFrame(
        {name: pl.Series(v).cast(SAMPLE_SCHEMA[name]) for name, v in values.items()}
    )
    return frame if gps else frame.with_columns(pl.lit(None, pl.Float32).alias("gps_m_s"))


def quantities(row: dict[str, float]) -> dict[str, float]:
    """Every summed quantity of one sample, written out from its definition."""
    force, wind = row["force_n"], row["wind_speed_m_s"]
    angle = math.radians(row["wind_angle_deg"])
    along, across = wind * math.cos(angle), wind * math.sin(angle)
    sign = "ahead" if along > 0 else "behind"
    air = {f"{term}_{side}": 0.0 for term in ("head", "front") for side in ("ahead", "behind")}
    air[f"head_{sign}"] = along * abs(along)
    air[f"front_{sign}"] = along * abs(along) * abs(math.cos(angle))
    air["side"] = along * abs(along) * abs(math.sin(angle))
    gps = row["gps_m_s"]
    found = {
        "force": force,
        "wind_v": wind,
        "wind_cos": math.cos(angle),
        "wind_sin": math.sin(angle),
        "wind_x": along,
        "wind_y": across,
        "gps": 0.0 if gps is None else gps,
        "gps_n": float(gps is not None),
        **air,
    }
    v = row["log1_m_s"]
    found |= {"log1_v": v, "log1_inv_v2": v**-2, "log2_v": row["log2_m_s"]}
    found |= {"log1_cw": force / v**2, "log1_cw2": (force / v**2) ** 2}
    return found | {f"log1_{name}": value / v**2 for name, value in air.items()}


def stacked(samples: pl.DataFrame, rate_hz: float):
    blocks = block_sums(samples, rate_hz).with_columns(pl.lit("t").alias("tow_id"))
    return stack_blocks(blocks, samples.select(pl.lit("t").alias("tow_id"), "run").unique())


@given(
    rate_hz=st.sampled_from([5, 7, 20, 33]),
    lengths=st.lists(st.integers(1, 120), min_size=1, max_size=4),
    window=st.tuples(st.integers(0, 6), st.integers(1, 25)),
    gps=st.booleans(),
    seed=st.integers(0, 1000),
)
def test_every_window_mean_is_that_over_samples(rate_hz, lengths, window, gps, seed):
    samples = samples_of(lengths, seed, gps)
    blocks = stacked(samples, rate_hz)
    start, end = window[0], window[0] + window[1]
    second = np.arange(blocks.seconds)
    mask = np.broadcast_to((second >= start) & (second < end), blocks.n.shape)
    sums = WindowSums(blocks, mask)
    for i, run in enumerate(samples["run"].unique().sort()):
        rows = samples.filter(pl.col("run") == run).rows(named=True)
        chosen = [quantities(r) for k, r in enumerate(rows) if start * rate_hz <= k < end * rate_hz]
        assert sums.count[i] == len(chosen)
        for name in SUM_NAMES:
            values = [q[name] for q in chosen]
            size = math.fsum(map(abs, values)) / max(len(values), 1)
            mean = math.fsum(values) / max(len(values), 1)
            assert abs(sums.mean(name)[i] - mean) <= EXACT * size, name


@given(
    share=st.floats(0.01, 0.999),
    channel=st.sampled_from([c for c in SAMPLE_SCHEMA if c not in ("run", "gps_m_s")]),
    seed=st.integers(0, 99),
)
def test_samples_that_are_no_numbers_are_left_out_however_many(share, channel, seed):
    samples = samples_of([400, 300, 350], seed)
    gone = np.random.default_rng(seed).random(len(samples)) < share
    values = np.where(gone, np.float32(np.nan), samples[channel].to_numpy())
    found = block_sums(samples.with_columns(pl.Series(channel, values)), 5)
    whole = samples.with_columns(
        second=pl.int_range(pl.len()).over("run") // 5, left=~pl.Series(gone)
    )
    expected = whole.group_by("run", "second", maintain_order=True).agg(
        n=pl.col("left").sum(), force=pl.col("force_n").cast(pl.Float64).filter("left").sum()
    )
    in_run = whole.group_by("run").agg(pl.col("left").any())["left"]
    if channel == "log2_m_s" and not in_run.all():  # without log 2 a run reads as log 1
        return
    assert found["n"].to_list() == expected["n"].to_list()
    assert found.select(pl.selectors.float().is_finite().all()).row(0) == (True,) * len(SUM_NAMES)
    if channel != "force_n":
        assert np.allclose(found["force"], expected["force"], rtol=EXACT)


def test_a_run_without_blocks_breaks_a_promise():
    blocks = block_sums(samples_of([20]), 10).with_columns(pl.lit("t").alias("tow_id"))
    runs = pl.DataFrame({"tow_id": ["t", "t"], "run": pl.Series([1, 2], dtype=pl.Int8)})
    with pytest.raises(BrokenPromiseError, match="tow t, run 2"):
        stack_blocks(blocks, runs)
