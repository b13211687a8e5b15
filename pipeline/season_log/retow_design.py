"""Which few boats to tow again so that the season factors are tied together best.

A boat that is towed again beside dGPS tells what the logs of its earlier seasons were. By how much
that shrinks the uncertainty of all factors follows from the joint estimate before anyone has towed:
a greedy A-optimal design (Atkinson, Donev & Tobias, Optimum Experimental Designs, 2007, ch. 12).
Who is due anyhow is in `pipeline.register.due`.
"""

from typing import Final

import numpy as np
import polars as pl

from pipeline.arrays import BoolArray, FloatArray
from pipeline.choice import first_largest
from pipeline.history import UNKNOWN_LOG_SD
from pipeline.season_log.archive import ANCHORED, Archive, build_archive
from pipeline.season_log.estimate import SeasonFactors
from pipeline.season_log.priors import PRIORS
from pipeline.tables.frames import dtypes
from pipeline.tables.keys import LINE
from pipeline.tables.season_log import RetowChoice

MAX_BOATS: Final = 10

RETOW_SCHEMA: Final = dtypes(RetowChoice, without=["method"])


def retow_choice(estimated: SeasonFactors) -> pl.DataFrame:
    """Choose the boats to tow again, the most informative first, each given those before it.

    A candidate is a boat and crew as it was left after its last reported alteration, towed once,
    with dGPS, in the season after the last. With h its error by each ln factor and r the variance
    of the rest, that tow turns the covariance C of the factors into C - C h h'C / (h'C h + r).

    Returns:
        Rows of `RETOW_SCHEMA`, at most `MAX_BOATS`: `seasons` are those without dGPS in which the
        boat was towed; `factor_sd_*_ratio` the root of the mean variance of all ln factors before
        and after.
    """
    archive = build_archive(estimated.tows, PRIORS)
    if not archive.logs.height:
        return pl.DataFrame(schema=RETOW_SCHEMA)
    is_known = estimated.factors["factor"].is_not_null().to_numpy()
    covariance = np.diag(np.where(is_known, 0.0, UNKNOWN_LOG_SD**2))
    covariance[np.ix_(is_known, is_known)] = estimated.covariance

    h, r, is_candidate = _candidate_tows(archive, estimated)
    season = archive.logs["season"].to_numpy()
    lines = archive.frame.with_columns(boat=archive.boat).unique("boat").sort("boat").select(LINE)
    rows: list[dict[str, object]] = []
    for position in range(1, MAX_BOATS + 1):
        shift = h @ covariance
        total = (shift * h).sum(axis=1) + r
        gain = np.where(is_candidate, (shift**2).sum(axis=1) / total, 0.0)
        best = int(first_largest(gain))
        if gain[best] <= 0.0:
            break
        before = covariance
        covariance = before - np.outer(shift[best], shift[best]) / total[best]
        is_candidate[best] = False
        seasons = np.unique(season[h[best] > 0.0])
        rows.append(
            {
                **lines.row(best, named=True),
                "position": position,
                "seasons": ", ".join(str(year) for year in seasons),
                "factor_sd_before_ratio": float(np.sqrt(np.diag(before).mean())),
                "factor_sd_after_ratio": float(np.sqrt(np.diag(covariance).mean())),
            }
        )
    return pl.DataFrame(rows, schema=RETOW_SCHEMA)


def _candidate_tows(
    archive: Archive, estimated: SeasonFactors
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Return h, (boats, logs), r, (boats,), and whether a boat is as it was left, (boats,)."""
    boat, season = archive.boat, archive.season
    has_log_error = archive.log != ANCHORED
    kappa = archive.column("kappa")
    random_sd = archive.column("ln_cw_sd")
    log_sd = np.where(has_log_error, kappa * estimated.tow_log_sd_of(season), 0.0)
    tow_variance = random_sd**2 + estimated.tow_sd**2 + log_sd**2
    precision = np.bincount(boat, 1.0 / tow_variance)
    h = np.zeros((len(precision), archive.logs.height))
    own = has_log_error
    np.add.at(h, (boat[own], archive.log[own]), (kappa / tow_variance)[own])

    mean_season = np.bincount(boat, season / tow_variance) / precision
    years = season.max() + 1.0 - mean_season
    new_tow = estimated.tow_sd**2 + float(np.median(random_sd)) ** 2
    change = (estimated.ageing_sd * years) ** 2 + estimated.drift_sd**2 * years
    r = new_tow + 1.0 / precision + change

    is_last = archive.frame.select(pl.col("state") == pl.col("state").max().over(LINE)).to_series()
    return h / precision[:, None], r, np.bincount(boat, is_last.to_numpy()) > 0
