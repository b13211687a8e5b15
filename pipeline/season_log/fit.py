"""All unknowns at once: their mode with given faults, the variances, and what follows from both.

Given the alterations and faults the model is linear and Gaussian. The unknowns and the variances
are searched by scoring (REML: Patterson & Thompson 1971; variances with log-normal priors), the
posterior is Laplace's about the mode. Which faults there are is searched in `faults`.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, Self

import numpy as np
import scipy

from pipeline.arrays import BoolArray, FloatArray, IntArray, StrArray
from pipeline.model import Boats
from pipeline.season_log.archive_tows import ArchiveTows
from pipeline.season_log.assumed import Settings
from pipeline.season_log.boats import GPS, LEVEL, Patterns, patterns_of
from pipeline.season_log.effects import OF_BOATS, Effects, Slopes, slopes

MAX_ITERATIONS: Final = 500
TOLERANCE: Final = 1e-10
UNTROUBLED: Final = 4
"""First iterations, in which no boat is taken for changed: logs may be far off yet.

They step by the information as if that were certain. What is seen may tell next to nothing there,
and a step by it can leap to where the search finds no way back.
"""
MOST_MOVED: Final = 0.9
"""By how much what is found of changes may seem to move with their share."""
LEAST_SD: Final = 0.001
"""No number of a tow is ever better known: keeps the search finite where all tows agree."""
NOT_OBSERVED: Final = 1e4
"""Variance of a number that a tow does not have."""
OF_TOWS: Final = 3
"""First variances: of ln Cw, bend and GPS between tows. Those of the log follow, per era and where
calibrated, and the drift of boats per year."""


@dataclass(frozen=True)
class Problem:
    """The tows of an archive as arrays; n tows.

    Attributes:
        tows: the tows.
        observed: (n, 3) level (less its boat's mean), bend and ln(GPS / log).
        given: (n, 3, 3) their random covariance; huge where a tow has no such number.
        boat_level: (n,) that mean.
        q, force_n: (n,) usual bend and force.
        reference_ln: (n,) ln factor of the log at whose true speed the numbers hold.
        effects: what moves the numbers.
        era: (n,) place; the last is that of calibrated tows, whenever.
        groups: boats by their number of tows, with what may have changed between these.
    """

    tows: ArchiveTows
    observed: FloatArray
    given: FloatArray
    boat_level: FloatArray
    q: FloatArray
    force_n: FloatArray
    reference_ln: FloatArray
    effects: Effects
    era: IntArray
    groups: list[Patterns]
    settings: Settings

    @classmethod
    def of(cls, tows: ArchiveTows, settings: Settings) -> Self:
        """The problem that the tows pose."""
        level, gps, reference_ln, season, speed = (
            tows.numbers(name)
            for name in ("ln_cw", "gps_ln_ratio", "reference_ln", "season", "declared_speed_m_s")
        )
        mean = tows.boat_mean(level)
        has_gps = np.isfinite(gps) & (tows.log >= 0)
        given = np.zeros((len(level), 3, 3))
        given[:, 0, 0], given[:, 1, 1] = (tows.numbers(n) ** 2 for n in ("ln_cw_sd", "q_sd"))
        given[:, 0, 1] = given[:, 1, 0] = tows.numbers("ln_cw_q_cov")
        given[:, GPS, GPS] = np.where(has_gps, tows.numbers("gps_sd") ** 2, NOT_OBSERVED)
        excess = 0.25 * (settings.gps_noise_m_s / speed) ** 2
        era = np.searchsorted(settings.era_starts, season, side="right") - 1
        return cls(
            tows,
            np.stack(
                [level - mean, tows.numbers("q"), np.where(has_gps, gps - excess, 0.0)], axis=1
            ),
            given + LEAST_SD**2 * np.eye(3),
            mean,
            tows.boat_mean(0.5 * tows.numbers("kappa") - 1.0),
            np.exp(level) * (speed * np.exp(-reference_ln)) ** 2,
            reference_ln,
            Effects.of(tows, settings),
            np.where(tows.log >= 0, np.maximum(era, 0), len(settings.era_starts)),
            patterns_of(tows.boat, season, season < settings.straight_from, settings),
            settings,
        )

    def slopes(self, ln_factor: FloatArray) -> Slopes:
        """The numbers of the tows and their slopes at ln factors of their logs, (n,)."""
        return slopes(self.q, self.force_n, ln_factor, self.reference_ln)

    def own(self, tangent: Slopes, variance: FloatArray) -> FloatArray:
        """What each variance but that of drift adds to a tow's covariance, (n, variances, 3, 3).

        A number between tows has one everywhere, the log one per era.
        """
        tow, numbers = np.arange(len(self.era)), np.arange(OF_TOWS)
        own = np.zeros((len(self.era), len(variance) - 1, OF_TOWS, OF_TOWS))
        own[:, numbers, numbers, numbers] = variance[:OF_TOWS]
        of_log, by_log = OF_TOWS + self.era, tangent.ways["speed"]
        squares = by_log[:, :, None] * by_log[:, None]
        own[tow, of_log] = variance[of_log][:, None, None] * squares
        return own

    def parts(self, tangent: Slopes, variance: FloatArray) -> list[FloatArray]:
        """What each variance adds to the covariance of each group's numbers."""
        own = self.own(tangent, variance)
        return [g.parts(own, tangent.state, float(variance[-1])) for g in self.groups]

    @property
    def variance_prior(self) -> FloatArray:
        """Mean of every ln variance."""
        s = self.settings
        eras = [s.tow_log_sd] * len(s.era_starts)
        sd = [s.tow_sd, s.bend_sd_tow, s.gps_sd, *eras, s.calibration_sd, s.drift_sd]
        return 2.0 * np.log(sd)


@dataclass(frozen=True)
class Fit:
    """Effects and variances at their mode; k effects in the model.

    Attributes:
        problem: the archive.
        active: (k,) places of the effects in the model.
        value: (k,) of them.
        covariance: (k, k) of the values.
        ln_variance: as `OF_TOWS` lists them.
        shares: of gaps between tows with an alteration that was not reported, and of tows that were
            pulled askew before steering straight was aided.
        ln_variance_covariance: of these.
        boats: what each group of the problem says there.
        slopes: of the numbers of each tow.
        settled: whether the search, and those that led to it, came to rest within their limits.
    """

    problem: Problem
    active: IntArray
    value: FloatArray
    covariance: FloatArray
    ln_variance: FloatArray
    shares: FloatArray
    ln_variance_covariance: FloatArray
    boats: list[Boats]
    slopes: Slopes
    settled: bool = True

    @cached_property
    def name(self) -> StrArray:
        """What each effect in the model is, (k,)."""
        return np.asarray(self.problem.effects.column("name", self.active), dtype=np.str_)

    @cached_property
    def design(self) -> FloatArray:
        """Slopes of each tow's numbers by the effects, (n, 3, k)."""
        return self.problem.effects.design(self.slopes, self.active)

    @cached_property
    def share(self) -> FloatArray:
        """How much of each effect a tow has, (n, k)."""
        return self.problem.effects.share[:, self.active]

    @cached_property
    def of_boats(self) -> BoolArray:
        """Effects of boats, (k,); the others are of instruments."""
        return np.isin(self.name, OF_BOATS)

    @cached_property
    def of_log(self) -> BoolArray:
        """Effects that act as the scale of a log does, (k,)."""
        return np.asarray(self.problem.effects.column("way", self.active) == "speed")

    @property
    def is_fault(self) -> BoolArray:
        """Effects that are faults, (k,)."""
        return np.isin(self.active, self.problem.effects.faults)

    @property
    def drift_variance(self) -> float:
        """Of the drift of a boat's ln Cw, per year."""
        return float(np.exp(self.ln_variance[-1]))

    @cached_property
    def scatter_of_means(self) -> FloatArray:
        """Variance of a mean ln factor over tows about what the log does in general, (logs,).

        By it the mean over the very tows that a log is estimated from is better known than the log
        in general. 0 for a log that is known by other tows, calibrated on dGPS.
        """
        tows = self.problem.tows
        scatter = np.exp(self.ln_variance[OF_TOWS + self.problem.era])
        log = tows.log + 1  # 0, anchored, is left out
        of_mean = np.bincount(log, scatter)[1:] / np.bincount(log)[1:] ** 2
        return np.where(tows.logs["calibrated"].to_numpy(), 0.0, of_mean)

    def dof(self, direction: FloatArray) -> FloatArray:
        """Satterthwaite's degrees of freedom of combinations of the effects.

        Args:
            direction: (combinations, k).
        """
        along = direction @ self.covariance
        by = np.stack([((along @ one) * along).sum(axis=1) for one in self._moved], axis=1)
        variance = (along * direction).sum(axis=1)
        spread = np.einsum("ca,ab,cb->c", by, self.ln_variance_covariance, by)
        return np.asarray(2.0 * variance**2 / np.maximum(spread, 1e-300))

    @cached_property
    def weighed(self) -> FloatArray:
        """Precision of all numbers times the design, (n, 3, k)."""
        by_number = np.zeros((3 * len(self.problem.q), len(self.active)))
        for boats in self.boats:
            by_number[boats.rows] = boats.weighed
        return by_number.reshape(-1, 3, len(self.active))

    @cached_property
    def _moved(self) -> FloatArray:
        """Slope of the covariance of the scores by each ln variance, (variances, k, k)."""
        parts = self.problem.parts(self.slopes, np.exp(self.ln_variance))
        each = [b.moved_by(part) for b, part in zip(self.boats, parts, strict=True)]
        return np.asarray(np.sum(each, axis=0))


def fit(
    problem: Problem,
    active: IntArray,
    start: Fit | None = None,
    tolerance: float = TOLERANCE,
    changes: bool = True,
) -> Fit:
    """Effects and variances with given faults in the model.

    Args:
        active: effects in the model.
        start: an earlier fit to begin at.
        tolerance: movement below which nothing moves any more.
        changes: boats may have been altered, and tows pulled askew.
    """
    value, ln_variance = problem.effects.frame["mean"].to_numpy().copy(), problem.variance_prior
    shares = np.array([problem.settings.changed_share, problem.settings.askew_share])
    if start is not None:
        value[start.active], ln_variance, shares = start.value, start.ln_variance, start.shares
    place = np.concatenate([value[active], ln_variance, scipy.special.logit(shares)])
    for iteration in range(MAX_ITERATIONS):
        begins = start is None and iteration < UNTROUBLED
        fitted, step = _step(problem, active, place, changes and not begins)
        if np.abs(step).max() < tolerance and not begins:
            return fitted
        place = place + step
    return replace(fitted, settled=False)


def _step(
    problem: Problem, active: IntArray, place: FloatArray, changes: bool
) -> tuple[Fit, FloatArray]:
    """What is known at values, ln variances and logits of shares, and the step from there."""
    value, ln_variance, logit = np.split(place, [len(active), len(place) - 2])
    shares = scipy.special.expit(logit)
    effects = problem.effects
    mean, variance = (effects.column(name, active) for name in ("mean", "variance"))
    by_speed = effects.column("way", active) == "speed"
    tangent = problem.slopes(effects.share[:, active] @ np.where(by_speed, value, 0.0))
    design = effects.design(tangent, active)
    residual = problem.observed - tangent.predicted - design @ np.where(by_speed, 0.0, value)
    parts = problem.parts(tangent, np.exp(ln_variance))
    boats = [
        group.boats(
            residual,
            group.covariance(problem.given, tangent.state, part),
            tangent,
            design,
            shares if changes else None,
        )
        for group, part in zip(problem.groups, parts, strict=True)
    ]
    full = np.sum([b.total(b.weighed) for b in boats], axis=0)
    seen = np.sum([b.total(b.observed) for b in boats], axis=0) if changes else full
    prior = np.diag(1.0 / variance)
    covariance: FloatArray = np.linalg.inv(_positive(seen + prior, full + prior)).astype(np.float64)
    score = np.sum([b.score.sum(axis=0) for b in boats], axis=0)
    step = covariance @ (score - (value - mean) / variance)
    each = [b.by_variances(part, covariance) for b, part in zip(boats, parts, strict=True)]
    slope, fisher = (np.sum(of_groups, axis=0) for of_groups in zip(*each, strict=True))
    known = problem.settings.spread**-2.0
    # A variance that shrinks takes its own slope with it: that bends the density of its logarithm.
    fisher += np.diag(known + np.maximum(-slope, 0.0))
    of_variances: FloatArray = np.linalg.inv(fisher).astype(np.float64)
    move = of_variances @ (slope - known * (ln_variance - problem.variance_prior))
    gain = _share_step(problem, boats, logit)
    known_here = (value, covariance, ln_variance, shares, of_variances)
    fitted = Fit(problem, active, *known_here, boats, tangent)
    return fitted, np.concatenate([step, np.clip(move, -1.0, 1.0), gain])


def _positive(seen: FloatArray, full: FloatArray) -> FloatArray:
    """Observed information; that for known alterations where it is no maximum."""
    try:
        np.linalg.cholesky(seen)
    except np.linalg.LinAlgError:
        return full
    return seen


def _share_step(problem: Problem, boats: list[Boats], logit: FloatArray) -> FloatArray:
    """Step of the logits of the shares of gaps with an alteration and of tows askew.

    The shares are those of their priors and of what was found together. What is found moves with
    the shares (Louis 1982), which the step takes into account as far as it is no leap.
    """
    s = problem.settings
    possible = np.array([s.changed_gaps, s.askew_tows])
    found, moves = possible * (s.changed_share, s.askew_share), np.zeros((2, 2))
    for group, some in zip(problem.groups, boats, strict=True):
        of_boats = some.weight @ group.changes
        found += of_boats.sum(axis=0)
        moves += np.diag(of_boats.sum(axis=0)) - of_boats.T @ of_boats
        possible += (group.possible @ group.changes).sum(axis=0)
    share = found / possible
    moves /= (found * (1.0 - share))[:, None]
    moves /= max(1.0, np.abs(moves).sum(axis=1).max() / MOST_MOVED)
    gain: FloatArray = np.linalg.solve(np.eye(2) - moves, scipy.special.logit(share) - logit)
    return gain


def level_of_boats(fitted: Fit) -> FloatArray:
    """What all boats changed together, in ln Cw of each tow, (n,)."""
    return np.asarray(np.where(fitted.of_boats, fitted.design[:, LEVEL], 0.0) @ fitted.value)
