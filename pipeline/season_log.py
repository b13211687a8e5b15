"""The log error of each season, estimated from all repeat tows together.

A boat that was not altered must come out the same in two seasons; what is left between them is the
speed log. A speed error acts on Cw at a fixed speed with the elasticity kappa = 2 / (1 - r), so
repeat tows determine it well (research, method.md 8.1). It is the ubercalibration of astronomy:
boats are the stars, seasons the nights, tows calibrated on dGPS the absolute anchor.

Belongs here: the joint estimate, how sure it is and what it rests on; the second estimate without
boat identity; the test whether a step is the log's or the load cell's. Does not: how Cw of a tow
is computed, prescribed corrections (never data here) and what is done with the factors.

The model, for tow k of boat i in season j, with lambda = ln(true speed / log speed):

    ln Cw_k = theta_i + x_k beta + delta (t_k - t0) + h(lambda_j + w_k; r_k) + eps_k
    ln(GPS / log)_k = lambda_j + w_k + b_j + gamma_k                    (plain GPS, where there is)

h is what a scale error of the log does to a hyperbola exactly, about kappa lambda. Boats theta are
eliminated. Wander w, tow noise eps and GPS noise gamma have variances of their own; their
residuals get the weights of a t distribution, against alterations that nobody reported.
"""

from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
import polars as pl
from numpy.typing import ArrayLike
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.special import stdtrit

from pipeline.arrays import BoolArray, FloatArray, IntArray

LEVEL: Final = 0.95
GROUP: Final = ("season", "part", "log")
"""What has a log factor of its own: one log, in a season or the part of it until a replacement."""
LINE: Final = ("fsn_no", "rowers", "crew_class")

ESTIMATED: Final = "estimated"
GPS: Final = "gps"
NOT_DETERMINED: Final = "not determined"
NOT_TOLD: Final = "not told"

FEWEST_BOATS: Final = 3
SMALLEST_STEP: Final = 0.03
"""A smaller step of ln Cw is one per cent of speed: no cause is looked for."""
TELLING: Final = 3.0
"""A level step of this many sd of the slope's can be told: half way to the other cause is 1.5."""
SURE: Final = 4.0
"""A force step of this many sd is one, however large the log's own part of the level."""

MAX_ITERATIONS: Final = 300
TOLERANCE: Final = 1e-7
LEAST_MARGIN: Final = 0.05
"""1 - (v/B)^2 is kept above this while a log factor is searched."""
REGRESSIONS: Final = 8
"""Repeats of the second estimate until h is linear about its own answer."""
VARIANCE_FLOOR: Final = 1e-12
LOST: Final = 1e-9
"""A share of the information below this is none."""


@dataclass(frozen=True)
class Prior:
    """What is held of a number before the data: its mean and standard deviation."""

    mean: float
    sd: float


@dataclass(frozen=True)
class Settings:
    """What is assumed before looking at the data; all of it weak but for `gps_season_sd`.

    Attributes:
        era_starts: first season of each era of logs; an era has one wander (DOMAIN, history).
        ageing_per_year: change of ln Cw per year; half a per cent has been seen.
        weight_elasticity, length_elasticity: dlnCw / dln of the empty boat's weight, of its length.
        tow_sd, wander_sd, gps_sd: first guesses of the standard deviations of ln Cw of a tow beyond
            its random part, of ln of the log factor from tow to tow, and of ln(GPS / log) beyond
            its given uncertainty. They count as `prior_dof` observations.
        gps_season_sd: uncertainty of a season's mean GPS / log that does not average out.
        gps_noise_m_s: sideways noise of a fix; the length of a noisy velocity is too long by up to
            noise^2 / (2 v^2). How much of that a receiver smooths away is unknown: half is taken.
        t_dof: degrees of freedom of the residuals. With 8 the factors come out as near as with 4
            when 12 % of the boats are altered, and the intervals hold better.
        reference_year: t0.
    """

    era_starts: tuple[int, ...] = (2009, 2012)
    ageing_per_year: Prior = Prior(0.0, 0.005)
    weight_elasticity: Prior = Prior(0.4, 0.4)
    length_elasticity: Prior = Prior(0.0, 1.0)
    tow_sd: float = 0.01
    wander_sd: float = 0.005
    gps_sd: float = 0.01
    prior_dof: float = 2.0
    gps_season_sd: float = 0.003
    gps_noise_m_s: float = 0.1
    t_dof: float = 8.0
    reference_year: int = 2014


@dataclass(frozen=True)
class SeasonFactors:
    """Log factors with all that is known about them.

    Attributes:
        factors: one row per season, part and log that has tows without dGPS calibration, sorted:
            `season, part, log, factor, lo, hi, source, ln_sd, dof, n_tows, n_links, component,
            influence, influence_boat, critical_boats, weakest_mode, factor_no_boats,
            lo_no_boats, hi_no_boats, agreement`. See `estimate_season_factors`.
        covariance: covariance of ln factor between the rows of `factors` that are determined, in
            their order.
        wander_sd: standard deviation of ln factor from tow to tow, by first season of the era.
        tow_sd: core standard deviation of ln Cw of a tow beyond its random part.
        ageing_per_year: change of ln Cw per year, with `ageing_sd`.
        weakest_mode_sd: standard deviation of the combination of ln factors that is known worst.
    """

    factors: pl.DataFrame
    covariance: FloatArray
    wander_sd: dict[int, float]
    tow_sd: float
    ageing_per_year: float
    ageing_sd: float
    weakest_mode_sd: float


def estimate_season_factors(tows: pl.DataFrame, settings: Settings = Settings()) -> SeasonFactors:
    """Log factors of all seasons at once, from repeat tows and plain GPS.

    Args:
        tows: one row per sound tow:
            `tow_id, season, part, log`; `fsn_no, rowers, crew_class` (the line);
            `ln_cw`, ln Cw at one reference speed of the line, by the log as it reads (anchored
            tows: as calibrated) and corrected for everything else;
            `kappa`, elasticity 2 / (1 - r) of the line's true curve there, from pooled q;
            `ln_cw_sd`, its random part; `weight_kg, waterline_length_m` (may be null);
            `boat_type` (may be null); `altered`, reported, since the line's previous tow;
            `declared_speed_m_s`; `gps_ln_ratio`, ln(mean GPS / log), null without, with `gps_sd`,
            its random part; `anchored`, calibrated on dGPS: no log error is left.
        settings: what is assumed beforehand.

    Returns:
        The factors. `source` is `estimated` with boats that link the season to others, `gps` with
        GPS alone, `not determined` (numbers null) where neither ties it to an anchored season.
        `n_links` counts boats also towed elsewhere, `component` the connected part of the network
        (0 has the anchor), `influence` is the largest change of the factor when one boat
        (`influence_boat`) is left out, `critical_boats` how many boats would leave the season
        undetermined, `weakest_mode` its share in the combination of seasons that is known worst,
        `agreement` (factor - the one without boat identity) in standard deviations.
    """
    network = _Network.of(tows)
    rows = _rows(network, settings)
    fit = _fit(rows, settings)
    spread = _spread(rows, fit, settings)
    ageing_sd = float(np.sqrt(spread.covariance[-3, -3]))
    second = _without_boats(network, fit, ageing_sd, settings)
    return _as_factors(network, rows, fit, spread, second, settings)


# The network of boats and seasons


@dataclass(frozen=True)
class _Network:
    """Tows sorted by line and time, with what ties them together.

    Attributes:
        tows: the tows.
        group: index of each tow's row of `groups`, -1 for anchored tows, shape (tows,).
        boat: index of the boat as it was until a reported alteration, shape (tows,).
        cluster: index of the boat whatever its crew and alterations, shape (tows,).
        groups: season, part and log of the tows that are not anchored.
        boat_names: fsn_no by cluster.
        links: boats that tie a group to others, shape (groups,).
        component: connected part of the network, 0 with the anchor, shape (groups,).
        has_gps: groups with plain GPS, shape (groups,).
    """

    tows: pl.DataFrame
    group: IntArray
    boat: IntArray
    cluster: IntArray
    groups: pl.DataFrame
    boat_names: list[str]
    links: IntArray
    component: IntArray
    has_gps: BoolArray

    @classmethod
    def of(cls, tows: pl.DataFrame) -> "_Network":
        tows = tows.sort(*LINE, "season", "part", "tow_id").with_columns(
            pl.col("altered").fill_null(False).cum_sum().over(LINE).alias("state")
        )
        loose = ~tows["anchored"].to_numpy()
        groups = tows.filter(loose).select(GROUP).unique().sort(GROUP)
        key = groups.with_row_index("group")
        group = tows.join(key, on=GROUP, how="left", maintain_order="left")["group"]
        group_index = np.where(loose, group.cast(pl.Int64).fill_null(-1).to_numpy(), -1)
        boat = _index(tows, (*LINE, "state"))
        has_gps = np.zeros(groups.height, dtype=bool)
        has_gps[group_index[loose & tows["gps_ln_ratio"].is_not_null().to_numpy()]] = True
        names = tows["fsn_no"].unique().sort().to_list()
        links, component = _connect(group_index, boat, has_gps)
        return cls(
            tows,
            group_index,
            boat,
            _index(tows, ("fsn_no",)),
            groups,
            names,
            links,
            component,
            has_gps,
        )

    @property
    def determined(self) -> BoolArray:
        """Groups that are tied to the anchor, shape (groups,)."""
        return np.asarray(self.component == 0)

    def numbers(self, column: str) -> FloatArray:
        """A column as float64, NaN where null, shape (tows,)."""
        return self.tows[column].cast(pl.Float64).fill_null(np.nan).to_numpy()


def _index(tows: pl.DataFrame, columns: tuple[str, ...]) -> IntArray:
    """Rank of each row's combination of values in sorted order."""
    key = tows.select(columns).unique().sort(columns).with_row_index("index")
    placed = tows.select(columns).join(key, on=columns, how="left", maintain_order="left")
    return placed["index"].to_numpy().astype(np.int64)


def _connect(group: IntArray, boat: IntArray, has_gps: BoolArray) -> tuple[IntArray, IntArray]:
    """Links and connected component of each group; GPS ties a group to the anchor."""
    groups, boats = len(has_gps), int(boat.max(initial=-1)) + 1
    edges = np.unique(np.stack([boat, group + 1]), axis=1)  # node 0 is the anchor
    degree = np.bincount(edges[0], minlength=boats)
    linking = edges[1][degree[edges[0]] > 1]
    links = np.bincount(linking, minlength=groups + 1)[1:].astype(np.int64)
    gps_nodes = np.flatnonzero(has_gps) + 1
    nodes = groups + 1 + boats
    start = np.concatenate([edges[1], np.zeros(len(gps_nodes), np.int64)])
    end = np.concatenate([edges[0] + groups + 1, gps_nodes])
    graph = coo_array((np.ones(len(start)), (start, end)), shape=(nodes, nodes))
    label = connected_components(graph, directed=False)[1]
    other, component = np.unique(label[1 : groups + 1], return_inverse=True)
    # The anchor's part is 0, the others follow in the order of their seasons.
    first = [int(np.flatnonzero(component == i)[0]) for i in range(len(other))]
    rank = np.argsort(np.argsort(np.where(other == label[0], -1, first)))
    offset = 0 if label[0] in other else 1
    return links, np.asarray(rank[component] + offset, dtype=np.int64)


# Rows of the joint least squares


@dataclass(frozen=True)
class _Rows:
    """Observations: first ln Cw of boats towed more than once, sorted by boat; then ln(GPS / log).

    Unknowns are, in this order: ln factor of each determined group, GPS offset of each of them
    that has GPS, ageing, weight, length. `n` observations, `p` unknowns.

    Attributes:
        value: (n,) observed.
        group: (n,) index of the determined group, -1 for anchored tows.
        r: (n,) (v/B)^2 of the true curve; 0 for GPS.
        is_cw: (n,) ln Cw, not GPS.
        fixed: (n, p) design of everything but the log factor.
        starts: first row of each boat.
        boat: (n_cw,) index of the boat.
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

    def linear(self, ln_factor: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Observed values, design and slope of h, linear about given ln factors."""
        value, slope = _linear_scale(self.value, self.group, self.r, ln_factor)
        loose = self.group >= 0
        value = np.where(self.is_cw, value, self.value)
        slope = np.where(self.is_cw, slope, loose)
        design = self.fixed.copy()
        design[np.flatnonzero(loose), self.group[loose]] = slope[loose]
        return value, design, slope


def scale_effect(ln_factor: ArrayLike, r: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """What a log that reads low does to ln Cw at a fixed speed, and its slope.

    A log that must be multiplied by y = exp(ln factor) gives A y^2 and B / y, so that ln Cw at the
    speed where (v/B)^2 = r is too high by 2 ln y - ln((1 - r y^2) / (1 - r)), about kappa ln y
    with kappa = 2 / (1 - r) (research, method.md 0.1, 0.2).
    """
    y2 = np.exp(2.0 * np.asarray(ln_factor, dtype=np.float64))
    bend = np.asarray(r, dtype=np.float64)
    margin = np.maximum(1.0 - bend * y2, LEAST_MARGIN)
    return np.log(y2) - np.log(margin / (1.0 - bend)), 2.0 / margin


def _linear_scale(
    value: FloatArray, group: IntArray, r: FloatArray, ln_factor: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Observed values as linear in the ln factors, and the slope; 0 for anchored tows."""
    loose = group >= 0
    now = np.append(ln_factor, 0.0)[group]  # -1, anchored, reads the 0
    shift, slope = scale_effect(now, r)
    return value - np.where(loose, shift - slope * now, 0.0), np.where(loose, slope, 0.0)


def _rows(network: _Network, settings: Settings) -> _Rows:
    place = np.where(network.determined, np.cumsum(network.determined) - 1, -1)
    loose = network.group >= 0
    group = np.where(loose, place[network.group], -1) if len(place) else network.group
    sound = ~loose | (group >= 0)
    boats = np.bincount(network.boat[sound], minlength=int(network.boat.max(initial=-1)) + 1)
    cw = np.flatnonzero(sound & (boats[network.boat] > 1))
    gps_ratio = network.numbers("gps_ln_ratio")
    gps = np.flatnonzero((group >= 0) & np.isfinite(gps_ratio))
    cw = cw[np.argsort(network.boat[cw], kind="stable")]
    all_rows = np.concatenate([cw, gps])
    is_cw = np.arange(len(all_rows)) < len(cw)
    groups = int(network.determined.sum())
    offsets = np.flatnonzero(network.has_gps[network.determined])
    excess = _rectification(network.numbers("declared_speed_m_s")[gps], settings)
    boat = network.boat[cw]
    year = network.numbers("season") - settings.reference_year
    fixed = np.zeros((len(all_rows), groups + len(offsets) + 3))
    column = {int(g): groups + i for i, g in enumerate(offsets)}
    fixed[len(cw) + np.arange(len(gps)), [column[int(g)] for g in group[gps]]] = 1.0
    fixed[: len(cw), -3] = year[cw]
    fixed[: len(cw), -2] = _ln_change(network.numbers("weight_kg")[cw], boat)
    fixed[: len(cw), -1] = _ln_change(network.numbers("waterline_length_m")[cw], boat)
    priors = (settings.ageing_per_year, settings.weight_elasticity, settings.length_elasticity)
    rectified_sd = float(np.mean(excess)) / np.sqrt(3.0) if len(gps) else 0.0
    offset_sd = np.full(len(offsets), np.hypot(settings.gps_season_sd, rectified_sd))
    prior_sd = np.concatenate([offset_sd, [p.sd for p in priors]])
    none = np.zeros(groups)
    given_sd = np.concatenate([network.numbers("ln_cw_sd")[cw], network.numbers("gps_sd")[gps]])
    era = np.searchsorted(settings.era_starts, network.numbers("season"), side="right") - 1
    return _Rows(
        value=np.concatenate([network.numbers("ln_cw")[cw], gps_ratio[gps] - excess]),
        group=group[all_rows],
        r=1.0 - 2.0 / network.numbers("kappa")[all_rows],
        is_cw=is_cw,
        fixed=fixed,
        starts=np.flatnonzero(np.diff(boat, prepend=-1)),
        boat=np.cumsum(np.diff(boat, prepend=boat[:1]) != 0),
        cluster=network.cluster[all_rows],
        known_variance=given_sd**2,
        era=np.where(group[all_rows] >= 0, np.maximum(era[all_rows], 0), -1),
        prior_mean=np.concatenate([none, np.zeros(len(offsets)), [p.mean for p in priors]]),
        prior_precision=np.concatenate([none, 1.0 / prior_sd**2]),
        groups=groups,
    )


def _rectification(speed_m_s: FloatArray, settings: Settings) -> FloatArray:
    """Half of the most by which noise across the course can lengthen a velocity, as a ratio."""
    return np.asarray(0.25 * (settings.gps_noise_m_s / speed_m_s) ** 2, dtype=np.float64)


def _ln_change(values: FloatArray, boat: IntArray) -> FloatArray:
    """Ln of a size of a boat, 0 where it is not known for all of the boat's tows."""
    known = values > 0
    missing = np.bincount(boat, ~known, minlength=int(boat.max(initial=-1)) + 1)
    usable = known & (missing[boat] == 0)
    return np.where(usable, np.log(np.where(usable, values, 1.0)), 0.0)


# The fit


@dataclass(frozen=True)
class _Fit:
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
        return float(self.solution[-3])


def _fit(rows: _Rows, settings: Settings) -> _Fit:
    """Weighted least squares, weights and variances by turns until nothing moves.

    Weights are those of the EM algorithm for t residuals; the variances solve the REML equations
    sum(d u r^2 / v^2) = sum(d (1 - h) / v), d the share of a component in a row's variance and h
    the row's leverage, by multiplicative steps, which keep them positive.
    """
    guess = np.array(
        [settings.tow_sd, settings.gps_sd] + [settings.wander_sd] * len(settings.era_starts)
    )
    start = guess**2
    variances, robustness = start, np.ones(len(rows.value))
    solution = rows.prior_mean
    for _ in range(MAX_ITERATIONS):
        value, design, slope = rows.linear(solution[: rows.groups])
        parts = _variance_parts(rows, slope, len(settings.era_starts))
        variance = rows.known_variance + parts @ variances
        weight = robustness / variance
        value, design = _eliminate_boats(rows, weight, value, design)
        normal = design.T @ (weight[:, None] * design)
        right = design.T @ (weight * value)
        inverse = np.linalg.inv(normal + np.diag(rows.prior_precision))
        previous = solution
        solution = inverse @ (right + rows.prior_precision * rows.prior_mean)
        residual = value - design @ solution
        leverage = _boat_share(rows, weight) + weight * np.einsum(
            "ij,jk,ik->i", design, inverse, design
        )
        free = np.maximum(1.0 - leverage, 0.0)
        apart = np.maximum(1.0 - _boat_share(rows, 1.0 / variance), LEAST_MARGIN)
        robustness = (settings.t_dof + 1.0) / (settings.t_dof + residual**2 / (variance * apart))
        found = parts.T @ (robustness * (residual / variance) ** 2)
        expected = parts.T @ (free / variance)
        found += settings.prior_dof * start / variances**2
        expected += settings.prior_dof / variances
        step = found / expected
        variances = variances * step
        if max(np.abs(solution - previous).max(), np.abs(step - 1.0).max() * 1e-3) < TOLERANCE:
            break
    return _Fit(solution, variances, design, residual, variance, robustness)


def _variance_parts(rows: _Rows, slope: FloatArray, eras: int) -> FloatArray:
    """Share of each variance component in each row: tow, GPS, wander of each era; (n, 2 + eras)."""
    wander = (rows.era[:, None] == np.arange(eras)) * (slope**2)[:, None]
    return np.column_stack([rows.is_cw, ~rows.is_cw, wander]).astype(np.float64)


def _eliminate_boats(
    rows: _Rows, weight: FloatArray, value: FloatArray, design: FloatArray
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


def _boat_share(rows: _Rows, weight: FloatArray) -> FloatArray:
    """Weight of a row in its boat's mean; 0 for GPS."""
    count = len(rows.boat)
    share = np.zeros(len(weight))
    if count:
        share[:count] = weight[:count] / np.add.reduceat(weight[:count], rows.starts)[rows.boat]
    return share


# How sure


class _LeftOut(NamedTuple):
    """Least squares with one boat left out after the other.

    Attributes:
        covariance: (p, p) jackknife over boats, plus what the priors themselves may be off.
        dof: (p,) effective number of boats that an unknown rests on, plus 1.
        change: (boats, p) solution without the boat minus the solution.
        lost: (boats, p) whether nothing determines an unknown without the boat.
    """

    covariance: FloatArray
    dof: FloatArray
    change: FloatArray
    lost: BoolArray


def _leave_out(
    design: FloatArray,
    value: FloatArray,
    weight: FloatArray,
    cluster: IntArray,
    prior: tuple[FloatArray, FloatArray],
    slack: float,
) -> _LeftOut:
    """Leaves each boat out in closed form, the weights of the others kept.

    Args:
        design: (n, p), boats eliminated where they have effects.
        value: (n,) observed.
        weight: (n,) weights.
        cluster: (n,) index of the boat.
        prior: mean and precision of the unknowns, (p,) each.
        slack: by how much more the solution moves because weights would change too.
    """
    mean, precision = prior
    normal = design.T @ (weight[:, None] * design)
    right = design.T @ (weight * value)
    inverse = np.linalg.inv(normal + np.diag(precision))
    solution = inverse @ (right + precision * mean)
    boats = int(cluster.max(initial=-1)) + 1
    member = (cluster[:, None] == np.arange(boats)).astype(np.float64)
    weighted = weight[:, None] * design
    normal_of = np.einsum("nb,ni,nj->bij", member, weighted, design, optimize=True)
    right_of = member.T @ (weighted * value[:, None])
    # The tiny term keeps an unknown that is lost without the boat from stopping the others.
    information = np.maximum(np.diag(normal), 1.0)
    left = np.linalg.inv(normal + np.diag(precision + LOST * information) - normal_of)
    change = np.einsum("bij,bj->bi", left, right - right_of + precision * mean) - solution
    lost = np.einsum("bii->bi", left) * information * np.sqrt(LOST) > 1.0
    kept = np.where(lost, 0.0, change) * slack
    by_model = (inverse @ normal @ inverse) * slack
    jackknife = kept.T @ kept
    # A boat that cannot be left out says nothing here; its scatter is taken from all the others.
    short = np.maximum(np.diag(by_model) - np.diag(jackknife), 0.0) * lost.any(axis=0)
    share = np.einsum("ij,bjk,ki->bi", inverse, normal_of, inverse)
    squares = np.maximum((share**2).sum(axis=0), np.finfo(np.float64).tiny)
    return _LeftOut(
        jackknife + np.diag(short) + inverse @ np.diag(precision) @ inverse,
        share.sum(axis=0) ** 2 / squares + 1.0,
        change,
        lost,
    )


def _spread(rows: _Rows, fit: _Fit, settings: Settings) -> _LeftOut:
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
    return _leave_out(fit.design, observed, u / fit.variance, rows.cluster, prior, slack)


# The second estimate, without boat identity


@dataclass(frozen=True)
class _Second:
    """Ln factors by regression on what a boat is, not on which; (all groups,) each."""

    ln_factor: FloatArray
    sd: FloatArray
    dof: FloatArray
    known: BoolArray


def _without_boats(network: _Network, fit: _Fit, ageing_sd: float, settings: Settings) -> _Second:
    """Regression of ln Cw on ln weight, ln length, type, crew and season.

    Only the ageing is taken from the joint estimate, since nothing but repeat tows can tell it;
    its uncertainty is added.
    """
    tows, groups = network.tows, network.groups.height
    sizes = [network.numbers("weight_kg"), network.numbers("waterline_length_m")]
    sound = np.logical_and.reduce([size > 0 for size in sizes])
    if groups == 0 or not (sound & (network.group < 0)).any():
        nothing = np.zeros(groups)
        return _Second(nothing, nothing, nothing, nothing > 0)
    kinds = tows.select(
        pl.col("boat_type").fill_null(""), "crew_class", pl.col("rowers").cast(pl.String)
    ).to_dummies(drop_first=True)
    logs = [np.log(np.where(sound, size, 1.0)) for size in sizes]
    about = [x - x[sound].mean() for x in logs]
    other = np.column_stack([np.ones(tows.height), *about, kinds.to_numpy()])[sound]
    group, r = network.group[sound], 1.0 - 2.0 / network.numbers("kappa")[sound]
    year = network.numbers("season")[sound] - settings.reference_year
    observed = network.numbers("ln_cw")[sound] - fit.ageing_per_year * year
    slopes = (settings.weight_elasticity, settings.length_elasticity)
    prior_sd = np.array([1e3, *(p.sd for p in slopes), *np.ones(kinds.width)])
    mean = np.array([*np.zeros(groups + 1), *(p.mean for p in slopes), *np.zeros(kinds.width)])
    precision = np.concatenate([np.zeros(groups), prior_sd**-2.0])
    counts = np.bincount(group[group >= 0], minlength=groups)
    precision[:groups] = np.where(counts > 0, 0.0, 1.0)
    ln_factor, variance = np.zeros(groups), 1.0
    for _ in range(REGRESSIONS):
        value, slope = _linear_scale(observed, group, r, ln_factor)
        design = np.column_stack([(group[:, None] == np.arange(groups)) * slope[:, None], other])
        normal = design.T @ design / variance + np.diag(precision)
        solution = np.linalg.solve(normal, design.T @ value / variance + precision * mean)
        ln_factor = solution[:groups]
        variance = float(np.mean((value - design @ solution) ** 2)) + VARIANCE_FLOOR
    weight = np.full(len(value), 1.0 / variance)
    left = _leave_out(design, value, weight, network.cluster[sound], (mean, precision), 1.0)
    by_ageing = np.linalg.solve(normal, design.T @ year / variance)[:groups] * ageing_sd
    sd = np.sqrt(np.diag(left.covariance)[:groups] + by_ageing**2)
    return _Second(ln_factor, sd, left.dof[:groups], counts > 0)


# The answer


def _as_factors(
    network: _Network, rows: _Rows, fit: _Fit, spread: _LeftOut, second: _Second, settings: Settings
) -> SeasonFactors:
    n = rows.groups
    known = np.flatnonzero(network.determined)
    ln_factor, covariance = fit.solution[:n], spread.covariance[:n, :n]
    sd = np.sqrt(np.diag(covariance))
    mode_variance, modes = np.linalg.eigh(covariance) if n else (np.zeros(1), np.zeros((0, 1)))
    lost = spread.lost[:, :n]
    moves = np.where(lost, np.inf, np.abs(np.expm1(spread.change[:, :n])) * np.exp(ln_factor))
    boat = moves.argmax(axis=0) if moves.size else np.zeros(n, np.int64)
    largest = moves.max(axis=0, initial=0.0)
    table = network.groups.with_columns(
        _placed("ln_factor", ln_factor, known, network),
        _placed("ln_sd", sd, known, network),
        _placed("dof", spread.dof[:n], known, network),
        pl.Series("n_tows", np.bincount(network.group[network.group >= 0]), pl.Int64),
        pl.Series("n_links", network.links, pl.Int64),
        pl.Series("component", network.component, pl.Int64),
        _placed("influence", np.where(np.isfinite(largest), largest, np.nan), known, network),
        _placed("boat", boat.astype(np.float64), known, network),
        _placed("critical_boats", lost.sum(axis=0).astype(np.float64), known, network),
        _placed("weakest_mode", modes[:, -1], known, network),
        pl.Series("has_gps", network.has_gps),
    )
    return SeasonFactors(
        factors=_described(table, network, second),
        covariance=covariance,
        wander_sd=dict(zip(settings.era_starts, np.sqrt(fit.variances[2:]).tolist(), strict=True)),
        tow_sd=float(np.sqrt(fit.variances[0])),
        ageing_per_year=fit.ageing_per_year,
        ageing_sd=float(np.sqrt(spread.covariance[-3, -3])),
        weakest_mode_sd=float(np.sqrt(max(mode_variance[-1], 0.0))),
    )


def _placed(name: str, values: FloatArray, known: IntArray, network: _Network) -> pl.Series:
    """Values of the determined groups as a column of all groups, null for the others."""
    column = np.full(network.groups.height, np.nan)
    column[known] = values
    return pl.Series(name, column, pl.Float64).fill_nan(None)


def _described(table: pl.DataFrame, network: _Network, second: _Second) -> pl.DataFrame:
    """Factors and intervals from the ln factors, with where they come from."""
    names = pl.Series(network.boat_names, dtype=pl.String)
    boat = table["boat"].cast(pl.Int64)
    source = (
        pl.when(pl.col("ln_factor").is_null())
        .then(pl.lit(NOT_DETERMINED))
        .when((pl.col("n_links") == 0) & pl.col("has_gps"))
        .then(pl.lit(GPS))
        .otherwise(pl.lit(ESTIMATED))
    )
    half = _half_width(table["ln_sd"], table["dof"])
    other = pl.Series(np.where(second.known, second.ln_factor, np.nan)).fill_nan(None)
    other_sd = pl.Series(second.sd)
    other_half = _half_width(other_sd, pl.Series(second.dof))
    ln_factor = table["ln_factor"]
    apart = (ln_factor - other) / (table["ln_sd"] ** 2 + other_sd**2).sqrt()
    return table.select(
        *GROUP,
        ln_factor.exp().alias("factor"),
        (ln_factor - half).exp().alias("lo"),
        (ln_factor + half).exp().alias("hi"),
        source.alias("source"),
        "ln_sd",
        "dof",
        "n_tows",
        "n_links",
        "component",
        "influence",
        names.gather(boat).alias("influence_boat"),
        pl.col("critical_boats").cast(pl.Int64),
        "weakest_mode",
        other.exp().alias("factor_no_boats"),
        (other - other_half).exp().alias("lo_no_boats"),
        (other + other_half).exp().alias("hi_no_boats"),
        apart.alias("agreement"),
    )


def _half_width(sd: pl.Series, dof: pl.Series) -> pl.Series:
    quantile = stdtrit(dof.fill_null(1.0).clip(1.0).to_numpy(), 0.5 * (1.0 + LEVEL))
    return sd * pl.Series(quantile)


# The log or the load cell


def log_or_force(tows: pl.DataFrame, found: SeasonFactors) -> pl.DataFrame:
    """Whether the step of a season against the others comes from the log or from the load cell.

    A scale error of the log leaves A B^2 as it is, that of the load cell multiplies it; both move
    the level (research, method.md 8.2). So the slope q / Cw of 1/Cw on (v/v0)^2, which is
    v0^2 / (A B^2), is compared with that of the same boats' other tows.

    Args:
        tows: as for `estimate_season_factors`, with `q` and its standard deviation `q_sd` of the
            free curve at the reference speed, by the log as it reads.
        found: the season factors.

    Returns:
        One row per season, part and log (anchored ones too): `level_step` (ln Cw against the
        boats' other tows, those corrected by their factors), `force_step` (the part in ln force
        that the slope shows), both with `_sd`, `n_boats`, and `cause`: `log`, `force`, `none` (no
        level step of 3 % and twice its sd), or `not told`: the slope is too uncertain.
    """
    placed = tows.join(
        found.factors.select(*GROUP, pl.col("factor").log().alias("ln_factor")),
        on=GROUP,
        how="left",
    ).filter(pl.col("anchored") | pl.col("ln_factor").is_not_null())
    placed = placed.sort(*LINE, "season", "part", "tow_id").with_columns(
        pl.col("altered").fill_null(False).cum_sum().over(LINE).alias("state")
    )
    boat = _index(placed, (*LINE, "state"))
    ln_factor = np.where(placed["anchored"], 0.0, placed["ln_factor"].fill_null(0.0))
    kappa, ln_cw, q, q_sd = (placed[c].to_numpy() for c in ("kappa", "ln_cw", "q", "q_sd"))
    corrected = ln_cw - scale_effect(ln_factor, 1.0 - 2.0 / kappa)[0]
    pooled_q = 0.5 * kappa - 1.0
    rows = []
    for key, part in placed.with_row_index("row").group_by(GROUP, maintain_order=True):
        inside = np.zeros(placed.height, dtype=bool)
        inside[part["row"].to_numpy()] = True
        rows.append(
            dict(zip(GROUP, key, strict=True))
            | _step(boat, inside, ln_cw, corrected, q / pooled_q, q_sd / pooled_q)
        )
    numbers = ("level_step", "level_step_sd", "force_step", "force_step_sd")
    schema = {name: tows.schema[name] for name in GROUP} | dict.fromkeys(numbers, pl.Float64())
    return pl.DataFrame(rows, schema=schema | {"n_boats": pl.Int64(), "cause": pl.String()}).sort(
        GROUP
    )


def _step(
    boat: IntArray,
    inside: BoolArray,
    ln_cw: FloatArray,
    corrected: FloatArray,
    q_ratio: FloatArray,
    q_ratio_sd: FloatArray,
) -> dict[str, float | int | str | None]:
    """Level and slope of a group's tows against those of the same boats elsewhere."""
    size = int(boat.max()) + 1
    counts = np.stack([np.bincount(boat, side, size) for side in (inside, ~inside)])
    both = (counts > 0).all(axis=0)
    if both.sum() < FEWEST_BOATS:
        return {"n_boats": int(both.sum()), "cause": NOT_TOLD}

    def mean(values: FloatArray, side: BoolArray, count: FloatArray) -> FloatArray:
        return np.asarray(np.bincount(boat, values * side, size)[both] / count[both])

    usual = np.zeros(size)
    usual[both] = mean(corrected, ~inside, counts[1])
    level = mean(ln_cw, inside, counts[0]) - usual[both]
    slope = q_ratio * np.exp(usual[boat] - ln_cw)
    slope_sd = q_ratio_sd * np.exp(usual[boat] - ln_cw)
    change = mean(slope, inside, counts[0]) - mean(slope, ~inside, counts[1])
    change_variance = (
        mean(slope_sd**2, inside, counts[0]) / counts[0, both]
        + mean(slope_sd**2, ~inside, counts[1]) / counts[1, both]
    )
    level_step, level_sd = _weighted_mean(level, 1.0 / (1.0 / counts[:, both]).sum(axis=0))
    change_step, change_sd = _weighted_mean(change, 1.0 / change_variance)
    share = max(1.0 + change_step, LEAST_MARGIN)
    force_step, force_sd = -float(np.log(share)), change_sd / share
    return {
        "level_step": level_step,
        "level_step_sd": level_sd,
        "force_step": force_step,
        "force_step_sd": force_sd,
        "n_boats": int(both.sum()),
        "cause": _cause(level_step, level_sd, force_step, force_sd),
    }


def _weighted_mean(values: FloatArray, weight: FloatArray) -> tuple[float, float]:
    """Weighted mean and its standard error from the scatter about it."""
    mean = float(np.average(values, weights=weight))
    scatter = float((weight * (values - mean) ** 2).sum() / (len(values) - 1))
    return mean, float(np.sqrt(scatter / weight.sum()))


def _cause(level: float, level_sd: float, force: float, force_sd: float) -> str:
    if abs(level) < max(SMALLEST_STEP, 2.0 * level_sd):
        return "none"
    if abs(force) > SURE * force_sd:
        return "force"
    if abs(level) < TELLING * force_sd:
        return NOT_TOLD
    return "log" if abs(force) < abs(force - level) else "force"
