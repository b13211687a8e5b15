"""A simulated world as the frames and arrays that `recompute` works on, without files."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
import polars as pl

from herijk.simulate import (
    RunTruth,
    Tow,
    World,
    WorldSettings,
    simulate_tow,
    simulate_world,
    true_cw_kg_m,
)
from pipeline.blocks.run_blocks import RunBlocks, stack_blocks
from pipeline.blocks.sums import block_sums
from pipeline.channels import (
    BACK,
    OUT,
    RUNS_PER_FILE,
    SECOND_FILE_OFFSET,
    TARGET_SPEED_RATIOS,
)
from pipeline.method.definition import Method
from pipeline.recompute.recompute import recompute
from pipeline.recompute.results import Recomputed

FREEBOARDS = ("freeboard_lowest_m", "freeboard_bow_m", "freeboard_stern_m")


@dataclass(frozen=True)
class Measured:
    """What is known of a world's tows, and beside it what is true.

    Attributes:
        tows: rows of the table `tows`, but for the columns about files.
        runs: rows of `tow_runs`.
        blocks: their blocks, stacked.
        truth: per tow the fields of `TowTruth`, with `season`.
        run_truth: what really happened in each run, by tow.
        nearest_b_m_s: B of the hyperbola nearest to the true curve at 15 C, by tow.
    """

    tows: pl.DataFrame
    runs: pl.DataFrame
    blocks: RunBlocks
    truth: pl.DataFrame
    run_truth: dict[str, tuple[RunTruth, ...]]
    nearest_b_m_s: dict[str, float]


def measure(settings: WorldSettings) -> Measured:
    """Simulates a world and adds its samples up."""
    world = simulate_world(settings)
    tows = tow_rows(world)
    runs = run_rows(tows, [tow.tow_id for tow in world.tows if tow.second_name])
    blocks, run_truth = [], {}
    for tow in world.tows:
        samples, run_truth[tow.tow_id] = simulate_tow(world, tow)
        tow_id = pl.lit(tow.tow_id).alias("tow_id")
        blocks.append(block_sums(samples, settings.rate_hz).select(tow_id, pl.all()))
    stacked = stack_blocks(pl.concat(blocks), runs)
    nearest = {
        tow.tow_id: nearest_hyperbola(tow.hull, tow.declared_speed_m_s, 15.0, settings.air)[1]
        for tow in world.tows
    }
    return Measured(tows, runs, stacked, truth_rows(world), run_truth, nearest)


def nearest_hyperbola(hull, declared_speed_m_s, temperature_c, air):
    """A and B of the hyperbola through the true Cw at 90, 100 and 110 %: linear in 1/Cw, v^2."""
    speeds = declared_speed_m_s * np.array(TARGET_SPEED_RATIOS)
    inverse_cw = 1.0 / true_cw_kg_m(hull, speeds, temperature_c, air)
    slope, intercept = np.polyfit(speeds**2, inverse_cw, 1)
    return 1.0 / intercept, np.sqrt(-intercept / slope)


STILL_AIR = {"wind_v": "log1_v", "wind_x": "log1_v", "wind_y": None, "wind_sin": None}
"""What blocks hold where no wind was measured: the boat's own speed from ahead, or nothing."""


def find_tows_without_gps(world: Measured, tows: np.ndarray) -> Measured:
    """The same world in which some tows, marked in shape (tows,), had no GPS on board."""
    lost = _runs_of(world, tows)
    sums = {
        name: np.where(lost & name.startswith("gps"), 0.0, values)
        for name, values in world.blocks.sums.items()
    }
    return replace(world, blocks=replace(world.blocks, sums=sums))


def without_wind(world: Measured, tows: np.ndarray) -> Measured:
    """The same world in which some tows, marked in shape (tows,), had no anemometer.

    Only for methods that average the wind: terms per sample stay as they were.
    """
    lost, sums = _runs_of(world, tows), dict(world.blocks.sums)
    still = {name: sums[own] if own else 0.0 for name, own in STILL_AIR.items()}
    for name, values in {**still, "wind_cos": world.blocks.n}.items():
        sums[name] = np.where(lost, values, sums[name])
    listed = world.tows.with_columns(wind_measured=pl.Series(~tows))
    return replace(world, tows=listed, blocks=replace(world.blocks, sums=sums))


def with_force_ratio(world: Measured, tows: np.ndarray, ratio: float) -> Measured:
    """The same world in which the force of some tows, marked in shape (tows,), is read x ratio."""
    changed, sums = _runs_of(world, tows), dict(world.blocks.sums)
    for name, power in {"force": 1, "log1_cw": 1, "log1_cw2": 2}.items():
        sums[name] = np.where(changed, sums[name] * ratio**power, sums[name])
    return replace(world, blocks=replace(world.blocks, sums=sums))


def _runs_of(world: Measured, tows: np.ndarray) -> np.ndarray:
    names = world.tows.filter(pl.Series(tows))["tow_id"].implode()
    return world.blocks.runs["tow_id"].is_in(names).to_numpy()[:, None]


def recompute_world(
    settings: WorldSettings, methods: Sequence[Method]
) -> tuple[Recomputed, pl.DataFrame]:
    """Tables of all methods, one below the other, and the truth of every tow."""
    measured = measure(settings)
    made = [recompute(method, measured.tows, measured.blocks) for method in methods]
    names = [field.name for field in fields(Recomputed) if field.name != "factors"]
    tables = {name: pl.concat([getattr(one, name) for one in made]) for name in names}
    return Recomputed(**tables, factors=None), measured.truth


def tow_rows(world: World) -> pl.DataFrame:
    """What the tow lists say."""
    return pl.DataFrame(
        [_tow_row(world, tow) for tow in world.tows], infer_schema_length=None
    ).with_columns(
        pl.col("season", "rowers", "sample_rate_hz").cast(pl.Int32),
        pl.col("speed_correction_ratio", "water_temperature_c", "salinity_g_kg", *FREEBOARDS).cast(
            pl.Float64
        ),
    )


def _tow_row(world: World, tow: Tow) -> dict[str, object]:
    return {
        "tow_id": tow.tow_id,
        "season": tow.season,
        "tow_date": tow.day,
        "fsn_no": tow.boat.fsn_no,
        "rowers": tow.rowers,
        "crew_class": tow.crew_class,
        "declared_speed_m_s": tow.declared_speed_m_s,
        "waterline_length_m": tow.boat.waterline_length_m,
        "beam_m": tow.boat.beam_m,
        "bow_height_m": tow.boat.bow_height_m,
        "weight_kg": tow.weight_kg,
        "weight_after_kg": tow.weight_after_kg,
        "crew_weight_kg": tow.crew_kg,
        "water_temperature_c": tow.listed_temperature_c,
        "salinity_g_kg": tow.salinity_g_kg or None,
        "speed_correction_ratio": None,
        "altered": tow.altered_reported,
        "sample_rate_hz": world.settings.rate_hz,
        **dict(zip(FREEBOARDS, tow.freeboards_m or (None,) * 3, strict=True)),
        "log1_part": 0,
        "log2_part": 0,
    }


def run_rows(tows: pl.DataFrame, two_files: Sequence[str] = ()) -> pl.DataFrame:
    """Six runs a tow, out at three speeds and back at the same; selected as the lists say."""
    runs = pl.DataFrame(
        {
            "run": range(1, RUNS_PER_FILE + 1),
            "direction": [OUT] * 3 + [BACK] * 3,
            "target_speed_ratio": TARGET_SPEED_RATIOS * 2,
        },
        schema_overrides={"run": pl.Int8, "direction": pl.Int8},
    )
    with_second = pl.col("tow_id").is_in(two_files)
    first = (
        tows.select("tow_id")
        .join(runs, how="cross")
        .with_columns((~with_second | (pl.col("direction") == OUT)).alias("selected"))
    )
    second = first.filter(with_second).with_columns(
        pl.col("run") + pl.lit(SECOND_FILE_OFFSET, pl.Int8),
        (pl.col("direction") == BACK).alias("selected"),
    )
    return pl.concat([first, second]).sort("tow_id", "run")


def truth_rows(world: World) -> pl.DataFrame:
    """What nobody was told."""
    return pl.DataFrame(
        [{"tow_id": t.tow_id, "season": t.season, **vars(t.truth)} for t in world.tows]
    ).with_columns(pl.col("season").cast(pl.Int32))
