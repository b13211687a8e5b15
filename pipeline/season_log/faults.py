"""Which faults there are: each joins or leaves the model by its odds, one at a time.

A fault enters by what one step from a fit promises, and stays by its own fit or not at all. It also
needs boats: one boat that differs from its other tows may have been altered, and nothing tells that
from an instrument that was off (`boat_evidence`). A fault that one boat alone shows is unresolved.
It is not corrected; both explanations are named, and the interval holds both.
"""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import scipy

from pipeline.arrays import BoolArray, FloatArray, IntArray
from pipeline.choice import first_largest
from pipeline.model import Scores
from pipeline.season_log.boat_evidence import BoatEvidence, boats_needed
from pipeline.season_log.boats import LEVEL
from pipeline.season_log.effects import OF_BOATS
from pipeline.season_log.factors import refused
from pipeline.season_log.fit import Fit, Problem, fit

MOST_FAULTS: Final = 12
ROUGH: Final = 1e-4
"""Movement at which a fit is good enough to ask which faults there are."""


@dataclass(frozen=True)
class UnresolvedFault:
    """An instrument fault that one boat alone shows, or two that disagree.

    Attributes:
        place: its place among the effects.
        size: what the boat's own tows make of it, if the boat was not altered.
        boats: numbers of the boats that show it.
    """

    place: int
    size: float
    boats: tuple[str, ...]


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
        has_boats: (faults,) whether enough boats inform a fault for it to be told from an
            alteration of one of them.
        unresolved: at most one fault per season, that too few boats show.
        refused: (logs,) whether the factor of a log contradicts what needs no model
            (`factors.refused`).
    """

    fit: Fit
    chance: FloatArray
    shows: BoolArray
    hidden_by: IntArray
    has_boats: BoolArray
    unresolved: tuple[UnresolvedFault, ...]
    refused: BoolArray

    @property
    def determined(self) -> BoolArray:
        """Logs that are tied to the anchor and not refused, (logs,)."""
        tied = self.fit.problem.tows.logs["component"].to_numpy() == 0
        return np.asarray(tied & ~self.refused)

    @property
    def unresolved_variance(self) -> FloatArray:
        """Variance of ln Cw of each tow by faults that are unresolved, (tows,).

        Anything between nothing and the whole fault is equally likely, and nothing is corrected: a
        rectangular distribution about one of its ends (GUM, 4.3.7 and F.2.4.5).
        """
        effects = self.fit.problem.effects
        variance = np.zeros(len(self.fit.problem.q))
        for fault in self.unresolved:
            design = effects.design(self.fit.slopes, np.array([fault.place]))
            variance += (design[:, LEVEL, 0] * fault.size) ** 2 / 3.0
        return variance

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
    ln_odds[~_agrees_with_boats(fitted, places)] = -np.inf
    if len(places) and ln_odds.min() < 0.0:
        return np.delete(fitted.active, places[int(ln_odds.argmin())])
    faults = fitted.problem.effects.faults
    more, _ = _odds(fitted, _scores(fitted))
    there = [_kinds(fitted, also) in fitted_before for also in faults.tolist()]
    more[np.isin(faults, fitted.active) | there] = -np.inf
    promising = np.flatnonzero(more > 0.0)
    more[promising[~_has_boats(fitted, faults[promising])]] = -np.inf
    best = int(first_largest(more))
    return np.append(fitted.active, faults[best]) if more[best] > 0.0 else None


def _has_boats(fitted: Fit, faults: IntArray) -> BoolArray:
    """Return of which faults, by their places among the effects, enough boats tell."""
    n_boats = BoatEvidence.from_fit(fitted, faults).n_informing
    return np.asarray(n_boats >= boats_needed(fitted.problem, faults))


def _agrees_with_boats(fitted: Fit, places: IntArray) -> BoolArray:
    """Return which faults of the fit, by their places in it, enough boats bear out."""
    faults = fitted.active[places]
    n_agreeing = BoatEvidence.from_fit(fitted, faults).count_agreeing(fitted.value[places])
    return np.asarray(n_agreeing >= boats_needed(fitted.problem, faults))


def _find_unresolved(fitted: Fit) -> tuple[UnresolvedFault, ...]:
    """Return the faults that a boat alone would show, were it not altered, and no other can tell.

    Of a season the likeliest only: what one boat shows, other kinds of faults would explain as
    well. That all boats changed is not told from one that did.
    """
    effects = fitted.problem.effects
    is_candidate = ~np.isin(effects.frame["name"].to_numpy()[effects.faults], OF_BOATS)
    faults = effects.faults[is_candidate & ~np.isin(effects.faults, fitted.active)]
    prior = effects.column("variance", faults)
    chance = effects.column("chance", faults)
    evidence = BoatEvidence.from_fit(fitted, faults)
    ln_odds = np.where(evidence.informs, evidence.ln_odds(prior, chance), -np.inf)
    # One boat more than a fault needs settles which of them was altered.
    ln_odds[:, evidence.n_informing > boats_needed(fitted.problem, faults)] = -np.inf
    season = effects.column("season", faults)
    hulls = fitted.problem.tows.hull_names
    found = []
    for year in np.unique(season[(ln_odds > 0.0).any(axis=0)]):
        likeliest = first_largest(np.where(season == year, ln_odds.max(axis=0), -np.inf))
        shown_by = np.flatnonzero(ln_odds[:, likeliest] > 0.0)
        sizes = evidence.size[shown_by, likeliest]
        found.append(
            UnresolvedFault(
                place=int(faults[likeliest]),
                size=float(sizes[np.abs(sizes).argmax()]),
                boats=tuple(hulls[shown_by].tolist()),
            )
        )
    return tuple(found)


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
    has_boats = _has_boats(fitted, faults)
    return Posterior(
        fit=fitted,
        chance=chance,
        shows=shows & has_boats,
        hidden_by=hidden_by,
        has_boats=has_boats,
        unresolved=_find_unresolved(fitted),
        refused=refused(fitted),
    )
