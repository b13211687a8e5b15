"""What each boat alone says of a fault of an instrument.

The mixture over patterns (`patterns`) allows for boats that were altered. But where a season has
one boat that was towed before, an alteration of that boat and a fault of the load cell predict the
same numbers. So faults are counted in boats: at least two have to bear a fault out.

By the numbers of one boat alone, with precision P of a boat that was never altered, derivatives x
of its numbers by the fault, and r what its numbers lie beyond the fit:

    information = x' P x,    size = fitted size + x' P r / information
"""

from dataclasses import dataclass
from typing import Final, Self

import numpy as np
import scipy

from pipeline.arrays import BoolArray, FloatArray, IntArray
from pipeline.season_log.fit import Fit, Model
from pipeline.season_log.observation_model import BOAT_EFFECTS

MIN_BOATS: Final = 2
"""Boats that have to bear out a fault."""
MIN_INFORMATION_SHARE: Final = 0.1
"""A boat informs a fault if its information is at least this share of the most that a boat has. A
boat towed once, or in the middle of a drift, has next to none (inferred)."""
MIN_AGREEING_SHARE: Final = 0.5
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
    def from_fit(cls, fit: Fit, faults: IntArray) -> Self:
        """Return the evidence of each boat, whatever its crew, by generalised least squares.

        Args:
            faults: places of the faults among the effects, in the fit or not, (c,).
        """
        effects, hull = fit.model.effects, fit.model.archive.hull
        information = np.zeros((hull.max() + 1, len(faults)))
        if not len(faults):
            return cls(information=information, size=information)
        score = np.zeros_like(information)
        design = effects.design(fit.linear, faults).reshape(-1, len(faults))
        for b in fit.boats:
            boat = hull[b.group.tow[:, 0]]
            by_fault = design[b.group.numbers]
            # Pattern 0 is that of a boat that never changed.
            unchanged_residual = b.weighted_residual[:, 0, :, None]
            np.add.at(information, boat, (by_fault * (b.inverse @ by_fault)).sum(axis=1))
            np.add.at(score, boat, (by_fault * unchanged_residual).sum(axis=1))
        fitted_size = np.zeros(len(effects.listed))
        fitted_size[fit.active] = fit.value
        has_any = information > 0.0
        beyond_fit = np.where(has_any, score / np.where(has_any, information, 1.0), 0.0)
        size = np.where(has_any, fitted_size[faults] + beyond_fit, 0.0)
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
        agrees = self.size * np.sign(size) >= MIN_AGREEING_SHARE * np.abs(size)
        return np.asarray((self.informs & agrees).sum(axis=0))

    def ln_odds(self, variance: FloatArray, probability: FloatArray) -> FloatArray:
        """Return the ln odds of each fault by each boat alone, against no fault, (h, c).

        The formula is that of the score test (`faults`).

        Args:
            variance, probability: prior variance of the size of each fault, and the prior
                probability that there is one, (c,).
        """
        ratio = variance * self.information
        square = self.size**2 * self.information
        by_tows = 0.5 * square * ratio / (1.0 + ratio) - 0.5 * np.log1p(ratio)
        return np.asarray(by_tows + scipy.special.logit(probability))


def count_boats_needed(model: Model, faults: IntArray) -> IntArray:
    """Return how many boats have to bear out each fault, by places among the effects, (c,).

    One more in a season whose log nothing but boats determines: one of them tells the log.
    """
    archive, effects = model.archive, model.effects
    has_other_tie = archive.logs["calibrated"].to_numpy() | archive.logs["has_gps"].to_numpy()
    rests_on_boats = np.append(~has_other_tie, [False])[archive.log]  # ANCHORED reads the last
    is_in_season = effects.covariate[:, faults] != 0.0
    has_loose_log = (is_in_season & rests_on_boats[:, None]).any(axis=0)
    is_instrument = ~np.isin(effects.name[faults], BOAT_EFFECTS)
    return np.asarray(MIN_BOATS + (has_loose_log & is_instrument))
