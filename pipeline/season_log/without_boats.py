"""The second estimate: season factors by what boats are, not by which they are.

It shares no assumption with the joint estimate about boats that stay as they were, so that their
agreement is a test of it (docs/method.md, 4).
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
import polars as pl

from pipeline.arrays import BoolArray, FloatArray
from pipeline.season_log.assumed import Settings
from pipeline.season_log.left_out import leave_out
from pipeline.season_log.network import Network
from pipeline.season_log.scale import linear_scale

REGRESSIONS: Final = 100
TOLERANCE: Final = 1e-12
"""The second estimate is repeated until h is linear about its own answer."""
VARIANCE_FLOOR: Final = 1e-12


@dataclass(frozen=True)
class Second:
    """Ln factors by regression on what a boat is, not on which; (all groups,) each.

    `known`: which are determined; none where the regression did not come to rest.
    """

    ln_factor: FloatArray
    sd: FloatArray
    dof: FloatArray
    known: BoolArray


def without_boats(network: Network, ageing: tuple[float, float], settings: Settings) -> Second:
    """Regression of ln Cw on ln weight, ln length, type, crew and season.

    Args:
        network: all tows; those without weight or length do not take part.
        ageing: change of ln Cw per year and its sd, from the joint estimate: nothing but repeat
            tows can tell it.
        settings: what is assumed beforehand.
    """
    tows, groups = network.tows, network.groups.height
    sizes = [network.numbers("weight_kg"), network.numbers("waterline_length_m")]
    sound = np.logical_and.reduce([size > 0 for size in sizes])
    nothing = np.zeros(groups)
    unknown = Second(nothing, nothing, nothing, nothing > 0)
    if groups == 0 or not (sound & (network.group < 0)).any():
        return unknown
    kinds = tows.select(
        pl.col("boat_type").fill_null(""), "crew_class", pl.col("rowers").cast(pl.String)
    ).to_dummies(drop_first=True)
    logs = [np.log(np.where(sound, size, 1.0)) for size in sizes]
    about = [x - x[sound].mean() for x in logs]
    of_kind = kinds.to_numpy().reshape(tows.height, kinds.width)  # none where all are of one
    other = np.column_stack([np.ones(tows.height), *about, of_kind])[sound]
    group, r = network.group[sound], 1.0 - 2.0 / network.numbers("kappa")[sound]
    reference_ln = network.numbers("reference_ln")[sound]
    year = network.numbers("season")[sound] - settings.reference_year
    observed = network.numbers("ln_cw")[sound] - ageing[0] * year
    slopes = (settings.weight_elasticity, settings.length_elasticity)
    prior_sd = np.array([1e3, *(p.sd for p in slopes), *np.ones(kinds.width)])
    mean = np.array([*np.zeros(groups + 1), *(p.mean for p in slopes), *np.zeros(kinds.width)])
    precision = np.concatenate([np.zeros(groups), prior_sd**-2.0])
    counts = np.bincount(group[group >= 0], minlength=groups)
    precision[:groups] = np.where(counts > 0, 0.0, 1.0)
    ln_factor, variance = np.zeros(groups), 1.0
    for _ in range(REGRESSIONS):
        value, slope = linear_scale(observed, group, r, reference_ln, ln_factor)
        design = np.column_stack([(group[:, None] == np.arange(groups)) * slope[:, None], other])
        normal = design.T @ design / variance + np.diag(precision)
        solution = np.linalg.solve(normal, design.T @ value / variance + precision * mean)
        moved = np.abs(solution[:groups] - ln_factor).max()
        ln_factor = solution[:groups]
        variance = float(np.mean((value - design @ solution) ** 2)) + VARIANCE_FLOOR
        if moved < TOLERANCE:
            break
    else:  # it never came to rest
        return unknown
    noise, residual = np.sqrt(variance), value - design @ solution
    left = leave_out(design / noise, residual / noise, network.cluster[sound], precision)
    by_ageing = np.linalg.solve(normal, design.T @ year / variance)[:groups] * ageing[1]
    sd = np.sqrt(np.diag(left.covariance)[:groups] + by_ageing**2)
    return Second(ln_factor, sd, left.dof[:groups], counts > 0)
