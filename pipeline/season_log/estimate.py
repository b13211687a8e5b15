"""From tows to season factors: the joint posterior as tables."""

from dataclasses import dataclass

import numpy as np
import polars as pl

from pipeline.arrays import FloatArray
from pipeline.quantiles import t_quantile
from pipeline.season_log.archive_tows import ArchiveTows
from pipeline.season_log.assumed import USUAL
from pipeline.season_log.diagnosis import season_diagnosis, season_steps
from pipeline.season_log.effects import AGEING
from pipeline.season_log.factors import GPS, NOT_SETTLED, factors_of
from pipeline.season_log.faults import Posterior, roughly, solve
from pipeline.season_log.fit import OF_TOWS, Problem
from pipeline.season_log.tow_estimates import with_estimates


@dataclass(frozen=True)
class SeasonFactors:
    """Log factors with all that is known about them.

    Attributes:
        factors: one row per season, part and log that has tows without dGPS calibration, sorted:
            rows of the table `season_links`. See `estimate_season_factors`.
        covariance: covariance of ln factor between the rows of `factors` that are determined, in
            their order.
        tow_log_sd: standard deviation of ln factor from tow to tow, by first season of the era.
        calibration_sd: the same of tows calibrated on dGPS.
        tow_sd: standard deviation of ln Cw of a tow beyond its random part and its log.
        ageing_per_year: change of ln Cw per year that all boats share, with `ageing_sd`.
        drift_sd: standard deviation of what a boat drifts from that in a year.
        tows: what it was estimated from, with what the instruments did to each and what all tows
            say of its Cw; `weights`: what that rests on (`tow_estimates.with_estimates`).
        diagnosis: per season and instrument, what is wrong; `steps`: whether a season's step is the
            log's or the load cell's (`pipeline.season_log.diagnosis`).
    """

    factors: pl.DataFrame
    covariance: FloatArray
    tow_log_sd: dict[int, float]
    calibration_sd: float
    tow_sd: float
    ageing_per_year: float
    ageing_sd: float
    drift_sd: float
    tows: pl.DataFrame
    weights: pl.DataFrame
    diagnosis: pl.DataFrame
    steps: pl.DataFrame

    def tow_log_sd_of(self, season: FloatArray) -> FloatArray:
        """Standard deviation of ln factor from tow to tow, by the era of each season."""
        sd = np.zeros(len(season))
        for first, of_era in sorted(self.tow_log_sd.items()):
            sd = np.where(season >= first, of_era, sd)
        return sd

    def of_season(self, season: int) -> tuple[float, float, float, str] | None:
        """Factor, bounds and source of a season; None where not determined.

        Where the log was replaced it is the mean over the tows of its determined parts.
        """
        known = self.factors.drop_nulls("factor")
        mine = known["season"] == season
        parts = known.filter(mine)
        if parts.height < 2:
            return next(parts.select("factor", "lo", "hi", "source").iter_rows(), None)
        count = np.where(mine, known["n_tows"].to_numpy(), 0)
        share = count / count.sum()
        ln_factor = share @ known["factor"].log().to_numpy()
        sd = np.sqrt(share @ self.covariance @ share)
        half = sd * t_quantile(parts["dof"].to_numpy().min())
        factor, lo, hi = np.exp(ln_factor + np.array([0.0, -half, half])).tolist()
        sources = [source for source in parts["source"] if source != GPS]
        return factor, lo, hi, sources[0] if sources else GPS

    def is_refused(self, season: int) -> bool:
        """Whether the season has a factor that is not used."""
        own = self.factors.filter(pl.col("factor").is_null(), season=season)
        return NOT_SETTLED in own["source"]


def first_estimate(tows: pl.DataFrame) -> Posterior:
    """A rough one of all that `estimate_season_factors` estimates, from the same rows.

    Raises:
        BrokenPromiseError: as there.
    """
    return roughly(Problem.of(ArchiveTows.of(tows), USUAL))


def estimate_season_factors(tows: pl.DataFrame, near: Posterior | None = None) -> SeasonFactors:
    """Log factors of all seasons at once, from repeat tows and plain GPS.

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
        near: a first estimate to begin at.

    Returns:
        The factors. `source` is `estimated` with boats that link the season to others, `gps` with
        GPS alone, `not determined` (numbers null) where neither ties it to an anchored season, and
        `not settled` where the search did not come to rest, and (numbers null) where the factor
        contradicts what needs no model (`factors.refused`). `ln_sd`, the standard deviation of
        ln factor, is made up of three parts: `repeat_tows_sd`, by the scatter of repeat tows;
        `gps_sd`, by plain GPS; `assumed_sd`, by what is assumed of log, load cell and boats.
        `n_links` counts boats also towed elsewhere; `component` is the connected part of the
        network (0 has the anchor).

    Raises:
        BrokenPromiseError: a number that every tow must have is missing or not positive.
    """
    posterior = solve(Problem.of(ArchiveTows.of(tows), USUAL), near)
    fitted = posterior.fit
    factors, covariance = factors_of(fitted, posterior.determined, posterior.refused)
    of_tows, weights = with_estimates(posterior)
    diagnosis = season_diagnosis(posterior)
    sd = np.exp(0.5 * fitted.ln_variance).tolist()
    *tow_log_sd, calibration_sd, drift_sd = sd[OF_TOWS:]
    ageing = int(np.flatnonzero(fitted.name == AGEING)[0])
    return SeasonFactors(
        factors=factors,
        covariance=covariance,
        tow_log_sd=dict(zip(USUAL.era_starts, tow_log_sd, strict=True)),
        calibration_sd=calibration_sd,
        tow_sd=sd[0],
        ageing_per_year=float(fitted.value[ageing]),
        ageing_sd=float(np.sqrt(fitted.covariance[ageing, ageing])),
        drift_sd=drift_sd,
        tows=of_tows,
        weights=weights,
        diagnosis=diagnosis,
        steps=season_steps(posterior, diagnosis),
    )
