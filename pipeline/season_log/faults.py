"""The search of instrument faults: score test, refit, accept by evidence.

A candidate fault is tried if its score test promises posterior odds above 1: with score s,
information i (given all other effects) and prior variance w,

    ln odds = ln(p / (1 - p)) - 1/2 ln(1 + w i) + 1/2 s^2 w / (1 + w i).

It stays if the odds of its own fit are above 1 too. There they are a Savage-Dickey ratio: with
estimate u and posterior variance c,

    ln odds = ln(p / (1 - p)) + 1/2 ln(c / w) + 1/2 u^2 / c.

Faults enter and leave one at a time. No average is taken over models.

A fault also needs boats (`boat_evidence`): one boat that differs from its other tows may have been
altered, and nothing tells that from an instrument that was off. A fault that one boat alone shows
is unresolved. It is not corrected; both explanations are named, and the interval holds both.
"""

from dataclasses import dataclass, replace
from typing import Final, TypeAlias

import numpy as np
import scipy

from pipeline.arrays import BoolArray, FloatArray, IntArray
from pipeline.choice import find_first_largest
from pipeline.season_log.archive import LEVEL
from pipeline.season_log.boat_evidence import BoatEvidence, count_boats_needed
from pipeline.season_log.factors import find_refused
from pipeline.season_log.fit import Fit, Model, fit_model
from pipeline.season_log.observation_model import BOAT_EFFECTS

MAX_FAULTS: Final = 12
SEARCH_TOLERANCE: Final = 1e-4
"""Tolerance of a fit that only has to decide which faults to include."""

Kind: TypeAlias = tuple[str, int | None, int]
"""`Effect.kind`."""


@dataclass(frozen=True)
class ScoreTest:
    """What each candidate fault, added by itself, would do to a fit; f faults, k effects.

    Attributes:
        ln_odds: (f,) posterior ln odds that there is such a fault.
        would_show: (f,) whether a fault of the size of its prior would have odds above 1.
        displaced: (f,) place among the fit's effects of the one that would move most, in standard
            deviations: what the fault is mistaken for while it is not in the model.
    """

    ln_odds: FloatArray
    would_show: BoolArray
    displaced: IntArray


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
    """The estimate of everything; n tows, f candidate faults.

    Attributes:
        fit: with the faults whose odds are above 1.
        probability: (f,) of each candidate fault; 0 where its own fit did not bear out the test.
        test: of all candidates beside the fit.
        has_boats: (f,) whether enough boats inform a fault for it to be told from an alteration of
            one of them.
        unresolved: at most one fault per season, that too few boats show.
        is_refused: (logs,) whether a factor contradicts what needs no model (`find_refused`).
    """

    fit: Fit
    probability: FloatArray
    test: ScoreTest
    has_boats: BoolArray
    unresolved: tuple[UnresolvedFault, ...]
    is_refused: BoolArray

    @property
    def would_show(self) -> BoolArray:
        """Whether a fault of the usual size would be found, (f,)."""
        return np.asarray(self.test.would_show & self.has_boats)

    @property
    def unresolved_variance(self) -> FloatArray:
        """Variance of ln Cw of each tow by faults that are unresolved, (n,).

        Anything between nothing and the whole fault is equally likely, and nothing is corrected: a
        rectangular distribution about one of its ends (GUM, 4.3.7 and F.2.4.5).
        """
        model = self.fit.model
        variance = np.zeros(len(model.archive.y))
        for fault in self.unresolved:
            design = model.effects.design(self.fit.linear, np.array([fault.place]))
            variance += (design[:, LEVEL, 0] * fault.size) ** 2 / 3.0
        return variance

    @property
    def is_determined(self) -> BoolArray:
        """Logs that are connected with the anchor and not refused, (logs,)."""
        return np.asarray(self.fit.model.archive.is_connected & ~self.is_refused)

    @property
    def has_log(self) -> BoolArray:
        """Tows whose log is determined, and anchored tows, (n,)."""
        return np.append(self.is_determined, True)[self.fit.model.archive.log]

    @property
    def ln_factor(self) -> FloatArray:
        """Estimated ln factor of each tow's log; NaN where not determined, 0 with dGPS, (n,)."""
        return np.where(self.has_log, self.fit.ln_log_factor, np.nan)


def find_posterior(model: Model, near: Fit | None = None) -> Posterior:
    """Return the estimate of everything, with the faults that the archive shows.

    Args:
        near: a rough fit to the same tows, compared at other speeds.
    """
    rough = find_rough_fit(model, near)
    final = fit_model(model, rough.active, rough)
    converged = rough.has_converged and final.has_converged
    return _conclude(replace(final, has_converged=converged))


def find_rough_fit(model: Model, near: Fit | None = None) -> Fit:
    """Return a fit to `SEARCH_TOLERANCE`, with the faults that the archive shows.

    The search begins without altered boats. A log that was replaced looks like many tows pulled
    askew, and then is not missed; from a start where that cannot be, it is found.
    """
    if near is None or not _have_same_effects(near.model, model):
        near = _search_faults(model, None, with_patterns=False)
    return _search_faults(model, near, with_patterns=True)


def _have_same_effects(one: Model, other: Model) -> bool:
    """Return whether two models have the same effects, each with the same prior."""
    if len(one.effects.listed) != len(other.effects.listed):
        return False
    pairs = zip(one.effects.listed, other.effects.listed, strict=True)
    return all((a.kind, a.first_tow, a.sd) == (b.kind, b.first_tow, b.sd) for a, b in pairs)


def _search_faults(model: Model, start: Fit | None, with_patterns: bool) -> Fit:
    """Return the fit with every fault whose odds are above 1, and without the others.

    Test and own fit may disagree, so that a fault would come and go, or move from day to day. So a
    fault whose kind leads back to an earlier model is not tried again.
    """
    active = model.effects.permanent if start is None else start.active
    fit = fit_model(model, active, start, SEARCH_TOLERANCE, with_patterns)
    tried: set[tuple[Kind, ...]] = set()
    for _ in range(2 * MAX_FAULTS):
        tried.add(_list_kinds_of_faults(model, fit.active))
        places, ln_odds = compute_odds_in_fit(fit)
        ln_odds[~_is_borne_out_by_boats(fit, places)] = -np.inf
        if len(places) and ln_odds.min() < 0.0:
            active = np.delete(fit.active, places[ln_odds.argmin()])
        else:
            fault = _find_most_needed_fault(fit, tried)
            if fault is None:
                return fit
            active = np.append(fit.active, fault)
        fit = fit_model(model, active, fit, SEARCH_TOLERANCE, with_patterns)
        if fit.is_fault.sum() > MAX_FAULTS:
            break
    return replace(fit, has_converged=False)


def _list_kinds_of_faults(model: Model, active: IntArray) -> tuple[Kind, ...]:
    """Return the sorted kinds of the faults among some effects."""
    faults = active[model.effects.probability[active] < 1.0]
    return tuple(sorted(model.effects.listed[place].kind for place in faults))


def _find_most_needed_fault(fit: Fit, tried: set[tuple[Kind, ...]]) -> int | None:
    """Return the place of the fault with the largest odds above 1, of models not yet tried."""
    model = fit.model
    faults = model.effects.faults
    ln_odds = score_candidates(fit).ln_odds
    for place, fault in enumerate(faults):
        kinds = _list_kinds_of_faults(model, np.append(fit.active, fault))
        if fault in fit.active or kinds in tried:
            ln_odds[place] = -np.inf
    promising = np.flatnonzero(ln_odds > 0.0)
    ln_odds[promising[~_has_boats(fit, faults[promising])]] = -np.inf
    best = int(find_first_largest(ln_odds))
    return int(faults[best]) if ln_odds[best] > 0.0 else None


def _has_boats(fit: Fit, faults: IntArray) -> BoolArray:
    """Return whether enough boats inform faults, by their places among the effects, (c,)."""
    n_boats = BoatEvidence.from_fit(fit, faults).n_informing
    return np.asarray(n_boats >= count_boats_needed(fit.model, faults))


def _is_borne_out_by_boats(fit: Fit, places: IntArray) -> BoolArray:
    """Return whether enough boats bear out faults of a fit, by their places in the fit, (c,)."""
    faults = fit.active[places]
    n_agreeing = BoatEvidence.from_fit(fit, faults).count_agreeing(fit.value[places])
    return np.asarray(n_agreeing >= count_boats_needed(fit.model, faults))


def score_candidates(fit: Fit) -> ScoreTest:
    """Return the score test of every candidate fault beside a fit."""
    effects = fit.model.effects
    faults = effects.faults
    design = effects.design(fit.linear, faults).reshape(-1, len(faults))
    cross = np.zeros((len(fit.value), len(faults)))  # information shared with the effects
    own = np.zeros(len(faults))  # information on each fault, were the effects known
    score = np.zeros(len(faults))
    for b in fit.boats:
        by_fault = design[b.group.numbers]
        weighted = b.observed_precision @ by_fault
        cross += np.tensordot(b.design, weighted, axes=([0, 1], [0, 1]))
        own += (by_fault * weighted).sum(axis=(0, 1))
        score += np.tensordot(b.mean_residual, by_fault, axes=([0, 1], [0, 1]))
    shift = fit.covariance @ cross
    information = np.maximum(own - (cross * shift).sum(axis=0), 0.0)
    ratio = effects.variance[faults] * information  # w i
    ln_prior = scipy.special.logit(effects.probability[faults]) - 0.5 * np.log1p(ratio)
    standardized = np.abs(shift) / np.sqrt(np.diag(fit.covariance))[:, None]
    return ScoreTest(
        ln_odds=0.5 * score**2 * effects.variance[faults] / (1.0 + ratio) + ln_prior,
        would_show=0.5 * ratio**2 / (1.0 + ratio) + ln_prior > 0.0,
        displaced=find_first_largest(standardized),
    )


def compute_odds_in_fit(fit: Fit) -> tuple[IntArray, FloatArray]:
    """Return the faults in a fit, as places among its effects, and their ln odds."""
    places = np.flatnonzero(fit.is_fault)
    probability = fit.model.effects.probability[fit.active[places]]
    variance = np.diag(fit.covariance)[places]
    savage_dickey = np.log(variance / fit.prior_variance[places])
    savage_dickey += fit.value[places] ** 2 / variance
    return places, scipy.special.logit(probability) + 0.5 * savage_dickey


def _conclude(fit: Fit) -> Posterior:
    """Return the posterior that follows from the last fit."""
    test = score_candidates(fit)
    # A candidate that the test still favours was tried, and its own fit rejected it.
    probability = np.where(test.ln_odds > 0.0, 0.0, scipy.special.expit(test.ln_odds))
    places, ln_odds = compute_odds_in_fit(fit)
    row = np.searchsorted(fit.model.effects.faults, fit.active[places])
    probability[row] = scipy.special.expit(ln_odds)
    return Posterior(
        fit=fit,
        probability=probability,
        test=test,
        has_boats=_has_boats(fit, fit.model.effects.faults),
        unresolved=_find_unresolved(fit),
        is_refused=find_refused(fit),
    )


def _find_unresolved(fit: Fit) -> tuple[UnresolvedFault, ...]:
    """Return the faults that a boat alone would show, were it not altered, and no other can tell.

    Of a season the likeliest only: what one boat shows, other kinds of faults would explain as
    well. That all boats changed is not told from one that did.
    """
    effects = fit.model.effects
    is_instrument = ~np.isin(effects.name[effects.faults], BOAT_EFFECTS)
    faults = effects.faults[is_instrument & ~np.isin(effects.faults, fit.active)]
    evidence = BoatEvidence.from_fit(fit, faults)
    ln_odds = evidence.ln_odds(effects.variance[faults], effects.probability[faults])
    ln_odds[~evidence.informs] = -np.inf
    # One boat more than a fault needs settles which of them was altered.
    ln_odds[:, evidence.n_informing > count_boats_needed(fit.model, faults)] = -np.inf
    season = np.array([effects.listed[fault].season for fault in faults], dtype=np.float64)
    hull_names = fit.model.archive.hull_names
    unresolved = []
    for year in np.unique(season[(ln_odds > 0.0).any(axis=0)]):
        likeliest = find_first_largest(np.where(season == year, ln_odds.max(axis=0), -np.inf))
        shown_by = np.flatnonzero(ln_odds[:, likeliest] > 0.0)
        sizes = evidence.size[shown_by, likeliest]
        fault = UnresolvedFault(
            place=int(faults[likeliest]),
            size=float(sizes[np.abs(sizes).argmax()]),
            boats=tuple(hull_names[shown_by].tolist()),
        )
        unresolved.append(fault)
    return tuple(unresolved)
