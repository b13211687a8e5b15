"""A simulated world: boats, which boat is towed when, what each log made of it, and the truth.

Everything that holds for a whole tow is decided here; what happens within its runs, sample by
sample, is in `tow`. The schedule always starts at the first season of the table of instruments,
so that a season holds the same tows whichever other seasons are asked for.
"""

import datetime as dt
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cache
from typing import Final

import numpy as np

from herijk.pipeline.errors import HerijkError
from herijk.simulate.boats import Boat, draw_boat, loaded_hull, speed_at_power_m_s
from herijk.simulate.defects import FIRST_SEASON, Defects
from herijk.simulate.hull import REFERENCE_TEMPERATURE_C, AirCoefficients, Hull, true_cw_kg_m
from herijk.simulate.random_streams import Component, Subject, stream

RETOW_YEARS: Final = (4, 3, 5, 4)
"""Years to the next tow, in turn: 3, 4 and 5 from every season link all seasons together."""
FIRST_TOW_DAY: Final = (3, 10)
TOWS_A_DAY: Final = 8
DECLARATION_TEMPERATURE_C: Final = 8.0
"""Water in spring, at which the declared speed gives the intended power."""
HIGHEST_WEIGHT_GAIN_KG: Final = 8.0
"""A boat weighed after the tow is a little wetter (stated assumption)."""


@dataclass(frozen=True)
class WorldSettings:
    """What to simulate.

    Args:
        seasons: seasons to simulate, ascending.
        tows_per_season: tows in each.
        rate_hz: samples a second.
        seed: decides everything that is drawn.
        defects: sizes of the defects in a season.
        air: the air coefficients that are true in this world.
    """

    seasons: tuple[int, ...] = tuple(range(FIRST_SEASON, 2019))
    tows_per_season: int = 24
    rate_hz: int = 1000
    seed: int = 1
    defects: Callable[[int], Defects] = Defects.history
    air: AirCoefficients = field(default_factory=AirCoefficients)

    def __post_init__(self) -> None:
        """Check what a user typed."""
        if not self.seasons or list(self.seasons) != sorted(set(self.seasons)):
            raise HerijkError(f"seasons must ascend and be at least one; got {self.seasons}")
        if self.tows_per_season < 1:
            raise HerijkError(f"at least one tow a season is needed; got {self.tows_per_season}")
        if not 4 <= self.rate_hz <= 10_000:
            raise HerijkError(f"the rate must be 4 to 10000 Hz; got {self.rate_hz}")


@dataclass(frozen=True)
class TowTruth:
    """What the archive does not tell about a tow.

    True speed = log speed x `log_factor`. `cw` is at the declared speed and has the still-air
    part in it. `askew_ratio` is true force over straight force; `altered` also when unreported.
    """

    cw_at_tow_temperature_kg_m: float
    cw_at_15c_kg_m: float
    season_log_factor: float
    log_factor: float
    log2_ratio: float
    askew_ratio: float
    altered: bool


@dataclass(frozen=True)
class Tow:
    """One tow: what the list says about it, its true hull and the truth."""

    tow_id: str
    season: int
    number: int
    day: dt.date
    boat: Boat
    crew_class: str
    declared_speed_m_s: float
    weight_kg: float
    weight_after_kg: float
    water_temperature_c: float
    altered_reported: bool
    fast_run: bool
    hull: Hull
    truth: TowTruth

    @property
    def samples_name(self) -> str:
        """Name of the samples file without extension, e.g. `vlet 012 6h 2014`."""
        return (
            f"{self.boat.name} {self.boat.boat_type.rowers}{self.crew_class.lower()} {self.season}"
        )


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

    resistance: float = 1.0
    weight: float = 1.0
    altered_seasons: tuple[int, ...] = ()
    reported_seasons: tuple[int, ...] = ()


def simulate_world(settings: WorldSettings) -> World:
    """Decide boats, schedule, season factors and the truth of every tow.

    Raises:
        MissingKnowledgeError: a season before the first in the table of instruments.
    """
    for season in settings.seasons:
        settings.defects(season)

    @cache
    def boat(index: int) -> Boat:
        return draw_boat(index, stream(settings.seed, Subject.BOAT, index))

    slots = _schedule(settings, boat)
    history: dict[int, list[int]] = {}
    crew_history: dict[tuple[int, str], int] = {}
    factors = {season: _season_log_factor(settings, season) for season in settings.seasons}
    tows: list[Tow] = []
    for slot in slots:
        seasons = history.setdefault(slot.boat_index, [])
        if slot.season not in seasons:
            seasons.append(slot.season)
        crew = (slot.boat_index, slot.crew_class)
        previous = crew_history.get(crew, slot.season)
        crew_history[crew] = slot.season
        if slot.season in factors:
            condition = _condition(settings, slot.boat_index, tuple(seasons))
            factor = factors[slot.season]
            tows.append(
                _tow(
                    settings,
                    slot,
                    boat(slot.boat_index),
                    condition=condition,
                    previous_season=previous,
                    season_log_factor=factor,
                )
            )
    indices = sorted({tow.boat.index for tow in tows})
    return World(settings, tuple(boat(i) for i in indices), tuple(tows), factors)


def _schedule(settings: WorldSettings, boat: Callable[[int], Boat]) -> list[_Slot]:
    """Who is towed when: boats that are due, longest waiting first, then new boats."""

    def new_crews() -> Iterator[tuple[int, str]]:
        index = 0
        while True:
            for crew_class in boat(index).crew_classes:
                yield index, crew_class
            index += 1

    newcomers = new_crews()
    due: dict[tuple[int, str], int] = {}
    slots: list[_Slot] = []
    for season in range(FIRST_SEASON, settings.seasons[-1] + 1):
        waiting = sorted((when, crew) for crew, when in due.items() if when <= season)
        crews = [crew for _, crew in waiting[: settings.tows_per_season]]
        while len(crews) < settings.tows_per_season:
            crews.append(next(newcomers))
        for number, crew in enumerate(crews, start=1):
            due[crew] = season + RETOW_YEARS[(number - 1) % len(RETOW_YEARS)]
            slots.append(_Slot(season, number, *crew))
    return slots


def _season_log_factor(settings: WorldSettings, season: int) -> float:
    low, high = settings.defects(season).log_season_factor
    return float(stream(settings.seed, Subject.SEASON, season).uniform(low, high))


def _condition(settings: WorldSettings, boat_index: int, seasons: tuple[int, ...]) -> _Condition:
    """State of a boat in the last of the `seasons` in which it was towed so far."""
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
    resistance *= (1.0 + settings.defects(seasons[-1]).ageing_per_year) ** age_years
    return _Condition(resistance, weight, tuple(altered), tuple(reported))


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
    hull = loaded_hull(boat, slot.crew_class, weight_kg, condition.resistance)
    day_number = (slot.number - 1) // TOWS_A_DAY
    day_rng = stream(settings.seed, Subject.DAY, slot.season, day_number)
    temperature_c = round(float(day_rng.uniform(*defects.water_temperature_c)), 1)
    declared = _declared_speed_m_s(settings, boat, slot.crew_class)

    def cw(at_c: float) -> float:
        return float(true_cw_kg_m(hull, np.array(declared), at_c, settings.air))

    wander = float(draw(Component.LOG_WANDER).standard_normal())
    return Tow(
        tow_id=f"{slot.season}-{slot.number:03d}",
        season=slot.season,
        number=slot.number,
        day=dt.date(slot.season, *FIRST_TOW_DAY) + dt.timedelta(days=day_number),
        boat=boat,
        crew_class=slot.crew_class,
        declared_speed_m_s=declared,
        weight_kg=weight_kg,
        weight_after_kg=weight_kg
        + round(float(draw(Component.SCALES).uniform(0.0, HIGHEST_WEIGHT_GAIN_KG))),
        water_temperature_c=temperature_c,
        altered_reported=any(s > previous_season for s in condition.reported_seasons),
        fast_run=bool(draw(Component.FAST_RUN).random() < defects.fast_run_share),
        hull=hull,
        truth=TowTruth(
            cw_at_tow_temperature_kg_m=cw(temperature_c),
            cw_at_15c_kg_m=cw(REFERENCE_TEMPERATURE_C),
            season_log_factor=season_log_factor,
            log_factor=season_log_factor * float(np.exp(defects.log_tow_wander * wander)),
            log2_ratio=float(draw(Component.LOG2_RATIO).uniform(*defects.log2_ratio)),
            askew_ratio=1.0 + _askew_excess(defects, draw(Component.ASKEW)),
            altered=any(s > previous_season for s in condition.altered_seasons),
        ),
    )


def _declared_speed_m_s(settings: WorldSettings, boat: Boat, crew_class: str) -> float:
    """The speed that asks the intended power of the boat as built; kept at later tows."""
    as_built = loaded_hull(boat, crew_class, boat.weight_kg, condition=1.0)
    speed = speed_at_power_m_s(
        as_built,
        boat.target_power_w(crew_class),
        boat.boat_type.rowers,
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
