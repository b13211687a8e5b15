"""A fleet of one type with known truth, as tables; repetitions are in the column `method`."""

import datetime as dt

import numpy as np
import polars as pl

from pipeline import curve
from pipeline.consistency.components import variance_components
from pipeline.consistency.eras import era_shifts
from pipeline.consistency.lines import type_lines
from pipeline.consistency.observed import observe
from pipeline.consistency.repeats import repeat_pairs, reproducibility
from pipeline.consistency.tables import type_tables
from pipeline.consistency.tow_speed import slow_tows
from pipeline.tables.lake import ListedRaces

RUN_RATIOS = np.array([0.9, 1.0, 1.1, 0.9, 1.0, 1.1])
POWER = 0.8
CREW_KG = 760.0
NO_RACES = ListedRaces.create_empty()


def fleet(
    seed,
    repetitions=1,
    boats=12,
    seasons=(2016,),
    noise=0.02,
    b_cv=0.0,
    height_sd=0.0,
    season_sd=0.0,
    tow_sd=0.0,
    zero_sd_n=0.0,
    weights_kg=None,
    speeds_m_s=None,
    boat_type="like",
):
    """Curves, tows, boats and run points: every boat is towed once in every season.

    Cw at 2.5 m/s is 35 kg/m at a displacement of 1,800 kg and grows with its power 0.8; B = 4.6 m/s
    with a coefficient of variation b_cv, independent of weight and tow speed.
    """
    rng = np.random.default_rng(seed)
    boat, season = (x.ravel() for x in np.meshgrid(np.arange(boats), seasons, indexing="ij"))
    n = len(boat)
    weights = rng.normal(1000, 80, boats) if weights_kg is None else np.asarray(weights_kg, float)
    speeds = rng.uniform(2.4, 2.6, boats) if speeds_m_s is None else np.asarray(speeds_m_s)
    v0 = speeds[boat]
    tow_id = [f"{s}-{b:03d}" for b, s in zip(boat, season, strict=True)]
    fsn = [f"FSN{b:03d}" for b in range(boats)]

    b = 4.6 * np.exp(b_cv * rng.normal(size=(repetitions, boats)))
    height = height_sd * rng.normal(size=(repetitions, boats))
    shift = season_sd * rng.normal(size=(repetitions, len(seasons)))
    own = tow_sd * rng.normal(size=(repetitions, n))
    level = height[:, boat] + shift[:, np.searchsorted(seasons, season)] + own
    heavy = np.nan_to_num((weights + CREW_KG) / 1800.0, nan=1.0)[boat] ** POWER
    s = 1.0 / b[:, boat] ** 2
    a = 35.0 * np.exp(level) * heavy * (1.0 - s * 2.5**2)
    speed = v0[:, None] * RUN_RATIOS * rng.normal(1.0, 0.005, (repetitions, n, 6))
    cw = curve.cw(a[..., None], s[..., None], speed)
    cw *= 1.0 + noise * rng.normal(size=cw.shape)
    cw += zero_sd_n * rng.normal(size=(repetitions, n, 1)) / speed**2

    tows = pl.DataFrame(
        {
            "tow_id": tow_id,
            "fsn_no": [fsn[b] for b in boat],
            "tow_date": [dt.date(int(y), 2, 1) for y in season],
            "altered": [False] * n,
            "declared_speed_m_s": v0,
            "weight_kg": weights[boat],
            "crew_weight_kg": np.full(n, CREW_KG),
            "waterline_length_m": np.full(n, 8.2),
            "beam_m": np.full(n, 2.2),
        }
    ).with_columns(pl.col("weight_kg").fill_nan(None))
    run_points = pl.DataFrame(
        {
            "method": np.repeat([f"m{r:04d}" for r in range(repetitions)], n * 6),
            "tow_id": np.tile(np.repeat(tow_id, 6), repetitions),
            "run": np.tile(np.arange(1, 7, dtype=np.int8), repetitions * n),
            "used": np.ones(repetitions * n * 6, bool),
            "speed_m_s": speed.ravel(),
            "cw_kg_m": cw.ravel(),
        }
    )
    flat = speed.reshape(-1, 6), cw.reshape(-1, 6)
    curves = pl.DataFrame(
        {
            "method": np.repeat([f"m{r:04d}" for r in range(repetitions)], n),
            "tow_id": np.tile(tow_id, repetitions),
            "fsn_no": np.tile(np.array(fsn)[boat], repetitions),
            "season": np.tile(season.astype(np.int32), repetitions),
            "rowers": np.full(repetitions * n, 8, np.int32),
            "crew_class": ["H"] * (repetitions * n),
            "declared_speed_m_s": np.tile(v0, repetitions),
        }
    ).with_columns(*_fitted(*flat, np.tile(v0, repetitions)))
    boat_table = pl.DataFrame(
        {"fsn_no": fsn, "boat_type": pl.Series([boat_type] * boats, dtype=pl.String)}
    )
    return curves, tows, boat_table, run_points


def _fitted(speed, cw, v0):
    points = curve.Points.of(speed, cw)
    fitted = curve.fit(points)
    scatter = curve.own_scatter(fitted)
    at = fitted.cw_at(v0)
    interval = curve.cw_interval(points, fitted, scatter, v0)
    b = np.where(fitted.b_determined, fitted.b_m_s, np.nan)
    yield pl.Series("a_kg_m", fitted.a_kg_m)
    yield pl.Series("b_m_s", b).fill_nan(None)
    yield from (pl.lit(None, pl.Float64).alias(name) for name in ("b_lo_m_s", "b_hi_m_s"))
    yield pl.Series("cw_kg_m", at)
    yield pl.Series("cw_lo_kg_m", interval.lo)
    yield pl.Series("cw_hi_kg_m", interval.hi)
    yield pl.lit(None, pl.Float64).alias("cw_others_kg_m")
    yield pl.Series("power_w", at * v0**3 / 8)
    yield pl.Series("b_capped", np.zeros(len(v0), bool))
    yield pl.Series("status", ["accepted"] * len(v0))
    yield pl.Series("flags", [[]] * len(v0), dtype=pl.List(pl.String))


def newest_lines(observed):
    """Rows of the table `type_lines` of the newest tows."""
    return type_lines(observed)[0].filter(tows="newest")


def consistency_tables(curves, tows, boats, run_points):
    """All tables of the analysis but the lines, without races."""
    observed, pairs = observe(curves, tows, boats, run_points), repeat_pairs(curves, tows)
    return type_tables(observed) | {
        "variance_components": variance_components(observed),
        "slow_tows": slow_tows(observed, NO_RACES),
        "repeat_pairs": pairs,
        "era_shifts": era_shifts(pairs, boats),
        "reproducibility": reproducibility(pairs, observed),
    }
