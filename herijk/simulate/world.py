"""A simulated world: boats, which boat is towed when, what each log made of it, and the truth.

Everything that holds for a whole tow is decided here; what happens within its runs, sample by
sample, is in `tow`. The schedule always starts at the first season of the table of instruments,
so that a season holds the same tows whichever other seasons are asked for.
"""

import datetime as dt
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import count
from typing import Final

import numpy as np

from herijk.simulate.boats import (
    ROWERS_PER_THWART,
    Boat,
    Shape,
    crew_kg,
    draw_boat,
    load_hull,
    speed_at_power_m_s,
)
from herijk.simulate.defects import FIRST_SEASON, Defects
from herijk.simulate.hull import REFERENCE_TEMPERATURE_C, AirCoefficients, Hull, true_cw_kg_m
from herijk.simulate.random_streams import Component, Subject, stream
from pipeline.errors import HerijkError

RETOW_YEARS: Final = (4, 3, 5, 4)
"""Years to the next tow, in turn: 3, 4 and 5 from every season link all seasons together."""
FIRST_TOW_DAY: Final = (3, 10)
DECLARATION_TEMPERATURE_C: Final = 8.0
"""Water in spring, at which the declared speed gives the intended power."""
HIGHEST_WEIGHT_GAIN_KG: Final = 8.0
"""A boat weighed after the tow is a little wetter (stated assumption)."""
REPLACED_AT: Final = (0.3, 0.7)
"""Part of a season after which its log is replaced."""
FREE_THWART: Final = "3"
BLOCK_COEFFICIENT: Final = 0.65
"""Waterplane over length times beam: a heavier boat lies deeper (stated assumption)."""
FREEBOARDS: Final = (0.45, 1.0, 0.8)
"""Lowest, at the bow and at the stern, over the height of the bow (stated assumption)."""


@dataclass(frozen=True)
class WorldSettings:
    """What to simulate.

    Args:
        seasons: seasons to simulate, ascending.
        tows_per_season: tows in each.
        rate_hz: samples per second.
        seed: decides everything that is drawn.
        defects: sizes of the defects in a season.
        air: the air coefficients that are true in this world.
        shape: of the boats' resistance.
        spread: of boats of a type, relative to the usual; 0 makes them identical.
        linking_boats: of a season, how many of its boats are also towed in another; else all.
        tows_a_day, days_apart: how a season's tows are spread.
        freeboards_from: first season whose list gives freeboards (Sleepproef, R. Pot 2017).
    """

    seasons: tuple[int, ...] = tuple(range(FIRST_SEASON, 2019))
    tows_per_season: int = 24
    rate_hz: int = 1000
    seed: int = 1
    defects: Callable[[int], Defects] = Defects.history
    air: AirCoefficients = field(default_factory=AirCoefficients)
    shape: Shape = "bow wave"
    spread: float = 1.0
    linking_boats: Mapping[int, int] = field(default_factory=dict)
    tows_a_day: int = 8
    days_apart: int = 1
    freeboards_from: int = 2017

    def __post_init__(self) -> None:
        """Check what a user typed."""
        if not self.seasons or list(self.seasons) != sorted(set(self.seasons)):
            raise HerijkError("seasons must ascend and be at least one; got {}", self.seasons)
        if self.tows_per_season < 1:
            raise HerijkError("at least one tow per season is needed; got {}", self.tows_per_season)
        if not 4 <= self.rate_hz <= 10_000:
            raise HerijkError("the rate must be 4 to 10000 Hz; got {}", self.rate_hz)


@dataclass(frozen=True)
class TowTruth:
    """What the archive does not tell about a tow.

    True speed = log speed x `log_factor`, which is `log_factor_of_day`, of all tows of that day,
    with the tow's own deviation; `second_log_factor` is that of its second file, None without.
    `season_log_factor` is without trend and replaced log. `cw` is at the declared speed and has
    the still-air part in it. `askew_ratio` is true force over straight force; `force_zero_n` is
    what the load cell reads without force; `altered` also when unreported.
    """

    cw_at_tow_temperature_kg_m: float
    cw_at_15c_kg_m: float
    season_log_factor: float
    log_factor_of_day: float
    log_factor: float
    second_log_factor: float | None
    log2_ratio: float
    force_zero_n: float
    askew_ratio: float
    altered: bool


@dataclass(frozen=True)
class Tow:
    """One tow: what the list says about it, its true hull and the truth.

    `freeboards_m` are the lowest, at the bow and at the stern; `listed_temperature_c` is None
    where the list does not give it.
    """

    tow_id: str
    season: int
    number: int
    day: dt.date
    boat: Boat
    rowers: int
    crew_class: str
    declared_speed_m_s: float
    weight_kg: float
    weight_after_kg: float
    water_temperature_c: float
    salinity_g_kg: float
    listed_temperature_c: float | None
    freeboards_m: tuple[float, float, float] | None
    altered_reported: bool
    fast_run: bool
    hull: Hull
    truth: TowTruth

    @property
    def samples_name(self) -> str:
        """Name of the samples file without extension, e.g. `vlet 012 6h 2014`."""
        return f"{self.boat.name} {self.rowers}{self.crew_class.lower()} {self.season}"

    @property
    def second_name(self) -> str:
        """Name of the second samples file without extension; empty where there is none."""
        return "" if self.truth.second_log_factor is None else f"{self.samples_name} b"

    @property
    def free_thwart(self) -> str:
        """The thwart left free; empty with a full crew."""
        return FREE_THWART if self.rowers < self.boat.boat_type.rowers else ""

    @property
    def crew_kg(self) -> float:
        """Weight of the crew on board."""
        return crew_kg(self.crew_class, self.rowers)


@dataclass(frozen=True)
class World:
    """Boats and tows of the seasons asked for."""

    settings: WorldSettings
    boats: tuple[Boat, ...]
    tows: tuple[Tow, ...]
    season_log_factors: dict[int, float]


@dataclass(frozen=True)
class _Slot:
    """A place in the schedule: this crew of this boat is towed as number so many."""

    season: int
    number: int
    boat_index: int
    crew_class: str


@dataclass(frozen=True)
class _Condition:
    """State of a boat in one season, by age and by everything altered since it was built."""

    resistance: float
    weight: float
    altered_seasons: Sequence[int]
    reported_seasons: Sequence[int]


def simulate_world(settings: WorldSettings) -> World:
    """Decide boats, schedule, season factors and the truth of every tow.

    Raises:
        MissingKnowledgeError: a season before the first in the table of instruments.
    """
    factors = {}
    for season in settings.seasons:
        low, high = settings.defects(season).log_season_factor
        factors[season] = float(stream(settings.seed, Subject.SEASON, season).uniform(low, high))

    @cache
    def boat(index: int) -> Boat:
        rng = stream(settings.seed, Subject.BOAT, index)
        return draw_boat(index, rng, settings.shape, settings.spread)

    slots = _schedule(settings, boat)
    history: dict[int, list[int]] = {}
    crew_history: dict[tuple[int, str], int] = {}
    tows: list[Tow] = []
    for slot in slots:
        seasons = history.setdefault(slot.boat_index, [])
        if slot.season not in seasons:
            seasons.append(slot.season)
        crew = (slot.boat_index, slot.crew_class)
        previous = crew_history.get(crew, slot.season)
        crew_history[crew] = slot.season
        if slot.season in factors:
            tows.append(
                _tow(
                    settings,
                    slot,
                    boat(slot.boat_index),
                    condition=_condition(settings, slot.boat_index, seasons),
                    previous_season=previous,
                    season_log_factor=factors[slot.season],
                )
            )
    indices = sorted({tow.boat.index for tow in tows})
    return World(settings, tuple(boat(i) for i in indices), tuple(tows), factors)


def _schedule(settings: WorldSettings, boat: Callable[[int], Boat]) -> list[_Slot]:
    """Schedule tows: boats that are due, longest waiting first, then new boats."""
    newcomers = ((index, crew) for index in count() for crew in boat(index).crew_classes)
    due: dict[tuple[int, str], int] = {}
    slots: list[_Slot] = []
    for season in range(FIRST_SEASON, settings.seasons[-1] + 1):
        waiting = sorted((when, crew) for crew, when in due.items() if when <= season)
        linking = settings.linking_boats.get(season, settings.tows_per_season)
        crews = [crew for _, crew in waiting[: min(linking, settings.tows_per_season)]]
        while len(crews) < settings.tows_per_season:
            crews.append(next(newcomers))
        for number, crew in enumerate(crews, start=1):
            due.pop(crew, None)
            if number <= linking:
                due[crew] = season + RETOW_YEARS[(number - 1) % len(RETOW_YEARS)]
            slots.append(_Slot(season, number, *crew))
    return slots


def _condition(settings: WorldSettings, boat_index: int, seasons: Sequence[int]) -> _Condition:
    """Return the state of a boat in the last of the `seasons` in which it was towed so far."""
    resistance, weight = 1.0, 1.0
    altered: list[int] = []
    reported: list[int] = []
    for season in seasons[1:]:
        defects = settings.defects(season)
        rng = stream(settings.seed, Subject.ALTERATION, boat_index, season)
        chance, hidden = rng.random(2)
        size, weight_size = rng.standard_normal(2)
        if chance < defects.alteration_share:
            resistance *= float(np.exp(defects.alteration_sd * size))
            weight *= float(np.exp(defects.alteration_weight_sd * weight_size))
            altered.append(season)
            if hidden >= defects.unreported_share:
                reported.append(season)
    age_years = seasons[-1] - FIRST_SEASON
    now = settings.defects(seasons[-1])
    resistance *= (1.0 + now.ageing_per_year) ** age_years * now.fleet_resistance
    return _Condition(resistance, weight, altered, reported)


def _tow(
    settings: WorldSettings,
    slot: _Slot,
    boat: Boat,
    *,
    condition: _Condition,
    previous_season: int,
    season_log_factor: float,
) -> Tow:
    defects = settings.defects(slot.season)

    def draw(component: Component) -> np.random.Generator:
        return stream(settings.seed, Subject.TOW, slot.season, slot.number, component)

    weight_kg = float(round(boat.weight_kg * condition.weight))
    has_free_thwart = draw(Component.EMPTY_THWART).random() < defects.empty_thwart_share
    rowers = boat.boat_type.rowers - (ROWERS_PER_THWART if has_free_thwart else 0)
    on_board_kg = crew_kg(slot.crew_class, rowers)
    hull = load_hull(boat, on_board_kg, weight_kg, condition.resistance)
    day = (slot.number - 1) // settings.tows_a_day
    day_rng = stream(settings.seed, Subject.DAY, slot.season, day)
    temperature_c = round(float(day_rng.uniform(*defects.water_temperature_c)), 1)
    listed = draw(Component.TEMPERATURE).random() >= defects.temperature_missing_share
    declared = _choose_declared_speed(settings, boat, slot.crew_class, rowers)
    slow_rng = draw(Component.SLOW)
    is_slow = slow_rng.random() < defects.slow_share
    slow_ratio = float(slow_rng.uniform(*defects.slow_ratio))
    declared = round(declared * (slow_ratio if is_slow else 1.0), 2)

    def cw(at_c: float, salinity_g_kg: float = 0.0) -> float:
        speed_m_s = np.array(declared)
        return float(true_cw_kg_m(hull, speed_m_s, at_c, settings.air, salinity_g_kg))

    of_day = season_log_factor * _log_change(settings, slot.season, day)
    deviation = float(draw(Component.LOG_OF_TOW).standard_normal())
    log_factor = of_day * float(np.exp(defects.log_tow_sd * deviation))
    two_files = draw(Component.SECOND_FILE).random() < defects.second_file_share
    return Tow(
        tow_id=f"{slot.season}-{slot.number:03d}",
        season=slot.season,
        number=slot.number,
        day=dt.date(slot.season, *FIRST_TOW_DAY) + dt.timedelta(days=day * settings.days_apart),
        boat=boat,
        rowers=rowers,
        crew_class=slot.crew_class,
        declared_speed_m_s=declared,
        weight_kg=weight_kg,
        weight_after_kg=weight_kg
        + round(float(draw(Component.SCALES).uniform(0.0, HIGHEST_WEIGHT_GAIN_KG))),
        water_temperature_c=temperature_c,
        salinity_g_kg=defects.salinity_g_kg,
        listed_temperature_c=temperature_c if listed else None,
        freeboards_m=_freeboards_m(settings, slot.season, boat, weight_kg),
        altered_reported=any(s > previous_season for s in condition.reported_seasons),
        fast_run=bool(draw(Component.FAST_RUN).random() < defects.fast_run_share),
        hull=hull,
        truth=TowTruth(
            cw_at_tow_temperature_kg_m=cw(temperature_c, defects.salinity_g_kg),
            cw_at_15c_kg_m=cw(REFERENCE_TEMPERATURE_C),
            season_log_factor=season_log_factor,
            log_factor_of_day=of_day,
            log_factor=log_factor,
            second_log_factor=(
                log_factor * float(np.exp(defects.second_file_log)) if two_files else None
            ),
            log2_ratio=float(draw(Component.LOG2_RATIO).uniform(*defects.log2_ratio)),
            force_zero_n=defects.force_zero_n
            + defects.force_zero_drift_n * _place_in_season(settings, day)
            + defects.force_zero_tow_n * float(draw(Component.FORCE_ZERO).standard_normal()),
            askew_ratio=1.0 + _askew_excess(defects, draw(Component.ASKEW)),
            altered=any(s > previous_season for s in condition.altered_seasons),
        ),
    )


def _place_in_season(settings: WorldSettings, day: int) -> float:
    """Return -0.5 on the first day of tows, 0.5 on the last, 0 if there is one only."""
    last = (settings.tows_per_season - 1) // settings.tows_a_day
    return day / last - 0.5 if last else 0.0


def _log_change(settings: WorldSettings, season: int, day: int) -> float:
    """Return the factor of fouling and of a log replaced in mid-season on the season's log."""
    defects = settings.defects(season)
    replaced_at = stream(settings.seed, Subject.LOG_REPLACED, season).uniform(*REPLACED_AT)
    place = _place_in_season(settings, day)
    replaced = place + 0.5 > replaced_at
    return float(np.exp(defects.log_trend * place + defects.log_replaced * replaced))


def _freeboards_m(
    settings: WorldSettings, season: int, boat: Boat, weight_kg: float
) -> tuple[float, float, float] | None:
    """Return freeboards of the empty boat; a heavier one lies deeper."""
    if season < settings.freeboards_from:
        return None
    waterplane_m2 = BLOCK_COEFFICIENT * boat.waterline_length_m * boat.beam_m
    deeper_m = (weight_kg - boat.boat_type.weight_kg) / (1000.0 * waterplane_m2)
    lowest = round(boat.bow_height_m * FREEBOARDS[0] - deeper_m, 3)
    bow = round(boat.bow_height_m * FREEBOARDS[1] - deeper_m, 3)
    stern = round(boat.bow_height_m * FREEBOARDS[2] - deeper_m, 3)
    return lowest, bow, stern


def _choose_declared_speed(
    settings: WorldSettings, boat: Boat, crew_class: str, rowers: int
) -> float:
    """Return the speed that asks the intended power of the boat as built; kept at later tows."""
    as_built = load_hull(boat, crew_kg(crew_class, rowers), boat.weight_kg, condition=1.0)
    speed = speed_at_power_m_s(
        as_built,
        boat.target_power_w(crew_class),
        rowers,
        DECLARATION_TEMPERATURE_C,
        settings.air,
    )
    return round(speed, 2)


def _askew_excess(defects: Defects, rng: np.random.Generator) -> float:
    askew, gross, position = rng.random(3)
    if askew >= defects.askew_share:
        return 0.0
    if gross < defects.askew_gross_share:
        return defects.askew_gross_excess
    low, high = defects.askew_excess
    return float(low + position * (high - low))
