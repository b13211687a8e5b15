"""How far real hulls miss the hyperbola: lack of fit of the run points beyond their pure error.

Runs at one intended speed repeat each other, runs at different speeds show the shape (Draper &
Smith, Applied Regression Analysis, 1998, ch. 2). A parabola through the residuals of a tow says how
far its hull lies from its hyperbola. The mean square of that over all tows, less what scatter alone
makes of it, is the variance between hulls; a boat's own tows say how much of it is the boat's
(empirical Bayes: Morris 1983).
"""

from typing import Final, NamedTuple

import numpy as np

from pipeline.arrays import BoolArray, FloatArray, IntArray

USUAL_RATIO: Final = 0.002
"""Misfit of a hull of which nothing is known: median of the Delft series (method-details, 9)."""
PRIOR_TOWS: Final = 20.0
"""Number of tows that `USUAL_RATIO` counts for."""
MIN_SPEEDS: Final = 3
"""Fewest intended speeds that show a shape."""
PARAMETERS: Final = 4
"""Parameters of a tow's residuals: mean, slope, bend, and out against back."""
BEND: Final = 2
"""Place of the bend among them."""
MIN_SCATTER: Final = 1e-20
"""Mean square of residuals that are rounding alone. Wind coefficients of each run can bring every
point onto the curve: such points tell nothing."""


class Misfit(NamedTuple):
    """Misfit of each tow's hull at some speeds, as a ratio of Cw, by the tow's own points.

    Attributes:
        ratio: (tows, speeds); 0 where the tow does not tell.
        variance: (tows, speeds), by the scatter of its points; infinite where it does not tell.
    """

    ratio: FloatArray
    variance: FloatArray


def fit_parabolas(
    residual_ratio: FloatArray,
    is_used: BoolArray,
    speed_ratio: FloatArray,
    direction: FloatArray,
    target: FloatArray,
    speeds: FloatArray,
    group: IntArray | None = None,
) -> Misfit:
    """Fit a parabola in speed, and a difference of the two ways, to the residuals of each tow.

    Args:
        residual_ratio: (tows, points) (point - curve) / curve.
        is_used: (tows, points) whether a point counts.
        speed_ratio: (tows, points) speed / declared speed.
        direction: (tows, points) 1 out, -1 back.
        target: (tows, points) intended speed / declared speed.
        speeds: (speeds,) speed / declared speed at which the misfit is asked.
        group: (tows,) the same for tows that share their scatter; all, when left out.
    """
    shape = (len(is_used), len(speeds))
    ratio, variance = np.zeros(shape), np.full(shape, np.inf)
    tells = _has_enough_points(is_used, direction, target)
    if not tells.any():
        return Misfit(ratio, variance)
    weight = is_used[tells].astype(np.float64)
    x = (speed_ratio[tells] - 1.0) * weight
    y = residual_ratio[tells] * weight
    design = np.stack([weight, x, x**2, direction[tells] * weight], axis=2)
    inverse = np.linalg.inv(np.swapaxes(design, 1, 2) @ design)
    parameters = (inverse @ np.swapaxes(design, 1, 2) @ y[..., None])[..., 0]
    residual = y - (design @ parameters[..., None])[..., 0]

    # Pure error, pooled over the tows of a group.
    place = np.zeros(len(y), np.int64) if group is None else group[tells]
    spare_points = np.bincount(place, weight.sum(axis=1) - PARAMETERS)[place]
    scatter = (np.bincount(place, (residual**2).sum(axis=1))[place] / spare_points)[:, None]

    # The curve was fitted to the same points and took their mean and slope with it. What is left
    # of x² beside these two is the bow of a hull about its curve, and its bend the only unknown.
    line = design[:, :, :BEND]
    on_line = np.linalg.pinv(line) @ (x**2)[..., None]  # (t, 2, 1)
    at = speeds - 1.0
    bow = at**2 - (np.stack([np.ones_like(at), at], axis=1) @ on_line)[..., 0]
    is_known = scatter > MIN_SCATTER
    ratio[tells] = np.where(is_known, parameters[:, BEND, None] * bow, 0.0)
    variance[tells] = np.where(is_known, scatter * inverse[:, BEND, BEND, None] * bow**2, np.inf)
    return Misfit(ratio, variance)


def _has_enough_points(is_used: BoolArray, direction: FloatArray, target: FloatArray) -> BoolArray:
    """Return tows with runs at three intended speeds, both ways, and one to spare, (tows,)."""
    sorted_targets = np.sort(np.where(is_used, target, np.nan), axis=1)
    speeds = 1 + (np.diff(sorted_targets, axis=1) > 0).sum(axis=1)
    has_out = (is_used & (direction > 0)).any(axis=1)
    has_back = (is_used & (direction < 0)).any(axis=1)
    has_spare = is_used.sum(axis=1) > PARAMETERS
    return np.asarray(has_spare & (speeds >= MIN_SPEEDS) & has_out & has_back)


def shrink_to_lines(misfit: Misfit, line: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return what all tows of a boat and crew say of its misfit, and its variance.

    The normal model of meta-analysis at each speed: misfit_i ~ N(theta_i, variance_i), theta_i ~
    N(0, between), with `between` by moments. Crews of one boat are apart, as they are towed at
    other speeds: a hump lies where the hull's waves are, not at a share of the declared speed.

    Args:
        misfit: of all tows of an archive.
        line: (tows,) number of each tow's boat and crew.

    Returns:
        Posterior mean and variance, (tows, speeds) each.
    """
    tells = np.isfinite(misfit.variance)
    excess = np.where(tells, misfit.ratio**2 - misfit.variance, 0.0).sum(axis=0)
    between = (PRIOR_TOWS * USUAL_RATIO**2 + excess) / (PRIOR_TOWS + tells.sum(axis=0))
    between = np.maximum(between, 0.0)
    lines = int(line.max(initial=-1)) + 1
    precision = np.zeros((lines, misfit.ratio.shape[1]))
    weighted = np.zeros((lines, misfit.ratio.shape[1]))
    np.add.at(precision, line, 1.0 / misfit.variance)
    np.add.at(weighted, line, misfit.ratio / misfit.variance)
    variance = between / (1.0 + between * precision)
    return (variance * weighted)[line], variance[line]
