"""The fit: effects by generalised least squares, variances by REML, patterns by EM.

Given variances and pattern probabilities the model is linear and Gaussian in the effects, but for
the curvature of the log's channel, which is linearised anew in every iteration (Gauss-Newton). One
iteration makes four steps together; they are repeated until nothing moves:

1. E-step: probability of each pattern of each boat (`patterns.judge_patterns`);
2. effects u: Newton step with the observed information,
   u += C (X'P r - (u - mean) / prior variance),  C = (X'P X - missing + 1 / prior variance)^-1;
3. variances: Fisher scoring of the restricted likelihood on the logarithms,
   gradient_j = 1/2 tr[Z_j' (P r r'P - P + P X C X'P) Z_j],  information_ij = 1/2 |Z_i' P Z_j|^2,
   with Z_j Z_j' what ln variance j adds to the covariance, which is also its derivative; and a
   half-Cauchy prior on the standard deviation: with w = variance / scale^2, gradient
   1/2 - w / (1 + w) and information w / (1 + w)^2;
4. shares of altered gaps and askew tows: EM, accelerated by the missing information.

P is the inverse covariance of the numbers, averaged over patterns. Sources: Patterson & Thompson
1971 (REML); Dempster, Laird & Rubin 1977 (EM); Louis 1982 (information of mixtures); Gelman 2006
(half-Cauchy prior).
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
import scipy

from pipeline.arrays import BoolArray, FloatArray, IntArray, StrArray
from pipeline.season_log.archive import LEVEL, Archive
from pipeline.season_log.observation_model import (
    BOAT_EFFECTS,
    Effects,
    Linearization,
    linearize,
    list_effects,
)
from pipeline.season_log.patterns import (
    BoatGroup,
    GroupPosterior,
    group_boats,
    judge_patterns,
)
from pipeline.season_log.priors import Priors

MAX_ITERATIONS: Final = 500
TOLERANCE: Final = 1e-10
"""Largest step of an effect, ln variance or logit share at which the fit has converged."""
ITERATIONS_WITHOUT_PATTERNS: Final = 4
"""First iterations of a new fit: logs may be far off, and a wrong log looks like altered boats."""
MAX_MISSING_INFORMATION: Final = 0.9
"""Share of the information on a pattern share beyond which EM is not accelerated further."""
MAX_LN_VARIANCE_STEP: Final = 1.0
GAIN_LIMIT: Final = 0.5
"""Share of the last step of a ln variance beyond which the next step has twice the gain, or half of
it where it goes back. The patterns move with a variance, so that its density is flatter or more
curved than the expected information says: full steps would creep, or go to and fro for ever."""


@dataclass(frozen=True)
class Model:
    """An archive with everything that may be estimated of it."""

    archive: Archive
    effects: Effects
    groups: list[BoatGroup]
    priors: Priors

    def linearize_at(self, ln_factor: FloatArray) -> Linearization:
        """Return the forward model at ln factors of the logs, (n,)."""
        a = self.archive
        return linearize(a.usual_bend, a.force_n, ln_factor, a.reference_ln)

    @property
    def ln_variance_scale(self) -> FloatArray:
        """Ln of the squared prior scale of each variance, in the order of `Fit.ln_variance`."""
        p = self.priors
        of_numbers = [p.tow_sd, p.tow_bend_sd, p.tow_gps_sd]
        of_logs = [p.tow_log_sd] * len(p.era_starts) + [p.calibration_sd]
        return 2.0 * np.log(of_numbers + of_logs + [p.tow_zero_n, p.drift_sd])


def build_model(archive: Archive, priors: Priors) -> Model:
    """Return the model of an archive."""
    return Model(archive, list_effects(archive, priors), group_boats(archive, priors), priors)


@dataclass(frozen=True)
class Fit:
    """Estimates with given faults in the model; k effects, v variances.

    Attributes:
        model: the archive and its possible effects.
        active: (k,) places of the effects in the model.
        value: (k,) posterior mode of the effects.
        covariance: (k, k) of their posterior.
        ln_variance: (v,) of ln Cw, bend and GPS between tows; of the log between tows, for each
            era and for anchored tows; of the load cell's zero; of the drift per year.
        share: (2,) of gaps with an unreported alteration, and of early tows pulled askew.
        linear: the forward model at the estimate.
        boats: posterior of each group of boats.
        has_converged: whether this search, and those that led to it, ended within their limits.
    """

    model: Model
    active: IntArray
    value: FloatArray
    covariance: FloatArray
    ln_variance: FloatArray
    share: FloatArray
    linear: Linearization
    boats: list[GroupPosterior]
    has_converged: bool = True

    @cached_property
    def name(self) -> StrArray:
        """Names of the effects, (k,)."""
        return self.model.effects.name[self.active]

    @cached_property
    def prior_variance(self) -> FloatArray:
        """Prior variances of the effects, (k,)."""
        return self.model.effects.variance[self.active]

    @cached_property
    def covariate(self) -> FloatArray:
        """By how much each tow has each effect, (n, k)."""
        return self.model.effects.covariate[:, self.active]

    @cached_property
    def design(self) -> FloatArray:
        """Derivatives of the tows' numbers by the effects, (n, 3, k)."""
        return self.model.effects.design(self.linear, self.active)

    @cached_property
    def is_log(self) -> BoolArray:
        """Effects that are errors of a log, (k,)."""
        return np.asarray(self.model.effects.channel[self.active] == "log")

    @cached_property
    def is_boat(self) -> BoolArray:
        """Effects on boats; the others are errors of instruments, (k,)."""
        return np.isin(self.name, BOAT_EFFECTS)

    @property
    def is_fault(self) -> BoolArray:
        """Effects that are faults, (k,)."""
        return self.model.effects.probability[self.active] < 1.0

    @cached_property
    def boat_design(self) -> FloatArray:
        """Derivatives of ln Cw by the effects on boats, 0 for others, (n, k)."""
        return np.where(self.is_boat, self.design[:, LEVEL], 0.0)

    @cached_property
    def instrument_design(self) -> FloatArray:
        """Derivatives of ln Cw by the errors of instruments, 0 for others, (n, k)."""
        return np.where(self.is_boat, 0.0, self.design[:, LEVEL])

    @property
    def ln_log_factor(self) -> FloatArray:
        """Estimated ln factor of each tow's log, (n,)."""
        return self.covariate @ np.where(self.is_log, self.value, 0.0)

    @cached_property
    def tow_weight(self) -> FloatArray:
        """Weight of each tow in the mean over its log, (n, logs): observed tows count alike."""
        archive = self.model.archive
        own = archive.log[:, None] == np.arange(archive.logs.height)
        observed = own & archive.is_observed[:, None]
        counted = np.where(observed.any(axis=0), observed, own)
        return np.asarray(counted / counted.sum(axis=0))

    @cached_property
    def mean_log_design(self) -> FloatArray:
        """Mean ln factor over the tows of each log as a combination of effects, (logs, k)."""
        return np.asarray(self.tow_weight.T @ (self.covariate * self.is_log))

    @cached_property
    def mean_log_scatter(self) -> FloatArray:
        """Variance of the mean over each log's tows of the log's deviations, (logs,).

        0 for a log that other tows, calibrated on dGPS, determine: its tows are not in that mean.
        """
        archive = self.model.archive
        of_tow = np.exp(self.ln_variance[3 + archive.log_variance])
        of_mean = (self.tow_weight**2).T @ of_tow
        return np.where(archive.logs["calibrated"].to_numpy(), 0.0, of_mean)


def fit_model(
    model: Model,
    active: IntArray,
    start: Fit | None = None,
    tolerance: float = TOLERANCE,
    with_patterns: bool = True,
) -> Fit:
    """Fit effects, variances and pattern shares.

    Args:
        active: places of the effects in the model.
        start: an earlier fit to begin at.
        tolerance: largest step at which the fit has converged.
        with_patterns: boats may have been altered, and tows pulled askew, without a report.
    """
    priors = model.priors
    mode = model.effects.mean.copy()
    ln_variance = model.ln_variance_scale
    share = np.array([priors.altered_share, priors.askew_share])
    if start is not None:
        mode[start.active] = start.value
        ln_variance, share = start.ln_variance, start.share
    value = mode[active]
    unchanged = [group.leave_out_patterns() for group in model.groups]
    gain = np.ones(len(ln_variance))
    last_step = np.zeros(len(ln_variance))
    for iteration in range(MAX_ITERATIONS):
        is_warming_up = start is None and iteration < ITERATIONS_WITHOUT_PATTERNS
        groups = model.groups if with_patterns and not is_warming_up else unchanged
        linear, boats = _judge_all_patterns(model, groups, active, value, ln_variance, share)
        value_step, covariance = _step_effects_by_gls(model, active, value, boats)
        ln_variance_step = _step_variances_by_reml(model, ln_variance, covariance, boats)
        logit_step = _step_shares_by_em(model, share, boats)
        fit = Fit(
            model=model,
            active=active,
            value=value,
            covariance=covariance,
            ln_variance=ln_variance,
            share=share,
            linear=linear,
            boats=boats,
        )
        steps = np.concatenate([value_step, ln_variance_step, logit_step])
        if np.abs(steps).max() < tolerance and not is_warming_up:
            return fit
        gain = _adapt_gain(gain, ln_variance_step, last_step)
        last_step = ln_variance_step
        value = value + value_step
        ln_variance = ln_variance + _limit_step(gain * ln_variance_step)
        share = scipy.special.expit(scipy.special.logit(share) + logit_step)
    return replace(fit, has_converged=False)


def _judge_all_patterns(
    model: Model,
    groups: list[BoatGroup],
    active: IntArray,
    value: FloatArray,
    ln_variance: FloatArray,
    share: FloatArray,
) -> tuple[Linearization, list[GroupPosterior]]:
    """Return the forward model and the posterior of the patterns of every boat."""
    archive, effects = model.archive, model.effects
    is_log = effects.channel[active] == "log"
    ln_factor = effects.covariate[:, active] @ np.where(is_log, value, 0.0)
    linear = model.linearize_at(ln_factor)
    design = effects.design(linear, active)
    residual = archive.y - linear.predicted - design @ np.where(is_log, 0.0, value)
    variance = np.exp(ln_variance)
    boats = [
        judge_patterns(group, archive, linear, design, residual, variance, share, model.priors)
        for group in groups
    ]
    return linear, boats


def _step_effects_by_gls(
    model: Model, active: IntArray, value: FloatArray, boats: list[GroupPosterior]
) -> tuple[FloatArray, FloatArray]:
    """Return the Newton step of the effects, (k,), and their posterior covariance, (k, k)."""
    prior_precision = 1.0 / model.effects.variance[active]
    information = np.diag(prior_precision) + sum(b.information for b in boats)
    if np.linalg.eigvalsh(information)[0] <= 0.0:
        # Not at a maximum: take the patterns for known.
        complete = sum(
            np.tensordot(b.design, b.precision_design, axes=([0, 1], [0, 1])) for b in boats
        )
        information = np.diag(prior_precision) + complete
    covariance: FloatArray = np.linalg.inv(information).astype(np.float64)
    score = sum(b.score.sum(axis=0) for b in boats)
    step = covariance @ (score - prior_precision * (value - model.effects.mean[active]))
    return step, covariance


def _step_variances_by_reml(
    model: Model, ln_variance: FloatArray, covariance: FloatArray, boats: list[GroupPosterior]
) -> FloatArray:
    """Return the REML scoring step of the ln variances, (v,)."""
    v = len(ln_variance)
    gradient = np.zeros(v)
    information = np.zeros((v, v))
    for b in boats:
        weighted = b.probability[:, :, None] * b.weighted_residual
        squared_residual = np.swapaxes(weighted, 1, 2) @ b.weighted_residual
        by_effects = b.precision_design @ covariance @ np.swapaxes(b.precision_design, 1, 2)
        excess = squared_residual - b.mean_precision + by_effects
        n_boats, numbers, _, tows = b.random_design.shape
        z = b.random_design.reshape(n_boats, numbers, v * tows)
        own_excess = (z * (excess @ z)).sum(axis=(0, 1))  # diagonal of Z' excess Z
        gradient += 0.5 * own_excess.reshape(v, tows).sum(axis=1)
        shared_precision = np.swapaxes(z, 1, 2) @ (b.mean_precision @ z)  # Z' P Z
        square = (shared_precision**2).sum(axis=0).reshape(v, tows, v, tows)
        information += 0.5 * square.sum(axis=(1, 3))
    ratio = np.exp(ln_variance - model.ln_variance_scale)
    # A variance that shrinks takes its own gradient with it: that curves the density of its ln.
    information += np.diag(ratio / (1.0 + ratio) ** 2 + np.maximum(-gradient, 0.0))
    gradient += 0.5 - ratio / (1.0 + ratio)
    step: FloatArray = np.linalg.solve(information, gradient).astype(np.float64)
    return _limit_step(step)


def _limit_step(step: FloatArray) -> FloatArray:
    """Return a step of ln variances that nowhere exceeds `MAX_LN_VARIANCE_STEP`, (v,)."""
    return np.asarray(np.clip(step, -MAX_LN_VARIANCE_STEP, MAX_LN_VARIANCE_STEP))


def _adapt_gain(gain: FloatArray, step: FloatArray, last_step: FloatArray) -> FloatArray:
    """Return by how much the step of each ln variance is multiplied (Jacobs 1988), (v,)."""
    limit = GAIN_LIMIT * last_step**2
    goes_on = step * last_step > limit
    turns_back = step * last_step < -limit
    return gain * np.where(goes_on, 2.0, np.where(turns_back, 0.5, 1.0))


def _step_shares_by_em(model: Model, share: FloatArray, boats: list[GroupPosterior]) -> FloatArray:
    """Return the step of the logits of the pattern shares, (2,).

    EM sets a share to the expected count over the possible count. It closes only that part of the
    way which is not missing information, and the step is divided by that part (Louis 1982).
    """
    p = model.priors
    possible = np.array([p.altered_prior_gaps, p.askew_prior_tows])
    expected = possible * [p.altered_share, p.askew_share]
    missing = np.zeros((2, 2))
    for group in model.groups:
        possible += (group.is_possible @ group.pattern_kind).sum(axis=0)
    for b in boats:
        of_boat = b.probability @ b.group.pattern_kind
        expected += of_boat.sum(axis=0)
        missing += np.diag(of_boat.sum(axis=0)) - of_boat.T @ of_boat
    new_share = expected / possible
    rate = missing / (expected * (1.0 - new_share))[:, None]
    rate /= max(1.0, np.abs(rate).sum(axis=1).max() / MAX_MISSING_INFORMATION)
    em_step = scipy.special.logit(new_share) - scipy.special.logit(share)
    return np.asarray(np.linalg.solve(np.eye(2) - rate, em_step))
