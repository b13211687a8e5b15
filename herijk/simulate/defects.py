"""What can go wrong in a simulated tow, each by name and size, and what went wrong when.

`Defects` has one field per defect; zero (or one, for a factor) switches it off: `Defects()` is a
perfect tow test in still water without wind at 15 C. `SEASONS` says as data which instruments and
defects each season had; sources are in `docs/simulator.md`.
How a defect works on a channel is in `motion` and `instruments`.
"""

from dataclasses import dataclass, replace
from typing import Final

from pipeline.errors import MissingKnowledgeError


@dataclass(frozen=True)
class Defects:
    """Sizes of all defects; the default of every field is "absent".

    `sd` in a comment means a standard deviation, `share` the probability for a tow or run.
    """

    # Logs. True speed = log speed x factor: a worn propeller turns too slowly, its factor is > 1.
    log_season_factor: tuple[float, float] = (1.0, 1.0)  # range the season's factor is drawn from
    log_tow_sd: float = 0.0  # sd of ln factor between the tows of a season
    log_run_wander: float = 0.0  # relative sd between runs, and slowly within a run
    log_noise_m_s: float = 0.0  # sd
    log_flicker: float = 0.0  # relative sd of 1/f noise
    log2_ratio: tuple[float, float] = (1.0, 1.0)  # range of log 2 / log 1, drawn each tow
    log_trend: float = 0.0  # change of ln factor from the first day of the season to the last
    log_replaced: float = 0.0  # change of ln factor at an unreported change of log in mid-season
    steered_by_log: float = 0.0  # 1: the helmsman holds the target by log 1; 0: by true speed
    # GPS
    gps_wander_m_s: float = 0.0  # sd, slow
    gps_noise_m_s: float = 0.0  # sd of each fix
    gps_lag_s: float = 0.0
    gps_hold_s: float = 0.0  # time between fixes
    gps_scale: float = 1.0  # reading over true
    # Water and wind
    stream_m_s: float = 0.0  # sd along the course
    stream_drift_m_s: float = 0.0  # sd of the change in ten minutes
    tide_m_s: float = 0.0  # amplitude of a tidal current that turns during the tow
    water_temperature_c: tuple[float, float] = (15.0, 15.0)  # range, drawn each day
    salinity_g_kg: float = 0.0
    temperature_missing_share: float = 0.0  # of tows whose list does not give it
    wind_m_s: float = 0.0  # mean true wind speed
    wind_turbulence: float = 0.0  # sd of the wind over its mean
    slow_gusts: float = 0.0  # sd of gusts that last half a minute, over the mean wind
    vane_jitter_deg: float = 0.0  # sd
    vane_offset_deg: float = 0.0
    anemometer_scale: float = 1.0  # reading over true
    gust_share: float = 0.0  # of runs, with
    gust_m_s: float = 0.0  # this much more wind for some seconds
    # Towing
    speed_miss: float = 0.0  # relative sd of a run's speed about its target
    speed_wander_m_s: float = 0.0  # sd of the helmsman's slow wander
    ramp_share: float = 0.0  # of runs, still accelerating at the start
    ramp_m_s: float = 0.0  # largest speed missing at the start
    steering_share: float = 0.0  # of runs, with
    steering_force: float = 0.0  # a relative force peak
    steering_peaks: float = 0.0  # mean number in a run, anywhere in it, of
    steering_peak_force: float = 0.0  # relative force peaks, half of this to this
    surge_m_s: float = 0.0  # sd of the boat's swing on the tow line, once in four seconds
    inertia: float = 0.0  # part of (m + added mass) dv/dt that the load cell feels: 0 or 1
    surge_force: float = 0.0  # relative sd of the 1 Hz surge of the tow line
    force_wander: float = 0.0  # relative sd, seconds
    force_noise: float = 0.0  # relative sd, fast
    force_scale: float = 1.0  # reading over true
    force_zero_n: float = 0.0  # reading without force
    force_zero_tow_n: float = 0.0  # sd of that between tows
    force_zero_drift_n: float = 0.0  # change of that from the first day of the season to the last
    askew_share: float = 0.0  # of tows pulled askew
    askew_excess: tuple[float, float] = (0.0, 0.0)  # range of the relative excess of force
    askew_gross_share: float = 0.0  # of the tows pulled askew, with
    askew_gross_excess: float = 0.0  # this excess
    fast_run_share: float = 0.0  # of tows, with 120 % runs instead of 110 %
    slow_share: float = 0.0  # of tows, towed
    slow_ratio: tuple[float, float] = (1.0, 1.0)  # at this range of the boat's usual speed
    empty_thwart_share: float = 0.0  # of tows, for a crew of two rowers fewer
    second_file_share: float = 0.0  # of tows, whose runs back are those of a second file
    second_file_log: float = 0.0  # change of ln factor in that file
    # Files
    dropout_share: float = 0.0  # of runs in which log 1 reads 0 for up to a second
    gap_share: float = 0.0  # of runs in which the load cell gives no number for up to a second
    spike_share: float = 0.0  # of runs with one sample of the load cell 30 times too high
    # Boats
    alteration_share: float = 0.0  # of boats, between two seasons in which they are towed
    alteration_sd: float = 0.0  # sd of ln resistance
    alteration_weight_sd: float = 0.0  # sd of ln weight
    unreported_share: float = 0.0  # of alterations
    fleet_resistance: float = 1.0  # factor on the water resistance of all boats
    ageing_per_year: float = 0.0  # relative growth of water resistance

    @classmethod
    def history(cls, season: int) -> "Defects":
        """Return the defects that instruments and habits of a season had.

        Raises:
            MissingKnowledgeError: the season is before the first of `SEASONS`.
        """
        if season < FIRST_SEASON:
            raise MissingKnowledgeError(
                "season {} cannot be simulated: the table of instruments begins in {}; "
                "ask for {} or later",
                season,
                FIRST_SEASON,
                FIRST_SEASON,
            )
        return SEASONS[max(first for first in SEASONS if first <= season)]

    @classmethod
    def clean(cls, season: int) -> "Defects":
        """Return the instruments of a season in a world where only its log factor needs finding.

        Noise, wind, current and disturbed runs stay; what cannot be known from one tow (wander
        between tows, boats that change, askew pulling) is gone.
        """
        return replace(
            cls.history(season),
            log_tow_sd=0.0,
            askew_share=0.0,
            fast_run_share=0.0,
            alteration_share=0.0,
            ageing_per_year=0.0,
        )


_PROPELLER_LOGS = Defects(
    log_season_factor=(1.04, 1.065),
    log_tow_sd=0.012,
    log_run_wander=0.004,
    log_noise_m_s=0.04,
    log2_ratio=(0.99, 1.01),
    gps_hold_s=1.0,
    gps_lag_s=1.0,
    stream_m_s=0.04,
    stream_drift_m_s=0.006,
    water_temperature_c=(3.0, 12.0),
    wind_m_s=2.5,
    wind_turbulence=0.25,
    vane_jitter_deg=13.0,
    gust_share=0.12,
    gust_m_s=2.5,
    speed_miss=0.008,
    speed_wander_m_s=0.02,
    ramp_share=0.25,
    ramp_m_s=0.25,
    steering_share=0.20,
    steering_force=0.35,
    inertia=1.0,
    surge_force=0.055,
    force_wander=0.02,
    force_noise=0.05,
    askew_share=0.08,
    askew_excess=(0.05, 0.10),
    askew_gross_share=0.05,
    askew_gross_excess=0.40,
    fast_run_share=0.20,
    alteration_share=0.15,
    alteration_sd=0.05,
    alteration_weight_sd=0.03,
    unreported_share=0.5,
    ageing_per_year=0.003,
)
_WITH_GPS = replace(_PROPELLER_LOGS, gps_wander_m_s=0.08, gps_noise_m_s=0.03)
_DOPPLER_LOGS = replace(
    _WITH_GPS,
    log_season_factor=(0.985, 1.015),
    log_tow_sd=0.006,
    log_run_wander=0.002,
    log_noise_m_s=0.03,
)
_WITH_DGPS = replace(
    _DOPPLER_LOGS,
    log_season_factor=(0.99, 1.01),
    log_tow_sd=0.004,
    log2_ratio=(0.94, 0.97),
    gps_wander_m_s=0.0,
    gps_noise_m_s=0.01,
    gps_lag_s=2.0,
    steering_share=0.06,
    askew_share=0.0,
)
_SINCE_2015 = replace(_WITH_DGPS, log2_ratio=(0.996, 1.004), fast_run_share=0.0)

SEASONS: Final = {
    2009: _PROPELLER_LOGS,
    2011: _WITH_GPS,
    2012: _DOPPLER_LOGS,
    2014: _WITH_DGPS,
    2015: _SINCE_2015,
}
"""Each holds from its season until the next; the last holds on."""

FIRST_SEASON: Final = min(SEASONS)
FIRST_GPS_SEASON: Final = 2011
"""From then on there was a GPS receiver on board, from 2014 on a differential one."""
