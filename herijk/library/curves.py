"""Curves for anybody with speeds and forces: fit, interval, power and speed.

The formulas are those of the register (`pipeline.curve`); here they take plain lists and arrays.
"""

from __future__ import annotations  # the reference shows types by their names

import warnings
from dataclasses import dataclass
from typing import Final, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pipeline import curve as hyperbola
from pipeline.errors import HerijkError
from pipeline.races.power import speed_at_power

FloatArray = NDArray[np.float64]

MAX_RESIDUAL_RATIO: Final = 0.1
"""A point that lies farther from its curve, as a share of it, does not follow a hyperbola: the run
points of a tow test scatter by 1 to 3 % (inferred)."""

MIN_BEND: Final = 1e-9
"""(v/B)^2 at the highest speed below which a curve is flat but for rounding."""


class FitWarning(UserWarning):
    """Points that a hyperbola does not describe, or that show no bend and so no B."""


class Estimate(NamedTuple):
    """A number with its interval; `None` where the data set no bound."""

    value: float | None
    lo: float | None
    hi: float | None


@dataclass(frozen=True)
class Curve:
    """A resistance curve Cw(v) = A / (1 - (v/B)^2) [kg/m].

    Attributes:
        a_kg_m: A, the coefficient at v = 0.
        s_s2_m2: 1/B^2; zero or negative for a flat or falling curve, which has no B.
    """

    a_kg_m: float
    s_s2_m2: float

    @classmethod
    def from_a_b(cls, a_kg_m: float, b_m_s: float | None) -> Self:
        """Return the curve of an A and a B; no B is a flat curve.

        Raises:
            HerijkError: A or B is not a positive number.

        >>> Curve.from_a_b(20.0, 4.0).cw_kg_m(2.0)
        array(26.66666667)
        """
        if not all(0.0 < number < np.inf for number in (a_kg_m, 1.0 if b_m_s is None else b_m_s)):
            raise HerijkError("A and B must be positive numbers")
        return cls(a_kg_m, 0.0 if b_m_s is None else float(hyperbola.s_of_b(b_m_s)))

    def __repr__(self) -> str:
        """Return the curve by the numbers that people know."""
        return f"Curve(a_kg_m={self.a_kg_m}, b_m_s={self.b_m_s})"

    @property
    def b_m_s(self) -> float | None:
        """B, the speed at which the hyperbola goes to infinity; None for a flat curve."""
        return float(self.s_s2_m2**-0.5) if self.s_s2_m2 > 0 else None

    def cw_kg_m(self, speed_m_s: ArrayLike) -> FloatArray:
        """Return Cw [kg/m] at speeds [m/s] of any shape; infinite from B on.

        Raises:
            HerijkError: a speed is negative or not a number.
        """
        return hyperbola.cw(self.a_kg_m, self.s_s2_m2, _none_below_zero(speed_m_s))

    def power_w(self, speed_m_s: ArrayLike) -> FloatArray:
        """Return the power through the water of the whole crew [W]: P = Cw v^3.

        >>> Curve.from_a_b(20.0, None).power_w(3.0)
        array(540.)
        """
        speed = np.asarray(speed_m_s, dtype=np.float64)
        return np.asarray(self.cw_kg_m(speed) * speed**3, dtype=np.float64)

    def speed_m_s(self, power_w: ArrayLike) -> FloatArray:
        """Return the speed at which the whole crew gives a power; inverse of `power_w`.

        Raises:
            HerijkError: a power is negative or not a number.

        >>> Curve.from_a_b(20.0, None).speed_m_s(540.0).round(9)
        np.float64(3.0)
        """
        power = _none_below_zero(power_w)
        a = np.broadcast_to(self.a_kg_m, power.shape)
        s = np.broadcast_to(self.s_s2_m2, power.shape)
        return speed_at_power(a, s, power)


@dataclass(frozen=True)
class Fit:
    """A curve fitted to points, with what their scatter says about it.

    Attributes:
        curve: the curve of least squares in Cw.
        points: the points, as `pipeline.curve.Points` of one curve.
    """

    curve: Curve
    points: hyperbola.Points
    _fitted: hyperbola.Curves

    def __repr__(self) -> str:
        """Return the curve, B with its interval, and how many points."""
        return f"Fit(curve={self.curve}, b={self.b}, points={self.points.speed_m_s.size})"

    @property
    def b(self) -> Estimate:
        """B [m/s] with its 95 % interval; the value is None where the points bend no curve."""
        bounds = hyperbola.b_interval(
            self.points, self._fitted, hyperbola.own_scatter(self._fitted)
        )
        return Estimate(self.curve.b_m_s, _finite(bounds.lo[0]), _finite(bounds.hi[0]))

    @property
    def b_is_determined(self) -> bool:
        """Whether the points set B a lower and an upper bound."""
        return None not in self.b

    def cw(self, speed_m_s: float) -> Estimate:
        """Return Cw [kg/m] at a speed with its 95 % interval, by the scatter of the points alone.

        Raises:
            HerijkError: the speed is negative or not a number.
        """
        value = float(self.curve.cw_kg_m(speed_m_s))
        scatter = hyperbola.own_scatter(self._fitted)
        bounds = hyperbola.cw_interval(self.points, self._fitted, scatter, speed_m_s)
        return Estimate(_finite(value), _finite(bounds.lo[0]), _finite(bounds.hi[0]))


def fit(
    speed_m_s: ArrayLike, force_n: ArrayLike | None = None, *, cw_kg_m: ArrayLike | None = None
) -> Fit:
    """Fit a curve through speeds and forces, or through speeds and coefficients.

    Warns by `FitWarning` where a point lies more than 10 % from the curve, as a run at rest does,
    and where the points show no bend: the curve then has no B.

    Args:
        speed_m_s: speeds through water, shape (n,), positive.
        force_n: tow forces, shape (n,), positive; or
        cw_kg_m: coefficients F/v^2, shape (n,), positive.

    Raises:
        HerijkError: a number is missing or not positive, or the points determine no curve.

    >>> found = fit([2.7, 3.0, 3.3, 2.7, 3.0, 3.3], [215, 281, 364, 217, 279, 366])
    >>> round(found.curve.a_kg_m, 2), round(found.curve.b_m_s, 2)
    (23.88, 6.17)
    >>> found.b_is_determined
    True
    """
    speed = np.asarray(speed_m_s, dtype=np.float64)
    given = force_n if cw_kg_m is None else cw_kg_m
    if given is None or (force_n is not None and cw_kg_m is not None):
        raise HerijkError("give force_n or cw_kg_m, and not both")
    values = np.asarray(given, dtype=np.float64)
    if speed.ndim != 1 or speed.shape != values.shape:
        raise HerijkError("{} speeds and {} values; give as many of each", speed.size, values.size)
    if not (np.isfinite(speed) & np.isfinite(values) & (speed > 0) & (values > 0)).all():
        raise HerijkError("every speed and every force must be a positive number")
    points = hyperbola.Points.from_arrays(speed, values / speed**2 if cw_kg_m is None else values)
    fitted = hyperbola.fit(points)
    if not fitted.converged[0]:
        raise HerijkError("the points determine no curve; at least two different speeds are needed")
    curve = Curve(float(fitted.a_kg_m[0]), float(fitted.s_s2_m2[0]))
    if abs(curve.s_s2_m2) * speed.max() ** 2 < MIN_BEND:
        curve = Curve(curve.a_kg_m, 0.0)
    _warn_of_misfit(curve, points)
    return Fit(curve, points, fitted)


def _warn_of_misfit(curve: Curve, points: hyperbola.Points) -> None:
    """Warn where points do not follow a hyperbola, or have no bend."""
    speed, cw = points.speed_m_s[0], points.cw_kg_m[0]
    residual_ratio = np.abs(cw / curve.cw_kg_m(speed) - 1.0)
    worst = int(residual_ratio.argmax())
    if residual_ratio[worst] > MAX_RESIDUAL_RATIO:
        warnings.warn(
            f"the point at {speed[worst]:g} m/s lies {residual_ratio[worst]:.0%} from the curve: "
            "these points do not follow a hyperbola. Leave out runs at rest and speeds far from "
            "the others",
            FitWarning,
            stacklevel=3,
        )
    if curve.b_m_s is None:
        warnings.warn("the points show no bend: the curve has no B", FitWarning, stacklevel=3)


def _none_below_zero(numbers: ArrayLike) -> FloatArray:
    """Return speeds or powers as an array; refuse negative ones."""
    array = np.asarray(numbers, dtype=np.float64)
    if not (array >= 0.0).all():
        raise HerijkError("every speed and every power must be a number, 0 or more")
    return array


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
