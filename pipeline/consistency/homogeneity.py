"""Equal boats, equal B? A test, its power, and what the register would be if boats shared a bend.

Boats of a type may differ in the height of their curve; asked is whether they differ in its bend
beyond one shape that all share and what class explains. Scatter of the runs is relative and
pooled over the type. One row per boat and crew, its newest tow. B counts as free, also where the
method caps it. The load cell's zero differs by `ZERO_N` from tow to tow; it looks like a bend, so
tests and power take points of a tow as correlated by it.
"""

from dataclasses import dataclass
from typing import Final, Self

import numpy as np
import polars as pl
import scipy

from pipeline import curve
from pipeline.arrays import BoolArray, FloatArray
from pipeline.consistency import mixed
from pipeline.consistency.observed import UNKNOWN_TYPE, Observed, newest, q_at
from pipeline.tables.consistency import TypeHomogeneity
from pipeline.tables.declare import dy
from pipeline.tables.frames import frame_of
from pipeline.tables.keys import LINE
from pipeline.tables.row import Row

LEVEL: Final = 0.05
FEWEST_BOATS: Final = 3
ENOUGH_POWER: Final = 0.8
"""Power at `POWER_AT` from which on no difference seen means that bends can be equal."""

POWER_AT: Final = 0.10
"""True coefficient of variation of B at which the power of the test is stated."""

ZERO_N: Final = 2.0
"""Standard deviation of the load cell's zero from tow to tow [N] (inferred)."""

SPEED_RATIOS: Final = {"cw_085_kg_m": 0.85, "cw_kg_m": 1.0, "cw_115_kg_m": 1.15}

BEND_BOUNDS: Final = (-2.0, 0.999)
"""Limits of the shared s, as a share of the s that puts B on the fastest point."""

HIGHEST_POWER: Final = 6
"""Power of ln speed in the shape that equal hulls share: enough for a hump near hull speed."""

TINY: Final = 1e-12
"""Least scatter or sum of squares that is divided by."""

SAME_COLUMN: Final = 1e-9
"""Columns that differ by less, relatively, are one: a single class, or speeds all alike."""

OWN, PARTIAL, SHARED = "own", "partial", "shared"


def shared_bend(boats: Observed) -> float:
    """The one s = 1/B^2 [s2/m2] that fits all boats best, each with its own height."""
    fastest = float(np.where(boats.points.used, boats.points.speed_m_s, 0.0).max()) ** 2

    def slope(r: float) -> float:
        return _misfit_slope(boats, r / fastest)

    lowest, highest = BEND_BOUNDS
    if slope(lowest) >= 0.0:
        return lowest / fastest
    if slope(highest) <= 0.0:
        return highest / fastest
    return float(scipy.optimize.brentq(slope, lowest, highest, xtol=1e-15)) / fastest


def height_given_bend(points: curve.Points, s_s2_m2: FloatArray) -> FloatArray:
    """A [kg/m] of each curve by least squares with its s given, shape (rows,).

    s leaves every used speed below B.
    """
    g = points.used / (1.0 - s_s2_m2[:, None] * np.where(points.used, points.speed_m_s, 0.0) ** 2)
    return np.asarray((g * points.cw_kg_m).sum(axis=1) / (g * g).sum(axis=1))


def _misfit_slope(boats: Observed, s_s2_m2: float) -> float:
    """Slope along s of the squares of all residuals / their boat's Cw, with one s for all.

    A height at its best does not count in it (envelope theorem).
    """
    points, c0 = boats.points, boats.column("c0_kg_m")[:, None]
    v2 = np.where(points.used, points.speed_m_s, 0.0) ** 2
    a = height_given_bend(points, np.full(boats.table.height, s_s2_m2))[:, None]
    fitted = a * points.used / (1.0 - s_s2_m2 * v2)
    residual = np.where(points.used, points.cw_kg_m - fitted, 0.0)
    return float((-2.0 * residual * fitted * v2 / (1.0 - s_s2_m2 * v2) / c0**2).sum())


def type_homogeneity(observed: Observed) -> dy.DataFrame[TypeHomogeneity]:
    """Test per method and type whether boats share a bend, and what noise alone would give.

    Returns:
        Rows of the table `type_homogeneity`; where nothing is claimed, `reason` says why.
    """
    groups = newest(observed).groups("method", "boat_type")
    rows: list[Row] = [
        {"method": method, "boat_type": boat_type} | _tested(boats, boat_type)
        for (method, boat_type), boats in groups
    ]
    return frame_of(TypeHomogeneity, rows)


@dataclass(frozen=True)
class _Shapes:
    """Columns of ln Cw if boats are alike, as uncorrelated as `_whitened` makes them.

    Shape (boats, runs) each: ln Cw has one shape in ln speed, a polynomial, with a height for each
    boat and, as women are lighter, a slope for each class. Against it every boat may have a
    slope of its own. The shape is free in both, so that a hull that is no hyperbola counts for
    neither.

    Attributes:
        slope_unit: the step of ln speed in which slopes are counted.
    """

    used: BoolArray
    height: FloatArray
    slope: FloatArray
    by_class: FloatArray
    bends: list[FloatArray]
    ln_cw: FloatArray
    slope_unit: float

    @classmethod
    def of(cls, boats: Observed) -> Self:
        used = boats.points.used
        speed, cw = (
            np.where(used, values, 1.0) for values in (boats.points.speed_m_s, boats.points.cw_kg_m)
        )
        ln_speed = np.log(speed)
        unit = float(ln_speed[used].std())
        x = np.where(used, (ln_speed - ln_speed[used].mean()) / unit, 0.0)
        women = (boats.table["crew_class"] == "D").to_numpy()[:, None]
        bends = [x**power for power in range(2, HIGHEST_POWER + 1)]
        zero = (
            used
            * ZERO_N
            / (cw * speed**2 * np.maximum(boats.column("run_sd_ratio"), TINY)[:, None])
        )
        height, slope, by_class, ln_cw, *bends = (
            _whitened(column, zero)
            for column in (used.astype(np.float64), x, women * x, used * np.log(cw), *bends)
        )
        return cls(used, height, slope, by_class, bends, ln_cw, unit)

    def test(self) -> tuple[float, float, tuple[int, int]]:
        """Whether boats need slopes of their own beside one shape (analysis of covariance).

        Returns:
            Sums of squares of ln Cw that own slopes explain and that they leave; degrees of
            freedom.
        """
        same, same_rank = self._alike(self.ln_cw[:, :, None])
        own, own_rank = _rest(
            self.used, [self.height, self.slope], self.bends, self.ln_cw[:, :, None]
        )
        boats, points = len(self.used), int(self.used.sum())
        dof = boats + own_rank - same_rank, points - 2 * boats - own_rank
        left = float((own**2).sum())
        return max(float((same**2).sum()) - left, 0.0), left, dof

    def weights(self, slope_sd: FloatArray) -> FloatArray:
        """What slopes of that standard deviation add to each direction of the sum between.

        Relative to ln speed, shape (boats,); the larger, the better the test sees them. Where few
        boats share a shape, it takes a part of their slopes along.
        """
        own = self.slope[:, :, None] * np.diag(slope_sd * self.slope_unit)[:, None, :]
        return np.asarray(np.linalg.svd(self._alike(own)[0], compute_uv=False) ** 2)

    def _alike(self, values: FloatArray) -> tuple[FloatArray, int]:
        return _rest(self.used, [self.height], [self.slope, self.by_class, *self.bends], values)


def _whitened(column: FloatArray, along: FloatArray) -> FloatArray:
    """A column with the covariance 1 + u u' of each row taken out; u is `along`, (boats, runs)."""
    squared = np.maximum((along**2).sum(axis=1, keepdims=True), TINY)
    share = (1.0 - 1.0 / np.sqrt(1.0 + squared)) / squared
    return np.asarray(column - share * (along * column).sum(axis=1, keepdims=True) * along)


def _rest(
    used: BoolArray, own: list[FloatArray], shared: list[FloatArray], values: FloatArray
) -> tuple[FloatArray, int]:
    """What columns of each boat's own and shared ones leave of values, and rank of the shared.

    Values have the shape (boats, runs, k), what is left (points, k).
    """
    basis = np.linalg.qr(np.stack(own, axis=2) * used[:, :, None])[0]
    columns = np.concatenate([*(c[:, :, None] for c in shared), values], axis=2) * used[:, :, None]
    left = (columns - basis @ (np.swapaxes(basis, 1, 2) @ columns))[used]
    of_shared, of_values = left[:, : len(shared)], left[:, len(shared) :]
    solution, _, rank, _ = np.linalg.lstsq(of_shared, of_values, rcond=SAME_COLUMN)
    return of_values - of_shared @ solution, int(rank)


def _tested(boats: Observed, boat_type: str) -> Row:
    n_boats = boats.table["fsn_no"].n_unique()
    counts: Row = {"n": boats.table.height, "n_boats": n_boats}
    if boat_type == UNKNOWN_TYPE:
        return counts | {"reason": "no_type"}
    if n_boats < FEWEST_BOATS:
        return counts | {"reason": "few_boats"}
    shapes = _Shapes.of(boats)
    between, within, dof = shapes.test()
    if within <= 1e-20 * boats.table.height:
        return counts | {"reason": "no_scatter"}
    f = between / dof[0] / (within / dof[1])
    p_value = float(scipy.special.fdtrc(*dof, f))
    found = counts | {
        "p_value": p_value,
        "equal_possible": equal_possible(p_value, power=0.0),
        "noise_share": min(1.0, 1.0 / f) if f > 0 else 1.0,
        "reason": "",
    }
    shared = shared_bend(boats)
    if not 0.0 < shared * _middle_speed(boats) ** 2 < 1.0:
        return found
    seen = shapes.weights(_slopes_by_b(boats, shared)) * dof[1] / within
    at_10pct = power(POWER_AT**2 * seen, dof)
    return found | {
        "shared_b_m_s": float(1.0 / np.sqrt(shared)),
        "power_at_10pct": at_10pct,
        "equal_possible": equal_possible(p_value, at_10pct),
    }


def equal_possible(p_value: float, power: float) -> bool | None:
    """Whether all boats of a type can have one bend; None where the test could not have seen it.

    Args:
        p_value: of the test.
        power: of the test at `POWER_AT`.
    """
    if p_value < LEVEL:
        return False
    return True if power >= ENOUGH_POWER else None


def _slopes_by_b(boats: Observed, shared_s2_m2: float) -> FloatArray:
    """How the slope of ln Cw in ln speed, 2 q at the tow speed, moves with ln B, shape (rows,).

    With r = s v0^2 and q = r / (1 - r): dq = 2 q (1 + q) dB/B.
    """
    r = np.clip(shared_s2_m2 * boats.column("declared_speed_m_s") ** 2, 0.0, 0.95)
    q = r / (1.0 - r)
    return np.asarray(4.0 * q * (1.0 + q))


def power(seen: FloatArray, dof: tuple[int, int]) -> float:
    """Chance that the test sees slopes that truly differ.

    Each direction of the sum of squares between is 1 + seen times chi^2; their sum is taken as one
    chi^2 with the same mean and variance (Satterthwaite 1946).

    Args:
        seen: variance of the slopes along each direction of the sum between, as a multiple of
            that of noise.
    """
    scales = 1.0 + np.sort(seen)[::-1][: dof[0]]
    rest = dof[0] - len(scales)
    mean, squares = scales.sum() + rest, (scales**2).sum() + rest
    limit = float(scipy.special.fdtri(*dof, 1.0 - LEVEL))
    return float(scipy.special.fdtrc(mean**2 / squares, dof[1], limit * dof[0] / mean))


def _middle_speed(boats: Observed) -> float:
    """The median declared speed, at which bends of a type are compared."""
    return float(np.median(boats.column("declared_speed_m_s")))


def _bend_prior(boats: Observed) -> tuple[float, float] | None:
    """Mean of q at the middle speed of a type, and its true sd between boats (REML).

    None where the search for that did not come to rest.
    """
    q, unit = q_at(boats, _middle_speed(boats))
    known = np.isfinite(q)
    variance = (unit * boats.column("run_sd_ratio") ** 2)[known]
    hull = boats.table["hull"].to_numpy()[known]
    fit = mixed.fit(mixed.Problem(q[known], variance, np.ones(len(hull)), hull), mixed.BOAT)
    return None if fit is None else (float(fit.beta[0]), fit.sd[0])


def pooled_curves(observed: Observed) -> pl.DataFrame:
    """The register if boats of a type kept their own bend, shared it in part, or wholly.

    In part: q at the standard speed is drawn to the type's mean, the more the noisier it is
    (empirical Bayes). Heights are fitted anew to the runs, so Cw near the tow hardly moves.

    Returns:
        Rows of the table `pooled_curves`, three per method and tow; of types of fewer than three
        boats, and boats of no type, only the own curve. Where the search for the spread of a type's
        bends did not come to rest, none is shared in part.
    """
    boats = newest(observed)
    speed, partial, shared = np.full((3, boats.table.height), np.nan)
    for (_, boat_type), rows in boats.rows_by("method", "boat_type"):
        own = boats.take(rows)
        speed[rows] = _middle_speed(own)
        if boat_type != UNKNOWN_TYPE and own.table["fsn_no"].n_unique() >= FEWEST_BOATS:
            shared[rows] = shared_bend(own)
            if (prior := _bend_prior(own)) is not None:
                partial[rows] = _drawn(own, *prior)
    parts = [
        _pooled(boats.take(rows), pooling, s[rows], speed[rows])
        for pooling, s in ((OWN, boats.column("s_s2_m2")), (PARTIAL, partial), (SHARED, shared))
        for rows in [np.flatnonzero(~np.isnan(s))]
    ]
    return pl.concat(parts).sort("method", "boat_type", maintain_order=True)


def _drawn(boats: Observed, mean: float, between: float) -> FloatArray:
    """The s of each boat of a type with its q drawn to the mean of the type."""
    speed = _middle_speed(boats)
    q, unit = q_at(boats, speed)
    noise = unit * boats.column("run_sd_ratio") ** 2
    share = between**2 / np.maximum(between**2 + noise, 1e-300)
    drawn = mean + np.where(np.isfinite(q), share * (q - mean), 0.0)
    ceiling = 0.999 / np.where(boats.points.used, boats.points.speed_m_s, 0.0).max(axis=1) ** 2
    return np.asarray(np.minimum(drawn / (1.0 + drawn) / speed**2, ceiling))


def _pooled(boats: Observed, pooling: str, s: FloatArray, speed_m_s: FloatArray) -> pl.DataFrame:
    a = height_given_bend(boats.points, s)
    declared = boats.column("declared_speed_m_s")
    q = curve.cw(1.0, s, speed_m_s) - 1.0
    b = np.where(s > 0, 1.0 / np.sqrt(np.where(s > 0, s, 1.0)), np.inf)
    numbers = {"q": q, "a_kg_m": a, "b_m_s": b} | {
        name: curve.cw(a, s, ratio * declared) for name, ratio in SPEED_RATIOS.items()
    }
    return boats.table.select(
        "method",
        "tow_id",
        *LINE,
        "boat_type",
        pl.lit(pooling).alias("pooling"),
        pl.Series("standard_speed_m_s", speed_m_s),
        *(
            pl.Series(name, np.where(np.isfinite(v), v, np.nan)).fill_nan(None)
            for name, v in numbers.items()
        ),
    )
