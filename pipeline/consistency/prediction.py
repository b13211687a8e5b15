"""Cw as it is to be expected without a tow: from what a tape and a scale say.

ln Cw of all boats at a standard speed, against ln displacement, length, beam and that speed, with a
random effect of the type:

    y = X beta + type + boat + error

Spreads are estimated by the model of `boat_model`, first of boats within types, then of types.
"""

from typing import Final

import numpy as np
import polars as pl
import scipy

from pipeline import curve
from pipeline.arrays import FloatArray
from pipeline.consistency.boat_model import BoatModel
from pipeline.consistency.noise import decompose, find_spread
from pipeline.consistency.observed import is_within_curve, ln_cw_variance_at
from pipeline.quantiles import NORMAL, t_quantile
from pipeline.tables.consistency import PredictedCw
from pipeline.tables.keys import LINE, UNKNOWN_TYPE

MIN_BOATS_PER_COLUMN: Final = 3
MEASURES: Final = ("displacement_kg", "waterline_length_m", "beam_m", "standard_speed_m_s")


def predict_cw(observed: pl.DataFrame) -> pl.DataFrame:
    """Predict Cw of each boat and crew from all other boats, beside that of its newest tow.

    The standard speed is the median declared speed of the type and class: known without a tow, and
    within the speeds at which most curves count. A tow disagrees where the difference is more than
    both 95 % uncertainties together (root of the sum of squares).

    Args:
        observed: rows of `observe`.

    Returns:
        Rows of the table `predicted_cw`; tows without weight, or whose curve does not count at the
        standard speed, are left out; where the prediction is empty, `reason` says why.
    """
    speed = pl.col("declared_speed_m_s").median().over("method", "boat_type", "crew_class")
    newest = observed.filter("newest").with_columns(standard_speed_m_s=speed)
    parts: list[pl.DataFrame] = [PredictedCw.create_empty()]
    for _, fleet in newest.group_by("method", maintain_order=True):
        parts.append(_predict_fleet(fleet))
    return pl.concat(parts, how="diagonal")


def _predict_fleet(newest: pl.DataFrame) -> pl.DataFrame:
    """Predict each tow of a method."""
    speed = newest["standard_speed_m_s"].to_numpy()
    declared = newest["declared_speed_m_s"].to_numpy()
    a = newest["a_kg_m"].to_numpy()
    cw = curve.cw(a, curve.s_of_height(a, newest["cw_kg_m"].to_numpy(), declared), speed)
    fleet = newest.with_columns(
        cw_at_standard=pl.Series(cw), variance=pl.Series(ln_cw_variance_at(newest, speed))
    ).filter(
        pl.Series(np.isfinite(cw) & is_within_curve(newest, speed)),
        pl.col("displacement_kg").is_not_null(),
    )
    cw = fleet["cw_at_standard"].to_numpy()
    variance = fleet["variance"].to_numpy()
    rows = fleet.select(
        "method",
        "tow_id",
        pl.col(LINE),
        "boat_type",
        "standard_speed_m_s",
        cw_kg_m="cw_at_standard",
        cw_sd_ratio=pl.col("variance").sqrt(),
    )
    x = _measure_columns(fleet)
    if fleet["fsn_no"].n_unique() < MIN_BOATS_PER_COLUMN * (x.shape[1] + 1):
        return rows.with_columns(reason=pl.lit("few_boats"))
    covariance = _estimate_covariance(fleet, np.log(cw), variance, x)
    error, error_variance = leave_boats_out(np.log(cw), covariance, x, fleet["fsn_no"].to_numpy())
    sd = np.sqrt(np.maximum(error_variance - variance, 0.0))
    half = float(t_quantile(fleet["fsn_no"].n_unique() - x.shape[1])) * sd
    both = NORMAL * np.sqrt(variance + sd**2)
    return rows.with_columns(
        predicted_cw_kg_m=pl.Series(cw * np.exp(-error)),
        predicted_lo_kg_m=pl.Series(cw * np.exp(-error - half)),
        predicted_hi_kg_m=pl.Series(cw * np.exp(-error + half)),
        ln_ratio=pl.Series(error),
        disagrees=pl.Series(np.abs(error) > both),
        reason=pl.lit(""),
    )


def _measure_columns(fleet: pl.DataFrame) -> FloatArray:
    """Return level and centred logarithms of the measures, without those that add nothing."""
    columns = np.ones((fleet.height, 1))
    for name in MEASURES:
        values = np.log(fleet[name].to_numpy().astype(np.float64))
        if not len(values):
            continue
        rest = values - columns @ np.linalg.lstsq(columns, values)[0]
        if np.sqrt((rest**2).mean()) > 1e-6:
            columns = np.column_stack([columns, values - values.mean()])
    return columns


def _estimate_covariance(
    fleet: pl.DataFrame, y: FloatArray, variance: FloatArray, x: FloatArray
) -> FloatArray:
    """Return the covariance of the tows by error, boat and type, (n, n).

    A boat of no known type is a type by itself.
    """
    of_boat = fleet["fsn_no"].rank("dense").cast(pl.Int64).to_numpy()
    own_type = pl.when(boat_type=UNKNOWN_TYPE).then("fsn_no").otherwise("boat_type")
    of_type = fleet.select(own_type.rank("dense").cast(pl.Int64)).to_series().to_numpy()
    same_boat = np.asarray(of_boat[:, None] == of_boat, dtype=np.float64)
    type_columns = np.asarray(of_type[:, None] == np.unique(of_type), dtype=np.float64)
    within = np.column_stack([type_columns, _find_independent(x[:, 1:], type_columns)])
    covariance = np.diag(variance)
    if len(np.unique(of_boat)) > within.shape[1]:
        boats = BoatModel(y=y, covariance=covariance, x=within, boat=of_boat)
        covariance = covariance + boats.boat_sd**2 * same_boat
    whiten = np.linalg.inv(np.linalg.cholesky(covariance))
    free = scipy.linalg.null_space((whiten @ x).T)
    axes, strength, _ = decompose(free.T @ whiten @ type_columns)
    type_sd = find_spread(axes.T @ free.T @ whiten @ y, strength)
    return covariance + type_sd**2 * (type_columns @ type_columns.T)


def _find_independent(candidates: FloatArray, columns: FloatArray) -> FloatArray:
    """Return the candidates that the columns and earlier candidates do not explain."""
    chosen: list[int] = []
    for place in range(candidates.shape[1]):
        with_it = np.column_stack([columns, candidates[:, chosen + [place]]])
        if np.linalg.matrix_rank(with_it) == with_it.shape[1]:
            chosen.append(place)
    return candidates[:, chosen]


def leave_boats_out(
    y: FloatArray, covariance: FloatArray, x: FloatArray, boat: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return y less its prediction from the other boats, and the variance of that difference.

    With P the precision of y about X beta, of the rows b of one boat they are (P_bb)^-1 (P y)_b and
    the diagonal of (P_bb)^-1: the prediction from all other rows, their errors and the type's own
    effect included.
    """
    precision = np.linalg.inv(covariance)
    by_columns = precision @ x
    about = precision - by_columns @ np.linalg.inv(x.T @ by_columns) @ by_columns.T
    error = np.zeros(len(y))
    variance = np.zeros(len(y))
    for name in np.unique(boat):
        rows = np.flatnonzero(boat == name)
        own = np.linalg.inv(about[np.ix_(rows, rows)])
        error[rows] = own @ (about[rows] @ y)
        variance[rows] = np.diag(own)
    return error, variance
