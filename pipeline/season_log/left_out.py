"""The cluster jackknife of a least-squares solution: each boat is left out in turn.

Boats, not tows, are the independent things: the tows of one boat share what is odd about it.
"""

from typing import Final, NamedTuple

import numpy as np

from pipeline.arrays import FloatArray, IntArray

LOST: Final = 1e-9
"""A share of the information below this counts as nothing."""


class LeftOut(NamedTuple):
    """Least squares with one boat left out after the other.

    Attributes:
        covariance: (p, p) jackknife over boats, plus what the priors themselves may be off.
        dof: (p,) effective number of boats that an unknown rests on, plus 1.
    """

    covariance: FloatArray
    dof: FloatArray


def leave_out(
    design: FloatArray, residual: FloatArray, cluster: IntArray, precision: FloatArray
) -> LeftOut:
    """Leaves each boat out in closed form, the weights of the others kept.

    Args:
        design: (n, p) slopes and
        residual: (n,) of the solution, both divided by the standard deviation of an observation.
        cluster: (n,) index of the boat.
        precision: (p,) of the priors of the unknowns.
    """
    boats = int(cluster.max(initial=-1)) + 1
    normal_of = _sum_of(cluster, boats, design[:, :, None] * design[:, None, :])
    # From the boat's residuals, not as the difference of two solutions, which loses their digits.
    pull_of = _sum_of(cluster, boats, design * residual[:, None])
    normal = normal_of.sum(axis=0)
    inverse = np.linalg.inv(normal + np.diag(precision))
    # The tiny term keeps an unknown that is lost without the boat from stopping the others.
    information = np.maximum(np.diag(normal), 1.0)
    left = np.linalg.inv(normal + np.diag(precision + LOST * information) - normal_of)
    lost = np.einsum("bii->bi", left) * information * np.sqrt(LOST) > 1.0
    change = np.where(lost, 0.0, np.einsum("bij,bj->bi", left, pull_of))
    jackknife = change.T @ change
    # A boat that cannot be left out says nothing here; its scatter is taken from all the others.
    by_model = np.diag(inverse @ normal @ inverse)
    short = np.maximum(by_model - np.diag(jackknife), 0.0) * lost.any(axis=0)
    share = np.einsum("ij,bjk,ki->bi", inverse, normal_of, inverse)
    squares = np.maximum((share**2).sum(axis=0), np.finfo(np.float64).tiny)
    return LeftOut(
        jackknife + np.diag(short) + inverse @ np.diag(precision) @ inverse,
        share.sum(axis=0) ** 2 / squares + 1.0,
    )


def _sum_of(cluster: IntArray, boats: int, rows: FloatArray) -> FloatArray:
    """Sum of each boat's rows, shape (boats, ...)."""
    total = np.zeros((boats, *rows.shape[1:]))
    np.add.at(total, cluster, rows)
    return total
