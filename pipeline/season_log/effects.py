"""What every unknown of logs, load cells and boats does to the numbers of a tow.

Belongs here: the effects, with what is assumed of each, and the slopes of ln Cw, bend and
ln(GPS / log) by them. Does not: any estimate.

A log that reads low (y = true speed / log speed = exp lambda) turns the boat's ln Cw at a speed
and its bend q = r / (1 - r) into

    ln Cw + 2 lambda - ln m,    q z^2 / m,    m = 1 - q (z^2 - 1),    z = y / y0

if they are taken where the log reads that speed over y0: the nearer y0 comes to y, the less the
bend matters.

A load cell that reads exp(phi) times the force adds phi to ln Cw and leaves q. One whose zero is
off by the share g of the force adds g to ln Cw and -(1 + q) g to the bend (method-details, 4).
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Final, NamedTuple, Self

import numpy as np
import polars as pl

from pipeline.arrays import BoolArray, FloatArray, IntArray
from pipeline.curve import LEAST_MARGIN
from pipeline.season_log.archive_tows import LOG, ArchiveTows
from pipeline.season_log.assumed import Settings

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

WAYS: Final = {
    **dict.fromkeys((LOG_SCALE, TREND, CHANGE), "speed"),
    **dict.fromkeys((FORCE, WATER, FLEET, AGEING, WEIGHT, LENGTH), "level"),
    **dict.fromkeys((ZERO, ZERO_DRIFT), "zero"),
    GPS_SCALE: "gps",
    SEASON_BEND: "bend",
}
"""By which way an effect reaches the numbers of a tow."""

OF_BOATS: Final = (FLEET, AGEING, WEIGHT, LENGTH, SEASON_BEND)
"""Effects of boats; all others are of instruments."""

FEWEST_AFTER_CHANGE: Final = 3
"""Fewer tows before or after a change cannot be told from tows that are odd."""


class Effect(NamedTuple):
    """One unknown: how much of it a tow has, and what is assumed of it.

    Attributes:
        name: what it is.
        season, part: which it is of, where it is of one.
        share: (tows,) how much of it each tow has.
        sd, mean: of the prior; of a fault, if there is one.
        chance: that there is such a fault; 1 for what there always is.
        first_tow: where it begins, of a log that changed.
    """

    name: str
    season: int | None
    part: int
    share: FloatArray
    sd: float
    mean: float = 0.0
    chance: float = 1.0
    first_tow: str | None = None


@dataclass(frozen=True)
class Effects:
    """All effects of an archive: first what there always is, then candidate faults; e effects.

    Attributes:
        frame: a row each, as `Effect` without `share`; `variance` of the prior; `way`; `label`, the
            name with its season; `kind`, a number that all places where one log may have changed
            have in common.
        share: (tows, e) how much of each a tow has.
        always, faults: places of what there always is, and of faults that there may be.
    """

    frame: pl.DataFrame
    share: FloatArray
    always: IntArray
    faults: IntArray

    @classmethod
    def of(cls, tows: ArchiveTows, settings: Settings) -> Self:
        """The effects there may be in an archive."""
        listed = [*_always(tows, settings), *_faults(tows, settings)]
        rows = pl.DataFrame(listed, orient="row", schema_overrides={"first_tow": pl.String})
        season, is_fault = pl.col("season").cast(pl.String), pl.col("chance") < 1.0
        frame = rows.drop("share").with_columns(
            variance=pl.col("sd") ** 2,
            way=pl.col("name").replace_strict(WAYS),
            label=pl.concat_str("name", season, separator=" ", ignore_nulls=True),
            kind=pl.struct("name", "season", "part", is_fault).rank("dense"),
        )
        faulty = frame.select(is_fault).to_series().to_numpy()
        share = np.stack([effect.share for effect in listed], axis=1)
        return cls(frame, share, np.flatnonzero(~faulty), np.flatnonzero(faulty))

    def column(self, name: str, chosen: IntArray) -> Any:
        """A column of `frame` for some effects, as an array."""
        return self.frame[name].to_numpy()[chosen]

    def design(self, slopes: "Slopes", chosen: IntArray) -> FloatArray:
        """Slopes of the numbers by some effects, (tows, 3, chosen)."""
        by = np.stack([slopes.ways[way] for way in self.column("way", chosen)], axis=2)
        return np.asarray(by * self.share[:, None, chosen])


def _always(tows: ArchiveTows, settings: Settings) -> Iterator[Effect]:
    season = tows.numbers("season")
    for place, log in enumerate(tows.logs.iter_rows(named=True)):
        mine, year, part = (tows.log == place) * 1.0, log["season"], log["part"]
        sd, mean = (settings.log_sd, 0.0)
        if log["calibrated"]:
            sd, mean = log["prior_sd"], log["prior_ln"]
        yield Effect(LOG_SCALE, year, part, mine, sd, mean)
        yield Effect(SEASON_BEND, year, part, mine, settings.season_bend_sd)
        if log["has_gps"]:
            yield Effect(GPS_SCALE, year, part, mine, settings.gps_season_sd)
    for year in np.unique(season).astype(int).tolist():
        recorded = tows.frame.filter(season=year)["force_sd"].drop_nulls().to_numpy()
        sd = float(np.median(recorded)) if len(recorded) else settings.force_sd
        yield Effect(FORCE, year, 0, (season == year) * 1.0, sd)
        unrecorded = (season == year) & ~tows.frame["temperature_known"].to_numpy()
        if unrecorded.any():
            yield Effect(WATER, year, 0, unrecorded * 1.0, settings.water_sd)
    for name, values, prior in (
        (AGEING, season - settings.reference_year, settings.ageing_per_year),
        (WEIGHT, ln_size(tows, "weight_kg"), settings.weight_elasticity),
        (LENGTH, ln_size(tows, "waterline_length_m"), settings.length_elasticity),
    ):
        yield Effect(name, None, 0, values, prior.sd, prior.mean)


Design = Callable[[FloatArray, FloatArray, BoolArray], list[FloatArray]]
"""From the season and day of every tow and which are of one season or log, (tows,) each: how much
each tow has of a fault there, (tows,); as many as there are places where it may begin."""


def _throughout(_season: FloatArray, _day: FloatArray, mine: BoolArray) -> list[FloatArray]:
    return [mine.astype(np.float64)]


def _from_then_on(season: FloatArray, _day: FloatArray, mine: BoolArray) -> list[FloatArray]:
    """From a season on; not from the first."""
    later = season >= season[mine].min()
    return [] if later.all() else [later.astype(np.float64)]


def _drifting(_season: FloatArray, day: FloatArray, mine: BoolArray) -> list[FloatArray]:
    """From -1 to 1 in the course of a season; nothing where all tows are of one day."""
    first, span = float(day[mine].min()), float(np.ptp(day[mine]))
    if span == 0.0:
        return []
    return [mine * (2.0 * (day - first) / span - 1.0)]


def _replaced(_season: FloatArray, day: FloatArray, mine: BoolArray) -> list[FloatArray]:
    """From each day on that has tows enough before and after."""
    after = [mine & (day >= start) for start in np.unique(day[mine])]
    least, most = FEWEST_AFTER_CHANGE, mine.sum() - FEWEST_AFTER_CHANGE
    return [share * 1.0 for share in after if least <= share.sum() <= most]


FAULTS: Final[tuple[tuple[str, str, str, Design], ...]] = (
    (FORCE, "season", "force_fault_sd", _throughout),
    (ZERO, "season", "zero_fault_n", _throughout),
    (ZERO_DRIFT, "season", "zero_fault_n", _drifting),
    (FLEET, "season", "fleet_fault_sd", _from_then_on),
    (TREND, "log", "trend_fault_sd", _drifting),
    (CHANGE, "log", "change_fault_sd", _replaced),
)
"""Every fault that there may be: its name, what has one, its size in `Settings`, its design."""


def _faults(tows: ArchiveTows, settings: Settings) -> Iterator[Effect]:
    season, day = tows.numbers("season"), np.nan_to_num(tows.numbers("day"))
    of = {
        "season": [(y, 0, season == y) for y in np.unique(season).astype(int).tolist()],
        "log": [(*log, tows.log == i) for i, log in enumerate(tows.logs.select(LOG).rows())],
    }
    names = tows.frame["tow_id"].to_numpy()
    for name, whose, size, design in FAULTS:
        for year, part, mine in of[whose]:
            shares = design(season, day, mine)
            for share in shares:
                begins = day == day[share > 0.0].min() if name == CHANGE else None
                first = None if begins is None else names[begins & (share > 0.0)].min()
                sd, chance = getattr(settings, size), settings.fault_chance / len(shares)
                yield Effect(name, year, part, share, sd, 0.0, chance, first)


def ln_size(tows: ArchiveTows, column: str) -> FloatArray:
    """Ln of a size less its mean over the boat's tows, 0 for boats where a tow has none."""
    size = tows.numbers(column)
    known = size > 0
    ln = np.log(np.where(known, size, 1.0))
    usable = tows.boat_mean((~known).astype(np.float64)) == 0.0
    return np.where(usable, ln - tows.boat_mean(ln), 0.0)


@dataclass(frozen=True)
class Slopes:
    """The numbers of each tow as predicted, and their slopes; n tows.

    Attributes:
        predicted: (n, 3) for a boat of level 0 and its usual bend.
        state: (n, 3, 2) by the boat's level and bend.
        ways: (n, 3) by each way in which an effect acts.
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
