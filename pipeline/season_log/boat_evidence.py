"""What each boat alone says of a fault of an instrument.

The mixture over patterns (`boats`) allows for boats that were altered, but where a season has one
boat that was towed before, an alteration of it and a fault of the load cell predict the same
numbers. So faults are counted in boats: at least two have to bear a fault out.
"""

from dataclasses import dataclass
from typing import Final, Self

import numpy as np
import scipy

from pipeline.arrays import BoolArray, FloatArray, IntArray
from pipeline.season_log.effects import OF_BOATS
from pipeline.season_log.fit import Fit, Problem

MIN_BOATS: Final = 2
"""Boats that have to bear out a fault."""
MIN_INFORMATION_SHARE: Final = 0.1
"""A boat informs a fault if its information is at least this share of the most that a boat has. A
boat towed once, or in the middle of a drift, has next to none (inferred)."""
AGREES_FROM: Final = 0.5
"""A boat bears a fault out if its own tows give at least this share of it: they lie nearer to the
fault than to none."""


@dataclass(frozen=True)
class BoatEvidence:
    """What each boat alone says of faults, were it never altered; h boats, c faults.

    All other effects are held at their values in the fit.

    Attributes:
        information: (h, c) inverse variance of the size of each fault by the tows of each boat.
        size: (h, c) the size that these tows give; 0 where they give none.
    """

    information: FloatArray
    size: FloatArray

    @classmethod
    def from_fit(cls, fitted: Fit, faults: IntArray) -> Self:
        """Return the evidence of each boat, whatever its crew, by generalised least squares.

        Args:
            faults: places of the faults among the effects, in the fit or not, (c,).
        """
        problem = fitted.problem
        hull = problem.tows.frame["hull"].to_numpy()
        if not len(faults):
            nothing = np.zeros((hull.max() + 1, 0))
            return cls(information=nothing, size=nothing)
        design = problem.effects.design(fitted.slopes, faults).reshape(-1, len(faults))
        information = np.zeros((hull.max() + 1, len(faults)))
        pull = np.zeros_like(information)
        for boats in fitted.boats:
            whose = hull[boats.rows[:, 0] // 3]
            slope = design[boats.rows]
            # The first pattern is that of a boat that never changed.
            np.add.at(information, whose, (slope * (boats.widest @ slope)).sum(axis=1))
            np.add.at(pull, whose, (slope * boats.pull[:, 0, :, None]).sum(axis=1))
        value = np.zeros(problem.effects.frame.height)
        value[fitted.active] = fitted.value
        has_any = information > 0.0
        beyond_fit = np.where(has_any, pull / np.where(has_any, information, 1.0), 0.0)
        size = np.where(has_any, value[faults] + beyond_fit, 0.0)
        return cls(information=information, size=size)

    @property
    def informs(self) -> BoolArray:
        """Whether a boat tells something of a fault, (h, c)."""
        most = self.information.max(axis=0)
        return np.asarray((self.information >= MIN_INFORMATION_SHARE * most) & (most > 0.0))

    @property
    def n_informing(self) -> IntArray:
        """Number of boats that tell something of each fault, (c,)."""
        return np.asarray(self.informs.sum(axis=0))

    def count_agreeing(self, size: FloatArray) -> IntArray:
        """Return how many boats bear out faults of given sizes, (c,)."""
        agrees = self.size * np.sign(size) >= AGREES_FROM * np.abs(size)
        return np.asarray((self.informs & agrees).sum(axis=0))

    def ln_odds(self, prior: FloatArray, chance: FloatArray) -> FloatArray:
        """Return the ln odds of each fault by each boat alone, against no fault, (h, c).

        Args:
            prior, chance: variance of each fault, and the probability that there is one, (c,).
        """
        known = prior * self.information
        square = self.size**2 * self.information
        by_tows = 0.5 * square * known / (1.0 + known) - 0.5 * np.log1p(known)
        return np.asarray(by_tows + scipy.special.logit(chance))


def boats_needed(problem: Problem, faults: IntArray) -> IntArray:
    """Return how many boats have to bear out each fault, by places among the effects, (c,).

    One more in a season whose log nothing but boats determines: one of them tells the log.
    """
    tows, effects = problem.tows, problem.effects
    is_tied = tows.logs["calibrated"].to_numpy() | tows.logs["has_gps"].to_numpy()
    rests_on_boats = np.append(~is_tied, [False])[tows.log]  # -1, anchored, reads the last
    of_instrument = ~np.isin(effects.column("name", faults), OF_BOATS)
    is_in_season = effects.share[:, faults] != 0.0
    has_loose_log = (is_in_season & rests_on_boats[:, None]).any(axis=0)
    return np.asarray(MIN_BOATS + (has_loose_log & of_instrument))
