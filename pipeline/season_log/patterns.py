"""Altered boats and askew tows: the numbers of a boat as a mixture of normal distributions.

The level and the bend of a boat are random effects and integrated out; its level drifts as a random
walk. Besides, at most one thing happens to a boat that nobody reported: it was altered in one of
the gaps between its tows, or one of its early tows was pulled askew. Each possibility is a pattern:
a component of a mixture, with

    y of the boat | pattern p  ~  N(X u + excess_p, V + A_p A_p')

X u are the effects (`observation_model`), V the covariance of an unchanged boat, A_p what the
pattern adds.
A boat with T tows has 2 T patterns and 3 T numbers, so that all patterns can be enumerated.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy

from pipeline.arrays import BoolArray, FloatArray, IntArray
from pipeline.season_log.archive import BEND, GPS, LEVEL, Archive
from pipeline.season_log.observation_model import Linearization
from pipeline.season_log.priors import Priors


@dataclass(frozen=True)
class BoatGroup:
    """The b boats that have T tows each, stacked: one array operation serves them all.

    Attributes:
        tow: (b, T) rows of the tows in the archive.
        is_after: (p, T) whether a tow is after the alteration that the pattern supposes.
        is_askew: (p, T) whether the pattern supposes that a tow was pulled askew.
        is_possible: (b, p) whether the boat can have the pattern: askew are early tows only.
        years: (b, T) since the first tow of the boat.
    """

    tow: IntArray
    is_after: BoolArray
    is_askew: BoolArray
    is_possible: BoolArray
    years: FloatArray

    @property
    def shared_years(self) -> FloatArray:
        """Years of drift that two tows have in common, (b, T, T)."""
        return np.minimum(self.years[:, :, None], self.years[:, None, :])

    @property
    def numbers(self) -> IntArray:
        """Places of the boats' numbers among all 3 n numbers of the archive, (b, 3 T)."""
        return (3 * self.tow[:, :, None] + np.arange(3)).reshape(len(self.tow), -1)

    @property
    def pattern_kind(self) -> FloatArray:
        """Whether a pattern is an alteration, and whether it is a tow askew, (p, 2)."""
        kinds = np.stack([self.is_after.any(axis=1), self.is_askew.any(axis=1)], axis=1)
        return kinds.astype(np.float64)

    def leave_out_patterns(self) -> "BoatGroup":
        """Return the boats with pattern 0 alone: nothing happened to any of them."""
        return replace(
            self,
            is_after=self.is_after[:1],
            is_askew=self.is_askew[:1],
            is_possible=self.is_possible[:, :1],
        )


def group_boats(archive: Archive, priors: Priors) -> list[BoatGroup]:
    """Return the boats of an archive by their number of tows."""
    order = np.argsort(archive.boat, kind="stable")
    _, first, count = np.unique(archive.boat[order], return_index=True, return_counts=True)
    is_early = archive.season < priors.straight_from
    groups = []
    for tows in np.unique(count):
        tow = order[first[count == tows][:, None] + np.arange(tows)]
        # Pattern 0: nothing. Patterns 1 to T - 1: altered before that tow. Then: tow k askew.
        is_after = np.zeros((2 * tows, tows), dtype=bool)
        is_askew = np.zeros((2 * tows, tows), dtype=bool)
        for k in range(1, tows):
            is_after[k, k:] = True
        for k in range(tows):
            is_askew[tows + k, k] = True
        groups.append(
            BoatGroup(
                tow=tow,
                is_after=is_after,
                is_askew=is_askew,
                is_possible=np.hstack([np.ones(tow.shape, dtype=bool), is_early[tow]]),
                years=archive.season[tow] - archive.season[tow[:, :1]],
            )
        )
    return groups


def compute_random_design(
    group: BoatGroup, archive: Archive, linear: Linearization, variance: FloatArray
) -> FloatArray:
    """Return the design Z of the random effects between tows, one standard deviation of each.

    Component j has an effect per tow: Z_j Z_j' is what it adds to the covariance of the numbers,
    and the derivative of that covariance by ln variance j.

    Args:
        variance: (v,) of ln Cw, bend and GPS between tows, of the log between tows per era and of
            anchored tows, of the load cell's zero between tows [N²], and of the drift per year.

    Returns:
        (b, 3 T, v, T). An effect is of its tow alone; but a drift since the tow before is of all
        later tows too.
    """
    boats, tows = group.tow.shape
    sd = np.sqrt(variance)
    by_log = linear.by_channel["log"][group.tow]
    by_zero = linear.by_channel["zero"][group.tow]
    by_level = linear.by_boat[group.tow][..., 0]
    drift_sd = sd[-1] * np.sqrt(np.diff(group.years, axis=1, prepend=0.0))
    design = np.zeros((boats, tows, 3, len(variance), tows))
    for k in range(tows):
        for number in (LEVEL, BEND, GPS):
            design[:, k, number, number, k] = sd[number]
        component = 3 + archive.log_variance[group.tow[:, k]]
        design[np.arange(boats), k, :, component, k] = sd[component, None] * by_log[:, k]
        design[:, k, :, -2, k] = sd[-2] * by_zero[:, k]
        design[:, k:, :, -1, k] = drift_sd[:, k, None, None] * by_level[:, k:]
    return design.reshape(boats, 3 * tows, len(variance), tows)


def compute_unchanged_covariance(
    group: BoatGroup,
    archive: Archive,
    linear: Linearization,
    random_design: FloatArray,
    priors: Priors,
) -> FloatArray:
    """Return the covariance V of the numbers of boats that nothing happened to, (b, 3 T, 3 T)."""
    boats, tows = group.tow.shape
    known = np.zeros((boats, tows, 3, tows, 3))
    for k in range(tows):
        known[:, k, :, k] = archive.y_covariance[group.tow[:, k]]
    by_boat = linear.by_boat[group.tow] * [priors.level_sd, priors.bend_sd]
    of_boat = by_boat.reshape(boats, 3 * tows, 2)
    between_tows = random_design.reshape(boats, 3 * tows, -1)
    covariance = known.reshape(boats, 3 * tows, 3 * tows)
    for design in (of_boat, between_tows):
        covariance = covariance + design @ np.swapaxes(design, 1, 2)
    return np.asarray(covariance)


def compute_pattern_factor(group: BoatGroup, linear: Linearization, priors: Priors) -> FloatArray:
    """Return A of each pattern, (b, p, 3 T, 2): its covariance is V + A A'."""
    boats, tows = group.tow.shape
    change = linear.by_boat[group.tow] * [priors.altered_sd, priors.altered_bend_sd]
    factor = change[:, None] * group.is_after[:, :, None, None]
    factor[..., LEVEL, 0] += priors.askew_excess.sd * group.is_askew
    return factor.reshape(boats, -1, 3 * tows, 2)


@dataclass(frozen=True)
class GroupPosterior:
    """E-step: what the boats of a group say at given effects and variances; k effects.

    Attributes:
        group: the boats.
        design: (b, 3 T, k) derivatives of their numbers by the effects.
        random_design: (b, 3 T, v, T) of the random effects between tows.
        inverse: (b, 3 T, 3 T) inverse covariance of the numbers of an unchanged boat.
        inverse_a: (b, p, 3 T, 2) `inverse` times the factor A of each pattern, and
        gain: (b, p, 2, 3 T): inverse covariance under a pattern is `inverse` - `inverse_a` `gain`.
        weighted_residual: (b, p, 3 T) precision times residual.
        probability: (b, p) posterior probability of each pattern.
    """

    group: BoatGroup
    design: FloatArray
    random_design: FloatArray
    inverse: FloatArray
    inverse_a: FloatArray
    gain: FloatArray
    weighted_residual: FloatArray
    probability: FloatArray

    @property
    def precision(self) -> FloatArray:
        """Inverse covariance of the numbers under each pattern, (b, p, 3 T, 3 T)."""
        return np.asarray(self.inverse[:, None] - self.inverse_a @ self.gain)

    @cached_property
    def mean_precision(self) -> FloatArray:
        """Precision averaged over patterns, (b, 3 T, 3 T)."""
        boats, patterns, size, rank = self.inverse_a.shape
        weighted = self.probability[:, :, None, None] * self.inverse_a
        left = np.swapaxes(weighted, 1, 2).reshape(boats, size, patterns * rank)
        return np.asarray(self.inverse - left @ self.gain.reshape(boats, patterns * rank, size))

    @cached_property
    def mean_residual(self) -> FloatArray:
        """Weighted residual averaged over patterns, (b, 3 T)."""
        return np.asarray((self.probability[:, None] @ self.weighted_residual)[:, 0])

    @cached_property
    def observed_precision(self) -> FloatArray:
        """Precision less the information that is missing as the pattern is unknown (Louis 1982)."""
        deviation = self.weighted_residual - self.mean_residual[:, None]
        weighted = self.probability[:, :, None] * deviation
        return np.asarray(self.mean_precision - np.swapaxes(weighted, 1, 2) @ deviation)

    @cached_property
    def precision_design(self) -> FloatArray:
        """Averaged precision times design, (b, 3 T, k)."""
        return np.asarray(self.mean_precision @ self.design)

    @cached_property
    def information(self) -> FloatArray:
        """Observed information of all boats on the effects, (k, k)."""
        weighted = self.observed_precision @ self.design
        return np.tensordot(self.design, weighted, axes=([0, 1], [0, 1]))

    @property
    def information_per_boat(self) -> FloatArray:
        """Observed information of each boat on the effects, (b, k, k)."""
        return np.asarray(np.swapaxes(self.design, 1, 2) @ self.observed_precision @ self.design)

    @cached_property
    def score(self) -> FloatArray:
        """Gradient of the log likelihood by the effects, per boat, (b, k)."""
        return np.asarray((self.mean_residual[:, None] @ self.design)[:, 0])


def judge_patterns(
    group: BoatGroup,
    archive: Archive,
    linear: Linearization,
    design: FloatArray,
    residual: FloatArray,
    variance: FloatArray,
    share: FloatArray,
    priors: Priors,
) -> GroupPosterior:
    """Return the posterior of every pattern of the boats of a group (the E-step of EM).

    Args:
        design: (n, 3, k) of all tows.
        residual: (n, 3) observed less predicted numbers of all tows.
        variance: (v,) variance components, as in `compute_random_design`.
        share: (2,) of gaps with an unreported alteration, and of early tows pulled askew.
    """
    boats, tows = group.tow.shape
    own = np.repeat(residual[group.tow][:, None], len(group.is_askew), axis=1)
    own[..., LEVEL] -= priors.askew_excess.mean * group.is_askew
    own = own.reshape(boats, -1, 3 * tows)

    # Inverse and determinant of V + A A', by Woodbury's identity.
    random_design = compute_random_design(group, archive, linear, variance)
    unchanged = compute_unchanged_covariance(group, archive, linear, random_design, priors)
    inverse: FloatArray = np.linalg.inv(unchanged).astype(np.float64)
    a = compute_pattern_factor(group, linear, priors)
    inverse_a = inverse[:, None] @ a
    capacitance = np.eye(2) + np.swapaxes(a, 2, 3) @ inverse_a
    gain = np.linalg.inv(capacitance) @ np.swapaxes(inverse_a, 2, 3)
    ln_determinant = np.linalg.slogdet(unchanged)[1][:, None] + np.linalg.slogdet(capacitance)[1]

    weighted_residual = own @ inverse - (inverse_a @ (gain @ own[..., None]))[..., 0]
    ln_density = -0.5 * ((own * weighted_residual).sum(axis=2) + ln_determinant)

    ln_prior = group.pattern_kind @ scipy.special.logit(share)
    ln_prior = np.where(group.is_possible, ln_prior, -np.inf)
    return GroupPosterior(
        group=group,
        design=design[group.tow].reshape(boats, 3 * tows, -1),
        random_design=random_design,
        inverse=inverse,
        inverse_a=inverse_a,
        gain=gain,
        weighted_residual=weighted_residual,
        probability=scipy.special.softmax(ln_density + ln_prior, axis=1),
    )
