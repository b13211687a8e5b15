"""The cluster jackknife of a least-squares solution: each boat is left out in turn.

Boats, not tows, are the independent things: the tows of one boat share what is odd about it.
"""

from typing import Final, NamedTuple

import numpy as np

from herijk.pipeline.arrays import BoolArray, FloatArray, IntArray

LOST: Final = 1e-9
"""A share of the information below this is none."""


class LeftOut(NamedTuple):
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


def leave_out(
    design: FloatArray,
    value: FloatArray,
    weight: FloatArray,
    cluster: IntArray,
    prior: tuple[FloatArray, FloatArray],
    slack: float,
) -> LeftOut:
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
    weighted = weight[:, None] * design
    normal_of = _sum_of(cluster, boats, weighted[:, :, None] * design[:, None, :])
    # From the boat's residuals, not as the difference of two solutions, which loses their digits.
    pull_of = _sum_of(cluster, boats, weighted * (value - design @ solution)[:, None])
    # The tiny term keeps an unknown that is lost without the boat from stopping the others.
    information = np.maximum(np.diag(normal), 1.0)
    left = np.linalg.inv(normal + np.diag(precision + LOST * information) - normal_of)
    change = -np.einsum("bij,bj->bi", left, pull_of)
    lost = np.einsum("bii->bi", left) * information * np.sqrt(LOST) > 1.0
    kept = np.where(lost, 0.0, change) * slack
    by_model = (inverse @ normal @ inverse) * slack
    jackknife = kept.T @ kept
    # A boat that cannot be left out says nothing here; its scatter is taken from all the others.
    short = np.maximum(np.diag(by_model) - np.diag(jackknife), 0.0) * lost.any(axis=0)
    share = np.einsum("ij,bjk,ki->bi", inverse, normal_of, inverse)
    squares = np.maximum((share**2).sum(axis=0), np.finfo(np.float64).tiny)
    return LeftOut(
        jackknife + np.diag(short) + inverse @ np.diag(precision) @ inverse,
        share.sum(axis=0) ** 2 / squares + 1.0,
        change,
        lost,
    )


def _sum_of(cluster: IntArray, boats: int, rows: FloatArray) -> FloatArray:
    """Sum of each boat's rows, shape (boats, ...)."""
    total = np.zeros((boats, *rows.shape[1:]))
    np.add.at(total, cluster, rows)
    return total
