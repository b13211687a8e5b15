"""Every prior of the joint model, in one table. No arithmetic here.

A standard deviation of a logarithm is a ratio: 0.01 is 1 %.
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
    """Priors of logs, load cells, boats and GPS: standard deviations, unless a comment differs."""

    # Logs. One variance between tows per era; `era_starts` are the first seasons of the eras.
    era_starts: tuple[int, ...] = (2009, 2012)
    log_sd: float = UNKNOWN_LOG_SD  # ln factor of a log of which nothing is known
    tow_log_sd: float = 0.004  # ln factor from tow to tow
    calibration_sd: float = 0.0036  # the same where dGPS calibrates each tow

    # Boats.
    level_sd: float = 1.0  # ln Cw between boats: wide, no boat is drawn to the others
    bend_sd: float = 0.08  # bend q about that of the boat's type
    drift_sd: float = 0.003  # ln Cw of one boat per year, a random walk
    ageing_per_year: Normal = Normal(0.0, 0.005)  # ln Cw of all boats (half a per cent was seen)
    reference_year: int = 2014  # of the ageing
    weight_elasticity: Normal = Normal(0.4, 0.4)  # d ln Cw / d ln weight of the empty boat
    length_elasticity: Normal = Normal(0.0, 1.0)  # d ln Cw / d ln waterline length

    # Between tows, beyond the known random error of each tow.
    tow_sd: float = 0.0065  # ln Cw
    tow_bend_sd: float = 0.01  # bend q
    tow_gps_sd: float = 0.008  # ln(GPS / log)
    ln_variance_sd: float = 1.5  # of every ln variance: a prior variance counts as one repeat tow

    # Bend of all boats of a season without dGPS. A hull is no hyperbola, so bends towed at speeds
    # that are a log's error off move together, by as much as that error itself moves them. With
    # this prior a bend alone cannot tell a log from a load cell.
    season_bend_sd: float = 0.06

    # Alteration that nobody reported. The share of gaps between tows with one has a Beta prior that
    # counts as `altered_prior_gaps` gaps.
    altered_sd: float = 0.05  # change of ln Cw
    altered_bend_sd: float = 0.02  # change of q
    altered_share: float = 0.08
    altered_prior_gaps: float = 20.0

    # Tow pulled askew, before steering straight was aided: 5 to 10 % of Cw (presentation 2015).
    askew_excess: Normal = Normal(0.075, 0.03)  # in ln Cw
    askew_share: float = 0.05
    askew_prior_tows: float = 20.0
    straight_from: int = STEERED_STRAIGHT_FROM

    # Plain GPS. The length of a noisy velocity is too long by up to noise^2 / (2 v^2); how much of
    # that a receiver smooths away is unknown: half is taken.
    gps_season_sd: float = 0.003  # mean ln(GPS / log) of a season
    gps_noise_m_s: float = 0.1

    # Load cell of a season, and water of a season whose temperature nobody wrote down.
    force_sd: float = 0.002  # ln force, with a daily calibration
    water_sd: float = 0.012  # ln Cw: 0.3 % per degree, 4 C either way

    # Faults of a season: probability of each, and its size if there is one.
    fault_probability: float = 0.01
    force_fault_sd: float = 0.05  # ln force
    fleet_fault_sd: float = 0.03  # ln Cw of all boats from a season on
    zero_fault_n: float = 10.0  # zero of the load cell, and its drift from the middle of a season
    trend_fault_sd: float = 0.02  # ln factor of a log at the end of a season against its middle
    change_fault_sd: float = 0.04  # ln factor of a log after an unreported replacement


PRIORS: Final = Priors()
