"""The simulated fleet: boat types as a table, and boats drawn from it.

Every number of a type is in `BOAT_TYPES` with its source in `docs/simulator.md`. What a
boat does in the water is in `hull`; when it is towed in `world`.
"""

from dataclasses import dataclass, replace
from typing import Final, Literal, TypeAlias

import numpy as np
import scipy

from herijk.simulate.delft import RESIDUARY
from herijk.simulate.hull import AirCoefficients, Hull, true_cw_kg_m

MEN: Final = "H"
WOMEN: Final = "D"
ROWER_KG: Final = {MEN: 95.0, WOMEN: 75.0}
"""Crew weight per rower, in clothes (Sleepproef, R. Pot 2017)."""
POWER_W: Final = {MEN: (71.0, 89.0), WOMEN: (41.0, 54.0)}
"""Power per rower at the declared speed, inside the 70-90 and 40-55 W that the text asks for."""
CREWS: Final = (((MEN,), 0.62), ((WOMEN,), 0.23), ((MEN, WOMEN), 0.15))
"""Which crews tow a boat, and the share of boats (stated assumption)."""


@dataclass(frozen=True)
class BoatType:
    """What boats of one type have in common; see `Hull` for the last six."""

    name: str
    share: float
    rowers: int
    waterline_length_m: float
    beam_m: float
    bow_height_m: float
    weight_kg: float
    wetted_surface_ratio: float
    form_factor: float
    wave_coefficient: float
    wave_exponent: float
    hump_amplitude: float
    hump_phase_rad: float


BOAT_TYPES: Final = tuple(
    BoatType(*row)
    for row in (
        # name, share, rowers, length, beam, height, weight, surface, form, wave, growth, humps
        ("Kromhoutwhaler", 0.22, 8, 8.20, 2.20, 0.85, 1100, 2.9, 0.10, 0.070, 1.6, 0.010, 3.3),
        ("Kuikensloep", 0.26, 8, 7.90, 2.25, 0.90, 600, 2.8, 0.08, 0.062, 2.4, 0.010, 5.5),
        ("Stersloep", 0.14, 12, 10.07, 2.73, 1.05, 1038, 3.0, 0.08, 0.068, 2.4, 0.010, 3.3),
        ("Barkas", 0.12, 10, 9.10, 2.60, 1.05, 1350, 3.0, 0.12, 0.070, 1.6, 0.010, 3.3),
        ("Vlet", 0.10, 6, 7.20, 2.10, 0.80, 850, 2.9, 0.12, 0.072, 2.0, 0.010, 4.5),
        ("", 0.16, 8, 8.68, 2.76, 1.00, 1293, 2.9, 0.10, 0.070, 1.6, 0.010, 3.3),
    )
)
"""The last row, without a name, stands for boats of no type."""

LENGTH_SD: Final = 0.004
BEAM_SD: Final = 0.008
WEIGHT_SD: Final = 0.07
ROUGHNESS_SD: Final = 0.01
"""Spread within a type, relative (stated assumptions; rows of the type "" spread more)."""
NO_TYPE_SPREAD: Final = 3.0
GIVEN_NAMES: Final = ("Tréwes", "Noordvaarder", "Zeeëgel", "Vrouwe Coöperatie")
"""Names with letters that a wrong encoding spoils; given to every seventh boat."""
GIVEN_NAME_EVERY: Final = 7
FIRST_FSN_NUMBER: Final = 100
HUMP_AMPLITUDE: Final = 0.03
"""Size of a marked hump; a hyperbola through 90, 100 and 110 % then misses 0.8 % (median)."""
HUMP_PHASE_RAD: Final = 0.0

ROWERS_PER_THWART: Final = 2
FIRST_THWART: Final = 0.22
LAST_THWART: Final = 0.74
"""Distance of the thwarts from the bow over the length on the waterline (stated assumption)."""
RUDDER_HEIGHT: Final = 0.8
RUDDER_BREADTH: Final = 0.4
RUDDER_THICKNESS_M: Final = 0.04
"""Size of a rudder, over the height of the bow where it is no length (stated assumption)."""

Shape: TypeAlias = Literal["bow wave", "hump", "delft"]
"""Where the shape of the resistance comes from: see `hull`; `delft` is a hull of its series."""


@dataclass(frozen=True)
class Boat:
    """One boat as built; lengths are as the federation measures them, to the centimetre."""

    index: int
    name: str
    boat_type: BoatType
    waterline_length_m: float
    beam_m: float
    bow_height_m: float
    weight_kg: float
    roughness: float
    crew_classes: tuple[str, ...]
    power_share: float
    residuary: tuple[float, ...] | None = None

    @property
    def fsn_no(self) -> str:
        """The boat's identity in the federation's lists."""
        return f"FSN{FIRST_FSN_NUMBER + self.index}"

    @property
    def ht_no(self) -> str:
        """Number in the other register: seven digits, text."""
        return f"{(1_308_179 * (self.index + 1)) % 9_999_991:07d}"

    @property
    def thwarts_m(self) -> tuple[float, ...]:
        """Distances of the thwarts from the bow."""
        number = self.boat_type.rowers // ROWERS_PER_THWART
        places = np.linspace(FIRST_THWART, LAST_THWART, number)
        return tuple(round(float(place) * self.waterline_length_m, 2) for place in places)

    @property
    def rudder_m(self) -> tuple[float, float, float]:
        """Height, breadth and thickness of the rudder."""
        height = round(RUDDER_HEIGHT * self.bow_height_m, 2)
        breadth = round(RUDDER_BREADTH * self.bow_height_m, 2)
        return height, breadth, RUDDER_THICKNESS_M

    def target_power_w(self, crew_class: str) -> float:
        """Return the power per rower [W] at which this boat is towed."""
        low, high = POWER_W[crew_class]
        return low + self.power_share * (high - low)


def draw_boat(index: int, rng: np.random.Generator, shape: Shape, spread: float) -> Boat:
    """Draw boat number `index` from the table of types.

    Args:
        index: number of the boat.
        rng: decides what is drawn.
        shape: of its resistance.
        spread: of boats of a type, relative to the usual; 0 makes them identical.
    """
    shares = np.array([boat_type.share for boat_type in BOAT_TYPES])
    kind = int(rng.choice(len(BOAT_TYPES), p=shares / shares.sum()))
    boat_type = BOAT_TYPES[kind]
    length_spread, spread = (spread, spread) if boat_type.name else (NO_TYPE_SPREAD, 1.0)
    if shape == "hump":
        boat_type = replace(boat_type, hump_amplitude=HUMP_AMPLITUDE, hump_phase_rad=HUMP_PHASE_RAD)
    form = kind if boat_type.name else index  # boats of no type each have their own
    length, beam, weight, roughness = rng.standard_normal(4)
    crew_shares = [share for _, share in CREWS]
    return Boat(
        index=index,
        name=_name(index, boat_type),
        boat_type=boat_type,
        waterline_length_m=round(
            boat_type.waterline_length_m * (1 + length_spread * LENGTH_SD * length), 2
        ),
        beam_m=round(boat_type.beam_m * (1 + length_spread * BEAM_SD * beam), 2),
        bow_height_m=boat_type.bow_height_m,
        weight_kg=round(boat_type.weight_kg * float(np.exp(spread * WEIGHT_SD * weight))),
        roughness=float(np.exp(spread * ROUGHNESS_SD * roughness)),
        crew_classes=CREWS[int(rng.choice(len(CREWS), p=crew_shares))][0],
        power_share=float(rng.random()),
        residuary=RESIDUARY[form % len(RESIDUARY)] if shape == "delft" else None,
    )


def crew_kg(crew_class: str, rowers: int) -> float:
    """Return the weight of a crew [kg]."""
    return rowers * ROWER_KG[crew_class]


def load_hull(boat: Boat, on_board_kg: float, weight_kg: float, condition: float) -> Hull:
    """Return the hull of a boat with its crew.

    Args:
        boat: the boat.
        on_board_kg: weight of the crew.
        weight_kg: the empty boat as weighed on the day.
        condition: factor on water resistance by age and alterations; roughness is added here.
    """
    boat_type = boat.boat_type
    displacement_kg = weight_kg + on_board_kg
    # S = c sqrt(volume L), the usual estimate; c is high because keel and rudder are in it.
    volume_m3 = displacement_kg / 1000.0
    wetted_m2 = boat_type.wetted_surface_ratio * np.sqrt(volume_m3 * boat.waterline_length_m)
    return Hull(
        waterline_length_m=boat.waterline_length_m,
        beam_m=boat.beam_m,
        bow_height_m=boat.bow_height_m,
        displacement_kg=displacement_kg,
        wetted_surface_m2=float(wetted_m2),
        form_factor=boat_type.form_factor,
        wave_coefficient=boat_type.wave_coefficient,
        wave_exponent=boat_type.wave_exponent,
        hump_amplitude=boat_type.hump_amplitude,
        hump_phase_rad=boat_type.hump_phase_rad,
        condition=boat.roughness * condition,
        residuary=boat.residuary,
    )


def speed_at_power_m_s(
    hull: Hull, power_w: float, rowers: int, temperature_c: float, air: AirCoefficients
) -> float:
    """Return the speed at which each rower delivers `power_w`: solves `Cw(v) v^3 / n = P`."""

    def surplus_w(speed_m_s: float) -> float:
        cw = float(true_cw_kg_m(hull, np.array(speed_m_s), temperature_c, air))
        return cw * speed_m_s**3 / rowers - power_w

    return float(scipy.optimize.brentq(surplus_w, 0.5, 6.0))


def _name(index: int, boat_type: BoatType) -> str:
    if index % GIVEN_NAME_EVERY == 0:
        return f"{GIVEN_NAMES[index // GIVEN_NAME_EVERY % len(GIVEN_NAMES)]} {index:03d}"
    return f"{(boat_type.name or 'sloep').lower()} {index:03d}"
