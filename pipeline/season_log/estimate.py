"""From tows to season factors: the joint posterior as tables."""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import polars as pl

from pipeline.arrays import FloatArray, IntArray
from pipeline.choice import first_largest
from pipeline.errors import BrokenPromiseError
from pipeline.quantiles import t_quantile
from pipeline.season_log.assumed import USUAL
from pipeline.season_log.diagnosis import (
    NOT_DETERMINED,
    NOT_SETTLED,
    season_diagnosis,
    season_steps,
)
from pipeline.season_log.effects import AGEING
from pipeline.season_log.guard import refused
from pipeline.season_log.network import GROUP, Network
from pipeline.season_log.posterior import Posterior, Problem, solve
from pipeline.season_log.tows import best_estimates, instrument_errors

ESTIMATED: Final = "estimated"
GPS: Final = "gps"


@dataclass(frozen=True)
class SeasonFactors:
    """Log factors with all that is known about them.

    Attributes:
        factors: one row per season, part and log that has tows without dGPS calibration, sorted:
            `season, part, factor, lo, hi, source, ln_sd, dof, n_tows, n_links, component,
            influence, influence_boat, critical_boats`. See `estimate_season_factors`.
        covariance: covariance of ln factor between the rows of `factors` that are determined, in
            their order.
        tow_log_sd: standard deviation of ln factor from tow to tow, by first season of the era.
        calibration_sd: the same of tows calibrated on dGPS.
        tow_sd: standard deviation of ln Cw of a tow beyond its random part and its log.
        ageing_per_year: change of ln Cw per year that all boats share, with `ageing_sd`.
        drift_sd: standard deviation of what a boat drifts from that in a year.
        tows: what it was estimated from.
        instruments: per tow, what its instruments did: `pipeline.season_log.tows`.
        best: per tow, what all tows together say of its Cw; `weights`: what that rests on.
        diagnosis: per season and instrument, what is wrong: `pipeline.season_log.diagnosis`;
            `steps`: whether a season's step is the log's or the load cell's.
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
    instruments: pl.DataFrame
    best: pl.DataFrame
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


def estimate_season_factors(tows: pl.DataFrame) -> SeasonFactors:
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
            `boat_type` (may be null); `altered`, reported, since the line's previous tow;
            `declared_speed_m_s`; `gps_ln_ratio`, ln(mean GPS / log), null without, with `gps_sd`,
            its random part; `anchored`, calibrated on dGPS: no log error is left;
            `own_calibration_ln`, ln factor of the log by dGPS, null where it is not calibrated;
            `others_calibration_ln`, the same by other tows, null without, with its `_sd`;
            `force_sd`, of the load cell by its record, null without one;
            `temperature_known`, of the water.

    Returns:
        The factors. `source` is `estimated` with boats that link the season to others, `gps` with
        GPS alone, `not determined` (numbers null) where neither ties it to an anchored season, and
        `not settled` where the search did not come to rest, and (numbers null) where the factor
        contradicts what needs no model (`guard`).
        `n_links` counts boats also towed elsewhere; `component` is the connected part of the
        network (0 has the anchor). `influence` is the largest change of the factor when one boat
        (`influence_boat`) is left out, and `critical_boats` how many boats would leave the season
        undetermined.

    Raises:
        BrokenPromiseError: a number that every tow must have is missing or not positive.
    """
    _refuse_unknown(tows)
    network = Network.of(tows)
    posterior = _guarded(solve(Problem.of(network, USUAL)))
    fit = posterior.fit
    ageing = int(np.flatnonzero(posterior.names == AGEING)[0])
    ageing_per_year = float(posterior.mean[ageing])
    ageing_sd = float(np.sqrt(posterior.covariance[ageing, ageing]))
    along = _group_means(posterior)
    covariance = _of_means(posterior, along @ posterior.covariance @ along.T)
    change = _without_each_boat(posterior)
    instruments = instrument_errors(posterior, change)
    best, weights = best_estimates(posterior, instruments)
    eras = len(USUAL.era_starts)
    *tow_log_sd, calibration_sd = np.exp(0.5 * fit.state.ln_variance[3 : 4 + eras]).tolist()
    diagnosis = season_diagnosis(posterior)
    return SeasonFactors(
        factors=_described(posterior, along, covariance, change),
        covariance=covariance,
        tow_log_sd=dict(zip(USUAL.era_starts, tow_log_sd, strict=True)),
        calibration_sd=calibration_sd,
        tow_sd=float(np.exp(0.5 * fit.state.ln_variance[0])),
        ageing_per_year=ageing_per_year,
        ageing_sd=ageing_sd,
        drift_sd=float(np.sqrt(fit.state.drift_variance)),
        tows=tows,
        instruments=instruments,
        best=best,
        weights=weights,
        diagnosis=diagnosis,
        steps=season_steps(posterior, diagnosis),
    )


def _refuse_unknown(tows: pl.DataFrame) -> None:
    for name in ("ln_cw", "kappa", "ln_cw_sd", "declared_speed_m_s"):
        least = -np.inf if name == "ln_cw" else 0.0
        sound = pl.col(name).is_finite() & (pl.col(name) > least)
        faulty = tows.filter(~sound.fill_null(False))
        if faulty.height:
            raise BrokenPromiseError(
                "season factors: {} of tow {} is {}, and {} more; give only tows "
                "with a sound curve",
                name,
                faulty["tow_id"][0],
                faulty[name][0],
                faulty.height - 1,
            )


def _guarded(posterior: Posterior) -> Posterior:
    """The posterior, with the factors refused that contradict what needs no model."""
    along = _group_means(posterior)
    known = posterior.problem.network.determined
    ln_factor, ln_sd = np.zeros(len(known)), np.zeros(len(known))
    ln_factor[known] = along @ posterior.mean
    ln_sd[known] = np.sqrt(np.einsum("gf,fh,gh->g", along, posterior.covariance, along))
    network = replace(posterior.problem.network, refused=refused(posterior, ln_factor, ln_sd))
    return replace(posterior, problem=replace(posterior.problem, network=network))


def _group_means(posterior: Posterior) -> FloatArray:
    """Mean ln factor over the tows of each determined group as a sum of unknowns."""
    network = posterior.problem.network
    share = posterior.problem.share[:, posterior.places] * posterior.of_log
    groups = np.flatnonzero(network.determined)
    means = [share[network.group == number].mean(axis=0) for number in groups]
    return np.array(means).reshape(len(groups), len(posterior.places))


def _of_means(posterior: Posterior, covariance: FloatArray) -> FloatArray:
    """Covariance of the mean ln factors over tows, by that of what logs do in general.

    The scatter of the tows is in their mean as well as in what they tell of the log: it is in the
    difference only as far as the prior draws the estimate.
    """
    own = posterior.scatter_of_means[posterior.problem.network.determined]
    drawn = own / posterior.problem.settings.log_sd**2
    return np.asarray(covariance * (1.0 + drawn + drawn[:, None]) - np.diag(own))


def _without_each_boat(posterior: Posterior) -> FloatArray:
    """Change of every unknown of the fit when a boat is left out, (boats, unknowns)."""
    fit, cluster = posterior.fit, posterior.problem.network.cluster
    clusters = int(cluster.max()) + 1
    information = np.zeros((clusters, len(fit.active), len(fit.active)))
    score = np.zeros((clusters, len(fit.active)))
    for boats in fit.boats:
        whose = cluster[boats.rows[:, 0] // 3]
        np.add.at(information, whose, boats.information)
        np.add.at(score, whose, boats.score)
    left = np.linalg.inv(fit.covariance) - information
    return np.asarray(-np.linalg.solve(left, score[:, :, None])[:, :, 0])


def _described(
    posterior: Posterior,
    along: FloatArray,
    covariance: FloatArray,
    change: FloatArray,
) -> pl.DataFrame:
    """The factor of each group with its interval and what it rests on; see `SeasonFactors`.

    Args:
        along: as `_group_means` gives it.
        covariance: of the determined ln factors.
        change: of every unknown of the fit without each boat, (boats, unknowns).
    """
    network, fit = posterior.problem.network, posterior.fit
    known = np.flatnonzero(network.determined)

    def placed(values: FloatArray | IntArray) -> pl.Series:
        """Numbers of the determined groups, null for the others."""
        column = np.full(network.groups.height, np.nan)
        column[known] = values
        return pl.Series(column, dtype=pl.Float64).fill_nan(None)

    mean = along @ posterior.mean
    critical = network.critical[:, known]
    move = np.where(critical, np.inf, np.abs(np.expm1(change @ along.T)) * np.exp(mean))
    influence = move.max(axis=0, initial=0.0)
    boat = first_largest(move) if move.size else np.zeros(len(known))
    ln_factor, dof = placed(mean), placed(fit.dof(along))
    sd = placed(np.sqrt(np.diag(covariance)))
    half = _half_width(sd, dof)
    by_gps_alone = (network.links == 0) & (network.has_gps | network.calibrated)
    source = np.where(by_gps_alone, GPS, ESTIMATED) if fit.settled else NOT_SETTLED
    source = np.where(network.component == 0, source, NOT_DETERMINED)
    return network.groups.select(
        *GROUP,
        factor=ln_factor.exp(),
        lo=(ln_factor - half).exp(),
        hi=(ln_factor + half).exp(),
        source=pl.Series(np.where(network.refused, NOT_SETTLED, source), dtype=pl.String),
        ln_sd=sd,
        dof=dof,
        n_tows=pl.Series(np.bincount(network.group[network.group >= 0]), dtype=pl.Int64),
        n_links=pl.Series(network.links, dtype=pl.Int64),
        component=pl.Series(network.component, dtype=pl.Int64),
        influence=placed(np.where(np.isfinite(influence), influence, np.nan)),
        influence_boat=pl.Series(network.boat_names).gather(placed(boat).cast(pl.Int64)),
        critical_boats=placed(critical.sum(axis=0)).cast(pl.Int64),
    )


def _half_width(sd: pl.Series, dof: pl.Series) -> pl.Series:
    quantile = t_quantile(dof.fill_null(1.0).clip(1.0).to_numpy())
    return sd * pl.Series(quantile)
