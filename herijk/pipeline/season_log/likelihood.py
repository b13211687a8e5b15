"""What the tows of a boat say together: their joint normal density, unreported alterations summed.

Each tow gives three numbers: ln Cw and the bend q of its own curve, and ln(GPS / log). The boat's
level and bend are random and integrated out; where it may have been altered without a report, every
pattern of at most `MOST_ALTERATIONS` steps between its tows is a component of a normal mixture.
Belongs here: that density with its slopes, per boat, as arrays. Does not: what moves the numbers of
a tow (`effects`) and the search for the unknowns (`posterior`).
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import Final

import numpy as np
import scipy

from herijk.pipeline.arrays import FloatArray, IntArray
from herijk.pipeline.season_log.assumed import Settings

LEVEL, BEND, GPS = range(3)
"""The numbers of a tow."""

MOST_ALTERATIONS: Final = 2

LEVEL_SD: Final = 1.0
"""Of ln Cw between boats: so wide that a boat's level is its own."""


@dataclass(frozen=True)
class Patterns:
    """Patterns of alterations of boats with the same number of tows.

    Attributes:
        tow: (boats, tows) index of each tow.
        boat: (boats,) index of each boat.
        steps: (patterns,) number of alterations.
        level, bend: (patterns, tows, tows) prior covariance of the boat's level and bend.
    """

    tow: IntArray
    boat: IntArray
    steps: IntArray
    level: FloatArray
    bend: FloatArray

    def prior(self, share: float) -> FloatArray:
        """Ln prior of each pattern, where a boat is altered between two tows in that share."""
        gaps = self.tow.shape[1] - 1
        ln_prior = self.steps * np.log(share) + (gaps - self.steps) * np.log1p(-share)
        return np.asarray(ln_prior - scipy.special.logsumexp(ln_prior))


def patterns_of(boat: IntArray, settings: Settings) -> list[Patterns]:
    """Boats by their number of tows, each with every pattern of alterations.

    Args:
        boat: index of the boat as it was until a reported alteration, (tows,), sorted by time.
    """
    order = np.argsort(boat, kind="stable")
    boats, first, count = np.unique(boat[order], return_index=True, return_counts=True)
    return [
        Patterns(order[first[count == n][:, None] + np.arange(n)], boats[count == n], *steps)
        for n in np.unique(count).tolist()
        for steps in [_steps(n, settings)]
    ]


def _steps(tows: int, settings: Settings) -> tuple[IntArray, FloatArray, FloatArray]:
    most = min(MOST_ALTERATIONS, tows - 1)
    chosen = [c for n in range(most + 1) for c in combinations(range(1, tows), n)]
    place = np.arange(tows)
    step = np.zeros((len(chosen), tows, tows))
    for number, places in enumerate(chosen):
        for first in places:
            after = (place >= first).astype(np.float64)
            step[number] += np.outer(after, after)
    level = LEVEL_SD**2 + settings.changed_sd**2 * step
    bend = settings.bend_sd**2 + settings.changed_bend_sd**2 * step
    return np.array([len(c) for c in chosen]), level, bend


@dataclass(frozen=True)
class Told:
    """What boats with the same number of tows say, at given unknowns; 3 x tows numbers per boat.

    Attributes:
        weight: (boats, patterns) posterior of each pattern.
        precision: (boats, patterns, n, n) of the numbers.
        pull: (boats, patterns, n) precision times residual.
        mean_precision, mean_pull: the same, averaged over patterns.
        slope: (boats, n, unknowns) of the numbers by the unknowns.
    """

    patterns: Patterns
    weight: FloatArray
    precision: FloatArray
    pull: FloatArray
    mean_precision: FloatArray
    mean_pull: FloatArray
    slope: FloatArray

    @property
    def information(self) -> FloatArray:
        """Observed information on the unknowns, per boat (Louis 1982)."""
        off = self.pull - self.mean_pull[:, None]
        unsure = np.einsum("bp,bpi,bpj->bij", self.weight, off, off)
        seen = self.mean_precision - unsure
        return np.asarray(np.swapaxes(self.slope, 1, 2) @ seen @ self.slope)

    @property
    def complete_information(self) -> FloatArray:
        """The same as if the pattern of each boat were known."""
        return np.asarray(np.swapaxes(self.slope, 1, 2) @ self.mean_precision @ self.slope)

    @property
    def score(self) -> FloatArray:
        """Slope of the ln density, summed over boats."""
        return np.asarray(np.einsum("bi,bip->p", self.mean_pull, self.slope))


def tell(
    groups: list[Patterns],
    residual: FloatArray,
    covariance: FloatArray,
    state: FloatArray,
    slope: FloatArray,
    share: float,
) -> Iterator[Told]:
    """The density of all boats.

    Args:
        groups: boats by number of tows.
        residual: (tows, 3) observed less predicted, level centred per boat.
        covariance: (tows, 3, 3) of what is a tow's own.
        state: (tows, 3, 2) slope of the numbers by the boat's level and bend.
        slope: (tows, 3, unknowns).
        share: of gaps between tows in which a boat was altered without a report.
    """
    for group in groups:
        boats, tows = group.tow.shape
        n, z = 3 * tows, state[group.tow]
        full = np.einsum("bki,blj,pkl->bpkilj", z[..., 0], z[..., 0], group.level)
        full += np.einsum("bki,blj,pkl->bpkilj", z[..., 1], z[..., 1], group.bend)
        each = np.arange(tows)
        # Indexing twice with one array puts that axis first.
        full[:, :, each, :, each, :] += covariance[group.tow].swapaxes(0, 1)[:, :, None]
        full = full.reshape(boats, -1, n, n)
        precision = np.linalg.inv(full)
        own = residual[group.tow].reshape(boats, 1, n)
        pull = np.einsum("bpij,bqj->bpi", precision, own)
        ln_density = -0.5 * ((pull * own).sum(axis=2) + np.linalg.slogdet(full)[1])
        weight = scipy.special.softmax(ln_density + group.prior(share), axis=1)
        yield Told(
            group,
            weight,
            precision,
            pull,
            np.einsum("bp,bpij->bij", weight, precision),
            np.einsum("bp,bpi->bi", weight, pull),
            slope[group.tow].reshape(boats, n, -1),
        )
