"""Named worlds: what is wrong in each, as data.

A world is the tow tests of a base, with faults in some of its seasons. `history` is everything
that is known to have gone wrong and `clean` has instruments and weather alone; every hostile world
is the clean one with one thing more, so that its effect is not mixed with others.
How large and in which seasons is an example; what must hold must hold for other amounts too.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Final, TypeAlias

import numpy as np

from herijk.simulate.defects import FIRST_SEASON, Defects
from herijk.simulate.world import WorldSettings
from pipeline.errors import HerijkError

BEFORE_DGPS: Final = range(FIRST_SEASON, 2014)
EVER: Final = range(FIRST_SEASON, 10_000)
LOGS_ONLY: Final = range(2010, 2011)
WITH_DGPS: Final = range(2016, 2017)
SINCE_DGPS: Final = range(2014, 10_000)

Faults: TypeAlias = Mapping[range, Mapping[str, Any]]
"""By seasons what differs from the base in them: fields of `Defects`."""


@dataclass(frozen=True)
class NamedWorld:
    """A base with faults.

    Attributes:
        about: what is wrong, one sentence.
        faults: what is wrong, by seasons.
        options: fields of `WorldSettings` that differ from the default.
        base: what holds without faults.
    """

    about: str
    faults: Faults = field(default_factory=dict)
    options: Mapping[str, Any] = field(default_factory=dict)
    base: Callable[[int], Defects] = Defects.clean

    def defects(self, season: int) -> Defects:
        """Return the defects of a season."""
        of_season = self.base(season)
        for seasons, sizes in self.faults.items():
            if season in seasons:
                of_season = replace(of_season, **sizes)
        return of_season


def _warming(first: float, last: float) -> Faults:
    """Warm the water by the season until dGPS came, without writing its temperature down."""
    middles = np.linspace(first, last, len(BEFORE_DGPS))
    return {
        range(season, season + 1): {
            "temperature_missing_share": 1.0,
            "water_temperature_c": (middle - 1.0, middle + 1.0),
        }
        for season, middle in zip(BEFORE_DGPS, middles.tolist(), strict=True)
    }


SPREAD_OUT: Final = {"tows_a_day": 2, "days_apart": 3}
"""A season of weeks, so that something can drift in it."""

MODERATE: Final[Faults] = {
    EVER: {
        "tide_m_s": 0.05,
        "vane_offset_deg": 3.0,
        "anemometer_scale": 0.97,
        "alteration_share": 0.08,
        "unreported_share": 0.7,
        "askew_gross_share": 0.0,
    },
    BEFORE_DGPS: {"log_tow_sd": 0.004, "log_trend": 0.005, "askew_share": 0.02},
    range(2011, 2012): {"force_scale": 1.002},
    range(2013, 2014): {"force_scale": 0.998, "force_zero_n": 0.5},
    range(2015, 2016): {"force_scale": 0.998},
    range(2017, 2018): {"force_scale": 1.002, "force_zero_n": -0.5},
}
"""Errors of every kind at moderate size."""

ROUGH: Final[Mapping[str, Any]] = {
    "slow_gusts": 0.25,
    "log_flicker": 0.01,
    "stream_drift_m_s": 0.015,
    "steering_peaks": 0.7,
    "steering_peak_force": 0.3,
    "surge_m_s": 0.0015,
    "surge_force": 0.10,
    "force_zero_tow_n": 2.0,
}
"""Errors that remember: each spoils a window or a whole tow, and none of them averages out."""

WORLDS: Final[Mapping[str, NamedWorld]] = {
    "history": NamedWorld("Everything that is known to have gone wrong.", base=Defects.history),
    "real": NamedWorld(
        "Errors of every kind at moderate size: humped hulls, logs that drift, unreported changes.",
        MODERATE,
        {"shape": "hump"},
        base=Defects.history,
    ),
    "rough": NamedWorld(
        "As real, with gusts and logs that have a memory, surge, steering peaks, a wandering zero.",
        {**MODERATE, EVER: {**MODERATE[EVER], **ROUGH}},
        {"shape": "hump"},
        base=Defects.history,
    ),
    "clean": NamedWorld("Instruments and weather of each season, and nothing else wrong."),
    "restless": NamedWorld(
        "Logs vary 1.2 % between tows, 12 % of boats are altered unreported, boats age.",
        {
            BEFORE_DGPS: {"log_tow_sd": 0.012},
            EVER: {
                "alteration_share": 0.12,
                "alteration_sd": 0.08,
                "unreported_share": 1.0,
                "ageing_per_year": 0.004,
            },
        },
    ),
    "log-steers": NamedWorld(
        "The helmsman holds the speed that log 1 reads: a log that reads low makes him go faster.",
        {EVER: {"steered_by_log": 1.0}},
    ),
    "fouling": NamedWorld(
        "Logs foul by 4 % from the first day of a season to the last, until 2013.",
        {BEFORE_DGPS: {"log_trend": 0.04}},
        SPREAD_OUT,
    ),
    "log-replaced": NamedWorld(
        "In mid-season of 2010 the log is replaced by one 4 % off; nobody writes it down.",
        {LOGS_ONLY: {"log_replaced": -0.04}},
        SPREAD_OUT,
    ),
    "force-scale-dgps": NamedWorld(
        "The load cell reads 4 % too much in 2016.", {WITH_DGPS: {"force_scale": 1.04}}
    ),
    "force-scale-logs": NamedWorld(
        "The load cell reads 4 % too much in 2010.", {LOGS_ONLY: {"force_scale": 1.04}}
    ),
    "force-zero": NamedWorld(
        "The load cell reads 10 N without force in 2016.", {WITH_DGPS: {"force_zero_n": 10.0}}
    ),
    "force-zero-drift": NamedWorld(
        "The zero of the load cell drifts from -12 to 12 N within 2016.",
        {WITH_DGPS: {"force_zero_drift_n": 24.0}},
        SPREAD_OUT,
    ),
    "anemometer": NamedWorld(
        "The anemometer reads 0.8 of the wind, always.", {EVER: {"anemometer_scale": 0.8}}
    ),
    "anemometer-one": NamedWorld(
        "The anemometer reads 0.7 of the wind in 2012.",
        {range(2012, 2013): {"anemometer_scale": 0.7}},
    ),
    "vane": NamedWorld(
        "The vane points 15 degrees off, always.", {EVER: {"vane_offset_deg": 15.0}}
    ),
    "tide": NamedWorld("A tide of 0.3 m/s turns during every tow.", {EVER: {"tide_m_s": 0.3}}),
    "fleet-step": NamedWorld(
        "The whole fleet has 3 % less resistance from 2014 on.",
        {SINCE_DGPS: {"fleet_resistance": 0.97}},
    ),
    "askew": NamedWorld(
        "A quarter of the tows is pulled askew until 2013, 5 to 10 %, some 40 %.",
        {
            BEFORE_DGPS: {
                "askew_share": 0.25,
                "askew_excess": (0.05, 0.10),
                "askew_gross_share": 0.05,
                "askew_gross_excess": 0.40,
            }
        },
    ),
    "gps-lag": NamedWorld("The dGPS lags 4 s from 2014 on.", {SINCE_DGPS: {"gps_lag_s": 4.0}}),
    "gps-scale": NamedWorld(
        "The dGPS reads 1 % too much in 2016.", {WITH_DGPS: {"gps_scale": 1.01}}
    ),
    "delft": NamedWorld(
        "Hulls have the resistance of the Delft series.", options={"shape": "delft"}
    ),
    "hump": NamedWorld("Hulls have a marked hump near hull speed.", options={"shape": "hump"}),
    "identical": NamedWorld("Boats of a type are identical.", options={"spread": 0.0}),
    "identical-delft": NamedWorld(
        "Boats of a type are identical, of Delft shape.", options={"spread": 0.0, "shape": "delft"}
    ),
    "slow-tows": NamedWorld(
        "A third of the tows is done at 75 to 90 % of the usual speed.",
        {EVER: {"slow_share": 1 / 3, "slow_ratio": (0.75, 0.90)}},
    ),
    "dropouts": NamedWorld(
        "In 2 % of runs each: log 1 drops to 0, the load cell gives no number, or peaks.",
        {EVER: {"dropout_share": 0.02, "gap_share": 0.02, "spike_share": 0.02}},
    ),
    "two-files": NamedWorld(
        "A quarter of the tows has its runs back in a second file, with a log 2 % off the first.",
        {EVER: {"second_file_share": 0.25, "second_file_log": 0.02}},
    ),
    "lists": NamedWorld(
        "A tenth of the tows with a thwart left free.", {EVER: {"empty_thwart_share": 0.10}}
    ),
    "temperatures": NamedWorld(
        "Until 2013 temperatures are not written down, while the water warms from 4 to 12 C.",
        _warming(4.0, 12.0),
    ),
    "three-links": NamedWorld(
        "Of the boats of 2010 only three are also towed in other seasons.",
        options={"linking_boats": {2010: 3}},
    ),
    "unlinked": NamedWorld(
        "None of the boats of 2010 is towed in another season.",
        options={"linking_boats": {2010: 0}},
    ),
}


def world_settings(name: str, **size: Any) -> WorldSettings:
    """Return the settings of a named world.

    Args:
        name: a key of `WORLDS`.
        size: other fields of `WorldSettings`: seasons, tows_per_season, rate_hz, seed.

    Raises:
        HerijkError: no world has that name.
    """
    if name not in WORLDS:
        raise HerijkError("there is no world {}; there are: {}", name, ", ".join(WORLDS))
    world = WORLDS[name]
    return WorldSettings(defects=world.defects, **world.options, **size)
