"""Which faults there are: each joins or leaves the model by its odds, one at a time.

A fault enters by what one step from a fit promises, and stays by its own fit or not at all.
"""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import scipy

from pipeline.arrays import BoolArray, FloatArray, IntArray
from pipeline.choice import first_largest
from pipeline.model import Scores
from pipeline.season_log.factors import refused
from pipeline.season_log.fit import Fit, Problem, fit

MOST_FAULTS: Final = 12
ROUGH: Final = 1e-4
"""Movement at which a fit is good enough to ask which faults there are."""


@dataclass(frozen=True)
class Posterior:
    """What is known of all effects, and of the faults that were left out of the model.

    Attributes:
        fit: with the faults that are likelier than not.
        chance: (faults,) probability of each fault, in the order of `Effects.faults`; 0 where its
            own fit did not bear out what one step promised.
        shows: (faults,) whether a fault of the usual size would be likelier than not.
        hidden_by: (faults,) effect of the fit that would move most, in standard deviations: what
            one that does not show passes for.
        refused: (logs,) whether the factor of a log contradicts what needs no model
            (`factors.refused`).
    """

    fit: Fit
    chance: FloatArray
    shows: BoolArray
    hidden_by: IntArray
    refused: BoolArray

    @property
    def determined(self) -> BoolArray:
        """Logs that are tied to the anchor and not refused, (logs,)."""
        tied = self.fit.problem.tows.logs["component"].to_numpy() == 0
        return np.asarray(tied & ~self.refused)

    @property
    def log_known(self) -> BoolArray:
        """Tows whose log is determined, and anchored ones, (tows,)."""
        return np.append(self.determined, [True])[self.fit.problem.tows.log]

    @property
    def ln_factor(self) -> FloatArray:
        """Of the log of each tow, NaN where it is not known; 0 with dGPS, (tows,)."""
        of_log = np.where(self.fit.of_log, self.fit.value, 0.0)
        return np.where(self.log_known, self.fit.share @ of_log, np.nan)


def solve(problem: Problem, near: Posterior | None = None) -> Posterior:
    """The posterior of everything, with the faults that the archive shows.

    Args:
        near: what `roughly` found where the same tows were compared at other speeds.
    """
    rough = roughly(problem, near).fit
    sharp = fit(problem, rough.active, rough)
    return _posterior(replace(sharp, settled=rough.settled and sharp.settled))


def roughly(problem: Problem, near: Posterior | None = None) -> Posterior:
    """The same, to `ROUGH`."""
    start = None if near is None else near.fit
    if start is None or not start.problem.effects.frame.equals(problem.effects.frame):
        start = _with_needed_faults(problem, None, changes=False)
    return _posterior(_with_needed_faults(problem, start))


def _with_needed_faults(problem: Problem, start: Fit | None, changes: bool = True) -> Fit:
    """The fit with every fault that is likelier than not, and without the others.

    A log that was replaced is easily taken for many tows pulled askew, and then is not missed. From
    a start where no boat had changed it is found; what changed boats do without is left again.

    Where the promise of one step and a fault's own fit disagree it would come and go, at one place
    after the other, so no fault leads to the kinds of faults of an earlier model.
    """
    active = problem.effects.always if start is None else start.active
    fitted = fit(problem, active, start, ROUGH, changes)
    fitted_before: set[tuple[int, ...]] = set()
    for _ in range(2 * MOST_FAULTS):
        fitted_before.add(_kinds(fitted))
        chosen = _better(fitted, fitted_before)
        if chosen is None:
            return fitted
        fitted = fit(problem, chosen, fitted, ROUGH, changes)
        if fitted.is_fault.sum() > MOST_FAULTS:
            break
    return replace(fitted, settled=False)


def _kinds(fitted: Fit, also: int | None = None) -> tuple[int, ...]:
    """Kinds of the faults of a model, and of one more, sorted."""
    places = fitted.active[fitted.is_fault].tolist() + ([] if also is None else [also])
    return tuple(sorted(fitted.problem.effects.column("kind", places).tolist()))


def _better(fitted: Fit, fitted_before: set[tuple[int, ...]]) -> IntArray | None:
    """The effects with the fault that is missed most, or without the one that is not needed.

    Args:
        fitted_before: kinds of faults of the models that no fault is to lead to.
    """
    places, ln_odds = _in_fit(fitted)
    if len(places) and ln_odds.min() < 0.0:
        return np.delete(fitted.active, places[int(ln_odds.argmin())])
    faults = fitted.problem.effects.faults
    more, _ = _odds(fitted, _scores(fitted))
    there = [_kinds(fitted, also) in fitted_before for also in faults.tolist()]
    more[np.isin(faults, fitted.active) | there] = -np.inf
    best = int(first_largest(more))
    return np.append(fitted.active, faults[best]) if more[best] > 0.0 else None


def _scores(fitted: Fit) -> Scores:
    """The scores of all faults that there may be."""
    effects = fitted.problem.effects
    design = effects.design(fitted.slopes, effects.faults)
    return Scores.of(fitted.boats, design.reshape(-1, design.shape[2]))


def _odds(fitted: Fit, scores: Scores) -> tuple[FloatArray, BoolArray]:
    """Ln odds of every fault beside the fit, and whether it would show (`Scores.odds`)."""
    effects = fitted.problem.effects
    prior, chance = (effects.column(name, effects.faults) for name in ("variance", "chance"))
    return scores.odds(fitted.covariance, prior, chance)


def _in_fit(fitted: Fit) -> tuple[IntArray, FloatArray]:
    """Faults in the fit, as places among its effects, and their ln odds (Savage-Dickey)."""
    places = np.flatnonzero(fitted.is_fault)
    effects, active = fitted.problem.effects, fitted.active[places]
    prior, chance = (effects.column(name, active) for name in ("variance", "chance"))
    variance = np.diag(fitted.covariance)[places]
    square = fitted.value[places] ** 2 / variance
    return places, 0.5 * (square + np.log(variance / prior)) + scipy.special.logit(chance)


def _posterior(fitted: Fit) -> Posterior:
    """The fit, with how likely each fault is beside it."""
    faults = fitted.problem.effects.faults
    scores, (places, ln_odds) = _scores(fitted), _in_fit(fitted)
    own = np.searchsorted(faults, fitted.active[places])
    more, shows = _odds(fitted, scores)
    # What the search has tried and rejected by its own fit has odds of one step still.
    chance = np.where(more > 0.0, 0.0, scipy.special.expit(more))
    chance[own] = scipy.special.expit(ln_odds)
    moved = np.abs(fitted.covariance @ scores.across)
    hidden_by = first_largest(moved / np.sqrt(np.diag(fitted.covariance))[:, None])
    return Posterior(fitted, chance, shows, hidden_by, refused(fitted))
