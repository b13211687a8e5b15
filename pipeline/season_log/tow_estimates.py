"""What the posterior says of single tows: instrument errors, and the boat's best estimate.

The measurand is ln Cw of the hull at its reference speed on the day of the tow. As measured, a tow
stands alone with the corrections of its instruments; the best estimate adds what the boat's other
tows say. Its weights on the boat's tows sum to 1: the boat's level is its own.
"""

from typing import Final

import numpy as np
import polars as pl
import scipy

from pipeline.arrays import FloatArray
from pipeline.model import Boats
from pipeline.quantiles import LEVEL as INTERVAL_LEVEL
from pipeline.season_log.boats import LEVEL, Patterns
from pipeline.season_log.effects import FORCE, ZERO, ZERO_DRIFT
from pipeline.season_log.faults import Posterior
from pipeline.season_log.fit import Fit, level_of_boats

BISECTIONS: Final = 40
LIKELY: Final = 0.05
"""A tow that was less likely pulled askew is taken for straight: the interval leaves that out."""
FARTHEST_SD: Final = 12.0
LEAST_WEIGHT: Final = 0.005
"""A smaller share of what an estimate rests on is left out of the list."""


def with_estimates(posterior: Posterior) -> tuple[pl.DataFrame, pl.DataFrame]:
    """What the instruments did to each tow, and what all tows say of its ln Cw.

    A fault counts where it is likelier than not, and not at all where it is not.

    Returns:
        The tows with `factor` of the log (null where the season is not determined; 1 with dGPS),
        `force_factor` and `force_zero_n` of the load cell: read = true x factor + zero; `bend`, q
        of the boat; `askew_ratio`, what being pulled askew may have added to ln Cw (root mean
        square; not corrected, and 0 where it is unlikely); `ln_sd` and `dof` of what the
        instruments do to ln Cw, per unit of the elasticity 2 + 2 q, faults that are unresolved
        among it; `others_ln_ratio`, change of ln
        Cw with the instruments as the other boats alone show them; `measured_ln_cw`, by the tow
        alone with these corrections; and `best_ln_cw, best_lo, best_hi` (95 %), by all.
        And the shares `tow_id, rests_on, weight` of the boat's tows in that, which sum to 1.
    """
    fitted, problem, speed = posterior.fit, posterior.fit.problem, posterior.fit.of_log
    level = np.where(fitted.of_boats, 0.0, fitted.design[:, LEVEL])
    force = fitted.is_fault & (fitted.name == FORCE)
    zero = fitted.is_fault & np.isin(fitted.name, (ZERO, ZERO_DRIFT))
    variance = ((level @ fitted.covariance) * level).sum(axis=1)
    own = np.append(fitted.scatter_of_means, 0.0)[problem.tows.log]  # -1, anchored, reads the last
    by_log = fitted.slopes.ways["speed"][:, LEVEL] ** 2
    variance += own * (2.0 * variance / problem.settings.log_sd**2 - by_log)
    variance += posterior.unresolved_variance
    known = np.sqrt(np.maximum(variance, 0.0)) / (2.0 + 2.0 * problem.q)
    applied = np.where(speed | force | zero, level, 0.0)
    change = _without_each_boat(fitted)[problem.tows.frame["hull"].to_numpy()]
    others = -(applied * change).sum(axis=1)
    share, value, determined = fitted.share, fitted.value, posterior.log_known
    ln_factor = np.where(determined, posterior.ln_factor, 0.0)
    ln_force, zero_n = share[:, force] @ value[force], share[:, zero] @ value[zero]
    by_force = ln_force - np.log1p(-zero_n / problem.force_n)
    measured = problem.tows.numbers("ln_cw") - problem.slopes(ln_factor).predicted[:, LEVEL]
    best, weights = _best(posterior)
    numbers = {
        "factor": np.where(determined, np.exp(ln_factor), np.nan),
        "force_factor": np.exp(ln_force),
        "force_zero_n": zero_n,
        "bend": problem.q,
        "askew_ratio": _askew(fitted),
        "ln_sd": np.where(determined, known, problem.settings.log_sd),
        "dof": fitted.dof(level),
        "others_ln_ratio": np.where(determined, others, np.nan),
        "measured_ln_cw": measured - by_force,
        **dict(zip(("best_ln_cw", "best_lo", "best_hi"), best.T, strict=True)),
    }
    columns = [pl.Series(name, values).fill_nan(None) for name, values in numbers.items()]
    return problem.tows.frame.drop("boat", "hull", "log_place").with_columns(columns), weights


def _without_each_boat(fitted: Fit) -> FloatArray:
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


def _askew(fitted: Fit) -> FloatArray:
    """Root mean square of what being pulled askew added to ln Cw of each tow."""
    problem = fitted.problem
    square = np.zeros(len(problem.q))
    for group, boats in zip(problem.groups, fitted.boats, strict=True):
        pull = boats.pull[..., LEVEL::3]
        own = np.einsum("bpkk->bpk", boats.precision_of_patterns)[..., LEVEL::3]
        variance = problem.settings.askew_excess.sd**2
        mean = group.excess + variance * pull
        weight = boats.weight[:, :, None] * group.askew
        weight *= weight.sum(axis=1, keepdims=True) > LIKELY
        there = (weight * (mean**2 + variance - variance**2 * own)).sum(axis=1)
        square[group.tow] = there
    return np.sqrt(square)


def _best(posterior: Posterior) -> tuple[FloatArray, pl.DataFrame]:
    """Ln Cw of each tow by all, with bounds, (tows, 3), and the shares of the boat's tows."""
    fitted, problem = posterior.fit, posterior.fit.problem
    numbers = np.zeros((len(problem.q), 3))
    shares = []
    for group, boats in zip(problem.groups, fitted.boats, strict=True):
        numbers[group.tow], weight = _of_boats(group, boats, posterior)
        tow, other = np.broadcast_arrays(group.tow[:, :, None], group.tow[:, None])
        shares.append(pl.DataFrame({"tow": tow.ravel(), "other": other.ravel(), "weight": weight}))
    numbers += (problem.boat_level + level_of_boats(fitted))[:, None]
    names, known = problem.tows.frame["tow_id"], posterior.log_known
    listed = pl.concat(shares)
    alone = (pl.col("tow") == pl.col("other")).cast(pl.Float64)
    weights = (
        listed.with_columns(
            pl.when(pl.Series(known[listed["tow"]])).then("weight").otherwise(alone).alias("weight")
        )
        .filter(pl.col("weight").abs() >= LEAST_WEIGHT)
        .sort("tow", "other")
        .with_columns(pl.col("weight") / pl.col("weight").sum().over("tow"))
    )
    return numbers, weights.select(
        tow_id=names.gather(weights["tow"]),
        rests_on=names.gather(weights["other"]),
        weight="weight",
    )


def _of_boats(group: Patterns, boats: Boats, posterior: Posterior) -> tuple[FloatArray, FloatArray]:
    """Boats with the same number of tows: (boats, tows, 3) numbers, and the shares, flat."""
    fitted = posterior.fit
    count, tows = group.tow.shape
    state = fitted.slopes.state[group.tow][..., 0]
    # Covariance of the level at each tow with every number of the boat, per pattern.
    level = group.level + (fitted.drift_variance * group.years)[:, None]
    with_level = np.einsum("bpkl,bli->bpkli", level, state).reshape(count, -1, tows, 3 * tows)
    gain = with_level @ boats.precision_of_patterns
    variance = np.einsum("bpkk->bpk", level) - (gain * with_level).sum(axis=3)
    of_all = np.where(fitted.of_boats, fitted.design[:, LEVEL], 0.0)
    by = of_all[group.tow][:, None] - gain @ boats.design[:, None]
    mean = np.einsum("bpkn,bpn->bpk", with_level, boats.pull)
    shared = np.einsum("bpkf,fg,bpkg->bpk", by, fitted.covariance, by, optimize=True)
    unresolved = posterior.unresolved_variance[group.tow][:, None]
    variance = np.maximum(variance + shared + unresolved, 1e-12)
    weight = np.repeat(boats.weight[:, :, None], tows, axis=2)
    average = (weight * mean).sum(axis=1)
    bounds = _quantiles(weight, mean, np.sqrt(variance))
    on_level = gain.reshape(count, -1, tows, tows, 3)[..., LEVEL]
    shares = np.einsum("bp,bpkl->bkl", boats.weight, on_level)
    return np.stack([average, *bounds], axis=2), shares.ravel()


def _quantiles(weight: FloatArray, mean: FloatArray, sd: FloatArray) -> FloatArray:
    """Both bounds of the 95 % interval of normal mixtures over axis 1, by bisection."""
    level = 0.5 + 0.5 * INTERVAL_LEVEL * np.array([-1.0, 1.0])[:, None, None]
    low = (mean - FARTHEST_SD * sd).min(axis=1) + np.zeros_like(level)
    high = (mean + FARTHEST_SD * sd).max(axis=1) + np.zeros_like(level)
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        below = (weight * scipy.special.ndtr((middle[:, :, None] - mean) / sd)).sum(axis=2) < level
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return np.asarray(0.5 * (low + high))
