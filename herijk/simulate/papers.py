"""What was printed in a simulated world: registers of the day and race results.

A printed register contains the faults of its day, as a real one does; it is there to compare
with, not to learn from. How it is spelled in a file is `simulate.archive_writer`.
"""

import datetime as dt
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, TypeAlias

from herijk.simulate.boats import Boat, speed_at_power_m_s
from herijk.simulate.practice import Practice, find_practice
from herijk.simulate.random_streams import Subject, stream
from herijk.simulate.world import Tow, World

VALID_YEARS: Final = 5
NO_CURVE: Final = (0.99, 25.00)
"""A and B that stand for "no valid curve": they give Cw = 1."""
RACE_DAY: Final = (6, 4)
RACE_KM: Final = 18.4
RACE_STREAM_KM: Final = 0.35
RACE_POWER_SPREAD: Final = 0.08


@dataclass(frozen=True)
class RegisterLine:
    """One line of a register; `tow_day` is None where there is no valid curve."""

    boat: Boat
    rowers: int
    crew_class: str
    a_kg_m: float
    b_m_s: float
    declared_speed_m_s: float
    tow_day: dt.date | None

    @property
    def cw_kg_m(self) -> float:
        """`A / (1 - (v/B)^2)` at the declared speed."""
        return self.a_kg_m / (1.0 - (self.declared_speed_m_s / self.b_m_s) ** 2)


@dataclass(frozen=True)
class RaceLine:
    """One crew's result; `stream_km` is None for crews that met no current."""

    tow: Tow
    seconds: int
    stream_km: float | None


Curves: TypeAlias = Mapping[str, Mapping[Practice, tuple[float, float]]]
"""A and B of every tow, by each practice by which it can have been printed."""


def print_register(world: World, year: int, curves: Curves) -> list[RegisterLine]:
    """Return the register of that year by the practice of the day, faults included."""
    lines: list[RegisterLine] = []
    newest = _newest_tows(world, year)
    crews = sorted({(tow.boat.index, tow.crew_class) for tow in world.tows})
    first = {(tow.boat.index, tow.crew_class): tow for tow in reversed(world.tows)}
    for crew in crews:
        tow = newest.get(crew, first[crew])
        valid = crew in newest and tow.season + VALID_YEARS >= year
        a_kg_m, b_m_s = curves[tow.tow_id][find_practice(tow.season, year)] if valid else NO_CURVE
        lines.append(
            RegisterLine(
                tow.boat,
                tow.rowers,
                tow.crew_class,
                round(a_kg_m, 2),
                round(b_m_s, 2),
                tow.declared_speed_m_s,
                tow.day if valid else None,
            )
        )
    return lines


def race(world: World, season: int) -> tuple[dt.date, list[RaceLine]]:
    """Return a race of all crews with a valid tow, each at about its power, by its true curve."""
    day = dt.date(season, *RACE_DAY)
    rng = stream(world.settings.seed, Subject.RACE, season)
    lines: list[RaceLine] = []
    for _, tow in sorted(_newest_tows(world, season).items()):
        effort = 1.0 + RACE_POWER_SPREAD * float(rng.uniform(-1.0, 1.0))
        stream_km = RACE_STREAM_KM if rng.random() < 0.5 else None
        speed_m_s = speed_at_power_m_s(
            tow.hull,
            effort * tow.boat.target_power_w(tow.crew_class),
            tow.rowers,
            tow.water_temperature_c,
            world.settings.air,
        )
        metres = 1000.0 * (RACE_KM - (stream_km or 0.0))
        lines.append(RaceLine(tow, round(metres / speed_m_s), stream_km))
    return day, lines


def _newest_tows(world: World, year: int) -> dict[tuple[int, str], Tow]:
    return {(tow.boat.index, tow.crew_class): tow for tow in world.tows if tow.season <= year}
