"""A second opinion without towing: Cw from what a tape and a scale say.

ln Cw of boats at a standard speed against ln displacement, length, beam and that speed, with a
random effect of the type; every boat is predicted from the other boats alone.
"""

from typing import Final

import numpy as np
import polars as pl

from pipeline.arrays import FloatArray
from pipeline.consistency import mixed
from pipeline.consistency.observed import (
    UNKNOWN_TYPE,
    Observed,
    curve_at,
    ln_cw_variance,
    newest,
)
from pipeline.quantiles import NORMAL, t_quantile
from pipeline.tables.consistency import PredictedCw
from pipeline.tables.keys import LINE

FEWEST_BOATS_PER_COLUMN: Final = 3
MEASURES: Final = ("displacement_kg", "waterline_length_m", "beam_m", "standard_speed_m_s")


def predicted_cw(observed: Observed) -> pl.DataFrame:
    """Cw of each boat and crew by its newest tow, and as predicted from all other boats.

    The standard speed is the median declared speed of the type and crew class: known without a
    tow, and within the speeds at which most curves count. A tow's uncertainty is that of its runs
    at the standard speed or, where wider, that of its interval, which also knows of the log. A tow
    disagrees where the difference is more than both 95 % uncertainties together (root of the sum of
    squares). The variances are estimated once, with all boats.

    Returns:
        Rows of the table `predicted_cw`; tows without weight, or whose curve does not count at the
        standard speed, are left out; where the prediction is empty, `reason` says why.
    """
    boats = newest(observed)
    speed = pl.col("declared_speed_m_s").median().over("method", "boat_type", "crew_class")
    boats = Observed(boats.table.with_columns(speed.alias("standard_speed_m_s")), boats.points)
    parts = [_predicted(fleet) for _, fleet in boats.groups("method")]
    return pl.concat([PredictedCw.create_empty(), *parts], how="diagonal")


def _predicted(fleet: Observed) -> pl.DataFrame:
    cw = curve_at(fleet, fleet.column("standard_speed_m_s"))
    weighed = fleet.table["displacement_kg"].is_not_null().to_numpy()
    fleet = fleet.take(np.flatnonzero(np.isfinite(cw) & weighed))
    speed = fleet.column("standard_speed_m_s")
    cw = curve_at(fleet, speed)
    variance = ln_cw_variance(fleet, speed)
    rows = fleet.table.select(
        "method",
        "tow_id",
        *LINE,
        "boat_type",
        "standard_speed_m_s",
        pl.Series("cw_kg_m", cw),
        pl.Series("cw_sd_ratio", np.sqrt(variance)),
    )
    x = _columns(fleet)
    if fleet.table["fsn_no"].n_unique() < FEWEST_BOATS_PER_COLUMN * (x.shape[1] + 1):
        return rows.with_columns(reason=pl.lit("few_boats"))
    # A boat of no type is one by itself.
    alone = pl.when(boat_type=UNKNOWN_TYPE).then("fsn_no").otherwise("boat_type").alias("type")
    hull, types = fleet.table.select("hull", alone).to_numpy().T
    problem = mixed.Problem(np.log(cw), variance, x, hull, types)
    fit = mixed.fit(problem, mixed.BOAT, mixed.OTHER)
    if fit is None:
        return rows.with_columns(reason=pl.lit("not_settled"))
    error, error_variance, _ = fit.leave_boats_out()
    ratio = np.where(np.isfinite(error_variance), error, np.nan)
    sd = np.sqrt(np.maximum(error_variance * fit.scale - variance, 0.0))
    half = float(t_quantile(fit.dof)) * sd
    numbers = {
        "predicted_cw_kg_m": cw * np.exp(-ratio),
        "predicted_lo_kg_m": cw * np.exp(-ratio - half),
        "predicted_hi_kg_m": cw * np.exp(-ratio + half),
        "ln_ratio": ratio,
        "both": NORMAL * np.sqrt(variance + sd**2),
    }
    return (
        rows.with_columns(pl.Series(k, v).fill_nan(None) for k, v in numbers.items())
        .with_columns(disagrees=pl.col("ln_ratio").abs() > pl.col("both"), reason=pl.lit(""))
        .drop("both")
    )


def _columns(fleet: Observed) -> FloatArray:
    """Level and centred logarithms of the measures, without those that add nothing."""
    kept = np.ones((fleet.table.height, 1))
    for name in MEASURES:
        values = np.log(fleet.column(name))
        rest = values - kept @ np.linalg.lstsq(kept, values)[0] if len(values) else values
        if len(values) and np.sqrt((rest**2).mean()) > 1e-6:
            kept = np.column_stack([kept, values - values.mean()])
    return kept


def prediction_error(predicted: pl.DataFrame) -> pl.DataFrame:
    """Cross-validated error of the prediction, next to the uncertainty of a tow, per method.

    Args:
        predicted: rows of `predicted_cw`.

    Returns:
        Rows of the table `prediction_error`.
    """
    known = predicted.drop_nulls("ln_ratio").group_by("method", maintain_order=True)
    return known.agg(
        n=pl.len(),
        n_boats=pl.col("fsn_no").n_unique(),
        rmse_ratio=(pl.col("ln_ratio") ** 2).mean().sqrt(),
        tow_sd_ratio=(pl.col("cw_sd_ratio") ** 2).mean().sqrt(),
    )
