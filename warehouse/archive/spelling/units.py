"""Units as people write them, and the scale that brings a number to its SI unit.

They are exact fractions with their usual spellings. A unit is never guessed from how large a
number is.
"""

import math
import unicodedata
from typing import Final, NamedTuple


class Scale(NamedTuple):
    """What brings a number to its SI unit.

    871 / 100 is exactly 8.71, and 871 * 0.01 need not be: so a numerator and a denominator.

    Attributes:
        numerator: after the shift the number is multiplied by it,
        denominator: and divided by it.
        shift: what is added first: to degrees Fahrenheit -32.
    """

    numerator: float = 1.0
    denominator: float = 1.0
    shift: float = 0.0

    def to_si(self, number: float) -> float:
        """A number in the SI unit."""
        return (number + self.shift) * self.numerator / self.denominator

    def turned(self) -> "Scale":
        """The scale of what has the other sign."""
        return self._replace(numerator=-self.numerator)

    def from_si(self, value: float) -> float:
        """A value in the SI unit in this one."""
        return value * self.denominator / self.numerator - self.shift


_USUAL: Final[dict[str, dict[str, tuple[float, ...]]]] = {
    "none": {},
    "speed": {
        "m/s": (1, 1), "cm/s": (1, 100), "km/h": (1, 3.6), "kn": (1852, 3600), "mph": (0.44704, 1),
        "ft/s": (0.3048, 1),
    },
    "force": {"n": (1, 1), "kn": (1000, 1), "kgf": (9.80665, 1), "lbf": (4.4482216152605, 1)},
    "angle": {"gra": (1, 1), "deg": (1, 1), "rad": (180, math.pi)},
    "length": {
        "m": (1, 1), "cm": (1, 100), "mm": (1, 1000), "km": (1000, 1), "nmi": (1852, 1),
        "ft": (0.3048, 1),
    },
    "mass": {"kg": (1, 1), "g": (1, 1000), "lb": (0.45359237, 1)},
    "temperature": {"c": (1, 1), "f": (5, 9, -32), "k": (1, 1, -273.15)},
    "ratio": {"%": (1, 100)},
    "rate": {"hz": (1, 1), "khz": (1000, 1)},
    "power": {"w": (1, 1), "kw": (1000, 1)},
    "time": {"s": (1, 1), "ms": (1, 1000), "min": (60, 1)},
}  # fmt: skip
UNITS: Final = {
    dimension: {unit: Scale(*numbers) for unit, numbers in units.items()}
    for dimension, units in _USUAL.items()
}
"""Per dimension the usual units, folded; the SI unit (degrees for angles) comes first."""

SPELLINGS: Final[dict[str, dict[str, str]]] = {
    "speed": {
        "mps": "m/s", "m/sec": "m/s", "ms-1": "m/s", "ms^-1": "m/s", "m·s-1": "m/s", "m.s-1": "m/s",
        "km/u": "km/h", "kmh": "km/h", "kmu": "km/h", "kph": "km/h", "km/uur": "km/h",
        "km/std": "km/h", "kt": "kn", "kts": "kn", "knoop": "kn", "knopen": "kn", "knots": "kn",
        "knot": "kn", "knoten": "kn", "knop": "kn", "noeuds": "kn", "noeud": "kn", "nœuds": "kn",
        "nd": "kn",
    },
    "force": {"newton": "n", "kilonewton": "kn", "kg-f": "kgf", "kgkracht": "kgf", "kp": "kgf",
              "kg": "kgf"},
    "angle": {
        "°": "gra", "º": "gra", "graden": "gra", "graad": "gra", "grad": "gra", "degree": "gra",
        "degrees": "gra", "radialen": "rad", "radians": "rad",
    },
    "length": {"meter": "m", "mtr": "m", "centimeter": "cm", "millimeter": "mm", "kilometer": "km",
               "nm": "nmi", "zm": "nmi", "sm": "nmi", "zeemijl": "nmi", "zeemijlen": "nmi",
               "seemeile": "nmi", "seemeilen": "nmi"},
    "mass": {"kilo": "kg", "kilogram": "kg", "kgs": "kg", "gram": "g", "lbs": "lb"},
    "temperature": {"°c": "c", "ºc": "c", "gradenc": "c", "celsius": "c", "degc": "c",
                    "gr": "c", "graden": "c", "°": "c", "º": "c", "grad": "c", "°f": "f",
                    "ºf": "f", "degf": "f", "fahrenheit": "f", "kelvin": "k"},
    "ratio": {"procent": "%", "percent": "%", "pct": "%", "prozent": "%"},
    "rate": {"hertz": "hz", "1/s": "hz", "s/s": "hz", "samples/s": "hz"},
    "power": {"watt": "w"},
    "time": {"sec": "s", "seconde": "s", "seconden": "s", "second": "s", "seconds": "s",
             "sek": "s", "msec": "ms"},
}  # fmt: skip

BEAUFORT: Final = frozenset({"bft", "bf", "beaufort"})
"""A class of winds and no speed: it cannot be converted."""


def fold_unit(text: str) -> str:
    """A unit for comparing: without case, blanks and ways to write an accent."""
    return "".join(unicodedata.normalize("NFC", text).casefold().split())


def find_scale(dimension: str, unit: str) -> Scale | None:
    """The scale of a unit as written; None where it is not one of this dimension."""
    folded = fold_unit(unit)
    return UNITS[dimension].get(SPELLINGS.get(dimension, {}).get(folded, folded))


def is_unit(text: str) -> bool:
    """Whether a text is a unit of any dimension, or Beaufort."""
    return fold_unit(text) in BEAUFORT or any(find_scale(name, text) for name in UNITS)
