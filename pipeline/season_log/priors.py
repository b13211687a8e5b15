"""Every prior of the joint model, in one table. No arithmetic here.

Behind each number stand its unit and its source. A standard deviation of a logarithm is a ratio:
0.01 is 1 %. *inferred*: no source gives it; *fitted*: the archive shows it, and the number is the
scale of a half-Cauchy prior (Gelman 2006), by which all smaller sizes are about as likely. P2015 is
the presentation of 24 January 2015 (docs/sources.md).
"""

from dataclasses import dataclass
from typing import Final

from pipeline.history import STEERED_STRAIGHT_FROM, UNKNOWN_LOG_SD


@dataclass(frozen=True)
class Normal:
    """A normal prior."""

    mean: float
    sd: float


@dataclass(frozen=True)
class Priors:
    """Priors of logs, load cells, boats and GPS: standard deviations, unless the unit differs."""

    # Logs. One variance between tows per era.
    era_starts: tuple[int, ...] = (2009, 2012)  # first seasons; other logs came in 2012
    log_sd: float = UNKNOWN_LOG_SD  # ln factor of a log; P2015: the worst was 6 % off
    tow_log_sd: float = 0.004  # ln factor from tow to tow; fitted
    calibration_sd: float = 0.0036  # ln factor from tow to tow with dGPS per tow; fitted

    # Boats.
    level_sd: float = 1.0  # ln Cw between boats; so wide that no boat is drawn to others
    bend_sd: float = 0.08  # q about that of the boat's type; inferred
    drift_sd: float = 0.003  # ln Cw of one boat per year, a random walk; fitted
    ageing_per_year: Normal = Normal(0.0, 0.005)  # ln Cw of all boats; inferred: 0.5 % was seen
    reference_year: int = 2014  # of the ageing; first season with dGPS per tow
    weight_elasticity: Normal = Normal(0.4, 0.4)  # d ln Cw / d ln weight of the boat; inferred
    length_elasticity: Normal = Normal(0.0, 1.0)  # d ln Cw / d ln waterline length; inferred

    # Between tows, beyond the known random error of each tow.
    tow_sd: float = 0.0065  # ln Cw; fitted
    tow_bend_sd: float = 0.01  # q; fitted
    tow_gps_sd: float = 0.008  # ln(GPS / log); fitted
    tow_zero_n: float = 1.0  # N, zero of the load cell; fitted

    # Bend of all boats of a season without dGPS. A hull is no hyperbola, so bends towed at speeds
    # that are a log's error off move together, by as much as that error itself moves them. With
    # this prior a bend alone cannot tell a log from a load cell.
    season_bend_sd: float = 0.06  # q; inferred

    # Alteration that nobody reported. The share has a Beta prior worth `altered_prior_gaps`.
    altered_sd: float = 0.05  # ln Cw; inferred
    altered_bend_sd: float = 0.02  # q; inferred
    altered_share: float = 0.08  # share of the gaps between tows; fitted
    altered_prior_gaps: float = 20.0  # number of gaps; inferred

    # Tow pulled askew, before steering straight was aided. The share has a Beta prior as well.
    askew_excess: Normal = Normal(0.075, 0.03)  # ln Cw; P2015: 5 to 10 %
    askew_share: float = 0.05  # share of the early tows; fitted
    askew_prior_tows: float = 20.0  # number of tows; inferred
    straight_from: int = STEERED_STRAIGHT_FROM  # season; P2015

    # Plain GPS. The length of a noisy velocity is too long by up to noise^2 / (2 v^2); how much of
    # that a receiver smooths away is unknown: half is taken.
    gps_season_sd: float = 0.003  # mean ln(GPS / log) of a season; inferred
    gps_noise_m_s: float = 0.1  # m/s; inferred

    # Load cell of a season, and water of a season whose temperature nobody wrote down.
    force_sd: float = 0.002  # ln force; inferred: a calibration every day
    water_sd: float = 0.012  # ln Cw; inferred: 0.3 % per degree, 4 C either way

    # Faults of a season: probability of each, and its size if there is one.
    fault_probability: float = 0.01  # per season and kind of instrument fault; inferred
    fleet_probability: float = 0.003  # per season, that all boats change at once; inferred
    force_fault_sd: float = 0.05  # ln force; inferred
    fleet_fault_sd: float = 0.03  # ln Cw of all boats from a season on; inferred
    zero_fault_n: float = 10.0  # N, zero of the load cell or half its drift in a season; inferred
    trend_fault_sd: float = 0.02  # ln factor at the end of a season less its middle; inferred
    change_fault_sd: float = 0.04  # ln factor after an unreported replacement; inferred


PRIORS: Final = Priors()
