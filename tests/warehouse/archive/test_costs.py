"""A fault costs what it touches: what is kept of a tow gives the Cw that it had before."""

import numpy as np
import polars as pl
import pytest

from herijk.simulate import WorldSettings, simulate_tow, simulate_world
from pipeline.blocks.run_blocks import stack_blocks
from pipeline.blocks.sums import block_sums
from pipeline.method.reading import read_shipped_method
from pipeline.recompute.recompute import recompute
from tests.worlds import run_rows, tow_rows
from warehouse.archive.plausibility import LEFT_OUT_S, judge_samples

RATE_HZ = 20
BOATS = 3
FAULTS = 80
SPEEDS = ("log1_m_s", "log2_m_s", "gps_m_s")
KINDS = ("dropout", "not a number", "spike", "push", "dead", "gust", "vane", "rows")


def spoil(samples: pl.DataFrame, kind: str, rows: slice, rng: np.random.Generator) -> pl.DataFrame:
    """The samples with a fault of a kind, of random size, in some rows."""
    every = samples.columns[1:]
    channels, change = {
        "dropout": ([rng.choice(SPEEDS)], lambda x: 0 * x + rng.uniform(0, 0.1)),
        "not a number": ([rng.choice(every)], lambda x: x * np.nan),
        "spike": ([rng.choice(SPEEDS)], lambda x: x * rng.uniform(1.5, 50)),
        "push": (["force_n"], lambda x: x * rng.choice([-1, 1]) * rng.uniform(6, 1000)),
        "dead": (["force_n"], lambda x: 0 * x + rng.uniform(-2, 2)),
        "gust": (["wind_speed_m_s"], lambda x: x + rng.uniform(25, 500)),
        "vane": (["wind_angle_deg"], lambda x: 0 * x + rng.uniform(400, 9000)),
        "rows": (every, lambda x: x * np.nan),
    }[kind]
    changed = {}
    for name in channels:
        values = samples[name].to_numpy().copy()
        values[rows] = change(values[rows])
        changed[name] = values
    return samples.with_columns(pl.Series(name, values) for name, values in changed.items())


def plant(samples: pl.DataFrame, kind: str, rng: np.random.Generator) -> tuple[pl.DataFrame, float]:
    """The samples with a fault somewhere in a run, and its length in seconds."""
    length_s = rng.uniform(3.0, 30.0) if rng.random() < 0.3 else rng.uniform(0.15, 1.9)
    length = max(3, round(length_s * RATE_HZ))
    start = int(rng.integers(6)) * 50 * RATE_HZ + int(rng.integers(50 * RATE_HZ - length))
    return spoil(samples, kind, slice(start, start + length), rng), length / RATE_HZ


@pytest.fixture(scope="module")
def judged() -> pl.DataFrame:
    """Every planted fault: kind, length, what was said to be lost, and Cw over that without it."""
    rng = np.random.default_rng(1)
    world = simulate_world(WorldSettings((2015,), BOATS, RATE_HZ, 4))
    clean = [simulate_tow(world, tow)[0] for tow in world.tows]
    listed_tows = tow_rows(world).with_columns(
        samples_path=pl.lit("x.csv"), second_path=pl.lit(None, pl.String)
    )
    tows, blocks, planted = [], [], []
    for number in range(-BOATS, FAULTS):
        boat = number % BOATS
        kind, length_s, samples = "none", 0.0, clean[boat]
        if number >= 0:
            kind = KINDS[number % len(KINDS)]
            samples, length_s = plant(samples, kind, rng)
        tow_id = pl.lit(f"{boat} {number + BOATS:03}").alias("tow_id")
        tow = listed_tows[boat].with_columns(tow_id)
        runs = run_rows(tow).with_columns(planned_s=50.0)
        found = judge_samples(samples, lambda row: ("x.csv", row + 2), tow.row(0, named=True), runs)
        lost = ",".join(sorted({str(fault.lost) for fault in found.faults}))
        planted.append((tow["tow_id"][0], kind, length_s, lost))
        tows.append(tow)
        blocks.append(block_sums(found.samples, RATE_HZ).select(tow_id, pl.all()))
    together, listed = pl.concat(blocks), pl.concat(tows)
    runs = run_rows(listed).join(together, on=["tow_id", "run"], how="semi")
    made = recompute(read_shipped_method("rebased-2015"), listed, stack_blocks(together, runs))
    random = made.uncertainty_budget.filter(component="random").select("tow_id", "u_ratio")
    found = (
        pl.DataFrame(planted, schema=["tow_id", "kind", "length_s", "lost"], orient="row")
        .join(made.curves.select("tow_id", "cw_kg_m", "runs_used"), on="tow_id")
        .join(random, on="tow_id")
        .with_columns(pl.col("tow_id").str.head(1).alias("boat"))
    )
    of_clean = found.filter(kind="none").select("boat", cw="cw_kg_m", u="u_ratio")
    return (
        found.filter(pl.col("kind") != "none")
        .join(of_clean, on="boat")
        .with_columns(off=(pl.col("cw_kg_m") / pl.col("cw") - 1).abs() / pl.col("u"))
    )


def test_every_planted_fault_is_said(judged):
    assert judged.height == FAULTS
    assert judged.filter(lost="").is_empty()


def test_short_faults_cost_seconds_and_move_cw_by_less_than_its_random_error(judged):
    short = judged.filter(pl.col("length_s") <= LEFT_OUT_S)
    assert set(short["lost"]) == {"seconds"}
    assert short["off"].max() < 1.0
    assert short["runs_used"].min() >= judged["runs_used"].max() - 1


def test_long_faults_cost_a_run_or_a_spare_channel_and_cw_stays_in_its_interval(judged):
    long = judged.filter(pl.col("length_s") > LEFT_OUT_S)
    assert set(long["lost"]) == {"run", "seconds"}
    assert long["off"].max() < 2.0
    assert long["cw_kg_m"].null_count() == 0
