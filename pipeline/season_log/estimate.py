"""From tows to season factors: the joint estimate as tables."""

from dataclasses import dataclass

import numpy as np
import polars as pl

from pipeline.arrays import FloatArray
from pipeline.quantiles import NORMAL
from pipeline.season_log.archive import build_archive
from pipeline.season_log.diagnosis import diagnose_seasons
from pipeline.season_log.factors import (
    BY_GPS,
    NOT_SETTLED,
    find_determined,
    make_factor_table,
)
from pipeline.season_log.faults import find_posterior, find_rough_fit
from pipeline.season_log.fit import Fit, build_model
from pipeline.season_log.observation_model import AGEING
from pipeline.season_log.priors import PRIORS
from pipeline.season_log.tow_estimates import estimate_tows


@dataclass(frozen=True)
class SeasonFactors:
    """Log factors with all that is known about them.

    Attributes:
        factors: a row per season and part that has tows without dGPS, sorted: rows of the table
            `season_links` (`estimate_season_factors`).
        covariance: of ln factor between the determined rows of `factors`, in their order.
        tow_log_sd: standard deviation of ln factor from tow to tow, by first season of the era.
        calibration_sd: the same of tows calibrated on dGPS.
        tow_sd: standard deviation of ln Cw of a tow beyond its random part, its log and its zero.
        tow_zero_n: standard deviation of the load cell's zero from tow to tow, N.
        ageing_per_year: change of ln Cw per year that all boats share.
        drift_sd: standard deviation of what a boat drifts from that in a year.
        tows, weights: what was estimated of each tow (`tow_estimates.estimate_tows`).
        diagnosis: what is wrong in each season (`diagnosis`).
    """

    factors: pl.DataFrame
    covariance: FloatArray
    tow_log_sd: dict[int, float]
    calibration_sd: float
    tow_sd: float
    tow_zero_n: float
    ageing_per_year: float
    drift_sd: float
    tows: pl.DataFrame
    weights: pl.DataFrame
    diagnosis: pl.DataFrame

    def get_tow_log_sd(self, season: FloatArray) -> FloatArray:
        """Return the standard deviation of ln factor from tow to tow in given seasons."""
        sd = np.zeros(len(season))
        for first, of_era in sorted(self.tow_log_sd.items()):
            sd = np.where(season >= first, of_era, sd)
        return sd

    def get_season(self, season: int) -> tuple[float, float, float, str] | None:
        """Return factor, bounds and source of a season; None where it is not determined.

        Where the log was replaced, the factor is the mean over the tows of its determined parts.
        """
        determined = self.factors.drop_nulls("factor")
        is_own = determined["season"] == season
        parts = determined.filter(is_own)
        if parts.height < 2:
            return next(parts.select("factor", "lo", "hi", "source").iter_rows(), None)
        tows = np.where(is_own, determined["n_tows"].to_numpy(), 0)
        weight = tows / tows.sum()
        ln_factor = weight @ determined["factor"].log().to_numpy()
        sd = np.sqrt(weight @ self.covariance @ weight)
        half_width = NORMAL * sd
        factor, lo, hi = np.exp(ln_factor + np.array([0.0, -half_width, half_width])).tolist()
        other_sources = [source for source in parts["source"] if source != BY_GPS]
        return factor, lo, hi, other_sources[0] if other_sources else BY_GPS

    def is_refused(self, season: int) -> bool:
        """Whether the season has a factor that is not used."""
        own = self.factors.filter(pl.col("factor").is_null(), season=season)
        return NOT_SETTLED in own["source"]


def estimate_roughly(tows: pl.DataFrame) -> tuple[Fit, dict[str, float]]:
    """Fit the rows that `estimate_season_factors` takes, to a loose tolerance.

    Returns:
        The fit, and the ln factor of each tow's log by `tow_id`: 0 with dGPS; a tow whose log is
        not determined is left out.

    Raises:
        BrokenPromiseError: a number that every tow must have is missing or not positive.
    """
    fit = find_rough_fit(build_model(build_archive(tows, PRIORS), PRIORS))
    archive = fit.model.archive
    has_log = np.append(find_determined(fit), True)[archive.log]
    tow_id = archive.frame["tow_id"].to_numpy()[has_log]
    return fit, dict(zip(tow_id.tolist(), fit.ln_log_factor[has_log].tolist(), strict=True))


def estimate_season_factors(tows: pl.DataFrame, near: Fit | None = None) -> SeasonFactors:
    """Estimate the log factors of all seasons at once, from repeat tows and plain GPS.

    Args:
        tows: one row per sound tow:
            `tow_id, season, part`; `fsn_no, rowers, crew_class` (the line);
            `day` within the season (may be null);
            `ln_cw`, ln Cw by the log as it reads (anchored tows: as calibrated), corrected for
            everything else, where that log over exp(-`reference_ln`) reads the line's reference
            speed: the nearer `reference_ln` is to the ln factor, the less rests on the bend;
            `q` = r / (1 - r) of its curve there; `ln_cw_sd, q_sd, ln_cw_q_cov`, their random part;
            `kappa`, elasticity 2 / (1 - r) of the line's true curve there, from pooled q;
            `weight_kg, waterline_length_m` (may be null);
            `altered`, reported, since the line's previous tow;
            `declared_speed_m_s`; `gps_ln_ratio`, ln(mean GPS / log), null without, with `gps_sd`,
            its random part; `anchored`, calibrated on dGPS: no log error is left;
            `others_calibration_ln`, ln factor of the log by dGPS in other tows, null without, with
            its `_sd`; `force_sd`, of the load cell by its record, null without one;
            `temperature_known`, of the water.
        near: a first fit to begin at (`estimate_roughly`).

    Returns:
        The factors. `source` is `estimated` with boats that link the season to others; `gps` with
        GPS alone; `not determined` (numbers null) where neither ties it to an anchored season;
        `not settled` where the search did not converge, and (numbers null) where the factor is
        refused (`factors.find_refused`). `ln_sd`, the standard deviation of ln factor, consists of
        `repeat_tows_sd`, by the scatter of repeat tows; `gps_sd`, by plain GPS; `assumed_sd`, by
        what is assumed of log, load cell and boats. `n_links` counts boats also towed elsewhere;
        `component` is the connected part of the network (0 has the anchor).

    Raises:
        BrokenPromiseError: a number that every tow must have is missing or not positive.
    """
    posterior = find_posterior(build_model(build_archive(tows, PRIORS), PRIORS), near)
    fit = posterior.fit
    factors, covariance = make_factor_table(fit, posterior.is_determined, posterior.is_refused)
    of_tows, weights = estimate_tows(posterior)
    sd = np.exp(0.5 * fit.ln_variance).tolist()
    eras = len(PRIORS.era_starts)
    ageing = int(np.flatnonzero(fit.name == AGEING)[0])
    return SeasonFactors(
        factors=factors,
        covariance=covariance,
        tow_log_sd=dict(zip(PRIORS.era_starts, sd[3 : 3 + eras], strict=True)),
        calibration_sd=sd[3 + eras],
        tow_sd=sd[0],
        tow_zero_n=sd[-2],
        ageing_per_year=float(fit.value[ageing]),
        drift_sd=sd[-1],
        tows=of_tows,
        weights=weights,
        diagnosis=diagnose_seasons(posterior),
    )
