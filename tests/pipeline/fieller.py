"""An independent interval of B, to check the profile of `pipeline.curve` against."""

import numpy as np
import scipy.special

from pipeline import curve


def b_interval_fieller(
    points: curve.Points, curves: curve.Curves, scatter: curve.Scatter, level: float = 0.95
) -> curve.Interval:
    """Fieller's interval of B [m/s] from the line 1/Cw = a - b v^2; a check on the profile.

    The set {s: (b - s a)^2 <= t^2 (v_bb - 2 s v_ab + s^2 v_aa)}; the line is weighted with the
    fitted Cw^4, so that it is the linearised fit in Cw. From 0 to infinity where the intercept
    itself is not significant.
    """
    speed = np.where(points.used, points.speed_m_s, 0.0)
    fitted_cw = curve.cw(curves.a_kg_m[:, None], curves.s_s2_m2[:, None], speed)
    weight = np.where(points.used, fitted_cw**4, 0.0)
    u = speed**2
    y = 1.0 / np.where(points.used, points.cw_kg_m, 1.0)
    w0, w1, w2 = (weight.sum(axis=1), (weight * u).sum(axis=1), (weight * u * u).sum(axis=1))
    y0, y1 = (weight * y).sum(axis=1), (weight * u * y).sum(axis=1)
    determinant = w0 * w2 - w1 * w1
    known = curves.converged & (scatter.dof > 0) & (determinant > 0)
    safe = np.where(known, determinant, 1.0)
    intercept, slope = (w2 * y0 - w1 * y1) / safe, -(w0 * y1 - w1 * y0) / safe
    quantile = scipy.special.stdtrit(np.maximum(scatter.dof, 1), 0.5 * (1 + level))
    t2 = quantile**2 * scatter.variance_kg2_m2 / safe
    # Var(a) = w2, Var(b) = w0, and Cov(a, b) = w1 since b is minus the slope; all times t2.
    second = intercept * intercept - t2 * w2
    first = intercept * slope - t2 * w1
    zeroth = slope * slope - t2 * w0
    bounded = known & (second > 0)
    root = np.sqrt(np.maximum(first * first - second * zeroth, 0.0))
    safe_second = np.where(bounded, second, 1.0)
    s_lo, s_hi = (first - root) / safe_second, (first + root) / safe_second
    lo, hi = (np.where(bounded, _b_of_s(s), end) for s, end in ((s_hi, 0.0), (s_lo, np.inf)))
    return curve.Interval(lo, hi)


def _b_of_s(s):
    positive = s > 0
    return np.where(positive, 1.0 / np.sqrt(np.where(positive, s, 1.0)), np.inf)
