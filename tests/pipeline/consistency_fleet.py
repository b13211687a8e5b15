"""A fleet of one type with known truth, as tables; repetitions are in the column `method`."""

import datetime as dt

import numpy as np
import polars as pl

from pipeline import curve
from pipeline.consistency.compared import type_tables
from pipeline.consistency.observed import observe
from pipeline.consistency.prediction import predict_cw
from pipeline.consistency.repeats import era_shifts, repeat_pairs, reproducibility
from pipeline.consistency.types import compare_types
from pipeline.quantiles import NORMAL
from pipeline.tables.lake import ListedRaces

RUN_RATIOS = np.array([0.9, 1.0, 1.1, 0.9, 1.0, 1.1])
POWER = 0.8
CREW_KG = {"H": 760.0, "D": 600.0}
WOMENS_SPEED_RATIO = 0.88
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
    women=0,
    boat_off=0.0,
    hump=0.0,
    log_exponent_sd=0.0,
    interval_ratio=1.0,
    seasons_in_turn=False,
    others=0,
):
    """Curves, tows, boats and run points: every boat is towed once in every season.

    Cw at 2.5 m/s is 35 kg/m at a displacement of 1,800 kg and grows with its power 0.8; B = 4.6 m/s
    with a coefficient of variation b_cv, independent of weight and tow speed.

    Args:
        noise, tow_sd, season_sd: errors of ln Cw of a run, a tow and a season.
        zero_sd_n, log_exponent_sd: of the load cell, and of the power of the true speed that the
            log reads, from tow to tow.
        interval_ratio: how much of their errors the intervals of tows say.
        b_cv, height_sd: spread between boats in B and in ln Cw.
        women: so many of the last boats have women's crews, lighter and towed slower.
        boat_off: boat 0 lies so far off in ln Cw.
        hump: of that height in ln Cw near 2.9 m/s, so that hulls are no hyperbolas.
        seasons_in_turn: every boat is towed in one of the seasons.
        others: so many boats of no known type are towed in two of the seasons.
    """
    rng = np.random.default_rng(seed)
    in_turn = [(b, seasons[b % len(seasons)]) for b in range(boats)]
    towed = in_turn if seasons_in_turn else [(b, s) for b in range(boats) for s in seasons]
    for other in range(others):
        twice = (seasons[other % len(seasons)], seasons[(other + 1) % len(seasons)])
        towed += [(boats + other, season) for season in twice]
    of_type = boats
    boats += others
    boat, season = (np.array(column) for column in zip(*towed, strict=True))
    n = len(boat)
    weights = rng.normal(1000, 80, boats) if weights_kg is None else np.asarray(weights_kg, float)
    speeds = rng.uniform(2.4, 2.6, boats) if speeds_m_s is None else np.asarray(speeds_m_s)
    is_woman = (np.arange(boats) >= of_type - women) & (np.arange(boats) < of_type)
    crew_class = np.where(is_woman, "D", "H")
    crew_kg = np.array([CREW_KG[name] for name in crew_class])
    speeds = np.where(crew_class == "D", WOMENS_SPEED_RATIO, 1.0) * speeds
    v0 = speeds[boat]
    tow_id = [f"{s}-{b:03d}" for b, s in zip(boat, season, strict=True)]
    fsn = [f"FSN{b:03d}" for b in range(boats)]

    b = 4.6 * np.exp(b_cv * rng.normal(size=(repetitions, boats)))
    height = height_sd * rng.normal(size=(repetitions, boats))
    shift = season_sd * rng.normal(size=(repetitions, len(seasons)))
    own = tow_sd * rng.normal(size=(repetitions, n))
    level = height[:, boat] + shift[:, np.searchsorted(seasons, season)] + own
    level += np.where(boat == 0, boat_off, 0.0)
    heavy = np.nan_to_num((weights + crew_kg) / 1800.0, nan=1.0)[boat] ** POWER
    s = 1.0 / b[:, boat] ** 2
    a = 35.0 * np.exp(level) * heavy * (1.0 - s * 2.5**2)
    speed = v0[:, None] * RUN_RATIOS * rng.normal(1.0, 0.005, (repetitions, n, 6))
    cw = curve.cw(a[..., None], s[..., None], speed)
    cw *= np.exp(hump * np.exp(-0.5 * ((speed - 2.9) / 0.15) ** 2))
    cw *= 1.0 + noise * rng.normal(size=cw.shape)
    if log_exponent_sd:
        exponent = 1.0 + log_exponent_sd * rng.normal(size=(repetitions, n, 1))
        read = v0[:, None] * (speed / v0[:, None]) ** exponent
        cw *= (speed / read) ** 2
        speed = read
    cw += zero_sd_n * rng.normal(size=(repetitions, n, 1)) / speed**2

    tows = pl.DataFrame(
        {
            "tow_id": tow_id,
            "fsn_no": [fsn[b] for b in boat],
            "tow_date": [dt.date(int(y), 2, 1) for y in season],
            "altered": [False] * n,
            "declared_speed_m_s": v0,
            "weight_kg": weights[boat],
            "crew_weight_kg": crew_kg[boat],
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
            "crew_class": np.tile(crew_class[boat], repetitions),
            "declared_speed_m_s": np.tile(v0, repetitions),
        }
    ).with_columns(*_fitted(*flat, np.tile(v0, repetitions), tow_sd * interval_ratio))
    types = [boat_type] * of_type + [None] * others
    boat_table = pl.DataFrame({"fsn_no": fsn, "boat_type": pl.Series(types, dtype=pl.String)})
    return curves, tows, boat_table, run_points


def _fitted(speed, cw, v0, tow_sd):
    points = curve.Points.from_arrays(speed, cw)
    fitted = curve.fit(points)
    scatter = curve.own_scatter(fitted)
    at = fitted.cw_at(v0)
    interval = curve.cw_interval(points, fitted, scatter, v0)
    b = np.where(fitted.b_determined, fitted.b_m_s, np.nan)
    yield pl.Series("a_kg_m", fitted.a_kg_m)
    yield pl.Series("b_m_s", b).fill_nan(None)
    yield from (pl.lit(None, pl.Float64).alias(name) for name in ("b_lo_m_s", "b_hi_m_s"))
    yield pl.Series("cw_kg_m", at)
    half = np.hypot(np.log(interval.hi / interval.lo) / 2.0, NORMAL * tow_sd)
    yield pl.Series("cw_lo_kg_m", at * np.exp(-half))
    yield pl.Series("cw_hi_kg_m", at * np.exp(half))
    yield pl.lit(None, pl.Float64).alias("cw_others_kg_m")
    yield pl.Series("power_w", at * v0**3 / 8)
    yield pl.Series("b_capped", np.zeros(len(v0), bool))
    yield pl.Series("status", ["accepted"] * len(v0))
    yield pl.Series("flags", [[]] * len(v0), dtype=pl.List(pl.String))


def compared(curves, tows, boats, run_points):
    """What the models say of the types of these tows."""
    observed = observe(curves, tows, boats, run_points)
    return compare_types(observed, repeat_pairs(curves, tows))


def consistency_tables(curves, tows, boats, run_points, races=NO_RACES):
    """All tables of the analysis."""
    observed, pairs = observe(curves, tows, boats, run_points), repeat_pairs(curves, tows)
    return type_tables(observed, pairs, races) | {
        "predicted_cw": predict_cw(observed),
        "repeat_pairs": pairs,
        "era_shifts": era_shifts(pairs, boats),
        "reproducibility": reproducibility(pairs, observed),
    }
