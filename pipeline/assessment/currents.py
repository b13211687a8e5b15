"""The current of each tow, from GPS less log: how fast it ran, and whether it changed.

Calibration on dGPS takes the current to be the same out and back, so that it drops out (Sleepproef,
R. Pot 2017, "IJking snelheid"). Half of a change from out to back stays in the calibrated speed.
Speed trials of ships look at the change between double runs (ISO 15016:2015); here runs 1 to 3 go
out and 4 to 6 back, so that one change is all that a tow can show.

A run reads `GPS = y log + d c`, with `d` 1 out and -1 back. The tow's own `y` takes the current to
be constant, so `y` comes from the other tows of the season, and its uncertainty is the spread of
the tows' own factors.
"""

from typing import Final

import numpy as np
import polars as pl

from pipeline.arrays import FloatArray, IntArray
from pipeline.assessment.checks import MIN_CURRENT_CHANGE_M_S
from pipeline.channels import BACK, OUT
from pipeline.quantiles import MAD_TO_SD, NORMAL

MIN_OTHER_TOWS: Final = 4
"""Other tows of the season with GPS from which the factor of the log is taken (inferred)."""

MIN_CHANGE_SD: Final = 3.0
"""Standard deviations from which chance does not explain a change: one sound tow in 370."""

CHANGED, NO_CHANGE, CANNOT_BE_TOLD = "changed", "no_change", "cannot be told"
"""Verdicts: whether the current changed from out to back."""


def estimate_currents(curves: pl.DataFrame, run_points: pl.DataFrame) -> pl.DataFrame:
    """Return the current along the course of the runs out, and its change from out to back.

    Args:
        curves, run_points: the tables of one method.

    Returns:
        Rows of the table `tow_currents`, for each tow with GPS both ways. The change and its
        interval are null where fewer than `MIN_OTHER_TOWS` other tows tell the factor of the log.
    """
    log = pl.col("speed_m_s") / pl.col("speed_factor")
    runs = run_points.filter("used", pl.col("gps_ratio") > 0).select(
        "tow_id", "direction", log_m_s=log, gps_m_s=log * pl.col("gps_ratio")
    )
    means = runs.group_by("tow_id", "direction", maintain_order=True).agg(
        pl.col("log_m_s", "gps_m_s").mean(), runs=pl.len()
    )
    tows = (
        means.filter(direction=OUT)
        .join(means.filter(direction=BACK), on="tow_id", suffix="_back", maintain_order="left")
        .join(curves.select("method", "tow_id", "season"), on="tow_id", maintain_order="left")
        .sort("tow_id")
    )
    log_out, log_back = tows["log_m_s"].to_numpy(), tows["log_m_s_back"].to_numpy()
    gps_out, gps_back = tows["gps_m_s"].to_numpy(), tows["gps_m_s_back"].to_numpy()
    own_factor = (gps_out + gps_back) / (log_out + log_back)
    factor, factor_sd = _estimate_factor_by_others(own_factor, tows["season"].to_numpy())
    is_known = np.isfinite(factor)

    # The current hardly depends on the factor: what is wrong with it goes out as it comes back.
    used_factor = np.where(is_known, factor, own_factor)
    used_factor_sd = np.where(is_known, factor_sd, 0.0)
    current = 0.5 * ((gps_out - used_factor * log_out) - (gps_back - used_factor * log_back))
    by_runs = _measure_run_scatter(runs) * np.sqrt(
        1.0 / tows["runs"].to_numpy() + 1.0 / tows["runs_back"].to_numpy()
    )
    current_sd = 0.5 * np.hypot(by_runs, used_factor_sd * (log_out - log_back))

    # The spread of the factors holds the scatter of the runs too.
    change = factor * (log_out + log_back) - (gps_out + gps_back)
    change_sd = factor_sd * (log_out + log_back)
    is_clear = np.abs(change) > np.maximum(MIN_CURRENT_CHANGE_M_S, MIN_CHANGE_SD * change_sd)
    numbers = {
        "current_m_s": current,
        "current_lo_m_s": current - NORMAL * current_sd,
        "current_hi_m_s": current + NORMAL * current_sd,
        "current_change_m_s": change,
        "current_change_lo_m_s": change - NORMAL * change_sd,
        "current_change_hi_m_s": change + NORMAL * change_sd,
    }
    verdict = np.select([~is_known, is_clear], [CANNOT_BE_TOLD, CHANGED], NO_CHANGE)
    columns = [pl.Series(name, values).fill_nan(None) for name, values in numbers.items()]
    return tows.select("method", "tow_id").with_columns(
        *columns, pl.Series("current_verdict", verdict, pl.String)
    )


def _estimate_factor_by_others(
    own_factor: FloatArray, season: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Return the log factor of each tow by the other tows of its season, and its sd, (tows,).

    The median and standard deviation of the others' own factors; the robust spread of all seasons
    is the least, as few tows may agree by chance. NaN with too few others.
    """
    factor, spread = np.full((2, own_factor.size), np.nan)
    others_in_season = np.zeros(own_factor.size)
    for tow in range(own_factor.size):
        is_other = season == season[tow]
        is_other[tow] = False
        others = own_factor[is_other]
        if others.size >= MIN_OTHER_TOWS:
            factor[tow] = np.median(others)
            spread[tow] = np.std(others, ddof=1)
            others_in_season[tow] = others.size
    is_known = np.isfinite(factor)
    of_all = MAD_TO_SD * np.median(np.abs(own_factor - factor)[is_known]) if is_known.any() else 0.0
    # Variance of a median: pi / 2 n.
    with_median = np.sqrt(1.0 + 0.5 * np.pi / np.maximum(others_in_season, 1.0))
    return factor, np.maximum(spread, of_all) * with_median


def _measure_run_scatter(runs: pl.DataFrame) -> float:
    """Return the robust sd [m/s] of a run's GPS less log about the mean of its tow and way."""
    factor = pl.col("gps_m_s").mean() / pl.col("log_m_s").mean()
    one_way = ("tow_id", "direction")
    scatter = pl.col("gps_m_s") - pl.col("log_m_s") * factor.over(one_way)
    size = pl.len().over(one_way)
    unbiased = scatter.abs() * (size / (size - 1)).sqrt()
    median = runs.select(unbiased.filter(size > 1).median()).item()
    return MAD_TO_SD * float(median or 0.0)
