"""Runs that do not lie on the curve through the other runs of their tow."""

from typing import Final, NamedTuple

import numpy as np
import polars as pl

from pipeline import curve
from pipeline.arrays import BoolArray, FloatArray
from pipeline.assessment.tow_summary import RUN_SD, USUAL_BEND

MAX_OFF_CURVE_RATIO: Final = 0.05
"""Distance from the curve through the other runs, relative to it, from which a run is to be towed
again. Inferred: as much as out and back may differ; the worst run of 3 of 89 tows of the demo is
further off, of 33 it is over 0.03."""

MIN_OTHER_RUNS: Final = 4
"""Fewest other runs whose curve a run is judged by: as many as a curve needs."""

MAX_BEYOND_RATIO: Final = 0.05
"""How far a run may lie outside the speeds of the others and still be judged by their curve: half
the step between intended speeds. Further out a hyperbola through four or five points says little.
"""

BEND_SD: Final = 0.4
"""Standard deviation of dlnCw/dlnv of a boat about `USUAL_BEND`: the sizes of
`pipeline.assessment.plausibility.BEND` together. Of two runs at one end of the speeds, of which
either can be the wrong one, it makes the one likelier that leaves a usual curve."""

MIN_MISFIT_APART: Final = 4.0
"""Misfit, in squares of the standard deviation of a run, by which one explanation must be better
than another for that one to be ruled out: two standard deviations."""


class OffCurve(NamedTuple):
    """A run that is off the curve through the others, or several of which one is.

    Attributes:
        runs: the likeliest first; several where the others do not tell which of them is off.
        ratio: Cw of the first over that of the curve through the other runs, less 1.
    """

    runs: list[int]
    ratio: float


def find_runs_off_curve(run_points: pl.DataFrame) -> list[OffCurve]:
    """Return the runs of a tow that are off the curve through its other runs, the worst first.

    The worst run is the one without which the others fit best on a curve of a usual bend. It is
    taken out, and the others are judged again, as long as enough are left. Where one difference
    between out and back explains more than any single run does, that difference is taken out first:
    otherwise it would be charged to single runs.

    Args:
        run_points: the rows of one tow, of which those with `used` count.
    """
    points = run_points.filter("used", pl.col("speed_m_s") > 0, pl.col("cw_kg_m") > 0)
    runs = points["run"].to_numpy()
    speed_m_s, cw_kg_m = points["speed_m_s"].to_numpy(), points["cw_kg_m"].to_numpy()
    is_out = points["direction"].to_numpy() > 0
    keep = np.ones(len(runs), dtype=bool)
    found: list[OffCurve] = []
    ways_are_equal = False
    while keep.sum() > MIN_OTHER_RUNS:
        misfit, ratio = _judge_without_each(speed_m_s, cw_kg_m, keep)
        worst = int(misfit.argmin())
        levelled = _level_ways(speed_m_s, cw_kg_m, is_out, keep)
        if levelled is not None and not ways_are_equal:
            level_misfit, _ = _measure_misfit(speed_m_s, levelled, keep[None])
            ways_are_equal = bool(level_misfit[0] < misfit[worst])
            if ways_are_equal:
                cw_kg_m = levelled
                continue
        is_off = np.abs(ratio) > MAX_OFF_CURVE_RATIO  # of what cannot be judged it is NaN
        if not is_off[worst]:
            break
        can_be = is_off & (misfit < misfit[worst] + MIN_MISFIT_APART)
        likeliest_first = [place for place in np.argsort(misfit, kind="stable") if can_be[place]]
        found.append(OffCurve(runs[likeliest_first].tolist(), float(ratio[worst])))
        keep[worst] = False
    return found


def _judge_without_each(
    speed_m_s: FloatArray, cw_kg_m: FloatArray, keep: BoolArray
) -> tuple[FloatArray, FloatArray]:
    """Return the misfit of the others without each run, and its distance from their curve.

    Infinite and NaN for runs that cannot be judged: taken out already, too far outside the speeds
    of the others, or without a curve through these.
    """
    others = keep & ~np.eye(len(speed_m_s), dtype=bool)
    misfit, curves = _measure_misfit(speed_m_s, cw_kg_m, others)
    slowest = np.where(others, speed_m_s, np.inf).min(axis=1)
    fastest = np.where(others, speed_m_s, -np.inf).max(axis=1)
    is_near = (speed_m_s >= slowest * (1 - MAX_BEYOND_RATIO)) & (
        speed_m_s <= fastest * (1 + MAX_BEYOND_RATIO)
    )
    expected = curve.cw(curves.a_kg_m, curves.s_s2_m2, speed_m_s)
    is_judged = keep & is_near & np.isfinite(misfit) & np.isfinite(expected)
    ratio = np.where(is_judged, cw_kg_m / np.where(is_judged, expected, 1.0) - 1, np.nan)
    return np.where(is_judged, misfit, np.inf), ratio


def _measure_misfit(
    speed_m_s: FloatArray, cw_kg_m: FloatArray, used: BoolArray
) -> tuple[FloatArray, curve.Curves]:
    """Return how badly runs fit on a curve, for several selections of them, and the curves.

    `used` has shape (selections, runs). The misfit is the sum of squares of the residuals and of
    the unusualness of the bend, in standard deviations; infinite where there is no curve.
    """
    shape = used.shape
    curves = curve.fit(
        curve.Points(np.broadcast_to(speed_m_s, shape), np.broadcast_to(cw_kg_m, shape), used)
    )
    count = np.maximum(used.sum(axis=1), 1)
    mean_cw = np.where(used, cw_kg_m, 0.0).sum(axis=1) / count
    mean_square_speed = np.where(used, speed_m_s**2, 0.0).sum(axis=1) / count
    r = curves.s_s2_m2 * mean_square_speed
    is_curve = curves.converged & (r < 1) & (mean_cw > 0)
    bend = 2 * r / np.where(is_curve, 1 - r, 1.0)
    scatter = RUN_SD * np.where(is_curve, mean_cw, 1.0)
    misfit = curves.rss_kg2_m2 / scatter**2 + ((bend - USUAL_BEND) / BEND_SD) ** 2
    return np.where(is_curve, misfit, np.inf), curves


def _level_ways(
    speed_m_s: FloatArray, cw_kg_m: FloatArray, is_out: BoolArray, keep: BoolArray
) -> FloatArray | None:
    """Return Cw with the runs back on the level of those out; None where a way has no runs."""
    _, fitted = _measure_misfit(speed_m_s, cw_kg_m, keep[None])
    on_curve = cw_kg_m / curve.cw(fitted.a_kg_m[0], fitted.s_s2_m2[0], speed_m_s)
    out, back = keep & is_out, keep & ~is_out
    if not (out.any() and back.any() and np.isfinite(on_curve[keep]).all()):
        return None
    return np.where(is_out, cw_kg_m, cw_kg_m * on_curve[out].mean() / on_curve[back].mean())
