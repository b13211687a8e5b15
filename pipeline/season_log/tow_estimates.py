"""What the joint estimate says of single tows: instrument errors, and the boat's best estimate.

The measurand is ln Cw of the hull at its reference speed on the day of the tow. As measured, a tow
stands alone, with the corrections of its instruments. The best estimate adds the boat's other tows.
"""

from typing import Final

import numpy as np
import polars as pl
import scipy

from pipeline.arrays import FloatArray
from pipeline.quantiles import LEVEL as INTERVAL_LEVEL
from pipeline.season_log.archive import LEVEL
from pipeline.season_log.faults import Posterior
from pipeline.season_log.fit import Fit
from pipeline.season_log.observation_model import FORCE, ZERO, ZERO_DRIFT
from pipeline.season_log.patterns import GroupPosterior

MIN_ASKEW_PROBABILITY: Final = 0.05
"""A tow that was less likely pulled askew is taken for straight."""
MIN_WEIGHT: Final = 0.005
"""A smaller weight of a tow in a best estimate is left out of the list."""
MAX_QUANTILE_SD: Final = 12.0
BISECTIONS: Final = 40


def estimate_tows(posterior: Posterior) -> tuple[pl.DataFrame, pl.DataFrame]:
    """Return the tows with what was estimated of each, and what the best estimates rest on.

    Returns:
        The tows with

        - `factor` of the log: null where it is not determined, 1 with dGPS;
        - `force_factor`, `force_zero_n` of the load cell: read = true x factor + zero. A fault
          counts where its odds are above 1, and else not at all;
        - `bend`, q of the boat;
        - `askew_ratio`, root mean square of what being pulled askew added to ln Cw: not corrected;
        - `ln_sd` of the instruments' error in ln Cw, per unit of 2 + 2 q, faults that are
          unresolved among it;
        - `others_ln_ratio`, change of ln Cw with the instruments as the other boats show them;
        - `measured_ln_cw`, of the tow alone, and `best_ln_cw`, `best_lo`, `best_hi` (95 %).

        And rows `tow_id, rests_on, weight`: weights of the boat's tows, which sum to 1.
    """
    fit = posterior.fit
    model, archive = fit.model, fit.model.archive
    has_log = posterior.has_log
    ln_factor = np.where(has_log, posterior.ln_factor, 0.0)
    is_force = fit.is_fault & (fit.name == FORCE)
    is_zero = fit.is_fault & np.isin(fit.name, (ZERO, ZERO_DRIFT))
    ln_force = fit.covariate[:, is_force] @ fit.value[is_force]
    zero_n = fit.covariate[:, is_zero] @ fit.value[is_zero]
    ln_force_read = ln_force - np.log1p(-zero_n / archive.force_n)
    predicted = model.linearize_at(ln_factor).predicted[:, LEVEL]

    is_corrected = fit.is_log | is_force | is_zero
    applied = np.where(is_corrected, fit.instrument_design, 0.0)
    change = _compute_change_without_boat(fit)[archive.hull]
    best, weights = _estimate_best(posterior)
    numbers = {
        "factor": np.where(has_log, np.exp(ln_factor), np.nan),
        "force_factor": np.exp(ln_force),
        "force_zero_n": zero_n,
        "bend": archive.usual_bend,
        "askew_ratio": _compute_askew_ratio(fit),
        "ln_sd": np.where(has_log, _compute_instrument_sd(posterior), model.priors.log_sd),
        "others_ln_ratio": np.where(has_log, -(applied * change).sum(axis=1), np.nan),
        "measured_ln_cw": archive.column("ln_cw") - predicted - ln_force_read,
        "best_ln_cw": best[:, 0],
        "best_lo": best[:, 1],
        "best_hi": best[:, 2],
    }
    columns = pl.DataFrame(numbers).fill_nan(None).get_columns()
    return archive.frame.with_columns(columns), weights


def _compute_instrument_sd(posterior: Posterior) -> FloatArray:
    """Return the sd of the instruments' error in ln Cw per unit of 2 + 2 q, (n,).

    The log's error is that of the mean over its tows (`factors.make_factor_table`).
    """
    fit, archive = posterior.fit, posterior.fit.model.archive
    design = fit.instrument_design
    variance = ((design @ fit.covariance) * design).sum(axis=1)
    scatter = np.append(fit.mean_log_scatter, 0.0)[archive.log]
    by_log = fit.linear.by_channel["log"][:, LEVEL]
    variance += scatter * (2.0 * variance / fit.model.priors.log_sd**2 - by_log**2)
    variance += posterior.unresolved_variance
    return np.asarray(np.sqrt(np.maximum(variance, 0.0)) / (2.0 + 2.0 * archive.usual_bend))


def _compute_change_without_boat(fit: Fit) -> FloatArray:
    """Return by how much every effect changes when a boat is left out, (boats, k): one step."""
    hull = fit.model.archive.hull
    k = len(fit.value)
    information = np.zeros((hull.max() + 1, k, k))
    score = np.zeros((hull.max() + 1, k))
    for b in fit.boats:
        boat = hull[b.group.tow[:, 0]]
        np.add.at(information, boat, b.information_per_boat)
        np.add.at(score, boat, b.score)
    remaining = np.linalg.inv(fit.covariance) - information
    return np.asarray(-np.linalg.solve(remaining, score[:, :, None])[:, :, 0])


def _compute_askew_ratio(fit: Fit) -> FloatArray:
    """Return the root mean square of what being pulled askew added to ln Cw of each tow, (n,)."""
    excess = fit.model.priors.askew_excess
    ratio = np.zeros(len(fit.model.archive.y))
    for b in fit.boats:
        weighted_residual = b.weighted_residual[..., LEVEL::3]
        precision = np.einsum("bpii->bpi", b.precision)[..., LEVEL::3]
        mean = excess.mean * b.group.is_askew + excess.sd**2 * weighted_residual
        variance = excess.sd**2 - excess.sd**4 * precision
        probability = b.probability[:, :, None] * b.group.is_askew
        is_likely = probability.sum(axis=1) > MIN_ASKEW_PROBABILITY
        square = (probability * (mean**2 + variance)).sum(axis=1)
        ratio[b.group.tow] = np.sqrt(np.where(is_likely, square, 0.0))
    return ratio


def _estimate_best(posterior: Posterior) -> tuple[FloatArray, pl.DataFrame]:
    """Return ln Cw of each tow by all tows with its bounds, (n, 3), and the weights behind it."""
    fit, archive = posterior.fit, posterior.fit.model.archive
    best = np.zeros((len(archive.y), 3))
    listed = []
    for b in fit.boats:
        best[b.group.tow], weight = _predict_levels(b, posterior)
        tow, other = np.broadcast_arrays(b.group.tow[:, :, None], b.group.tow[:, None])
        columns = {"tow": tow.ravel(), "other": other.ravel(), "weight": weight.ravel()}
        listed.append(pl.DataFrame(columns))
    best += (archive.mean_level + fit.boat_design @ fit.value)[:, None]

    weights = pl.concat(listed).sort("tow", "other")
    # A tow whose log is not determined stays as measured.
    is_alone = pl.Series(~posterior.has_log[weights["tow"]])
    alone = (pl.col("tow") == pl.col("other")).cast(pl.Float64)
    weights = (
        weights.with_columns(pl.when(is_alone).then(alone).otherwise("weight").alias("weight"))
        .filter(pl.col("weight").abs() >= MIN_WEIGHT)
        .with_columns(pl.col("weight") / pl.col("weight").sum().over("tow"))
    )
    tow_id = archive.frame["tow_id"]
    return best, weights.select(
        tow_id=tow_id.gather(weights["tow"]),
        rests_on=tow_id.gather(weights["other"]),
        weight="weight",
    )


def _predict_levels(b: GroupPosterior, posterior: Posterior) -> tuple[FloatArray, FloatArray]:
    """Predict the level of boats at each of their tows (BLUP), less the boat's mean.

    Under a pattern the level is normal: mean = K P r, variance = L - K P K' plus what the effects
    and unresolved faults are uncertain by, with L the prior covariance of the levels and K theirs
    with the numbers.

    Returns:
        (b, T, 3) mean and bounds of the mixture over patterns, and (b, T, T) the weight of each
        observed ln Cw in each level.
    """
    fit, priors = posterior.fit, posterior.fit.model.priors
    boats, tows = b.group.tow.shape
    is_after = b.group.is_after
    both_after = is_after[:, :, None] & is_after[:, None, :]
    drift = np.exp(fit.ln_variance[-1]) * b.group.shared_years
    prior = priors.level_sd**2 + priors.altered_sd**2 * both_after + drift[:, None]  # (b, p, T, T)
    by_level = fit.linear.by_boat[b.group.tow][..., 0]
    with_numbers = np.einsum("bpkl,bli->bpkli", prior, by_level).reshape(boats, -1, tows, 3 * tows)
    gain = with_numbers @ b.precision

    mean = np.einsum("bpkn,bpn->bpk", with_numbers, b.weighted_residual)
    own_variance = np.einsum("bpkk->bpk", prior) - (gain * with_numbers).sum(axis=3)
    by_effects = fit.boat_design[b.group.tow][:, None] - gain @ b.design[:, None]
    variance = own_variance + ((by_effects @ fit.covariance) * by_effects).sum(axis=3)
    variance = variance + posterior.unresolved_variance[b.group.tow][:, None]
    sd = np.sqrt(np.maximum(variance, 1e-12))

    probability = np.repeat(b.probability[:, :, None], tows, axis=2)
    lower, upper = _find_mixture_bounds(probability, mean, sd)
    estimate = np.stack([(probability * mean).sum(axis=1), lower, upper], axis=2)
    of_ln_cw = gain.reshape(boats, -1, tows, tows, 3)[..., LEVEL]
    return estimate, np.einsum("bp,bpkl->bkl", b.probability, of_ln_cw)


def _find_mixture_bounds(
    probability: FloatArray, mean: FloatArray, sd: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return both bounds of the 95 % interval of normal mixtures over axis 1, by bisection."""
    bounds = []
    for quantile in (0.5 - 0.5 * INTERVAL_LEVEL, 0.5 + 0.5 * INTERVAL_LEVEL):
        low = (mean - MAX_QUANTILE_SD * sd).min(axis=1)
        high = (mean + MAX_QUANTILE_SD * sd).max(axis=1)
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            below = scipy.special.ndtr((middle[:, None] - mean) / sd)
            is_low = (probability * below).sum(axis=1) < quantile
            low = np.where(is_low, middle, low)
            high = np.where(is_low, high, middle)
        bounds.append(0.5 * (low + high))
    return bounds[0], bounds[1]
