"""The observation model: what the unknowns do to the three numbers of a tow.

With lambda = ln(true speed / log speed) of a tow, z = exp(lambda) over the reference, theta and q
the level and bend of its boat, and m = 1 - q (z^2 - 1):

    ln Cw          = theta + 2 lambda - ln m    + level effects + zero / F       + noise
    q as read      = q z^2 / m                  + bend effects  - (1 + q) zero/F + noise
    ln(GPS / log)  = lambda                     + GPS effects                    + noise

An unknown (`Effect`) reaches these numbers through one channel:

    channel  d(ln Cw, q, ln GPS/log)                       used by
    log      2 + 2 q',  2 q' (1 + q) / m,  1               scale of a log, its trend, its change
    level    1, 0, 0                                       load cell, temperature, fleet, ageing
    zero     1 / F,  -(1 + q') / F,  0                     zero of the load cell
    gps      0, 0, 1                                       scale of plain GPS
    bend     (z^2 - 1) / m,  z^2 / m^2,  0                 bend of all boats in a season

where q' = q z^2 / m. The first two rows follow from what a scale error of the speed does to the
hyperbola A / (1 - (v/B)^2) exactly (docs/method-details.md, 4).
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from pipeline.arrays import BoolArray, FloatArray, IntArray, StrArray
from pipeline.curve import LEAST_MARGIN
from pipeline.season_log.archive import Archive, average_over_boat, to_numpy
from pipeline.season_log.priors import Priors

LOG_SCALE: Final = "log_scale"
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

CHANNEL: Final = {
    LOG_SCALE: "log",
    TREND: "log",
    CHANGE: "log",
    FORCE: "level",
    WATER: "level",
    FLEET: "level",
    AGEING: "level",
    WEIGHT: "level",
    LENGTH: "level",
    ZERO: "zero",
    ZERO_DRIFT: "zero",
    GPS_SCALE: "gps",
    SEASON_BEND: "bend",
}
BOAT_EFFECTS: Final = (FLEET, AGEING, WEIGHT, LENGTH, SEASON_BEND)
"""Effects on the boats themselves; all others are errors of instruments."""

MIN_TOWS_AFTER_CHANGE: Final = 3
"""Fewer tows before or after a change of the log cannot be told from tows that are odd."""


@dataclass(frozen=True)
class Linearization:
    """The forward model at given ln factors of the logs; n tows.

    Attributes:
        predicted: (n, 3) numbers of a boat of level 0 and its usual bend.
        by_boat: (n, 3, 2) derivatives by the boat's level and bend.
        by_channel: channel -> (n, 3) derivatives by an effect of that channel.
    """

    predicted: FloatArray
    by_boat: FloatArray
    by_channel: dict[str, FloatArray]


def linearize(
    usual_bend: FloatArray, force_n: FloatArray, ln_factor: FloatArray, reference_ln: FloatArray
) -> Linearization:
    """Return predictions and derivatives at given ln factors of the logs, (n,) each."""
    z2 = np.exp(2.0 * (ln_factor - reference_ln))
    m = np.maximum(1.0 - usual_bend * (z2 - 1.0), LEAST_MARGIN)
    bend_as_read = usual_bend * z2 / m
    one = np.ones(len(usual_bend))
    zero = np.zeros(len(usual_bend))
    level = np.stack([one, zero, zero], axis=1)
    bend = np.stack([(z2 - 1.0) / m, z2 / m**2, zero], axis=1)
    by_log = [2.0 + 2.0 * bend_as_read, 2.0 * bend_as_read * (1.0 + usual_bend) / m, one]
    return Linearization(
        predicted=np.stack([2.0 * ln_factor - np.log(m), bend_as_read, ln_factor], axis=1),
        by_boat=np.stack([level, bend], axis=2),
        by_channel={
            "log": np.stack(by_log, axis=1),
            "level": level,
            "zero": np.stack([one, -(1.0 + bend_as_read), zero], axis=1) / force_n[:, None],
            "gps": np.stack([zero, zero, one], axis=1),
            "bend": bend,
        },
    )


@dataclass(frozen=True)
class Effect:
    """One unknown of the model: a named column of the design, with its prior.

    Attributes:
        name: what it is.
        season, part: of which season or log it is; None and 0 for effects of the archive.
        covariate: (n,) by how much each tow has it.
        sd, mean: of its normal prior; of a fault, if there is one.
        probability: that there is such a fault; 1 for an effect that is always in the model.
        first_tow: the tow from which a log is another one.
    """

    name: str
    season: int | None
    part: int
    covariate: FloatArray
    sd: float
    mean: float = 0.0
    probability: float = 1.0
    first_tow: str | None = None

    @property
    def kind(self) -> tuple[str, int | None, int]:
        """What all days on which one log may have changed have in common."""
        return self.name, self.season, self.part

    @property
    def label(self) -> str:
        """Name with season, for people."""
        return self.name if self.season is None else f"{self.name} {self.season}"


@dataclass(frozen=True)
class Effects:
    """All effects of an archive: first those always in the model, then candidate faults."""

    listed: tuple[Effect, ...]

    @cached_property
    def covariate(self) -> FloatArray:
        """By how much each tow has each effect, (n, e)."""
        return np.stack([effect.covariate for effect in self.listed], axis=1)

    @cached_property
    def name(self) -> StrArray:
        """Names, (e,)."""
        return np.array([effect.name for effect in self.listed])

    @cached_property
    def channel(self) -> StrArray:
        """Channels, (e,)."""
        return np.array([CHANNEL[effect.name] for effect in self.listed])

    @cached_property
    def mean(self) -> FloatArray:
        """Prior means, (e,)."""
        return np.array([effect.mean for effect in self.listed])

    @cached_property
    def variance(self) -> FloatArray:
        """Prior variances, (e,)."""
        return np.array([effect.sd**2 for effect in self.listed])

    @cached_property
    def probability(self) -> FloatArray:
        """Prior probabilities, (e,)."""
        return np.array([effect.probability for effect in self.listed])

    @property
    def permanent(self) -> IntArray:
        """Places of the effects that are always in the model."""
        return np.flatnonzero(self.probability == 1.0)

    @property
    def faults(self) -> IntArray:
        """Places of the candidate faults."""
        return np.flatnonzero(self.probability < 1.0)

    def design(self, linear: Linearization, chosen: IntArray) -> FloatArray:
        """Return the design matrix: derivatives of the numbers by some effects, (n, 3, chosen)."""
        channels = list(linear.by_channel)
        by_channel = np.stack(list(linear.by_channel.values()), axis=2)
        place = [channels.index(channel) for channel in self.channel[chosen]]
        return np.asarray(by_channel[:, :, place] * self.covariate[:, None, chosen])


def list_effects(archive: Archive, priors: Priors) -> Effects:
    """Return every effect that an archive may show."""
    effects = list(_list_permanent_effects(archive, priors))
    effects += _list_season_faults(archive, priors)
    effects += _list_log_faults(archive, priors)
    return Effects(tuple(effects))


def _list_permanent_effects(archive: Archive, priors: Priors) -> Iterator[Effect]:
    for place, log in enumerate(archive.logs.iter_rows(named=True)):
        own = (archive.log == place).astype(np.float64)
        season, part = log["season"], log["part"]
        if log["calibrated"]:
            yield Effect(LOG_SCALE, season, part, own, sd=log["prior_sd"], mean=log["prior_ln"])
        else:
            yield Effect(LOG_SCALE, season, part, own, sd=priors.log_sd)
        yield Effect(SEASON_BEND, season, part, own, sd=priors.season_bend_sd)
        if log["has_gps"]:
            yield Effect(GPS_SCALE, season, part, own, sd=priors.gps_season_sd)
    is_unrecorded = ~archive.frame["temperature_known"].to_numpy()
    recorded_force_sd = archive.column("force_sd")
    for year in _list_seasons(archive):
        in_season = archive.season == year
        records = recorded_force_sd[in_season & np.isfinite(recorded_force_sd)]
        force_sd = float(np.median(records)) if len(records) else priors.force_sd
        yield Effect(FORCE, year, 0, in_season.astype(np.float64), sd=force_sd)
        if (in_season & is_unrecorded).any():
            unrecorded = (in_season & is_unrecorded).astype(np.float64)
            yield Effect(WATER, year, 0, unrecorded, sd=priors.water_sd)
    years: FloatArray = archive.season - float(priors.reference_year)
    ln_weight = _compute_ln_change(archive, "weight_kg")
    ln_length = _compute_ln_change(archive, "waterline_length_m")
    of_boats = (
        (AGEING, years, priors.ageing_per_year),
        (WEIGHT, ln_weight, priors.weight_elasticity),
        (LENGTH, ln_length, priors.length_elasticity),
    )
    for name, covariate, prior in of_boats:
        yield Effect(name, None, 0, covariate, sd=prior.sd, mean=prior.mean)


def _list_season_faults(archive: Archive, priors: Priors) -> Iterator[Effect]:
    """List the faults that any season may have: load cell, its zero, and a step of the fleet."""
    p = priors.fault_probability
    in_seasons = [(year, archive.season == year) for year in _list_seasons(archive)]
    for year, own in in_seasons:
        yield Effect(FORCE, year, 0, own * 1.0, sd=priors.force_fault_sd, probability=p)
    for year, own in in_seasons:
        yield Effect(ZERO, year, 0, own * 1.0, sd=priors.zero_fault_n, probability=p)
    for year, own in in_seasons:
        if (ramp := _make_ramp(archive.day, own)) is not None:
            yield Effect(ZERO_DRIFT, year, 0, ramp, sd=priors.zero_fault_n, probability=p)
    for year, _ in in_seasons[1:]:
        later = (archive.season >= year).astype(np.float64)
        fleet = priors.fleet_probability
        yield Effect(FLEET, year, 0, later, sd=priors.fleet_fault_sd, probability=fleet)


def _list_log_faults(archive: Archive, priors: Priors) -> Iterator[Effect]:
    """List the faults that a log without dGPS may have: a trend, and an unreported replacement."""
    p = priors.fault_probability
    logs = archive.logs.select("season", "part").rows()
    for place, (season, part) in enumerate(logs):
        if (ramp := _make_ramp(archive.day, archive.log == place)) is not None:
            yield Effect(TREND, season, part, ramp, sd=priors.trend_fault_sd, probability=p)
    tow_id = archive.frame["tow_id"].to_numpy()
    for place, (season, part) in enumerate(logs):
        own = archive.log == place
        starts = []
        for day in np.unique(archive.day[own]):
            after = own & (archive.day >= day)
            if MIN_TOWS_AFTER_CHANGE <= after.sum() <= own.sum() - MIN_TOWS_AFTER_CHANGE:
                starts.append((after, tow_id[after & (archive.day == day)].min()))
        for after, first_tow in starts:
            yield Effect(
                name=CHANGE,
                season=season,
                part=part,
                covariate=after * 1.0,
                sd=priors.change_fault_sd,
                probability=p / len(starts),
                first_tow=str(first_tow),
            )


def _list_seasons(archive: Archive) -> list[int]:
    return list(map(int, np.unique(archive.season)))


def _make_ramp(day: FloatArray, own: BoolArray) -> FloatArray | None:
    """Return -1 to 1 in the course of the days of some tows, 0 for others; None within one day."""
    first = day[own].min()
    span = np.ptp(day[own])
    if span == 0.0:
        return None
    return np.asarray(own * (2.0 * (day - first) / span - 1.0))


def _compute_ln_change(archive: Archive, column: str) -> FloatArray:
    """Return ln size less its mean over the boat's tows; 0 where a tow of the boat has none."""
    size = to_numpy(archive.frame, column)
    is_known = size > 0
    ln_size = np.log(np.where(is_known, size, 1.0))
    boat_is_known = average_over_boat((~is_known).astype(np.float64), archive.boat) == 0.0
    return np.where(boat_is_known, ln_size - average_over_boat(ln_size, archive.boat), 0.0)
