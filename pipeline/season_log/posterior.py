"""All unknowns at once: their posterior, the variances, and which faults there may be.

Given the alterations and faults the model is linear and Gaussian. The unknowns and the variances
are searched by scoring (REML: Patterson & Thompson 1971; variances with log-normal priors), the
posterior is Laplace's about the mode. A fault joins or leaves the model by its odds, one at a time,
and stays by its own fit or not at all.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
import scipy

from pipeline.arrays import BoolArray, FloatArray, IntArray, StrArray
from pipeline.choice import first_largest
from pipeline.model import Boats, Scores
from pipeline.season_log.assumed import Settings
from pipeline.season_log.effects import (
    OF_BOATS,
    WAYS,
    Slopes,
    Unknown,
    rectification,
    slopes,
    unknowns_of,
)
from pipeline.season_log.likelihood import (
    GPS,
    Patterns,
    boat_likelihoods,
    covariance_of,
    drift_of,
    patterns_of,
)
from pipeline.season_log.network import Network

MAX_ITERATIONS: Final = 500
TOLERANCE: Final = 1e-10
UNTROUBLED: Final = 4
"""First iterations, in which no boat is taken for changed: logs may be far off yet.

They step by the information as if that were certain. What is seen may tell next to nothing there,
and a step by it can leap to where the search finds no way back.
"""
LEAST_SD: Final = 0.001
"""No number of a tow is ever better known: keeps the search finite where all tows agree."""
NO_CHANGE: Final = np.full(2, 1e-300)
"""Shares of alterations and of tows pulled askew, where there are none."""
ACCELERATED: Final = 8
MODEST: Final = 0.1
"""Steps are accelerated after so many, when they are no larger than this."""
REMEMBERED: Final = 5
"""Steps that the acceleration looks back on."""
MOST_FAULTS: Final = 12
ROUGH: Final = 1e-4
"""Movement at which a fit is good enough to ask which faults there are."""
NOT_OBSERVED: Final = 1e4
"""Variance of a number that a tow does not have."""


@dataclass(frozen=True)
class Problem:
    """The tows of an archive as arrays; n tows.

    Attributes:
        network: the tows.
        observed: (n, 3) level (less its boat's mean), bend and ln(GPS / log).
        given: (n, 3, 3) their random covariance.
        absent: (n, 3, 3) huge variance of numbers that a tow does not have.
        boat_level: (n,) that mean.
        q, force_n: (n,) usual bend and force.
        reference_ln: (n,) ln factor of the log at whose true speed the numbers hold.
        unknowns: what there always is, then possible faults.
        share: (n, unknowns) how much of each a tow has.
        era: (n,) index; the last is that of calibrated tows, whenever.
        groups: boats by their number of tows, with what may have changed between these.
    """

    network: Network
    observed: FloatArray
    given: FloatArray
    absent: FloatArray
    boat_level: FloatArray
    q: FloatArray
    force_n: FloatArray
    reference_ln: FloatArray
    unknowns: list[Unknown]
    share: FloatArray
    era: IntArray
    groups: list[Patterns]
    settings: Settings

    @classmethod
    def of(cls, network: Network, settings: Settings) -> "Problem":
        """The problem that a network poses."""
        level, gps = network.numbers("ln_cw"), network.numbers("gps_ln_ratio")
        mean = network.boat_mean(level)
        has_gps = np.isfinite(gps) & (network.group >= 0)
        cov = network.numbers("ln_cw_q_cov")
        given = np.zeros((len(level), 3, 3))
        given[:, 0, 0], given[:, 1, 1] = (network.numbers(n) ** 2 for n in ("ln_cw_sd", "q_sd"))
        given[:, 0, 1] = given[:, 1, 0] = cov
        given[:, GPS, GPS] = np.where(has_gps, network.numbers("gps_sd") ** 2, 0.0)
        given += LEAST_SD**2 * np.eye(3)
        absent = np.zeros((len(level), 3, 3))
        absent[:, GPS, GPS] = np.where(has_gps, 0.0, NOT_OBSERVED)
        unknowns = unknowns_of(network, settings)
        reference_ln = network.numbers("reference_ln")
        log_speed = network.numbers("declared_speed_m_s") * np.exp(-reference_ln)
        season = network.numbers("season")
        era = np.searchsorted(settings.era_starts, season, side="right") - 1
        return cls(
            network,
            np.stack(
                [
                    level - mean,
                    network.numbers("q"),
                    np.where(has_gps, gps - rectification(network, settings), 0.0),
                ],
                axis=1,
            ),
            given,
            absent,
            mean,
            network.boat_mean(0.5 * network.numbers("kappa") - 1.0),
            np.exp(level) * log_speed**2,
            reference_ln,
            unknowns,
            np.stack([u.share for u in unknowns], axis=1),
            np.where(network.group >= 0, np.maximum(era, 0), len(settings.era_starts)),
            patterns_of(network.boat, season, season < settings.straight_from, settings),
            settings,
        )

    @property
    def always(self) -> IntArray:
        """Unknowns that there always are."""
        return np.flatnonzero([u.chance == 1.0 for u in self.unknowns])

    @property
    def faults(self) -> IntArray:
        """Unknowns of faults that there may be."""
        return np.flatnonzero([u.chance < 1.0 for u in self.unknowns])

    @property
    def kinds(self) -> IntArray:
        """Kind of each fault: all places where one log may have changed are one."""
        names = [(u.name, u.season, u.group) for u in (self.unknowns[i] for i in self.faults)]
        number = {name: place for place, name in enumerate(dict.fromkeys(names))}
        return np.array([number[name] for name in names], dtype=np.int64)

    def slopes(self, value: FloatArray, active: IntArray) -> tuple[Slopes, FloatArray]:
        """Slopes and residuals, (n, 3), at values of the active unknowns."""
        way = np.array([WAYS[self.unknowns[i].name] for i in active])
        speed = way == "speed"
        share = self.share[:, active]
        ln_factor = share[:, speed] @ value[speed]
        slopes_of_tows = slopes(self.q, self.force_n, ln_factor, self.reference_ln)
        others = np.where(speed, 0.0, value)
        return slopes_of_tows, self.observed - slopes_of_tows.predicted - self.design(
            slopes_of_tows, active
        ) @ others

    def design(self, tangent: Slopes, chosen: IntArray) -> FloatArray:
        """Slopes of the numbers by some unknowns, (n, 3, chosen)."""
        by = np.stack([tangent.ways[WAYS[self.unknowns[i].name]] for i in chosen], axis=2)
        return np.asarray(by * self.share[:, None, chosen])


@dataclass(frozen=True)
class _State:
    """What is searched: the active unknowns, ln variances, and the shares of what changes.

    `shares` are those of gaps between tows with an alteration that was not reported, and of tows
    that were pulled askew before steering straight was aided.
    """

    value: FloatArray
    ln_variance: FloatArray
    shares: FloatArray

    @property
    def drift_variance(self) -> float:
        """Of the drift of a boat's ln Cw, per year."""
        return float(np.exp(self.ln_variance[-1]))

    @property
    def array(self) -> FloatArray:
        return np.concatenate([self.value, self.ln_variance, scipy.special.logit(self.shares)])

    def of(self, array: FloatArray) -> "_State":
        k, variances = len(self.value), len(self.ln_variance)
        shares = scipy.special.expit(array[k + variances :])
        return _State(array[:k], array[k : k + variances], shares)


@dataclass(frozen=True)
class Fit:
    """Unknowns and variances at their mode.

    Attributes:
        active: (k,) unknowns in the model.
        state: their values, the ln variances and the shares of what changes. The variances are
            between tows, of bend, of GPS, of the log per era and where calibrated; last the drift
            of boats per year.
        covariance: (k, k) of the values.
        ln_variance_covariance: of the ln variances.
        groups: boats by number of tows; boats: what each group says there.
        slopes: of the numbers of each tow.
        own: (n, 3, 3) covariance of what is a tow's own.
        parts: (variances but that of drift, n, 3, 3) slope of `own` by each ln variance.
        settled: whether the search, and those that led to it, came to rest within their limits.
    """

    active: IntArray
    state: _State
    covariance: FloatArray
    ln_variance_covariance: FloatArray
    groups: list[Patterns]
    boats: list[Boats]
    slopes: Slopes
    own: FloatArray
    parts: FloatArray
    settled: bool = True

    @property
    def value(self) -> FloatArray:
        """Values of the active unknowns, (k,)."""
        return self.state.value

    def precision(self, group: Patterns) -> FloatArray:
        """Of the numbers of boats, (boats, patterns, n, n): too large to keep of every fit."""
        drift = drift_of(group, self.slopes.state, self.state.drift_variance)
        return np.asarray(np.linalg.inv(covariance_of(group, self.own, self.slopes.state, drift)))

    def dof(self, direction: FloatArray) -> FloatArray:
        """Satterthwaite's degrees of freedom of combinations of the active unknowns.

        Args:
            direction: (combinations, k).
        """
        along = direction @ self.covariance
        by = np.stack([((along @ one) * along).sum(axis=1) for one in self.moved], axis=1)
        variance = (along * direction).sum(axis=1)
        spread = np.einsum("ca,ab,cb->c", by, self.ln_variance_covariance, by)
        return np.asarray(2.0 * variance**2 / np.maximum(spread, 1e-300))

    @cached_property
    def moved(self) -> FloatArray:
        """Slope of the covariance of the scores by each ln variance, (variances, k, k)."""
        k = len(self.active)
        by_number, by_drift = np.zeros((3 * len(self.own), k)), np.zeros((k, k))
        for group, boats in zip(self.groups, self.boats, strict=True):
            weighed = boats.weighed
            drift = drift_of(group, self.slopes.state, self.state.drift_variance)
            by_drift += (np.swapaxes(weighed, 1, 2) @ drift @ weighed).sum(axis=0)
            by_number[boats.rows] = weighed
        by_tow = by_number.reshape(-1, 3, k)
        by_parts = [by_number.T @ (part @ by_tow).reshape(-1, k) for part in self.parts]
        return np.stack([*by_parts, by_drift])


def fit(
    problem: Problem,
    active: IntArray,
    start: Fit | None = None,
    tolerance: float = TOLERANCE,
    changes: bool = True,
) -> Fit:
    """Unknowns and variances with given faults in the model.

    Args:
        active: unknowns in the model.
        start: an earlier fit to begin at.
        tolerance: movement below which nothing moves any more.
        changes: boats may have been altered, and tows pulled askew.
    """
    mean = _prior(problem, active)[0]
    if start is None:
        prior = _variance_prior(problem)[0]
        now = _State(mean, prior, np.array(problem.settings.change_shares))
    else:
        before = dict(zip(start.active.tolist(), start.state.value.tolist(), strict=True))
        kept = [before.get(i, m) for i, m in zip(active.tolist(), mean.tolist(), strict=True)]
        now = replace(start.state, value=np.array(kept))
    places, steps = [now.array], []
    for iteration in range(MAX_ITERATIONS):
        begins = start is None and iteration < UNTROUBLED
        fitted, step = _step(problem, active, now, changes and not begins)
        steps.append(step)
        if np.abs(step).max() < tolerance and not begins:
            return fitted
        places.append(_following(places, steps))
        now = now.of(places[-1])
    return replace(fitted, settled=False)


def _step(problem: Problem, active: IntArray, now: _State, changes: bool) -> tuple[Fit, FloatArray]:
    """What is known at a state, and the scoring step from there."""
    mean, precision = _prior(problem, active)
    prior, prior_precision = _variance_prior(problem)
    tangent, residual = problem.slopes(now.value, active)
    own, parts = _own(problem, tangent, now.ln_variance)
    design = problem.design(tangent, active)
    shares = now.shares if changes else NO_CHANGE
    drifts = [drift_of(g, tangent.state, now.drift_variance) for g in problem.groups]
    boats = boat_likelihoods(problem.groups, residual, own, tangent.state, design, drifts, shares)
    full = np.sum([b.complete_information.sum(axis=0) for b in boats], axis=0)
    seen = np.sum([b.information.sum(axis=0) for b in boats], axis=0) if changes else full
    covariance: FloatArray = np.linalg.inv(_positive(seen, full, precision)).astype(np.float64)
    score = np.sum([b.score.sum(axis=0) for b in boats], axis=0)
    step = covariance @ (score - precision * (now.value - mean))
    slope, fisher = _variance_slopes(boats, covariance, parts, drifts)
    # A variance that shrinks takes its own slope with it: that bends the density of its logarithm.
    fisher += np.diag(prior_precision + np.maximum(-slope, 0.0))
    ln_variance_covariance: FloatArray = np.linalg.inv(fisher).astype(np.float64)
    move = ln_variance_covariance @ (slope - prior_precision * (now.ln_variance - prior))
    found = _shares(problem.groups, boats, problem.settings)
    gain = scipy.special.logit(found) - scipy.special.logit(now.shares)
    fitted = Fit(
        active,
        now,
        covariance,
        ln_variance_covariance,
        problem.groups,
        boats,
        tangent,
        own,
        parts,
    )
    return fitted, np.concatenate([step, np.clip(move, -1.0, 1.0), gain])


def _following(places: list[FloatArray], steps: list[FloatArray]) -> FloatArray:
    """Next place: by the last step; by the last few where these shrink, by two where it turned.

    On a plateau steps grow before they shrink; to look back on those would lead round and round.
    """
    last = 1
    if len(steps) > ACCELERATED:
        if _shrink(steps[-1 - REMEMBERED :]):
            last = 1 + REMEMBERED
        elif steps[-1] @ steps[-2] < 0.0:
            last = 2
    return _accelerated(places[-last:], steps[-last:])


def _shrink(steps: list[FloatArray]) -> bool:
    """Whether the steps are modest, and none is larger than both before it."""
    size = [np.abs(step).max() for step in steps]
    grew = any(size[i] >= max(size[i - 2 : i]) for i in range(2, len(size)))
    return size[-1] < MODEST and not grew


def _accelerated(places: list[FloatArray], steps: list[FloatArray]) -> FloatArray:
    """Next place by Anderson's acceleration (1965); a single step is taken as it is."""
    moved, changed = np.diff(places, axis=0), np.diff(steps, axis=0)
    weight = np.linalg.lstsq(changed.T, steps[-1], rcond=1e-10)[0]
    return np.asarray(places[-1] + steps[-1] - weight @ (moved + changed))


def _prior(problem: Problem, active: IntArray) -> tuple[FloatArray, FloatArray]:
    chosen = [problem.unknowns[i] for i in active]
    return np.array([u.mean for u in chosen]), np.array([u.sd for u in chosen]) ** -2.0


def _positive(seen: FloatArray, full: FloatArray, precision: FloatArray) -> FloatArray:
    """Observed information with the prior; that for known alterations where it is no maximum."""
    normal = seen + np.diag(precision)
    try:
        np.linalg.cholesky(normal)
    except np.linalg.LinAlgError:
        return full + np.diag(precision)
    return normal


def _variance_prior(problem: Problem) -> tuple[FloatArray, FloatArray]:
    """Mean and precision of every ln variance."""
    s = problem.settings
    eras = [s.tow_log_sd] * len(s.era_starts)
    sd = np.array([s.tow_sd, s.bend_sd_tow, s.gps_sd, *eras, s.calibration_sd, s.drift_sd])
    return 2.0 * np.log(sd), np.full(len(sd), s.spread**-2.0)


def _own(
    problem: Problem, tangent: Slopes, ln_variance: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Covariance of what is a tow's own, (n, 3, 3), and its slopes by each of its ln variances."""
    variance = np.exp(ln_variance[:-1])
    parts = np.zeros((len(variance), len(problem.q), 3, 3))
    for place in range(3):
        parts[place, :, place, place] = variance[place]
    by_speed = tangent.ways["speed"]
    for era in range(len(problem.settings.era_starts) + 1):
        of_log = (problem.era == era)[:, None] * by_speed
        parts[3 + era] = variance[3 + era] * of_log[:, :, None] * of_log[:, None, :]
    return problem.given + problem.absent + parts.sum(axis=0), parts


def _variance_slopes(
    boats: list[Boats], covariance: FloatArray, parts: FloatArray, drifts: list[FloatArray]
) -> tuple[FloatArray, FloatArray]:
    """Slope of the restricted ln likelihood by the ln variances, and their information."""
    variances = len(parts) + 1
    slope, fisher = np.zeros(variances), np.zeros((variances, variances))
    for some, drift in zip(boats, drifts, strict=True):
        b, n = some.rows.shape
        tow, each = some.rows[:, ::3] // 3, np.arange(n // 3)
        excess = some.excess(covariance[None])
        blocks = excess.reshape(b, n // 3, 3, n // 3, 3)[:, each, :, each, :]
        part = parts[:, tow]
        slope[:-1] += 0.5 * np.einsum("tbij,abtji->a", blocks, part, optimize=True)
        slope[-1] += 0.5 * (excess * drift).sum()
        precision = some.precision.reshape(b, n // 3, 3, n // 3, 3)
        across = np.einsum("bkilj,abljm->abkilm", precision, part, optimize=True)
        across = across.reshape(-1, b, n, n)
        across = np.concatenate([across, (some.precision @ drift)[None]])
        turned = np.ascontiguousarray(across.swapaxes(2, 3)).reshape(variances, -1)
        fisher += 0.5 * across.reshape(variances, -1) @ turned.T
    return slope, fisher


def _shares(groups: list[Patterns], boats: list[Boats], settings: Settings) -> FloatArray:
    """Shares of gaps with an alteration and of tows askew: their priors and what was found."""
    possible = np.array(settings.change_counts)
    changes = possible * settings.change_shares
    for group, some in zip(groups, boats, strict=True):
        changes += (some.weight @ group.changes).sum(axis=0)
        possible += len(group.tow) * group.possible
    return np.asarray(changes / possible)


@dataclass(frozen=True)
class Posterior:
    """What is known of all unknowns of the model, and of the faults that were left out of it.

    Attributes:
        problem: the archive.
        fit: with the faults that are likelier than not.
        chance: (faults,) probability of each fault, in the order of `Problem.faults`; 0 where its
            own fit did not bear out what one step promised.
        confusion: (faults, faults) probability that the one is there and would have been taken for
            the other: what it could be confused with.
        shows: (faults,) whether a fault of the usual size would be likelier than not.
        hidden_by: (faults,) unknown of the fit that would move most, in standard deviations.
    """

    problem: Problem
    fit: Fit
    chance: FloatArray
    confusion: FloatArray
    shows: BoolArray
    hidden_by: IntArray

    @property
    def places(self) -> IntArray:
        """Index of each unknown of the fit, (k,)."""
        return self.fit.active

    @property
    def mean(self) -> FloatArray:
        """Of the unknowns of the fit, (k,)."""
        return self.fit.value

    @property
    def covariance(self) -> FloatArray:
        """Of the unknowns of the fit, (k, k)."""
        return self.fit.covariance

    @cached_property
    def names(self) -> StrArray:
        """What each unknown of the fit is, (k,)."""
        return np.array([self.problem.unknowns[i].name for i in self.places])

    @cached_property
    def design(self) -> FloatArray:
        """Slopes of each tow's numbers by the unknowns of the fit, (n, 3, k)."""
        return self.problem.design(self.fit.slopes, self.places)

    @cached_property
    def of_boats(self) -> BoolArray:
        """Unknowns of boats, (k,); the others are of instruments."""
        return np.isin(self.names, tuple(OF_BOATS))

    @cached_property
    def of_log(self) -> BoolArray:
        """Unknowns that act as the scale of a log does, (k,)."""
        return np.array([WAYS[name] == "speed" for name in self.names.tolist()])

    @cached_property
    def scatter_of_means(self) -> FloatArray:
        """Variance of a mean ln factor over tows about what the log does in general, (groups,).

        By it the mean over the very tows that a log is estimated from is better known than the log
        in general. 0 for a log that is known by other tows, calibrated on dGPS.
        """
        problem = self.problem
        scatter = np.exp(self.fit.state.ln_variance[3 + problem.era])
        group = problem.network.group + 1  # 0, anchored, is left out
        of_mean = np.bincount(group, scatter)[1:] / np.bincount(group)[1:] ** 2
        return np.where(problem.network.calibrated, 0.0, of_mean)


def solve(problem: Problem) -> Posterior:
    """The posterior of everything, with the faults that the archive shows."""
    rough = _with_needed_faults(problem, _with_needed_faults(problem, None, changes=False))
    sharp = fit(problem, rough.active, rough)
    return _posterior(problem, replace(sharp, settled=rough.settled and sharp.settled))


def _with_needed_faults(problem: Problem, start: Fit | None, changes: bool = True) -> Fit:
    """The fit with every fault that is likelier than not, and without the others.

    A log that was replaced is easily taken for many tows pulled askew, and then is not missed. From
    a start where no boat had changed it is found; what changed boats do without is left again.

    A fault enters by what one step from the fit promises, and leaves by a fit of its own, which
    knows more. Where the two disagree it would come and go, at one place after the other, so no
    fault leads to the kinds of faults of an earlier model.
    """
    active = problem.always if start is None else start.active
    fitted = fit(problem, active, start, ROUGH, changes)
    fitted_before: set[tuple[int, ...]] = set()
    for _ in range(2 * MOST_FAULTS):
        fitted_before.add(_kinds_in(problem, fitted.active))
        chosen = _better(problem, fitted, fitted_before)
        if chosen is None:
            return fitted
        if np.isin(chosen, problem.faults).sum() > MOST_FAULTS:
            break
        fitted = fit(problem, chosen, fitted, ROUGH, changes)
    return replace(fitted, settled=False)


class Candidates(NamedTuple):
    """What each candidate fault, by itself, would do to a fit.

    Attributes:
        ln_odds: of it, (faults,).
        variance: of its size, (faults,).
        shift: how much the unknowns of the fit fall per unit of the fault, (k, faults).
    """

    ln_odds: FloatArray
    variance: FloatArray
    shift: FloatArray

    def shows(self, problem: Problem) -> BoolArray:
        """Whether a fault of one standard deviation of its prior would be likelier than not."""
        prior, chance = _faults_prior(problem)
        known = prior / self.variance - 1.0
        gain = 0.5 * (known**2 / (1.0 + known) - np.log1p(known))
        return np.asarray(gain + scipy.special.logit(chance) > 0.0)


def _faults_prior(problem: Problem) -> tuple[FloatArray, FloatArray]:
    """Variance of every fault if it is there, and the chance that it is."""
    faults = [problem.unknowns[i] for i in problem.faults]
    return np.array([u.sd for u in faults]) ** 2, np.array([u.chance for u in faults])


def _scores(problem: Problem, fitted: Fit) -> Scores:
    """The scores of all candidate faults."""
    design = problem.design(fitted.slopes, problem.faults)
    return Scores.of(fitted.boats, design.reshape(-1, design.shape[2]))


def _candidates(
    problem: Problem, scores: Scores, covariance: FloatArray, away: FloatArray
) -> Candidates:
    """Each fault added by itself to a normal posterior whose mean is `away` from the fit's."""
    prior, chance = _faults_prior(problem)
    pull = scores.pull - scores.across.T @ away
    variance = prior / (1.0 + prior * scores.information(covariance))
    ln_odds = 0.5 * (pull**2 * variance + np.log(variance / prior))
    ln_odds += scipy.special.logit(chance)
    return Candidates(ln_odds, variance, covariance @ scores.across)


def _in_fit(problem: Problem, fitted: Fit) -> tuple[IntArray, FloatArray]:
    """Faults in the fit, as places among its unknowns, and their ln odds (Savage-Dickey)."""
    places = np.flatnonzero(np.isin(fitted.active, problem.faults))
    unknowns = [problem.unknowns[i] for i in fitted.active[places]]
    variance = np.diag(fitted.covariance)[places]
    square = fitted.value[places] ** 2 / variance
    prior = np.array([u.sd for u in unknowns]) ** 2
    chance = np.array([u.chance for u in unknowns])
    ln_odds = 0.5 * (square + np.log(variance / prior)) + np.log(chance / (1.0 - chance))
    return places, ln_odds


def _kinds_in(problem: Problem, active: IntArray) -> tuple[int, ...]:
    """Kinds of the faults of a model, sorted."""
    return tuple(sorted(problem.kinds[np.isin(problem.faults, active)].tolist()))


def _better(problem: Problem, fitted: Fit, fitted_before: set[tuple[int, ...]]) -> IntArray | None:
    """The unknowns with the fault that is missed most, or without the one that is not needed.

    Args:
        fitted_before: kinds of faults of the models that no fault is to lead to.
    """
    places, ln_odds = _in_fit(problem, fitted)
    if len(places) and ln_odds.min() < 0.0:
        return np.delete(fitted.active, places[int(ln_odds.argmin())])
    nothing = np.zeros(len(fitted.active))
    scores = _scores(problem, fitted)
    more = _candidates(problem, scores, fitted.covariance, nothing).ln_odds
    more[np.isin(problem.faults, fitted.active)] = -np.inf
    there = _kinds_in(problem, fitted.active)
    left = [tuple(sorted((*there, kind))) in fitted_before for kind in problem.kinds.tolist()]
    more[left] = -np.inf
    best = int(first_largest(more))
    return np.append(fitted.active, problem.faults[best]) if more[best] > 0.0 else None


def _posterior(problem: Problem, fitted: Fit) -> Posterior:
    """The fit, with how likely each fault is beside it or in place of one of its own."""
    scores = _scores(problem, fitted)
    places, ln_odds = _in_fit(problem, fitted)
    own = np.searchsorted(problem.faults, fitted.active[places])
    more = _candidates(problem, scores, fitted.covariance, np.zeros(len(fitted.active)))
    # What the search has tried and rejected by its own fit has odds of one step still.
    chance = np.where(more.ln_odds > 0.0, 0.0, scipy.special.expit(more.ln_odds))
    chance[own] = scipy.special.expit(ln_odds)
    confusion = np.zeros((len(problem.faults), len(problem.faults)))
    for place, fault, odds in zip(places.tolist(), own.tolist(), ln_odds.tolist(), strict=True):
        along = fitted.covariance[:, place] / fitted.covariance[place, place]
        without = fitted.covariance - np.outer(along, fitted.covariance[place])
        away = -along * fitted.value[place]
        others = _candidates(problem, scores, without, away).ln_odds - odds
        others[own] = -np.inf
        confusion[fault] = scipy.special.expit(others)
    return Posterior(
        problem,
        fitted,
        chance,
        confusion,
        more.shows(problem),
        first_largest(np.abs(more.shift) / np.sqrt(np.diag(fitted.covariance))[:, None]),
    )
