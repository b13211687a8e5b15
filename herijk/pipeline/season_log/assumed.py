"""What is assumed about logs, boats and GPS before looking at the data. No arithmetic here."""

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True)
class Prior:
    """What is held of a number before the data: its mean and standard deviation."""

    mean: float
    sd: float


@dataclass(frozen=True)
class Settings:
    """What is assumed before looking at the data; all of it weak but for `gps_season_sd`.

    Attributes:
        era_starts: first season of each era of logs; an era has one wander (DOMAIN, history).
        ageing_per_year: change of ln Cw per year; half a per cent has been seen.
        weight_elasticity, length_elasticity: dlnCw / dln of the empty boat's weight, of its length.
        tow_sd, wander_sd, gps_sd: first guesses of the standard deviations of ln Cw of a tow beyond
            its random part, of ln of the log factor from tow to tow, and of ln(GPS / log) beyond
            its given uncertainty. They count as `prior_dof` observations.
        changed_sd: standard deviation of the change of ln Cw of a boat altered without a report.
        gps_season_sd: uncertainty of a season's mean GPS / log that does not average out.
        gps_noise_m_s: sideways noise of a fix; the length of a noisy velocity is too long by up to
            noise^2 / (2 v^2). How much of that a receiver smooths away is unknown: half is taken.
        t_dof: degrees of freedom of the residuals. With 8 the factors come out as near as with 4
            when 12 % of the boats are altered, and the intervals hold better.
        reference_year: t0.
    """

    era_starts: tuple[int, ...] = (2009, 2012)
    ageing_per_year: Prior = Prior(0.0, 0.005)
    weight_elasticity: Prior = Prior(0.4, 0.4)
    length_elasticity: Prior = Prior(0.0, 1.0)
    tow_sd: float = 0.01
    changed_sd: float = 0.08
    wander_sd: float = 0.003
    gps_sd: float = 0.01
    prior_dof: float = 0.1
    gps_season_sd: float = 0.003
    gps_noise_m_s: float = 0.1
    t_dof: float = 8.0
    reference_year: int = 2014


USUAL: Final = Settings()
