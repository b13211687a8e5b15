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
    """All priors. Standard deviations, unless it says otherwise.

    Attributes:
        era_starts: first season of each era of logs; an era has one between-tow log variance.
        log_sd: ln factor of a log of which nothing is known: the worst log was 6 % wrong.
        ageing_per_year: change of ln Cw per year; half a per cent has been seen.
        weight_elasticity, length_elasticity: dlnCw / dln of the empty boat's weight, of its length.
        drift_sd: of the change of a boat's ln Cw in a year beyond the ageing that all share, a
            random walk; with `spread`.
        tow_sd, bend_sd_tow, gps_sd, tow_log_sd, calibration_sd: between tows, each with `spread`:
            ln Cw beyond its random part, the same of the bend, ln(GPS / log) beyond its given
            uncertainty, the ln factor of the log, and that of a log calibrated on dGPS: by the
            calibration itself and by a current that changes meanwhile. `spread` is of the logarithm
            of a variance: what is said here counts as one repeat tow.
        bend_sd: bend of boats about what is usual for their type.
        season_bend_sd: bend of all boats in a season that no dGPS calibrates. A real hull is no
            hyperbola: towed at speeds that are a log's error off, all bends move together, by as
            much as the error itself moves them. So a bend alone tells no log from a load cell.
        changed_sd, changed_bend_sd: change of ln Cw and of the bend of a boat altered without a
            report.
        changed_share: of gaps between two tows with such an alteration, as `changed_gaps` gaps
            would show it.
        askew_excess: of ln Cw of a tow that was pulled askew: 5 to 10 % (presentation 2015).
        askew_share: of tows before `straight_from`, as `askew_tows` tows would show it.
        straight_from: first season in which steering straight was aided (presentation 2015).
        gps_season_sd: a season's mean ln(GPS / log) that does not average out.
        gps_noise_m_s: sideways noise of a fix; the length of a noisy velocity is too long by up to
            noise^2 / (2 v^2). How much of that a receiver smooths away is unknown: half is taken.
        force_sd: load cell of a season, as calibrated daily.
        water_sd: ln Cw of a season's tows whose water temperature nobody wrote down: 0.3 % per
            degree, and 4 C either way.
        fault_chance: probability of each kind of fault in a season.
        force_fault_sd, fleet_fault_sd: size of a fault: of ln force, of ln Cw of all boats from a
            season on.
        zero_fault_n: zero of the load cell [N]; also its drift from the middle of a season.
        trend_fault_sd, change_fault_sd: ln factor of a log at the end of a season against its
            middle, and after it was replaced without a report.
        reference_year: from which ageing is counted.
    """

    era_starts: tuple[int, ...] = (2009, 2012)
    log_sd: float = UNKNOWN_LOG_SD
    ageing_per_year: Prior = Prior(0.0, 0.005)
    weight_elasticity: Prior = Prior(0.4, 0.4)
    length_elasticity: Prior = Prior(0.0, 1.0)
    drift_sd: float = 0.003
    tow_sd: float = 0.0065
    bend_sd_tow: float = 0.01
    gps_sd: float = 0.008
    tow_log_sd: float = 0.004
    calibration_sd: float = 0.0036
    spread: float = 1.5
    bend_sd: float = 0.08
    season_bend_sd: float = 0.06
    changed_sd: float = 0.05
    changed_bend_sd: float = 0.02
    changed_share: float = 0.08
    changed_gaps: float = 20.0
    askew_excess: Prior = Prior(0.075, 0.03)
    askew_share: float = 0.05
    askew_tows: float = 20.0
    straight_from: int = STEERED_STRAIGHT_FROM
    gps_season_sd: float = 0.003
    gps_noise_m_s: float = 0.1
    force_sd: float = 0.002
    water_sd: float = 0.012
    fault_chance: float = 0.01
    force_fault_sd: float = 0.05
    fleet_fault_sd: float = 0.03
    zero_fault_n: float = 10.0
    trend_fault_sd: float = 0.02
    change_fault_sd: float = 0.04
    reference_year: int = 2014


USUAL: Final = Settings()
