"""The priors on logs, load cells, boats and GPS. No arithmetic here."""

from dataclasses import dataclass
from typing import Final

from pipeline.history import STEERED_STRAIGHT_FROM, UNKNOWN_LOG_SD


@dataclass(frozen=True)
class Prior:
    """A prior: mean and standard deviation."""

    mean: float
    sd: float


@dataclass(frozen=True)
class Settings:
    """All priors. Standard deviations, unless it says otherwise."""

    # Logs: first season of each era, which has one variance between tows; ln factor of a log of
    # which nothing is known (the worst was 6 % wrong); the same from tow to tow, and of a log
    # calibrated on dGPS, by the calibration itself and by a current that changes meanwhile.
    era_starts: tuple[int, ...] = (2009, 2012)
    log_sd: float = UNKNOWN_LOG_SD
    tow_log_sd: float = 0.004
    calibration_sd: float = 0.0036

    # Boats: change of ln Cw per year from the reference year (half a per cent has been seen);
    # dlnCw / dln of the empty boat's weight, and of its length; the change in a year beyond the
    # ageing that all share, a random walk; the bend about what is usual for their type.
    ageing_per_year: Prior = Prior(0.0, 0.005)
    reference_year: int = 2014
    weight_elasticity: Prior = Prior(0.4, 0.4)
    length_elasticity: Prior = Prior(0.0, 1.0)
    drift_sd: float = 0.003
    bend_sd: float = 0.08

    # Between tows: ln Cw and bend beyond their random part, ln(GPS / log) beyond its given one. All
    # variances have a log-normal prior of this spread: what is said here counts as one repeat tow.
    tow_sd: float = 0.0065
    bend_sd_tow: float = 0.01
    gps_sd: float = 0.008
    spread: float = 1.5

    # A real hull is no hyperbola: towed at speeds that are a log's error off, all bends of a season
    # move together, by as much as the error itself moves them. So where no dGPS calibrates a season
    # a bend alone tells no log from a load cell.
    season_bend_sd: float = 0.06

    # Altered without a report: change of ln Cw and bend; share of gaps between two tows with one,
    # as so many gaps would show it.
    changed_sd: float = 0.05
    changed_bend_sd: float = 0.02
    changed_share: float = 0.08
    changed_gaps: float = 20.0

    # Pulled askew: 5 to 10 % of Cw, until steering straight was aided (presentation 2015); share of
    # tows before, as so many tows would show it.
    askew_excess: Prior = Prior(0.075, 0.03)
    askew_share: float = 0.05
    askew_tows: float = 20.0
    straight_from: int = STEERED_STRAIGHT_FROM

    # Plain GPS: a season's mean ln(GPS / log) that does not average out; sideways noise of a fix
    # (the length of a noisy velocity is too long by up to noise^2 / (2 v^2); how much of that a
    # receiver smooths away is unknown: half is taken).
    gps_season_sd: float = 0.003
    gps_noise_m_s: float = 0.1

    # A season's load cell, as calibrated daily; ln Cw of its tows whose water temperature nobody
    # wrote down: 0.3 % per degree, and 4 C either way.
    force_sd: float = 0.002
    water_sd: float = 0.012

    # Faults of a season: probability of each kind, and their sizes: ln force, ln Cw of all boats
    # from then on, zero of the load cell and its drift from the middle of a season [N], ln factor
    # of a log at the end of a season against its middle, and after a replacement without a report.
    fault_chance: float = 0.01
    force_fault_sd: float = 0.05
    fleet_fault_sd: float = 0.03
    zero_fault_n: float = 10.0
    trend_fault_sd: float = 0.02
    change_fault_sd: float = 0.04


USUAL: Final = Settings()
