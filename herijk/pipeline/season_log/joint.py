"""The joint least squares over boats and seasons: rows, fit, and boats left out.

The model stands in the package's docstring. Boats are eliminated, so that the unknowns are few: ln
factor of each determined group, offset of its GPS where it has any, ageing, weight, length.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from herijk.pipeline.arrays import BoolArray, FloatArray, IntArray
from herijk.pipeline.season_log.assumed import Settings
from herijk.pipeline.season_log.left_out import LeftOut, leave_out
from herijk.pipeline.season_log.network import Network
from herijk.pipeline.season_log.scale import LEAST_MARGIN, linear_scale

MAX_ITERATIONS: Final = 2000
TOLERANCE: Final = 1e-12
"""Movement of the unknowns, and of the variances as a share, below which nothing moves any more.

A step is a tenth to a third shorter than the one before, so that this leaves the last bits alone:
two machines whose arithmetic differs there must come to the same factors.
"""

AGEING: Final = -3
"""Where ageing stands among the unknowns; weight and length come last."""


@dataclass(frozen=True)
class Rows:
    """Observations: first ln Cw of boats towed more than once, sorted by boat; then ln(GPS / log).

    `n` observations, `n_cw` of them of Cw; `p` unknowns.

    Attributes:
        value: (n,) observed.
        group: (n,) index of the determined group, -1 for anchored tows.
        r: (n,) (v/B)^2 of the true curve; of no account for GPS.
        is_cw: (n,) ln Cw, not GPS.
        fixed: (n, p) design of everything but the log factor.
        starts: first row of each boat.
        boat: (n_cw,) number of the boat.
        cluster: (n,) index of the boat whatever its crew and alterations.
        known_variance: (n,) given random part.
        era: (n,) index of the era, -1 for anchored tows.
        prior_mean, prior_precision: (p,).
        groups: number of determined groups.
    """

    value: FloatArray
    group: IntArray
    r: FloatArray
    is_cw: BoolArray
    fixed: FloatArray
    starts: IntArray
    boat: IntArray
    cluster: IntArray
    known_variance: FloatArray
    era: IntArray
    prior_mean: FloatArray
    prior_precision: FloatArray
    groups: int

    @classmethod
    def of(cls, network: Network, settings: Settings) -> "Rows":
        """What the determined part of a network has to say."""
        group, cw, gps = _chosen(network)
        rows = np.concatenate([cw, gps])
        is_cw = np.arange(len(rows)) < len(cw)
        boat = network.boat[cw]
        excess = _rectification(network.numbers("declared_speed_m_s")[gps], settings)
        given_sd = [network.numbers("ln_cw_sd")[cw], network.numbers("gps_sd")[gps]]
        season = network.numbers("season")[rows]
        era = np.searchsorted(settings.era_starts, season, side="right") - 1
        with_gps = np.flatnonzero(network.has_gps[network.determined])
        groups = int(network.determined.sum())
        mean, precision = _priors(groups, len(with_gps), excess, settings)
        fixed = np.zeros((len(rows), len(mean)))
        gps_column = groups + np.searchsorted(with_gps, group[gps])
        fixed[np.flatnonzero(~is_cw), gps_column] = 1.0
        fixed[is_cw, AGEING] = season[is_cw] - settings.reference_year
        fixed[is_cw, -2] = _ln_size(network.numbers("weight_kg")[cw], boat)
        fixed[is_cw, -1] = _ln_size(network.numbers("waterline_length_m")[cw], boat)
        new_boat = np.diff(boat, prepend=-1) != 0
        return cls(
            value=np.concatenate(
                [network.numbers("ln_cw")[cw], network.numbers("gps_ln_ratio")[gps] - excess]
            ),
            group=group[rows],
            r=1.0 - 2.0 / network.numbers("kappa")[rows],
            is_cw=is_cw,
            fixed=fixed,
            starts=np.flatnonzero(new_boat),
            boat=np.cumsum(new_boat) - 1,
            cluster=network.cluster[rows],
            known_variance=np.concatenate(given_sd) ** 2,
            era=np.where(group[rows] >= 0, np.maximum(era, 0), -1),
            prior_mean=mean,
            prior_precision=precision,
            groups=groups,
        )

    def anchored_pairs(self, solution: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Differences between a boat's consecutive anchored tows, and their random variance."""
        later = np.flatnonzero(self.is_cw & (self.group < 0))[1:]
        # Rows of Cw come first, sorted by boat and time.
        later = later[(self.group[later - 1] < 0) & (self.boat[later] == self.boat[later - 1])]
        level = self.value - self.fixed @ solution
        variance = self.known_variance[later] + self.known_variance[later - 1]
        return level[later] - level[later - 1], variance

    def linear(self, ln_factor: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Observed values, design and slope of h, linear about given ln factors."""
        value, slope = linear_scale(self.value, self.group, self.r, ln_factor)
        loose = self.group >= 0
        value = np.where(self.is_cw, value, self.value)
        slope = np.where(self.is_cw, slope, loose)
        design = self.fixed.copy()
        design[np.flatnonzero(loose), self.group[loose]] = slope[loose]
        return value, design, slope


def _chosen(network: Network) -> tuple[IntArray, IntArray, IntArray]:
    """Determined group of each tow (-1: none), and the tows whose Cw and whose GPS count."""
    determined = network.determined
    place = np.append(np.where(determined, np.cumsum(determined) - 1, -1), -1)
    group = place[network.group]
    sound = (network.group < 0) | (group >= 0)
    tows_of = np.bincount(network.boat[sound], minlength=int(network.boat.max(initial=-1)) + 1)
    cw = np.flatnonzero(sound & (tows_of[network.boat] > 1))
    gps = np.flatnonzero((group >= 0) & np.isfinite(network.numbers("gps_ln_ratio")))
    return group, cw[np.argsort(network.boat[cw], kind="stable")], gps


def _rectification(speed_m_s: FloatArray, settings: Settings) -> FloatArray:
    """Half of the most by which noise across the course can lengthen a velocity, as a ratio."""
    return np.asarray(0.25 * (settings.gps_noise_m_s / speed_m_s) ** 2, dtype=np.float64)


def _priors(
    groups: int, offsets: int, rectification: FloatArray, settings: Settings
) -> tuple[FloatArray, FloatArray]:
    """Mean and precision of every unknown; nothing is held of log factors."""
    covariates = (settings.ageing_per_year, settings.weight_elasticity, settings.length_elasticity)
    # Anything from none to twice the half that is taken off, all equally likely.
    rectified_sd = rectification.mean() / np.sqrt(3.0) if len(rectification) else 0.0
    offset_sd = np.hypot(settings.gps_season_sd, rectified_sd)
    mean = [0.0] * (groups + offsets) + [prior.mean for prior in covariates]
    sd = [np.inf] * groups + [offset_sd] * offsets + [prior.sd for prior in covariates]
    return np.array(mean), np.array(sd) ** -2.0


def _ln_size(size: FloatArray, boat: IntArray) -> FloatArray:
    """Ln of a size, 0 for boats of which it is not known at every tow."""
    known = size > 0
    missing = np.bincount(boat, ~known, minlength=int(boat.max(initial=-1)) + 1)
    usable = known & (missing[boat] == 0)
    return np.where(usable, np.log(np.where(usable, size, 1.0)), 0.0)


@dataclass(frozen=True)
class Fit:
    """The solution with what its uncertainty is made of.

    Attributes:
        solution: (p,) unknowns.
        variances: tow, GPS, then the wander of each era.
        design: (n, p), boats eliminated.
        residual, variance, robustness: (n,) residuals, their core variance, weights of the t
            distribution (about 1 where nothing is wrong).
    """

    solution: FloatArray
    variances: FloatArray
    design: FloatArray
    residual: FloatArray
    variance: FloatArray
    robustness: FloatArray

    @property
    def ageing_per_year(self) -> float:
        """Change of ln Cw per year."""
        return float(self.solution[AGEING])


def fit_jointly(rows: Rows, settings: Settings, tow_sd: float | None = None) -> Fit:
    """Weighted least squares, weights and variances by turns until nothing moves.

    Weights are those of the EM algorithm for t residuals; the variances solve the REML equations
    sum(d u r^2 / v^2) = sum(d (1 - h) / v), d the share of a component in a row's variance and h
    the row's leverage, by multiplicative steps, which keep them positive. `tow_sd` is held where it
    is given.
    """
    wander_sd = [settings.wander_sd] * len(settings.era_starts)
    start = np.array([settings.tow_sd, settings.gps_sd, *wander_sd]) ** 2
    variances, robustness, solution = start, np.ones(len(rows.value)), rows.prior_mean
    for _ in range(MAX_ITERATIONS):
        value, design, slope = rows.linear(solution[: rows.groups])
        parts = _variance_parts(rows, slope, len(wander_sd))
        variance = rows.known_variance + parts @ variances
        weight = robustness / variance
        value, design = _eliminate_boats(rows, weight, value, design)
        weighted = weight[:, None] * design
        inverse = np.linalg.inv(design.T @ weighted + np.diag(rows.prior_precision))
        previous, solution = (
            solution,
            inverse @ (weighted.T @ value + rows.prior_precision * rows.prior_mean),
        )
        residual = value - design @ solution
        leverage = _boat_share(rows, weight) + ((weighted @ inverse) * design).sum(axis=1)
        square = _misfit(rows, residual, variance)
        robustness = (settings.t_dof + 1.0) / (settings.t_dof + square)
        found = parts.T @ (robustness * (residual / variance) ** 2)
        expected = parts.T @ (np.maximum(1.0 - leverage, 0.0) / variance)
        found += settings.prior_dof * start / variances**2
        expected += settings.prior_dof / variances
        step = found / expected
        if tow_sd is not None:
            step[0] = tow_sd**2 / variances[0]
        variances = variances * step
        if max(np.abs(solution - previous).max(), np.abs(step - 1.0).max()) < TOLERANCE:
            break
    return Fit(solution, variances, design, residual, variance, robustness)


def _misfit(rows: Rows, residual: FloatArray, variance: FloatArray) -> FloatArray:
    """Squared residual of each row in units of its variance, as the weights are to see it.

    A boat's own mean takes up part of its residuals. Of two tows nobody can tell which is off: both
    have the misfit of their difference. Judged one by one they would agree only in principle: the
    slightest difference, of rounding even, would grow until one of them had all the weight.
    """
    shown = np.maximum(1.0 - _boat_share(rows, 1.0 / variance), LEAST_MARGIN)
    square = residual**2 / (variance * shown)
    first = rows.starts[np.bincount(rows.boat) == 2]
    second = first + 1
    difference = residual[second] - residual[first]
    square[first] = square[second] = difference**2 / (variance[first] + variance[second])
    return square


def _variance_parts(rows: Rows, slope: FloatArray, eras: int) -> FloatArray:
    """Share of each variance component in each row: tow, GPS, wander of each era; (n, 2 + eras)."""
    wander = (rows.era[:, None] == np.arange(eras)) * (slope**2)[:, None]
    return np.column_stack([rows.is_cw, ~rows.is_cw, wander]).astype(np.float64)


def _eliminate_boats(
    rows: Rows, weight: FloatArray, value: FloatArray, design: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Takes off each boat's weighted mean; rows of GPS stay as they are."""
    count = len(rows.boat)
    if not count:
        return value, design
    both = np.column_stack([value, design])
    of_cw = weight[:count, None]
    total = np.add.reduceat(of_cw * both[:count], rows.starts, axis=0)
    both[:count] -= (total / np.add.reduceat(of_cw, rows.starts, axis=0))[rows.boat]
    return both[:, 0], both[:, 1:]


def _boat_share(rows: Rows, weight: FloatArray) -> FloatArray:
    """Weight of a row in its boat's mean; 0 for GPS."""
    count = len(rows.boat)
    share = np.zeros(len(weight))
    if count:
        share[:count] = weight[:count] / np.add.reduceat(weight[:count], rows.starts)[rows.boat]
    return share


def leave_boats_out(rows: Rows, fit: Fit, settings: Settings) -> LeftOut:
    """How sure the joint solution is.

    A weight that falls as its residual grows makes the solution move by more than with the weights
    kept. With u = (dof + 1) / (dof + z^2) the slope of u z is u - 2 (u z)^2 / (dof + 1).
    """
    u = fit.robustness
    z2 = (settings.t_dof + 1.0) / u - settings.t_dof
    slope = u - 2.0 * z2 * u**2 / (settings.t_dof + 1.0)
    slack = float(u.sum() / slope.sum()) if len(u) else 1.0
    observed = fit.residual + fit.design @ fit.solution
    prior = rows.prior_mean, rows.prior_precision
    return leave_out(fit.design, observed, u / fit.variance, rows.cluster, prior, slack)
