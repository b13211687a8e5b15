"""Season factors: what the joint estimate is given, and what it gives to the tows.

Every tow is first computed without any factor for the seasons whose factor is estimated; from
those curves the factors follow, twice: at the speeds as read, then at true speed. They are applied
after. The statistics are in `pipeline.season_log`.
"""

import math
from collections.abc import Mapping
from typing import Final

import numpy as np
import polars as pl

from pipeline import curve
from pipeline.arrays import FloatArray
from pipeline.channels import BACK, OUT
from pipeline.recompute.budget import FORCE_SD, files_log_sd, scatter_of
from pipeline.recompute.computed import Computed
from pipeline.recompute.plan import Plan
from pipeline.season_log import SeasonFactors, estimate_season_factors, first_estimate
from pipeline.season_log.archive import LOG
from pipeline.steps.calibration import gps_factor
from pipeline.tables.frames import dtypes
from pipeline.tables.keys import LINE
from pipeline.tables.season_log import TowInstruments

FEWEST_OF_TYPE: Final = 5
"""A type's own bend is taken from so many anchored tows on."""

LEAST_SPREAD: Final = 1e-6
"""Variance of the bend between boats of a type: none at all would leave nothing to divide by."""

LOG_SCATTER: Final = 0.005
"""Standard deviation of ln y from tow to tow where too few are calibrated to show it (inferred)."""

INSTRUMENTS: Final = dtypes(TowInstruments, without=["method"])
"""What is estimated of a tow's instruments."""


def find_season_factors(c: Computed) -> SeasonFactors:
    """The log factors of all seasons, from tows computed without them.

    Tows of a line are compared at one true speed: its median declared speed. A first estimate, from
    the speeds as read, says what the logs read there. At those speeds themselves a log that is 6 %
    low would be compared at the edge of what was towed, and all would hang on the bend.

    Args:
        c: all tows under `without_factor`.
    """

    def rows(ln_factor: Mapping[str, float]) -> pl.DataFrame:
        return _with_calibrations(_with_kappa(_rows(c, ln_factor).drop_nulls("ln_cw")))

    first = first_estimate(rows({}))
    known = zip(first.fit.model.archive.frame["tow_id"], first.ln_factor.tolist(), strict=True)
    return estimate_season_factors(rows({t: ln for t, ln in known if math.isfinite(ln)}), first)


def instruments_of(plan: Plan, rows: pl.DataFrame | None) -> pl.DataFrame:
    """What was estimated of each tow, as far as its steps ask for it.

    Args:
        rows: `SeasonFactors.tows` or rows of the table `tow_instruments`; None where nothing
            was estimated.

    Returns:
        A row per tow with the columns of `INSTRUMENTS`, null where nothing is known; such a
        load cell has the factor 1 and the zero 0.
    """
    own = plan.tows.frame.select("tow_id", "season", "log1_part")
    known = pl.DataFrame(schema=INSTRUMENTS) if rows is None else rows
    joined = own.join(known.select(*INSTRUMENTS), on="tow_id", how="left", maintain_order="left")
    # A tow that takes no part in the estimate had the instruments of its season all the same.
    of_season = pl.col("factor", "force_factor", "force_zero_n", "ln_sd", "dof")
    filled = joined.with_columns(of_season.fill_null(of_season.mean().over("season", "log1_part")))
    asked = pl.Series(plan.option("speed.correction") == "estimated")
    return filled.with_columns(
        pl.when(asked).then("factor").alias("factor"),
        pl.col("force_factor").fill_null(1.0),
        pl.col("force_zero_n").fill_null(0.0),
    )


def _rows(c: Computed, ln_factor: Mapping[str, float]) -> pl.DataFrame:
    """Per tow its curve at its line's true speed, with uncertainty, and its GPS ratio."""
    tows, declared = c.tows, c.tows.of_tow("declared_speed_m_s")
    reference_ln = np.array([ln_factor.get(name, 0.0) for name in tows.frame["tow_id"]])
    of_line = pl.col("declared_speed_m_s").median().over(LINE)
    true_speed = tows.frame.select(of_line).to_series().to_numpy()
    speed = true_speed * np.exp(-reference_ln)
    water = _water_points(c)
    curves = curve.fit(water)
    cw, r = curves.cw_at(speed), curves.s_s2_m2 * speed**2
    errors = curve.covariance(water, curves, scatter_of(c, pooled=True), speed)
    sound = curves.converged & np.isfinite(cw) & (cw > 0) & tows.trusted
    sure = sound & np.isfinite(errors.c0_variance_kg2_m2)
    safe, safe_r = np.where(sound, cw, 1.0), np.where(sound, r, 0.0)
    calibrated = c.plan.option("calibration.rule") == "gps_per_tow"
    gps, gps_sd, has_gps = _gps_ratio(c)
    own_sd, q = files_log_sd(c), safe_r / (1.0 - safe_r)
    by_log = (2.0 + 2.0 * q, 2.0 * q * (1.0 + q))
    y = np.where(c.calibrated, c.calibration_factor, 1.0)
    numbers = {
        "ln_cw": np.where(sound, np.log(safe), np.nan),
        "ln_cw_sd": np.sqrt(
            np.where(sure, errors.c0_variance_kg2_m2 / safe**2, 1.0)
            + (by_log[0] * own_sd) ** 2
            + (_unmeasured_wind_kg_m(c) / safe) ** 2
        ),
        "q": q,
        "q_sd": np.hypot(np.where(sure, np.sqrt(errors.q_variance), 1.0), by_log[1] * own_sd),
        "ln_cw_q_cov": np.where(sure, errors.c0_q_covariance_kg_m / safe, 0.0)
        + by_log[0] * by_log[1] * own_sd**2,
        "own_calibration_ln": np.where(c.calibrated, np.log(c.known_factor * y), np.nan),
        "gps_ln_ratio": np.where(has_gps & ~calibrated, gps, np.nan),
        "gps_sd": np.where(has_gps & ~calibrated, np.hypot(gps_sd, own_sd), np.nan),
    }
    names = ("tow_id", *LINE, "boat_type", "season", "altered", "declared_speed_m_s")
    return tows.frame.select(
        *names,
        pl.col("weight_kg", "waterline_length_m").cast(pl.Float64),
        pl.col("tow_date").dt.ordinal_day().cast(pl.Float64).alias("day"),
        pl.col("log1_part").alias("part"),
        pl.Series("anchored", calibrated),
        pl.Series("temperature_known", c.temperature_known),
        pl.Series("water_off_c", c.water_off_c),
        FORCE_SD.alias("force_sd"),
        pl.Series("reference_ratio", declared / true_speed),
        pl.Series("reference_ln", reference_ln),
        *(pl.Series(name, values).fill_nan(None) for name, values in numbers.items()),
    )


def _unmeasured_wind_kg_m(c: Computed) -> FloatArray:
    """Standard uncertainty of Cw by wind that nobody measured, shape (tows,); 0 where it was."""
    still = c.tows.mean(c.still_air_kg_m, c.used)
    return np.where(c.tows.measured("wind"), 0.0, still * c.expected_wind_sd)


def _water_points(c: Computed) -> curve.Points:
    """Run points of the water alone: the still-air part does not scale with the log's error."""
    water = c.tows.by_tow(c.cw_kg_m - c.still_air_kg_m)
    return curve.Points(c.points.speed_m_s, water, c.points.used & (water > 0))


def _gps_ratio(c: Computed) -> tuple[FloatArray, FloatArray, np.ndarray]:
    """Gives ln(GPS / log) of each tow with runs both ways, its random part, and where known.

    The random part is the scatter of run ratios about their direction's mean, pooled over
    the tows with the same steps: one tow's six runs are too few.
    """
    tows, gps, log, which = c.tows, c.means.gps_m_s, c.means.speed_m_s, c.plan.which
    used = c.used & np.isfinite(gps)
    y, both = gps_factor(gps, log, tows.direction, tows.tow, used, tows.size)
    ratio = np.where(used, gps, 1.0) / np.where(used, log, 1.0)
    spread, count = np.zeros((2, len(c.plan.steps)))
    for way in (OUT, BACK):
        mine = used & (tows.direction == way)
        deviation = np.where(mine, ratio - tows.mean(ratio, mine)[tows.tow], 0.0)
        spread += np.bincount(which[tows.tow], deviation**2, len(spread))
        count += np.bincount(which, np.maximum(tows.count(mine) - 1, 0), len(count))
    run_sd = np.where(count > 0, np.sqrt(spread / np.maximum(count, 1)), 1.0)
    runs = np.maximum(tows.count(used), 1)
    return np.log(np.where(both, y, 1.0)), run_sd[which] / np.sqrt(runs), both


def _with_calibrations(rows: pl.DataFrame) -> pl.DataFrame:
    """Adds what dGPS says of a log in its other tows: `others_calibration_ln` and its `_sd`.

    The mean of ln y over the tows of a season that are calibrated, and its standard deviation by
    the scatter within all such seasons; null where there are none.
    """
    y = pl.col("own_calibration_ln")
    within = (y - y.mean().over(LOG)) ** 2
    spread, tows, groups = (
        rows.drop_nulls("own_calibration_ln")
        .select(within.sum().alias("spread"), pl.len(), pl.struct(LOG).n_unique().alias("groups"))
        .row(0)
    )
    scatter = (
        math.sqrt(spread / (tows - groups)) if tows - groups >= FEWEST_OF_TYPE else LOG_SCATTER
    )
    return rows.with_columns(
        y.mean().over(LOG).alias("others_calibration_ln"),
        pl.when(y.count().over(LOG) > 0)
        .then(scatter / y.count().over(LOG).sqrt())
        .alias("others_calibration_sd"),
    )


def _with_kappa(rows: pl.DataFrame) -> pl.DataFrame:
    """Adds `kappa`, the elasticity of the line's true curve, from the bend of its anchored tows.

    One tow's bend is uncertain, and boats of a type differ. So the mean of a line's own anchored
    tows is drawn towards its type (the fleet, where that has few) as far as its uncertainty is
    large against the spread between boats. Without this the difference between boats, times a log
    error of 5 %, passes for scatter of the log between tows.
    """
    anchored, q = rows.filter("anchored"), pl.col("q")
    trusted = anchored if anchored.height else rows
    by_type = trusted.group_by("boat_type", maintain_order=True).agg(
        q.median().alias("q_type"), pl.len()
    )
    usual = by_type.filter(pl.col("len") >= FEWEST_OF_TYPE).select("boat_type", "q_type")
    fleet, deviation = trusted["q"].median(), q - pl.col("q_type")
    typed = rows.join(
        usual, on="boat_type", how="left", nulls_equal=True, maintain_order="left"
    ).with_columns(pl.col("q_type").fill_null(pl.lit(fleet, pl.Float64)))
    seen = typed.filter("anchored")
    # The median of a squared standard normal number is 0.455.
    spread = seen.select((deviation**2).median() / 0.455 - (pl.col("q_sd") ** 2).median()).item()
    own = seen.group_by(LINE, maintain_order=True).agg(
        (deviation / pl.col("q_sd") ** 2).sum().alias("pull"),
        (pl.col("q_sd") ** -2.0).sum().alias("weight"),
    )
    between = max(spread or 0.0, LEAST_SPREAD)
    shift = pl.col("pull") / (pl.col("weight") + 1.0 / between)
    return (
        typed.join(own, on=LINE, how="left", maintain_order="left")
        .with_columns(kappa=2.0 + 2.0 * (pl.col("q_type") + shift.fill_null(0.0)))
        .drop("q_type", "pull", "weight")
    )
