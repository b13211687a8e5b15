"""The hyperbola Cw(v) = A / (1 - (v/B)^2): fitting many curves at once, and their intervals.

Belongs here: the least-squares fit through run points, the cap on B, what scatter of the points
says about Cw and B, and the closed-form re-base of a curve. Does not belong here: how a run point
is made, which runs count, hull speed, and whether a curve is acceptable.

A and B are what the register prints, but they are nearly collinear (correlation 0.98). Inside, a
curve is stored as A and s = 1/B^2. s <= 0 is an ordinary flat or falling curve: it has no B. For
errors a curve is described by C0 = Cw(v0) and q = r / (1 - r) with r = s v0^2, which are nearly
independent: Cw(v) = C0 / (1 - q ((v/v0)^2 - 1)).
"""

from dataclasses import dataclass, replace
from typing import Final, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from pipeline.arrays import BoolArray, FloatArray, IntArray
from pipeline.errors import BrokenPromiseError
from pipeline.quantiles import t_quantile

LEAST_MARGIN: Final = 0.05
"""1 - (v/B)^2 is kept above this where a speed is only supposed: beyond B there is no curve."""

VALID_RATIO: Final = (0.85, 1.15)
"""Speeds at which a curve counts, as ratios of its declared speed (Cw-kromme, R. Pot 2015)."""

CHUNK_FITS: Final = 8192
"""Fits worked on at a time, so that the working arrays stay in the processor's cache."""

MAX_ITERATIONS: Final = 100
TOLERANCE: Final = 1e-13
"""A fit is done when a step would move the fitted points by less than this share of the data."""

MIN_SPREAD: Final = 1e-6
"""Relative spread of v^2 below which the speeds count as one speed and determine no bend."""

WIDEST_LOG_INTERVAL: Final = 100.0
"""Half widths are cut at a factor e^100, which says nothing any more, to keep bounds finite."""

BISECTIONS: Final = 55
"""Halvings of the search interval for a bound of B: to the last bit of a float64."""


@dataclass(frozen=True)
class Points:
    """Run points of a batch of curves.

    Attributes:
        speed_m_s: (n_fits, n_points) speed through water, positive where used.
        cw_kg_m: resistance coefficient, likewise.
        used: whether the point counts; the others may hold anything.

    Raises:
        BrokenPromiseError: shapes differ, or a used point is not finite and positive.
    """

    speed_m_s: FloatArray
    cw_kg_m: FloatArray
    used: BoolArray

    def __post_init__(self) -> None:
        shapes = {self.speed_m_s.shape, self.cw_kg_m.shape, self.used.shape}
        if len(shapes) != 1 or self.speed_m_s.ndim != 2 or self.speed_m_s.shape[1] == 0:
            raise BrokenPromiseError(
                "Points need three arrays of one shape (n_fits, n_points), not {}.", shapes
            )
        both = np.stack([self.speed_m_s, self.cw_kg_m])
        unsound = (self.used & ~(np.isfinite(both) & (both > 0))).any(axis=(0, 2))
        if unsound.any():
            raise BrokenPromiseError(
                "{} curves use a point that is not a positive number, the first is curve {}. Set "
                "such points to unused beforehand.",
                unsound.sum(),
                unsound.argmax(),
            )

    @classmethod
    def from_arrays(
        cls, speed_m_s: ArrayLike, cw_kg_m: ArrayLike, used: ArrayLike | None = None
    ) -> Self:
        """Make points of anything array-like; one curve may be one row; by default all are used."""
        speed = np.atleast_2d(np.asarray(speed_m_s, dtype=np.float64))
        cw = np.atleast_2d(np.asarray(cw_kg_m, dtype=np.float64))
        mask = np.ones(speed.shape, bool) if used is None else np.atleast_2d(np.asarray(used, bool))
        return cls(speed, cw, mask)


@dataclass(frozen=True)
class Curves:
    """Fitted curves, one per row of the points; every array has shape (n_fits,), nothing is NaN.

    Attributes:
        a_kg_m: A, resistance coefficient at v = 0.
        s_s2_m2: s = 1/B^2; zero or negative for a flat or falling curve.
        rss_kg2_m2: residual sum of squares of the used points.
        n_points: number of used points.
        converged: False where the points determine no curve (fewer than two speeds, force that
            falls with speed, B prescribed below a measured speed), or the search for it did not
            come to rest. A and s are then those of the flat curve through the mean, A = 0 without
            any point.
        b_capped: True where B was lowered to its cap.
    """

    a_kg_m: FloatArray
    s_s2_m2: FloatArray
    rss_kg2_m2: FloatArray
    n_points: IntArray
    converged: BoolArray
    b_capped: BoolArray

    @property
    def b_determined(self) -> BoolArray:
        """Whether the curve has a finite B; `b_interval` says how well it is known."""
        return self.converged & (self.s_s2_m2 > 0)

    @property
    def b_m_s(self) -> FloatArray:
        """B where determined, infinite where not."""
        return _b_of_s(np.where(self.b_determined, self.s_s2_m2, 0.0))

    def cw_at(self, speed_m_s: ArrayLike) -> FloatArray:
        """Return Cw [kg/m] of every curve at its own speed, shape (n_fits,); infinite from B on."""
        return cw(self.a_kg_m, self.s_s2_m2, speed_m_s)


@dataclass(frozen=True)
class Scatter:
    """Scatter of single run points about their curve: own residuals or pooled over a season.

    Attributes:
        variance_kg2_m2: (n_fits,) variance of a point.
        dof: (n_fits,) degrees of freedom it rests on, infinite if known. At 0 nothing is known
            of the scatter and every interval is unbounded, whatever the variance says.
    """

    variance_kg2_m2: FloatArray
    dof: FloatArray


class Covariance(NamedTuple):
    """Covariance of C0 and q at one speed of every curve, (n_fits,); infinite where not known."""

    c0_variance_kg2_m2: FloatArray
    q_variance: FloatArray
    c0_q_covariance_kg_m: FloatArray


class Interval(NamedTuple):
    """Bounds of every curve, shape (n_fits,). A missing upper bound is infinite."""

    lo: FloatArray
    hi: FloatArray


# The model


def cw(a_kg_m: ArrayLike, s_s2_m2: ArrayLike, speed_m_s: ArrayLike) -> FloatArray:
    """Return Cw [kg/m] on the hyperbola A / (1 - s v^2), broadcast; infinite from B on."""
    a = np.asarray(a_kg_m, dtype=np.float64)
    s = np.asarray(s_s2_m2, dtype=np.float64)
    v = np.asarray(speed_m_s, dtype=np.float64)
    denominator = 1.0 - s * v * v
    valid = denominator > 0
    return np.where(valid, a / np.where(valid, denominator, 1.0), np.inf)


def s_of_b(b_m_s: ArrayLike) -> FloatArray:
    """Return s = 1/B^2 [s2/m2] of a B [m/s]; 0 for an infinite B."""
    b = np.asarray(b_m_s, dtype=np.float64)
    return 1.0 / (b * b)


def s_of_height(a_kg_m: FloatArray, cw_kg_m: FloatArray, speed_m_s: FloatArray) -> FloatArray:
    """Return s = 1/B^2 [s2/m2] by A and by Cw at a speed; 0 or less where there is no B."""
    return (1.0 - a_kg_m / cw_kg_m) / speed_m_s**2


def to_c0_q(
    a_kg_m: ArrayLike, s_s2_m2: ArrayLike, reference_speed_m_s: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Return C0 = Cw(v0) [kg/m] and q = r / (1 - r), r = s v0^2; infinite where v0 >= B."""
    s, v0 = np.asarray(s_s2_m2, dtype=np.float64), np.asarray(reference_speed_m_s, dtype=np.float64)
    # (1 - s v^2) = 1 / (1 + q), so q + 1 is the hyperbola with A = 1.
    return cw(a_kg_m, s, v0), cw(1.0, s, v0) - 1.0


def from_c0_q(
    c0_kg_m: ArrayLike, q: ArrayLike, reference_speed_m_s: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Return A [kg/m] and s [s2/m2] from C0 and q > -1 at a speed; inverse of `to_c0_q`."""
    c0, ratio = np.asarray(c0_kg_m, dtype=np.float64), np.asarray(q, dtype=np.float64)
    v0 = np.asarray(reference_speed_m_s, dtype=np.float64)
    return c0 / (1.0 + ratio), ratio / (1.0 + ratio) / (v0 * v0)


def rebase(
    a_kg_m: ArrayLike, b_m_s: ArrayLike, log_factor: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Return A [kg/m] and B [m/s] of a curve after its speeds are multiplied by the log factor.

    A pure scale error of the log maps hyperbolas onto hyperbolas: A / y^2 and B y, with A B^2
    unchanged. Exact as long as no wind correction depends on the speed. An infinite B stays so.
    """
    a = np.asarray(a_kg_m, dtype=np.float64)
    b = np.asarray(b_m_s, dtype=np.float64)
    y = np.asarray(log_factor, dtype=np.float64)
    return a / (y * y), b * y


# The fit


def fit(points: Points) -> Curves:
    """Fit hyperbolas by least squares in Cw through the used points, all curves at once.

    Variable projection (Golub & Pereyra 1973): for a given bend the height is linear, so only the
    bend is searched, by damped Gauss-Newton steps. The bend is taken as q at the root mean square
    speed: the same minimum as in s, but with height and bend nearly independent. A curve's result
    does not depend on which others are in the batch. `converged` says where there is none.
    """
    curves = _fit_flat(points)
    for start in range(0, len(curves.a_kg_m), CHUNK_FITS):
        chunk = _Columns.from_points(points, slice(start, start + CHUNK_FITS))
        n_points = _sum(chunk.weight)
        mean_square_speed = _sum(chunk.speed_squared) / np.maximum(n_points, 1.0)
        scale = np.where(mean_square_speed > 0, mean_square_speed, 1.0)
        z = chunk.weight * (chunk.speed_squared / scale - 1.0)
        has_two_speeds = _sum(z * z) > n_points * MIN_SPREAD**2
        solvable = np.flatnonzero((n_points >= 2) & has_two_speeds)
        if not solvable.size:
            continue
        found = _search_bend(
            z.take(solvable, axis=1),
            chunk.cw.take(solvable, axis=1),
            chunk.weight.take(solvable, axis=1),
        )
        in_chunk = solvable[found.fits]
        rows = start + in_chunk
        pivot_speed = np.sqrt(mean_square_speed[in_chunk])
        curves.a_kg_m[rows], curves.s_s2_m2[rows] = from_c0_q(found.c0, found.q, pivot_speed)
        curves.rss_kg2_m2[rows] = found.rss
        curves.converged[rows] = True
    return curves


def fit_given_b(points: Points, b_m_s: ArrayLike) -> Curves:
    """Fit A alone by least squares, with B given per curve.

    Args:
        points: run points of n_fits curves.
        b_m_s: (n_fits,) or one for all; infinite for a flat curve. Where it is not above every
            used speed there is no curve (`converged` is False).
    """
    s = np.broadcast_to(s_of_b(b_m_s), points.used.shape[:1])
    return _fit_given_s(points, s)


def fit_capped(points: Points, free: Curves, b_cap_m_s: ArrayLike) -> Curves:
    """Fit with B at most its cap; A is fitted again where the cap works.

    A missing B (s <= 0) counts as infinitely large and is capped too: the cap used by the
    federation is three times hull speed (presentation of 24 January 2015).

    Args:
        points: run points of n_fits curves.
        free: their free fit (`fit`).
        b_cap_m_s: (n_fits,) or one for all; infinite caps only at the flat curve.
    """
    s_min = np.broadcast_to(s_of_b(b_cap_m_s), free.s_s2_m2.shape)
    is_too_flat = free.converged & (free.s_s2_m2 < s_min)
    capped = _fit_given_s(points, s_min)
    curves = choose_curves(is_too_flat, capped, free)
    return replace(curves, b_capped=is_too_flat & capped.converged)


def choose_curves(where: BoolArray, one: Curves, other: Curves) -> Curves:
    """Return the curves of `one` where chosen, and those of `other` elsewhere."""
    return Curves(
        a_kg_m=np.where(where, one.a_kg_m, other.a_kg_m),
        s_s2_m2=np.where(where, one.s_s2_m2, other.s_s2_m2),
        rss_kg2_m2=np.where(where, one.rss_kg2_m2, other.rss_kg2_m2),
        n_points=np.where(where, one.n_points, other.n_points),
        converged=np.where(where, one.converged, other.converged),
        b_capped=np.where(where, one.b_capped, other.b_capped),
    )


def _fit_flat(points: Points) -> Curves:
    """Return flat curves through the means, not converged: what is left without a fit."""
    cw_used = np.where(points.used, points.cw_kg_m, 0.0)
    n_points = points.used.sum(axis=1)
    mean = cw_used.sum(axis=1) / np.maximum(n_points, 1)
    residual = np.where(points.used, cw_used - mean[:, None], 0.0)
    return Curves(
        a_kg_m=mean,
        s_s2_m2=np.zeros_like(mean),
        rss_kg2_m2=(residual * residual).sum(axis=1),
        n_points=n_points,
        converged=np.zeros(mean.shape, bool),
        b_capped=np.zeros(mean.shape, bool),
    )


def _fit_given_s(points: Points, s: FloatArray) -> Curves:
    """Return curves with s given; flat and not converged where s leaves a used speed beyond B."""
    flat = _fit_flat(points)
    profile = _Columns.from_points(points).profile(s)
    is_valid = profile.is_below_b & (flat.n_points > 0)
    given = replace(
        flat,
        a_kg_m=profile.a_kg_m,
        s_s2_m2=s,
        rss_kg2_m2=profile.rss_kg2_m2,
        converged=is_valid,
    )
    return choose_curves(is_valid, given, flat)


class _Profile(NamedTuple):
    """Fits of the height alone, at given s, (n_fits,)."""

    rss_kg2_m2: FloatArray
    a_kg_m: FloatArray
    is_below_b: BoolArray


@dataclass(frozen=True)
class _Columns:
    """Points turned to (n_points, n_fits), 0 where not used.

    Sums over points then run along whole rows: fast, and always in the same order.

    Attributes:
        speed_squared: v^2; cw: Cw; weight: 1 where used.
    """

    speed_squared: FloatArray
    cw: FloatArray
    weight: FloatArray

    @classmethod
    def from_points(cls, points: Points, rows: slice = slice(None)) -> Self:
        """Turn the points of some fits."""
        used = points.used[rows]
        speed = np.where(used, points.speed_m_s[rows], 0.0)
        cw_used = np.where(used, points.cw_kg_m[rows], 0.0)
        return cls(
            speed_squared=np.ascontiguousarray((speed * speed).T, dtype=np.float64),
            cw=np.ascontiguousarray(cw_used.T, dtype=np.float64),
            weight=np.ascontiguousarray(used.T, dtype=np.float64),
        )

    def profile(self, s: FloatArray) -> _Profile:
        """Fit the best A for a given s, and say whether s leaves all points below B."""
        denominator = 1.0 - s * self.speed_squared
        below_b = denominator > 0
        shape = self.weight / np.where(below_b, denominator, 1.0)
        norm = _sum(shape * shape)
        a = _sum(shape * self.cw) / np.where(norm > 0, norm, 1.0)
        residual = self.cw - a * shape
        return _Profile(_sum(residual * residual), a, np.asarray(below_b.all(axis=0)))


class _State(NamedTuple):
    """Where a search has come to, (open fits,).

    Attributes:
        q, c0, rss: bend, best height there, and residual sum of squares.
        step: the undamped next step of q.
        movement: length of that step in the space of the fitted points, kg/m.
    """

    q: FloatArray
    c0: FloatArray
    rss: FloatArray
    step: FloatArray
    movement: FloatArray

    def take(self, rows: BoolArray) -> "_State":
        """Return the state of some fits."""
        return _State(
            self.q[rows], self.c0[rows], self.rss[rows], self.step[rows], self.movement[rows]
        )

    def where(self, rows: BoolArray, other: "_State") -> "_State":
        """Return this state at some fits, and another elsewhere."""
        return _State(
            q=np.where(rows, self.q, other.q),
            c0=np.where(rows, self.c0, other.c0),
            rss=np.where(rows, self.rss, other.rss),
            step=np.where(rows, self.step, other.step),
            movement=np.where(rows, self.movement, other.movement),
        )


class _Found(NamedTuple):
    """Fits that came to rest, with their bend, height and residual sum of squares."""

    fits: IntArray
    q: FloatArray
    c0: FloatArray
    rss: FloatArray


def _search_bend(z: FloatArray, cw_used: FloatArray, weight: FloatArray) -> _Found:
    """Minimise the sum of squares over q.

    The bend stays between q = -1 (A infinite, s = -infinity) and the q that puts B on the fastest
    point: a step goes at most half way to either, and is halved until the sum of squares falls.

    Args:
        z: (v / v_pivot)^2 - 1, 0 where not used, (n_points, n_fits).
        cw_used, weight: Cw, and 1, of used points, likewise.
    """
    found = _Found(np.empty(0, np.int64), np.empty(0), np.empty(0), np.empty(0))
    open_fits = np.arange(z.shape[1])
    damping = np.ones(z.shape[1])
    upper = 1.0 / z.max(axis=0)
    size = _sum(cw_used * cw_used)
    state = _evaluate(np.clip(_guess_bend(z, cw_used), -0.9, 0.9 * upper), z, cw_used, weight)
    for _ in range(MAX_ITERATIONS):
        done = state.movement <= TOLERANCE * np.sqrt(size)
        if done.any():
            found = _Found(
                fits=np.concatenate([found.fits, open_fits[done]]),
                q=np.concatenate([found.q, state.q[done]]),
                c0=np.concatenate([found.c0, state.c0[done]]),
                rss=np.concatenate([found.rss, state.rss[done]]),
            )
            left = ~done
            open_fits, damping, upper, size = (
                open_fits[left], damping[left], upper[left], size[left],
            )  # fmt: skip
            z, cw_used, weight = z[:, left], cw_used[:, left], weight[:, left]
            state = state.take(left)
            if not open_fits.size:
                break
        at_least, at_most = 0.5 * (state.q - 1.0), 0.5 * (state.q + upper)
        q = np.minimum(np.maximum(state.q + damping * state.step, at_least), at_most)
        trial = _evaluate(q, z, cw_used, weight)
        # The slack lets the last steps pass, whose gain is below the rounding of the sum.
        is_better = trial.rss <= state.rss + TOLERANCE * size
        damping = np.where(is_better, 1.0, 0.5 * damping)
        state = trial.where(is_better, state)
    return found


def _guess_bend(z: FloatArray, cw_used: FloatArray) -> FloatArray:
    """Return the bend of the straight line 1/Cw = (1 - q z) / C0.

    Weighted with Cw^4 it acts as a fit in Cw.
    """
    cubed = cw_used * cw_used * cw_used
    weight = cubed * cw_used
    total = _sum(weight)
    z_mean = _sum(weight * z) / total
    dz = z - z_mean
    slope = _sum(cubed * dz) / _sum(weight * dz * dz)
    intercept = _sum(cubed) / total - slope * z_mean
    return np.where(intercept > 0, -slope / np.where(intercept > 0, intercept, 1.0), 0.0)


def _evaluate(q: FloatArray, z: FloatArray, cw_used: FloatArray, weight: FloatArray) -> _State:
    """Project out the height at bend q and take the Gauss-Newton step of what remains."""
    shape = weight / (1.0 - q * z)
    norm = _sum(shape * shape)
    c0 = _sum(shape * cw_used) / norm
    residual = cw_used - c0 * shape
    tangent = z * shape * shape
    tangent -= shape * (_sum(shape * tangent) / norm)
    tangent_norm = _sum(tangent * tangent)
    along = _sum(tangent * residual)
    return _State(
        q=q,
        c0=c0,
        rss=_sum(residual * residual),
        step=along / (c0 * tangent_norm),
        movement=np.abs(along) / np.sqrt(tangent_norm),
    )


def _sum(x: FloatArray) -> FloatArray:
    """Return sums over points (axis 0), one after the other: the same to the bit in any batch.

    NumPy adds rows one after the other, but the numbers of a single column in pairs.
    """
    return np.asarray(np.add.reduce(x) if x.shape[1] > 1 else x.cumsum(axis=0)[-1])


# Intervals


def own_scatter(curves: Curves) -> Scatter:
    """Return the scatter of a curve's own points about it, with n - 2 degrees of freedom."""
    dof = np.maximum(curves.n_points - 2, 0).astype(np.float64)
    variance = np.where(dof > 0, curves.rss_kg2_m2 / np.maximum(dof, 1.0), 0.0)
    return Scatter(variance, dof)


def covariance(
    points: Points, curves: Curves, scatter: Scatter, speed_m_s: ArrayLike
) -> Covariance:
    """Return the covariance of (C0, q) by the scatter of the points: variance (J'J)^-1.

    B counts as free; for a capped curve the result is therefore too wide rather than too narrow.

    Args:
        points: run points the curves were fitted to.
        scatter: own or pooled scatter of a point.
        speed_m_s: v0, that of C0 and q, (n_fits,) or one for all; usually the declared speed.
    """
    v0 = np.broadcast_to(np.asarray(speed_m_s, dtype=np.float64), curves.a_kg_m.shape)[:, None]
    a, s = curves.a_kg_m[:, None], curves.s_s2_m2[:, None]
    speed = points.speed_m_s
    c0 = cw(a, s, v0)
    fitted = cw(a, s, np.where(points.used, speed, 0.0))
    valid = points.used & np.isfinite(c0) & np.isfinite(fitted) & (c0 > 0)
    # Cw(v) / C0 = 1 / (1 - q x), x = (v/v0)^2 - 1: slopes of a point by C0 and by q.
    height = np.where(valid, fitted, 0.0) / np.where(valid, c0, 1.0)
    x = np.where(valid, speed / v0, 1.0) ** 2 - 1.0
    bend = np.where(valid, c0, 0.0) * height**2 * x
    hh = (height * height).sum(axis=1)
    hb = (height * bend).sum(axis=1)
    bb = (bend * bend).sum(axis=1)
    determinant = hh * bb - hb * hb
    known = curves.converged & (scatter.dof > 0) & (determinant > 0)
    unit = np.where(known, scatter.variance_kg2_m2 / np.where(known, determinant, 1.0), 0.0)
    return Covariance(
        c0_variance_kg2_m2=np.where(known, unit * bb, np.inf),
        q_variance=np.where(known, unit * hh, np.inf),
        c0_q_covariance_kg_m=np.where(known, -unit * hb, 0.0),
    )


def cw_interval(points: Points, curves: Curves, scatter: Scatter, speed_m_s: ArrayLike) -> Interval:
    """Return the 95 % interval of Cw [kg/m] at a speed per curve, by the scatter of its points.

    Taken on the logarithm, since errors of speed and force act as factors; so it is positive. It
    runs from 0 to infinity where the scatter is not known or the speed is not below B.

    Args: as of `covariance`.
    """
    variance, centre = covariance(points, curves, scatter, speed_m_s)[0], curves.cw_at(speed_m_s)
    known = np.isfinite(variance) & np.isfinite(centre)
    centre, sd = np.where(known, centre, 1.0), np.sqrt(np.where(known, variance, 0.0))
    factor = np.exp(np.minimum(_t_quantile(scatter.dof) * sd / centre, WIDEST_LOG_INTERVAL))
    return Interval(np.where(known, centre / factor, 0.0), np.where(known, centre * factor, np.inf))


def b_interval(points: Points, curves: Curves, scatter: Scatter) -> Interval:
    """Return the 95 % interval of B [m/s] by profile likelihood.

    The set {s: RSS(s) - RSS_min <= t^2 variance}, the standard answer where a parameter may not be
    identifiable (Raue et al. 2009). The upper bound is infinite ("none") where a flat curve is
    among them; the lower bound too where Cw falls so clearly that no finite B is. Without any
    knowledge of the scatter every B above the fastest point is possible.

    Args:
        points: run points the curves were fitted to.
        curves: their free fit (`fit`): a capped curve is not the minimum.
        scatter: own or pooled scatter of a point.
    """
    known = curves.converged & (scatter.dof > 0)
    quantile = _t_quantile(scatter.dof)
    increase = np.where(known, quantile * quantile * scatter.variance_kg2_m2, np.inf)
    limit = curves.rss_kg2_m2 + increase
    fastest = np.where(points.used, points.speed_m_s, 0.0).max(axis=1, initial=0.0)
    s_edge = np.where(fastest > 0, 1.0 / np.where(fastest > 0, fastest, 1.0) ** 2, np.inf)
    best = np.where(curves.converged, curves.s_s2_m2, 0.0)
    columns = _Columns.from_points(points)
    s_hi = _find_last_below(columns, best, np.where(known, s_edge, best), limit)
    s_hi = np.where(known, s_hi, s_edge)
    s_lo = _find_last_below(columns, best, np.minimum(best, 0.0), limit)
    b_lo = np.where(fastest > 0, _b_of_s(s_hi), 0.0)
    return Interval(b_lo, np.where(known, _b_of_s(s_lo), np.inf))


def _b_of_s(s: FloatArray) -> FloatArray:
    positive = s > 0
    return np.where(positive, 1.0 / np.sqrt(np.where(positive, s, 1.0)), np.inf)


def _t_quantile(dof: ArrayLike) -> FloatArray:
    """Return the two-sided t-quantile; for 0 degrees of freedom that for 1."""
    return t_quantile(np.maximum(dof, 1.0))


def _find_last_below(
    columns: _Columns, inside: FloatArray, outside: FloatArray, limit: FloatArray
) -> FloatArray:
    """Find the s farthest from `inside` towards `outside` with RSS(s) <= limit, by bisection.

    `outside` itself is the answer where its RSS is still below the limit.
    """
    at_end = columns.profile(outside)
    reaches_end = at_end.is_below_b & (at_end.rss_kg2_m2 <= limit)
    near, far = inside, outside
    for _ in range(BISECTIONS):
        middle = 0.5 * (near + far)
        at_middle = columns.profile(middle)
        is_below = at_middle.is_below_b & (at_middle.rss_kg2_m2 <= limit)
        near = np.where(is_below, middle, near)
        far = np.where(is_below, far, middle)
    return np.where(reaches_end, outside, near)
