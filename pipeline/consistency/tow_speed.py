"""Does the bend of a curve follow the speed of the tow? If the hyperbola is true, it does not.

And what a slow tow does to race power: its curve is used at speeds at which it was never towed.
"""

from collections.abc import Mapping
from typing import Final

import numpy as np
import polars as pl

from pipeline import curve
from pipeline.arrays import BoolArray, FloatArray
from pipeline.consistency import mixed
from pipeline.consistency.homogeneity import height_given_bend, shared_bend
from pipeline.consistency.observed import (
    ALL_TYPES,
    UNKNOWN_TYPE,
    Observed,
    counts_at,
    curve_anywhere,
    newest,
    q_at,
)
from pipeline.history import SLOW_POWER_W
from pipeline.hull import hull_speed_m_s
from pipeline.races.race import mean_speed_m_s, power_per_rower_w
from pipeline.tables.consistency import SlowTows, SpeedTrend
from pipeline.tables.declare import dy
from pipeline.tables.frames import frame_of
from pipeline.tables.keys import LINE
from pipeline.tables.row import Row

BORDERLINE_POWER_W: Final = {"H": 70.0, "D": 40.0}
RACED_POWER_W: Final = {"H": 100.0, "D": 57.0}
"""The upper end of "60-70 Watt", and "meer dan 100 Watt" in a race; women's inferred alike."""

LOW, MIDDLE, HIGH = "low", "middle", "high"
MIDDLE_RATIO: Final = (0.67, 0.80)
"""Tow speed / hull speed: between these "the curve is relatively flat", below it the wave
resistance rises (Cw-kromme, R. Pot 2015, "Totale weerstand")."""

FEWEST_BOATS: Final = 5
"""Fewest boats through which a trend is drawn."""
FEWEST_OTHERS: Final = 2


def is_slow(table: pl.DataFrame, limits: Mapping[str, float] = SLOW_POWER_W) -> BoolArray:
    """Whether a tow was made with less power per rower than its class's limit, shape (rows,)."""
    limit = pl.col("crew_class").replace_strict(limits, return_dtype=pl.Float64)
    slow = table.select((pl.col("power_w") < limit).fill_null(value=False)).to_series()
    return slow.to_numpy()


def speed_trend(observed: Observed) -> dy.DataFrame[SpeedTrend]:
    """Trend of the bend q at a type's standard speed with the speed of the tow.

    Per type and over all types. Men and women of a type each have a level of their own, so that
    the trend compares tows within a class. It is per unit of ln v0; 0.1 of it is what 10 % of tow
    speed does to q.

    Returns:
        Rows of the table `speed_trend`.
    """
    boats = newest(observed)
    rows: list[Row] = []
    for (method,), fleet in boats.groups("method"):
        typed = {t: own for (t,), own in fleet.rows_by("boat_type") if t != UNKNOWN_TYPE}
        every = np.concatenate([np.zeros(0, np.int64), *typed.values()])
        for boat_type, own in [*typed.items(), (ALL_TYPES, every)]:
            rows.append({"method": method, "boat_type": boat_type} | _trend(fleet.take(own)))
    return frame_of(SpeedTrend, rows)


def _trend(boats: Observed) -> Row:
    """The trend, and how many tows it is of; without one, why."""
    median = pl.col("declared_speed_m_s").median().over("boat_type")
    speed = boats.table.select(median).to_series().to_numpy()
    q, unit = q_at(boats, speed)
    known = np.isfinite(q)
    hull = boats.table["hull"].to_numpy()[known]
    group = boats.table.select(pl.struct("boat_type", "crew_class").rank("dense")).to_series()
    of_tow = group.to_numpy()[known]
    levels = (of_tow[:, None] == np.unique(of_tow)).astype(np.float64)
    n_boats = boats.table["fsn_no"].to_frame().filter(pl.Series(known)).n_unique()
    counts = {"n": len(hull), "n_boats": n_boats}
    if n_boats < max(FEWEST_BOATS, levels.shape[1] + 2):
        return counts | {"reason": "few_boats"}
    x = np.log(boats.column("declared_speed_m_s") / speed)[known]
    centred = x - levels @ np.linalg.lstsq(levels, x)[0]
    if np.abs(centred).max() < 1e-9:
        return counts | {"reason": "equal_values"}
    variance = unit * boats.column("run_sd_ratio") ** 2
    columns = np.column_stack([levels, centred])
    fit = mixed.fit(mixed.Problem(q[known], variance[known], columns, hull), mixed.BOAT)
    if fit is None:
        return counts | {"reason": "not_settled"}
    slope, lo, hi = (float(end[-1]) for end in fit.coefficients())
    return counts | {"slope": slope, "slope_lo": lo, "slope_hi": hi, "reason": ""}


def raced(observed: Observed, results: pl.DataFrame) -> pl.DataFrame:
    """The fastest race of each boat and crew between this tow and its next, per method and tow.

    Args:
        observed: all tows.
        results: `race_date, distance_m, stream_m, rowing_time_s` and the line.

    Returns:
        `method, tow_id, races, raced_speed_m_s` (through the water).
    """
    through_water = results["distance_m"] - results["stream_m"].fill_null(0.0)
    speed = mean_speed_m_s(through_water, results["rowing_time_s"])
    races = results.select(*LINE, "race_date", pl.Series("raced_speed_m_s", speed))
    tows = observed.table.select("method", "tow_id", "tow_date", *LINE)
    after = pl.col("race_date") >= pl.col("tow_date")
    last = pl.col("tow_date") == pl.col("tow_date").max().over("method", *LINE, "race_date")
    return (
        tows.join(races, on=LINE, maintain_order="left")
        .filter(after)
        .filter(last)
        .group_by("method", "tow_id", maintain_order=True)
        .agg(pl.len().cast(pl.Int32).alias("races"), pl.col("raced_speed_m_s").max())
    )


def slow_tows(observed: Observed, listed_races: pl.DataFrame) -> pl.DataFrame:
    """Tows whose curve is used where it was not measured, and what that does to race power.

    Towed with little power, or raced at speeds at which the curve does not count. The tow's own
    curve is compared with the curve of the same runs that has the bend of the type's other boats,
    at the fastest speed that its crew raced.

    Args:
        observed: all tows.
        listed_races: results as `raced` takes them.

    Returns:
        Rows of the table `slow_tows`; the ratio is empty where the type has no other boats.
    """
    table = observed.table.join(
        raced(observed, listed_races), on=["method", "tow_id"], how="left", maintain_order="left"
    )
    tows, slow = Observed(table, observed.points), is_slow(table)
    raced_speed = table["raced_speed_m_s"].to_numpy().astype(np.float64)
    beyond = np.isfinite(raced_speed) & ~counts_at(tows, raced_speed)
    chosen = tows.take(np.flatnonzero(is_slow(table, BORDERLINE_POWER_W) | beyond))
    raced_speed = chosen.column("raced_speed_m_s")
    raced_cw = curve_anywhere(chosen, raced_speed)
    bend = _bend_of_others(chosen, newest(tows.take(np.flatnonzero(~slow))))
    numbers = {
        "raced_power_w": power_per_rower_w(raced_cw, raced_speed, chosen.column("rowers")),
        "power_ratio_raced": _power_ratio(chosen, bend, raced_speed),
    }
    hull = hull_speed_m_s(chosen.column("waterline_length_m"))
    ratio = chosen.column("declared_speed_m_s") / hull
    high = chosen.table["crew_class"].replace_strict(RACED_POWER_W, return_dtype=pl.Float64)
    return (
        chosen.table.with_columns(
            *(pl.Series(k, v, pl.Float64).fill_nan(None) for k, v in numbers.items()),
            pl.Series("slow", is_slow(chosen.table), pl.Boolean),
            pl.Series("tow_hull_ratio", ratio, pl.Float64),
            pl.Series("speed_case", speed_case(ratio), pl.String),
        )
        .with_columns((pl.col("raced_power_w") > high).alias("raced_high"))
        .select(SlowTows.column_names())
        .sort("method", "tow_id")
    )


def _bend_of_others(chosen: Observed, others: Observed) -> FloatArray:
    """The s that a type's other boats share, shape (rows,); NaN where they are too few."""
    bend = np.full(chosen.table.height, np.nan)
    by_type = dict(others.rows_by("method", "boat_type"))
    for key, rows in chosen.rows_by("method", "boat_type"):
        own = others.take(by_type.get(key, np.zeros(0, np.int64)))
        if key[1] != UNKNOWN_TYPE and own.table["fsn_no"].n_unique() >= FEWEST_OTHERS:
            bend[rows] = shared_bend(own)
    return bend


def speed_case(tow_hull_ratio: FloatArray) -> list[str]:
    """Which of the three cases of Cw-kromme each tow is, by its speed / hull speed."""
    low, high = MIDDLE_RATIO
    return [LOW if r < low else MIDDLE if r < high else HIGH for r in tow_hull_ratio]


def _power_ratio(tows: Observed, s_s2_m2: FloatArray, speed_m_s: FloatArray) -> FloatArray:
    """Power by the own curve / by the shared bend, shape (rows,); NaN where one has none."""
    shared = curve.cw(height_given_bend(tows.points, s_s2_m2), s_s2_m2, speed_m_s)
    a = tows.column("c0_kg_m") / (1.0 + tows.column("q"))
    own = curve.cw(a, tows.column("s_s2_m2"), speed_m_s)
    known = np.isfinite(shared) & np.isfinite(own)
    return np.where(known, own, np.nan) / np.where(known, shared, 1.0)
