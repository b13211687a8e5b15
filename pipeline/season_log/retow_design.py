"""Which few boats to tow again so that the season factors are tied together best.

A boat that is towed again beside dGPS tells what the logs of its earlier seasons were. By how much
that shrinks the uncertainty of all factors together follows from the joint estimate alone, before
anyone has towed (sequential A-optimal design: Atkinson, Donev and Tobias, Optimum Experimental
Designs, 2007, ch. 12). Belongs here: that choice. Does not: who is due anyhow
(`pipeline.register.due`).
"""

from typing import Final

import numpy as np
import polars as pl

from pipeline.arrays import BoolArray, FloatArray
from pipeline.choice import first_largest
from pipeline.history import UNKNOWN_LOG_SD
from pipeline.season_log.archive_tows import ArchiveTows
from pipeline.season_log.estimate import SeasonFactors
from pipeline.tables.frames import dtypes
from pipeline.tables.keys import LINE
from pipeline.tables.season_log import RetowChoice

MOST_BOATS: Final = 10

RETOW_SCHEMA: Final = dtypes(RetowChoice, without=["method"])


def retow_choice(estimated: SeasonFactors) -> pl.DataFrame:
    """The boats to tow again, the most informative first, each given those before it.

    Of boats that tell as much, the first by boat and crew is chosen. Every candidate is a boat and
    crew as it was left after its last reported alteration, towed once, with dGPS, in the season
    after the last. They are `MOST_BOATS`, or fewer where another one would add nothing.

    Returns:
        Rows of `RETOW_SCHEMA`: `seasons` are those without dGPS in which the boat was towed;
        `factor_sd_*_ratio` the root of the mean variance of all ln factors before and after.
    """
    tows = ArchiveTows.of(estimated.tows)
    if not tows.logs.height:
        return pl.DataFrame(schema=RETOW_SCHEMA)
    covariance = _covariance(estimated)
    tie, variance, is_candidate = _candidates(tows, estimated)
    season = tows.logs["season"].to_numpy()
    lines = tows.frame.unique("boat").sort("boat").select(LINE)
    rows: list[dict[str, object]] = []
    for position in range(1, MOST_BOATS + 1):
        shift = tie @ covariance
        gain = (shift**2).sum(axis=1) / ((shift * tie).sum(axis=1) + variance)
        gain[~is_candidate] = 0.0
        best = int(first_largest(gain))
        if gain[best] <= 0.0:
            break
        before = _typical_sd(covariance)
        step = np.outer(shift[best], shift[best]) / (shift[best] @ tie[best] + variance[best])
        covariance = covariance - step
        is_candidate[best] = False
        rows.append(
            lines.row(best, named=True)
            | {
                "position": position,
                "seasons": ", ".join(map(str, np.unique(season[tie[best] > 0.0]).tolist())),
                "factor_sd_before_ratio": before,
                "factor_sd_after_ratio": _typical_sd(covariance),
            }
        )
    return pl.DataFrame(rows, schema=RETOW_SCHEMA)


def _covariance(estimated: SeasonFactors) -> FloatArray:
    """Of all ln factors; those that are not determined are as good as unknown."""
    known = estimated.factors["factor"].is_not_null().to_numpy()
    covariance = np.diag(np.where(known, 0.0, UNKNOWN_LOG_SD**2))
    covariance[np.ix_(known, known)] = estimated.covariance
    return covariance


def _candidates(
    tows: ArchiveTows, estimated: SeasonFactors
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """What one more tow of each boat would compare with its earlier ones.

    Returns:
        tie: (boats, logs) the error of the boat's mean ln Cw by each ln factor.
        variance: (boats,) of new less mean ln Cw beyond that.
        current: (boats,) whether it is how the boat and crew were left.
    """
    kappa, random_sd, season = (tows.numbers(n) for n in ("kappa", "ln_cw_sd", "season"))
    boat, loose = tows.boat, tows.log >= 0
    log_sd = estimated.tow_log_sd_of(season)
    own = random_sd**2 + estimated.tow_sd**2 + np.where(loose, kappa * log_sd, 0.0) ** 2
    weight = np.bincount(boat, 1.0 / own)
    tie = np.zeros((len(weight), tows.logs.height))
    np.add.at(tie, (boat[loose], tows.log[loose]), (kappa / own)[loose])
    years = season.max() + 1.0 - np.bincount(boat, season / own) / weight
    new_tow = estimated.tow_sd**2 + float(np.median(random_sd)) ** 2
    moved = (estimated.ageing_sd * years) ** 2 + estimated.drift_sd**2 * years
    variance = new_tow + 1.0 / weight + moved
    last = tows.frame.select(pl.col("state") == pl.col("state").max().over(LINE)).to_series()
    current = np.bincount(boat, last.to_numpy()) > 0
    return tie / weight[:, None], variance, current


def _typical_sd(covariance: FloatArray) -> float:
    return float(np.sqrt(np.trace(covariance) / len(covariance)))
