"""What every unknown of logs, load cells and boats does to the numbers of a tow.

Belongs here: the list of unknowns, with what is assumed of each, and the slopes of ln Cw, bend and
ln(GPS / log) by them. Does not: any estimate.

A log that reads low (y = true speed / log speed = exp lambda) turns the boat's ln Cw at a speed
and its bend q = r / (1 - r) into

    ln Cw + 2 lambda - ln m,    q z^2 / m,    m = 1 - q (z^2 - 1),    z = y / y0

if they are taken where the log reads that speed over y0: the nearer y0 comes to y, the less the
bend matters.

A load cell that reads exp(phi) times the force adds phi to ln Cw and leaves q. One whose zero is
off by the share g of the force adds g to ln Cw and -(1 + q) g to the bend (method-details, 4).
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from pipeline.arrays import BoolArray, FloatArray
from pipeline.curve import LEAST_MARGIN
from pipeline.season_log.assumed import Settings
from pipeline.season_log.network import Network

LOG: Final = "log_scale"
GPS_SCALE: Final = "gps_scale"
FORCE: Final = "force_scale"
ZERO: Final = "force_zero"
ZERO_DRIFT: Final = "force_zero_drift"
TREND: Final = "log_trend"
CHANGE: Final = "log_change"
WATER: Final = "water_temperature"
FLEET: Final = "fleet_step"
AGEING: Final = "ageing"
WEIGHT: Final = "weight"
LENGTH: Final = "length"
SEASON_BEND: Final = "season_bend"

WAYS: Final = {
    LOG: "speed",
    TREND: "speed",
    CHANGE: "speed",
    GPS_SCALE: "gps",
    FORCE: "level",
    WATER: "level",
    FLEET: "level",
    AGEING: "level",
    WEIGHT: "level",
    LENGTH: "level",
    ZERO: "zero",
    ZERO_DRIFT: "zero",
    SEASON_BEND: "bend",
}
"""By which way an unknown reaches the numbers of a tow."""


OF_BOATS: Final = frozenset({FLEET, AGEING, WEIGHT, LENGTH, SEASON_BEND})
"""Unknowns of boats; all others are of instruments."""

FEWEST_AFTER_CHANGE: Final = 3
"""Fewer tows before or after a change cannot be told from tows that are odd."""


class Unknown(NamedTuple):
    """One unknown: how much of it a tow has, and what is assumed of it.

    Attributes:
        name: what it is.
        season, group: which it is of, where it is of one; `group` is a row of `Network.groups`.
        share: (tows,) how much of it each tow has.
        sd: standard deviation of the prior; of a fault, if there is one.
        chance: that there is such a fault; 1 for what there always is.
        mean: of the prior.
    """

    name: str
    season: int | None
    group: int | None
    share: FloatArray
    sd: float
    chance: float = 1.0
    mean: float = 0.0


def unknowns_of(network: Network, settings: Settings) -> list[Unknown]:
    """All unknowns of an archive: first what there always is, then possible faults."""
    return [*_always(network, settings), *_faults(network, settings)]


def _always(network: Network, settings: Settings) -> Iterator[Unknown]:
    season = network.numbers("season")
    excess = rectification(network, settings)
    for number, year in enumerate(network.groups["season"]):
        mine = network.group == number
        sd, mean = _log_prior(network, number, settings)
        yield Unknown(LOG, year, number, mine * 1.0, sd, mean=mean)
        yield Unknown(SEASON_BEND, year, number, mine * 1.0, settings.season_bend_sd)
        if network.has_gps[number]:
            with_gps = mine & np.isfinite(network.numbers("gps_ln_ratio"))
            sd = float(np.hypot(settings.gps_season_sd, excess[with_gps].mean() / np.sqrt(3.0)))
            yield Unknown(GPS_SCALE, year, number, mine * 1.0, sd)
    for year in np.unique(season).astype(int).tolist():
        sd = _force_sd(network, year, settings)
        yield Unknown(FORCE, year, None, (season == year) * 1.0, sd)
        unrecorded = (season == year) & ~network.tows["temperature_known"].to_numpy()
        if unrecorded.any():
            yield Unknown(WATER, year, None, unrecorded * 1.0, settings.water_sd)
    for name, values, prior in (
        (AGEING, season - settings.reference_year, settings.ageing_per_year),
        (WEIGHT, ln_size(network, "weight_kg"), settings.weight_elasticity),
        (LENGTH, ln_size(network, "waterline_length_m"), settings.length_elasticity),
    ):
        yield Unknown(name, None, None, values, prior.sd, mean=prior.mean)


def _log_prior(network: Network, group: int, settings: Settings) -> tuple[float, float]:
    """Standard deviation and mean of ln factor of a log: by other tows of it with dGPS, if any."""
    if not network.calibrated[group]:
        return settings.log_sd, 0.0
    first = int(np.flatnonzero(network.group == group)[0])
    sd, mean = (network.numbers(f"others_calibration_{name}")[first] for name in ("sd", "ln"))
    return float(sd), float(mean)


def _force_sd(network: Network, year: int, settings: Settings) -> float:
    """Prior standard deviation of a season's load cell: by its records where there are any."""
    recorded = network.tows.filter(season=year)["force_sd"].drop_nulls()
    return settings.force_sd if recorded.is_empty() else float(np.median(recorded.to_numpy()))


def _faults(network: Network, settings: Settings) -> Iterator[Unknown]:
    season, chance = network.numbers("season"), settings.fault_chance
    day = np.nan_to_num(network.numbers("day"))
    years = np.unique(season).astype(int).tolist()
    for year in years:
        mine = season == year
        yield Unknown(FORCE, year, None, mine * 1.0, settings.force_fault_sd, chance)
        yield Unknown(ZERO, year, None, mine * 1.0, settings.zero_fault_n, chance)
        drift = _within(day, mine)
        if drift.any():
            yield Unknown(ZERO_DRIFT, year, None, drift, settings.zero_fault_n, chance)
    for year in years[1:]:
        later = (season >= year) * 1.0
        yield Unknown(FLEET, year, None, later, settings.fleet_fault_sd, chance)
    for number, year in enumerate(network.groups["season"]):
        mine = network.group == number
        drift = _within(day, mine)
        if not drift.any():
            continue
        yield Unknown(TREND, year, number, drift, settings.trend_fault_sd, chance)
        starts = _starts(day[mine])
        for first in starts:
            after = (mine & (day >= first)) * 1.0
            sd, each = settings.change_fault_sd, chance / len(starts)
            yield Unknown(CHANGE, year, number, after, sd, each)


def _within(day: FloatArray, mine: BoolArray) -> FloatArray:
    """Where in its season a tow is, -1 to 1; 0 for other tows, and where all are of one day."""
    span = np.ptp(day[mine]) if mine.any() else 0.0
    if span == 0.0:
        return np.zeros(len(day))
    return np.asarray(np.where(mine, 2.0 * (day - day[mine].min()) / span - 1.0, 0.0))


def _starts(day: FloatArray) -> list[float]:
    """Days on which a log may have been replaced, with tows enough before and after."""
    first = np.unique(day)
    before = (day < first[:, None]).sum(axis=1)
    enough = (before >= FEWEST_AFTER_CHANGE) & (len(day) - before >= FEWEST_AFTER_CHANGE)
    return [float(d) for d in first[enough]]


def rectification(network: Network, settings: Settings) -> FloatArray:
    """Half of the most by which noise across the course can lengthen a velocity, as a ratio."""
    speed = network.numbers("declared_speed_m_s")
    return np.asarray(0.25 * (settings.gps_noise_m_s / speed) ** 2, dtype=np.float64)


def ln_size(network: Network, column: str) -> FloatArray:
    """Ln of a size less its mean over the boat's tows, 0 for boats where a tow has none."""
    size = network.numbers(column)
    known = size > 0
    ln = np.log(np.where(known, size, 1.0))
    usable = network.boat_mean((~known).astype(np.float64)) == 0.0
    return np.where(usable, ln - network.boat_mean(ln), 0.0)


@dataclass(frozen=True)
class Slopes:
    """The numbers of each tow as predicted, and their slopes; n tows.

    Attributes:
        predicted: (n, 3) for a boat of level 0 and its usual bend.
        state: (n, 3, 2) by the boat's level and bend.
        ways: (n, 3) by each way in which an unknown acts.
    """

    predicted: FloatArray
    state: FloatArray
    ways: dict[str, FloatArray]


def slopes(
    q: FloatArray, force_n: FloatArray, ln_factor: FloatArray, reference_ln: FloatArray
) -> Slopes:
    """Predicted numbers of tows, and how they move.

    Args:
        q: usual bend of the boat.
        force_n: force at the reference speed.
        ln_factor: of the log, 0 where calibrated.
        reference_ln: ln y0.
    """
    z2 = np.exp(2.0 * (ln_factor - reference_ln))
    margin = np.maximum(1.0 - q * (z2 - 1.0), LEAST_MARGIN)
    bend = q * z2 / margin
    one, nothing = np.ones(len(q)), np.zeros(len(q))

    def numbers(ln_cw: FloatArray, q_log: FloatArray, gps: FloatArray) -> FloatArray:
        return np.stack([ln_cw, q_log, gps], axis=1)

    by_bend = numbers((z2 - 1.0) / margin, z2 / margin**2, nothing)
    return Slopes(
        numbers(2.0 * ln_factor - np.log(margin), bend, ln_factor),
        np.stack([numbers(one, nothing, nothing), by_bend], axis=2),
        {
            "speed": numbers(2.0 + 2.0 * bend, 2.0 * bend * (1.0 + q) / margin, one),
            "gps": numbers(nothing, nothing, one),
            "level": numbers(one, nothing, nothing),
            "zero": numbers(one, -(1.0 + bend), nothing) / force_n[:, None],
            "bend": by_bend,
        },
    )
