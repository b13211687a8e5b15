"""The scale of each season's anemometer, by the wind out and back.

The wind that a boat feels is the true wind less its own velocity. Out and back the true wind turns
about the boat and cancels; the boat's own speed is left. So mean apparent wind over boat speed is
what the anemometer reads of the wind, and needs no resistance and no other boat. A vane that points
askew turns the mean vector and leaves its length. Here: that ratio per tow, and the scale of each
season with what the other seasons say of it. Not here: what wind does to resistance (`wind`).
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
import scipy

from pipeline.arrays import BoolArray, FloatArray
from pipeline.blocks.batch import Batch
from pipeline.blocks.run_blocks import WindowSums
from pipeline.history import UNKNOWN_LOG_SD
from pipeline.steps.calibration import mean_over_both_ways

USUAL_TOW_SD: Final = 0.06
"""Spread of a tow's ratio where no season has two tows: wind changes between out and back."""

ARCHIVE_SD: Final = 0.15
"""Spread of ln scale of one anemometer used in all seasons (inferred)."""

BETWEEN_SEASONS: Final = np.geomspace(0.001, 0.5, 60)
"""Standard deviations of ln scale between seasons that are tried."""

USUAL_BETWEEN: Final = 0.02
"""Scale of their half-Cauchy prior (Gelman 2006): small as a rule, large if something broke."""


@dataclass(frozen=True)
class WindRatio:
    """Apparent wind of each tow over boat speed, mean of out and back; arrays of shape (tows,).

    Attributes:
        season: of the tow.
        ahead, abeam: the two parts of the mean vector; NaN where wind or speed is not known.
        shared_sd: of ln boat speed, the part that a season's tows share.
    """

    season: FloatArray
    ahead: FloatArray
    abeam: FloatArray
    shared_sd: FloatArray

    @classmethod
    def of(
        cls,
        batch: Batch,
        window: BoolArray,
        used: BoolArray,
        ground_m_s: FloatArray,
        water_m_s: FloatArray,
        log_sd: FloatArray,
    ) -> "WindRatio":
        """The ratio of each tow.

        Args:
            batch: tows and runs.
            window: blocks that count, shape (runs, seconds).
            used: runs that count.
            ground_m_s: speed by GPS, shape (runs,); NaN without.
            water_m_s: speed by the log as corrected so far, taken where there is no GPS.
            log_sd: of the ln factor of the log, shape (tows,); NaN where nothing is known.
        """
        sums = WindowSums(batch.blocks, window)
        speed, cos, sin = sums.mean("wind_v"), sums.total("wind_cos"), sums.total("wind_sin")
        length = np.maximum(np.hypot(cos, sin), 1e-9)
        blows = used & (speed > 0) & (water_m_s > 0)
        blows &= (batch.measured("wind") & batch.trusted)[batch.tow]
        by_gps = batch.count(blows & np.isfinite(ground_m_s)) == batch.count(blows)
        boat = np.where(by_gps[batch.tow], ground_m_s, water_m_s)
        mean = _both_ways(batch, np.where(blows, boat, 1.0), blows)
        return cls(
            batch.of_tow("season"),
            _both_ways(batch, speed * cos / length, blows) / mean,
            _both_ways(batch, speed * sin / length, blows) / mean,
            np.where(by_gps, 0.0, np.nan_to_num(log_sd, nan=UNKNOWN_LOG_SD)),
        )


def _both_ways(batch: Batch, values: FloatArray, runs: BoolArray) -> FloatArray:
    """Mean of out and back, each direction weighing the same; NaN without both."""
    mean, both = mean_over_both_ways(values, batch.direction, batch.tow, runs, batch.size)
    return np.where(both, mean, np.nan)


@dataclass(frozen=True)
class Anemometer:
    """What the anemometer of each season reads of the wind, arrays of shape (seasons,).

    Attributes:
        season: seasons, sorted.
        ln_scale, sd: ln(reading / wind) and its standard deviation.
        tows: how many tell.
    """

    season: FloatArray
    ln_scale: FloatArray
    sd: FloatArray
    tows: FloatArray

    def of_tows(self, season: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Ln scale and its standard deviation for the tows of some seasons, shape (tows,)."""
        place = np.searchsorted(self.season, season)
        return self.ln_scale[place], self.sd[place]


def anemometer_of_seasons(ratio: WindRatio) -> Anemometer:
    """The scale of every season: normal about that of the archive, the spread integrated out.

    Seasons without a tow that tells have what the others let expect. Between seasons the standard
    deviation is summed over a grid (Rue, Martino & Chopin 2009), so that one anemometer of many
    years is known from all of them, and one odd season does not move the others.
    """
    seasons, place = np.unique(ratio.season, return_inverse=True)
    known = np.isfinite(ratio.ahead) & np.isfinite(ratio.abeam)
    mine = place[known]
    tows = np.bincount(mine, minlength=len(seasons)).astype(np.float64)
    count = np.maximum(tows, 1.0)
    ahead, abeam, shared = (
        np.bincount(mine, values[known], len(seasons)) / count
        for values in (ratio.ahead, ratio.abeam, ratio.shared_sd)
    )
    length = np.where(tows > 0, np.hypot(ahead, abeam), 1.0)
    along = ratio.ahead[known] * ahead[mine] + ratio.abeam[known] * abeam[mine]
    along /= length[mine] ** 2
    spare = np.maximum(tows - 1.0, 0.0).sum()
    tow_sd = np.sqrt(((along - 1.0) ** 2).sum() / spare) if spare else USUAL_TOW_SD
    variance = np.where(tows > 0, tow_sd**2 / count + shared**2, 1e6)
    ln_scale, sd = _shrunk(np.log(np.maximum(length, 1e-3)), variance)
    return Anemometer(seasons, ln_scale, sd, tows)


def _shrunk(seen: FloatArray, variance: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Mean and sd of normal numbers about a common mean, whose spread is summed over a grid."""
    between = BETWEEN_SEASONS[:, None] ** 2
    weight = 1.0 / (variance + between)
    precision = weight.sum(axis=1) + ARCHIVE_SD**-2.0
    mean = (weight * seen).sum(axis=1) / precision
    ln_density = 0.5 * (np.log(weight).sum(axis=1) - np.log(precision))
    ln_density -= 0.5 * ((weight * seen**2).sum(axis=1) - precision * mean**2)
    # The grid is even in the logarithm: its measure is the standard deviation itself.
    ln_density += np.log(BETWEEN_SEASONS) - np.log1p((BETWEEN_SEASONS / USUAL_BETWEEN) ** 2)
    chance = scipy.special.softmax(ln_density)[:, None]
    pull = between * weight
    value = mean[:, None] + pull * (seen - mean[:, None])
    own = pull * variance + (1.0 - pull) ** 2 / precision[:, None]
    average = (chance * value).sum(axis=0)
    spread = (chance * (own + (value - average) ** 2)).sum(axis=0)
    return np.asarray(average), np.sqrt(spread)
