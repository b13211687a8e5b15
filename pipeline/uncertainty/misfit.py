"""How far real hulls miss the hyperbola: lack of fit of the run points beyond their pure error.

Runs at one intended speed repeat each other, runs at different speeds show the shape (lack of fit
against pure error: Draper & Smith, Applied Regression Analysis, 1998, ch. 2). A parabola through
the residuals of a tow says how far its hull lies from its hyperbola. The mean square over all
tows, less what scatter alone makes of it, is how much hulls differ in that; a boat's own tows say
how much of it is the boat's (empirical Bayes: Morris 1983).
"""

from typing import Final, NamedTuple, Self

import numpy as np

from pipeline.arrays import BoolArray, FloatArray, IntArray

USUAL_RATIO: Final = 0.002
"""Misfit of a hull of which nothing is known: median of the Delft series (method-details, 9)."""

USUAL_TOWS: Final = 20.0
"""How many tows `USUAL_RATIO` counts for."""

SHAPE: Final = 4
"""Numbers of a tow's residuals: mean, slope, bend, and out against back."""

ROUNDING: Final = 1e-20
"""Mean square of residuals that are rounding alone.

Wind coefficients of each run can bring every point onto the curve: such points tell nothing.
"""


class Departure(NamedTuple):
    """Departure of each tow's points from its hyperbola at some speeds, as a ratio.

    Attributes:
        ratio: (tows, speeds); 0 where the tow does not tell.
        variance: (tows, speeds), by the scatter of its points; infinite where it does not tell.
    """

    ratio: FloatArray
    variance: FloatArray

    @classmethod
    def of(
        cls,
        residual_ratio: FloatArray,
        used: BoolArray,
        speed_ratio: FloatArray,
        direction: FloatArray,
        target: FloatArray,
        asked: FloatArray,
        alike: IntArray | None = None,
    ) -> Self:
        """Departures of tows by their own points.

        Args:
            residual_ratio: (point - curve) / curve, (tows, points), as the next four.
            used: points that count.
            speed_ratio: speed / declared speed.
            direction: 1 out, -1 back.
            target: intended speed / declared speed.
            asked: speeds / declared speed at which to tell, (speeds,).
            alike: (tows,) the same for tows that share their scatter; all, when left out.
        """
        shape = (len(used), len(asked))
        ratio, variance = np.zeros(shape), np.full(shape, np.inf)
        tells = _tells(used, direction, target)
        if tells.any():
            weight = used[tells].astype(np.float64)
            e, x, way = (v[tells] * weight for v in (residual_ratio, speed_ratio - 1.0, direction))
            design = np.stack([weight, x, x**2, way], axis=2)
            inverse = np.linalg.inv(np.swapaxes(design, 1, 2) @ design)
            parabola = np.einsum("tij,tpj,tp->ti", inverse, design, e)
            rest = e - np.einsum("tpj,tj->tp", design, parabola)
            group = np.zeros(len(rest), np.int64) if alike is None else alike[tells]
            spare = np.bincount(group, weight.sum(axis=1) - SHAPE)[group]
            scatter = (np.bincount(group, (rest**2).sum(axis=1))[group] / spare)[:, None]
            at = asked - 1.0
            along = np.stack([np.ones_like(at), at, at**2, np.zeros_like(at)], axis=1)
            known = scatter > ROUNDING
            of_scatter = scatter * np.einsum("sj,tjk,sk->ts", along, inverse, along)
            ratio[tells] = np.where(known, parabola @ along.T, 0.0)
            variance[tells] = np.where(known, of_scatter, np.inf)
        return cls(ratio, variance)


def _tells(used: BoolArray, direction: FloatArray, target: FloatArray) -> BoolArray:
    """Tows with runs at three intended speeds, both ways, and one to spare."""
    levels = np.sort(np.where(used, target, np.nan), axis=1)
    distinct = 1 + (np.diff(levels, axis=1) > 0).sum(axis=1)
    both = (used & (direction > 0)).any(axis=1) & (used & (direction < 0)).any(axis=1)
    return np.asarray((used.sum(axis=1) > SHAPE) & (distinct >= SHAPE - 1) & both)


def departure_of_boats(departure: Departure, boat: IntArray) -> tuple[FloatArray, FloatArray]:
    """What all tows say of the departure of each tow's hull, and its variance, (tows, speeds).

    Args:
        departure: departures of all tows of an archive.
        boat: index of each tow's boat.
    """
    tells = np.isfinite(departure.variance)
    beyond = np.where(tells, departure.ratio**2 - departure.variance, 0.0).sum(axis=0)
    between = (USUAL_TOWS * USUAL_RATIO**2 + beyond) / (USUAL_TOWS + tells.sum(axis=0))
    between = np.maximum(between, 0.0)
    boats = int(boat.max(initial=-1)) + 1
    precision, pull = (np.zeros((boats, departure.ratio.shape[1])) for _ in range(2))
    np.add.at(precision, boat, 1.0 / departure.variance)
    np.add.at(pull, boat, departure.ratio / departure.variance)
    variance = between / (1.0 + between * precision)
    return (variance * pull)[boat], variance[boat]
