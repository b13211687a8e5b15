"""The factor of each log with its interval, what that consists of, and whether it can be used."""

from typing import Final

import numpy as np
import polars as pl

from pipeline.arrays import BoolArray, FloatArray
from pipeline.choice import first_largest
from pipeline.quantiles import t_quantile
from pipeline.season_log.boats import GPS as GPS_NUMBER
from pipeline.season_log.effects import GPS_SCALE
from pipeline.season_log.faults import Posterior
from pipeline.season_log.fit import Fit
from pipeline.season_log.guard import means

ESTIMATED: Final = "estimated"
GPS: Final = "gps"
NOT_DETERMINED: Final = "not determined"
NOT_SETTLED: Final = "not settled"


def without_each_boat(fitted: Fit) -> FloatArray:
    """Change of every effect of the fit when a boat is left out, (boats by number, k)."""
    hull = fitted.problem.tows.frame["hull"].to_numpy()
    k = len(fitted.active)
    information, score = np.zeros((hull.max() + 1, k, k)), np.zeros((hull.max() + 1, k))
    for boats in fitted.boats:
        whose = hull[boats.rows[:, 0] // 3]
        np.add.at(information, whose, boats.information)
        np.add.at(score, whose, boats.score)
    left = np.linalg.inv(fitted.covariance) - information
    return np.asarray(-np.linalg.solve(left, score[:, :, None])[:, :, 0])


def factors_of(posterior: Posterior, change: FloatArray) -> tuple[pl.DataFrame, FloatArray]:
    """The factor of each log, and the covariance between those that are determined.

    Args:
        change: of every effect of the fit without each boat, as `without_each_boat` gives it.

    Returns:
        Rows of `SeasonFactors.factors`, and (determined, determined) covariance of ln factor.
    """
    fitted, known = posterior.fit, posterior.determined
    tows, along = fitted.problem.tows, means(fitted)[known]
    covariance = _of_means(fitted, along @ fitted.covariance @ along.T, known)
    by_gps, assumed = _beside_repeats(fitted, along)
    variance = np.diag(covariance)
    mean, dof = along @ fitted.value, fitted.dof(along)
    half = np.sqrt(variance) * t_quantile(np.maximum(dof, 1.0))
    move = np.abs(np.expm1(change @ along.T)) * np.exp(mean)
    names = tows.frame.unique("hull").sort("hull")["fsn_no"]
    found = (
        tows.logs.select("log_place")
        .filter(pl.Series(known))
        .with_columns(
            factor=np.exp(mean),
            lo=np.exp(mean - half),
            hi=np.exp(mean + half),
            ln_sd=np.sqrt(variance),
            dof=dof,
            repeat_tows_sd=np.sqrt(np.maximum(variance - by_gps - assumed, 0.0)),
            gps_sd=np.sqrt(by_gps),
            assumed_sd=np.sqrt(assumed),
            influence=move.max(axis=0),
            influence_boat=names.gather(first_largest(move)),
        )
    )
    tied_by_gps = pl.col("has_gps") | pl.col("calibrated")
    by_gps_alone = (pl.col("n_links") == 0) & tied_by_gps
    usable = pl.when(by_gps_alone).then(pl.lit(GPS)).otherwise(pl.lit(ESTIMATED))
    source = (
        pl.when(pl.col("component") > 0)
        .then(pl.lit(NOT_DETERMINED))
        .when(pl.Series(posterior.refused) | pl.lit(not fitted.settled))
        .then(pl.lit(NOT_SETTLED))
        .otherwise(usable)
    )
    factors = tows.logs.with_columns(source=source).join(
        found, on="log_place", how="left", maintain_order="left"
    )
    return factors.drop("log_place", "prior_ln", "prior_sd", "has_gps", "calibrated"), covariance


def _of_means(fitted: Fit, covariance: FloatArray, known: BoolArray) -> FloatArray:
    """Covariance of the mean ln factors over tows, by that of what logs do in general.

    The scatter of the tows is in their mean as well as in what they tell of the log: it is in the
    difference only as far as the prior draws the estimate.
    """
    own = fitted.scatter_of_means[known]
    drawn = own / fitted.problem.settings.log_sd**2
    return np.asarray(covariance * (1.0 + drawn + drawn[:, None]) - np.diag(own))


def _beside_repeats(fitted: Fit, along: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Parts of the variance of ln factors that are the GPS's, and of what is assumed.

    The covariance C of the effects is C (prior + data) C: what each number and each prior has in it
    adds up.
    """
    weight = along @ fitted.covariance
    gps = fitted.problem.given[:, GPS_NUMBER, GPS_NUMBER] + np.exp(fitted.ln_variance[GPS_NUMBER])
    by_gps = ((fitted.weighed[:, GPS_NUMBER] @ weight.T) ** 2 * gps[:, None]).sum(axis=0)
    by_prior = weight**2 / fitted.problem.effects.prior[1][fitted.active]
    of_gps = fitted.name == GPS_SCALE
    return by_gps + by_prior[:, of_gps].sum(axis=1), by_prior[:, ~of_gps].sum(axis=1)
