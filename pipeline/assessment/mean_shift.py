"""Mean-shift outliers: groups of observations that all the others rule out.

Observations are Gaussian with known variances: independent noise and random effects. The shift of a
group in a given direction g is estimated from all the rest. With P the inverse of the covariance of
y, it is g'Py / g'Pg, with variance 1 / g'Pg (Cook & Weisberg 1982, Residuals and Influence in
Regression, 2.2.2). The clearest shift is taken out, which makes it a fixed effect, and the rest is
judged again. What is observed and what may shift is decided by the caller.
"""

from collections.abc import Sequence
from typing import Final, NamedTuple, Self

import numpy as np
import scipy

from pipeline.arrays import BoolArray, FloatArray
from pipeline.choice import find_first_largest
from pipeline.quantiles import MAD_TO_SD

MIN_SCALE: Final = 0.5
"""An archive may scatter less than is assumed; a limit shrinks to half at most."""

MIN_REMAINING_SHARE: Final = 1e-6
"""Share of the information on a candidate under which another that was taken out explains it."""

MIN_TOWS_FOR_SCALE: Final = 10
CANDIDATE_BATCH: Final = 2048
"""Number of candidates scored per batch; bounds the memory of the score matrix."""


class Observations(NamedTuple):
    """What is observed, and its prior scatter.

    Attributes:
        values: deviations from the expected mean, shape (n,).
        variance: of their independent noise, shape (n,).
        shared: which random effects each observation has, sparse, shape (n, effects).
        shared_variance: of these, shape (effects,).
    """

    values: FloatArray
    variance: FloatArray
    shared: "scipy.sparse.csr_array"
    shared_variance: FloatArray

    @classmethod
    def concatenate(cls, parts: Sequence[Self]) -> Self:
        """Return the observations of several kinds, which share nothing."""
        return cls(
            values=np.concatenate([part.values for part in parts]),
            variance=np.concatenate([part.variance for part in parts]),
            shared=scipy.sparse.block_diag([part.shared for part in parts], format="csr"),
            shared_variance=np.concatenate([part.shared_variance for part in parts]),
        )


class Candidates(NamedTuple):
    """What may have shifted.

    Attributes:
        directions: one per column, sparse, shape (n, candidates).
        is_single: whether a column is of one tow, whose scatter the archive itself shows.
        min_size: smallest size that matters, shape (candidates,).
        gross_size: size that no scatter explains, however wide, shape (candidates,).
    """

    directions: "scipy.sparse.csc_array"
    is_single: BoolArray
    min_size: FloatArray
    gross_size: FloatArray


class MeanShift(NamedTuple):
    """A candidate that has shifted.

    Attributes:
        place: of the candidate.
        size: of the shift.
        sd: standard deviation of the size.
        clear: whether it is beyond the limit from which chance is ruled out.
    """

    place: int
    size: float
    sd: float
    clear: bool


def find_mean_shifts(
    observations: Observations, candidates: Candidates, reject_at: float, flag_at: float
) -> list[MeanShift]:
    """Return the candidates whose standardized size exceeds the thresholds, the clearest first.

    Where tows scatter more or less than is assumed, the limits move with them. Shifts too large to
    be scatter come out before that is measured: a few of these make all others look scattered.

    Args:
        observations: deviations from what is expected, and how they scatter.
        candidates: what may have shifted.
        reject_at: standard deviations from which chance is ruled out.
        flag_at: standard deviations from which a single tow is unusual, judged when all clear
            shifts are taken out.
    """
    search = _Search(observations, candidates)
    gross = np.maximum(candidates.min_size, candidates.gross_size)
    shifts = search.take_out(reject_at, gross, clear=True)
    scales = search.measure_scales()
    shifts += search.take_out(reject_at * scales, candidates.min_size, clear=True)
    limits = np.where(candidates.is_single, flag_at * scales, np.inf)
    return shifts + search.take_out(limits, candidates.min_size, clear=False)


class _Search:
    """The state of the search: what the candidates show given all that was taken out before.

    The inverse of the covariance is by Woodbury's identity. What is factorised has a row per random
    effect, and is sparse: boats have tows in few seasons.
    """

    def __init__(self, observations: Observations, candidates: Candidates) -> None:
        self._candidates, self._effects = candidates, observations.shared
        self._noise = scipy.sparse.diags_array(1.0 / observations.variance)
        within = self._effects.T @ self._noise @ self._effects
        prior = scipy.sparse.diags_array(1.0 / observations.shared_variance)
        self._within = scipy.sparse.linalg.splu(
            (within + prior).tocsc(), permc_spec="MMD_AT_PLUS_A"
        )
        self._taken: list[tuple[FloatArray, float]] = []
        self._score = np.asarray(
            candidates.directions.T @ self._apply_precision(observations.values)
        )
        starts = range(0, candidates.directions.shape[1], CANDIDATE_BATCH)
        parts = [
            self._compute_information(candidates.directions[:, k : k + CANDIDATE_BATCH])
            for k in starts
        ]
        self._first_information = np.concatenate(parts)
        self._information = self._first_information.copy()

    def _apply_precision(self, values: FloatArray) -> FloatArray:
        scaled = np.asarray(self._noise @ values)
        effects = self._within.solve(np.asarray(self._effects.T @ scaled))
        return np.asarray(scaled - self._noise @ (self._effects @ effects))

    def _compute_information(self, directions: "scipy.sparse.csc_array") -> FloatArray:
        """Return g'Pg of each direction, before anything is taken out."""
        scaled = self._noise @ directions
        alone = np.asarray(directions.multiply(scaled).sum(axis=0)).ravel()
        across = (self._effects.T @ scaled).toarray()
        return np.asarray(alone - (across * self._within.solve(across)).sum(axis=0))

    @property
    def _is_open(self) -> BoolArray:
        """Candidates that are not taken out already, nor the same as one that is."""
        return np.asarray(self._information > MIN_REMAINING_SHARE * self._first_information)

    def measure_scales(self) -> FloatArray:
        """Return the scatter of tows over what is assumed, (candidates,); of groups at least 1."""
        single = self._candidates.is_single & self._is_open
        if single.sum() < MIN_TOWS_FOR_SCALE:
            return np.ones(len(single))
        z = self._score[single] / np.sqrt(self._information[single])
        scatter = MAD_TO_SD * float(np.median(np.abs(z)))
        return np.where(self._candidates.is_single, max(scatter, MIN_SCALE), max(scatter, 1.0))

    def take_out(
        self, limits: FloatArray | float, min_size: FloatArray, *, clear: bool
    ) -> list[MeanShift]:
        """Take out and return what is beyond its limit in standard deviations, clearest first."""
        taken: list[MeanShift] = []
        while True:
            sd = 1.0 / np.sqrt(np.where(self._is_open, self._information, 1.0))
            size = self._score * sd**2
            beyond = np.abs(size) / (sd * limits)
            beyond[~self._is_open | (np.abs(size) < min_size)] = 0.0
            best = int(find_first_largest(beyond))
            if beyond[best] < 1.0:
                return taken
            taken.append(MeanShift(best, float(size[best]), float(sd[best]), clear))
            direction = self._candidates.directions[:, [best]].toarray()[:, 0]
            moved = self._apply_precision(direction)
            for before, inverse in self._taken:
                moved -= before * (before @ direction) * inverse
            self._taken.append((moved, 1.0 / float(moved @ direction)))
            share = np.asarray(self._candidates.directions.T @ moved)
            self._score = self._score - share * size[best]
            self._information = self._information - share**2 * sd[best] ** 2
