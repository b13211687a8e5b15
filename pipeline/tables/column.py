"""Columns that many tables share, each declared once: type, meaning and limits.

The unit of a number is in the name of its column; see `pipeline.tables.display`.
"""

from functools import partial
from typing import Any, Final

from pipeline.tables.declare import dy

LOWER_END: Final = (
    "lower end of its 95 % interval; where methods.interval is runs_alone, of the spread of the "
    "runs alone: the log's error is not in it"
)
"""Description of the lower end of an interval of Cw or B."""


CREW_CLASS: Final = "^[A-Z][A-Z0-9]{0,2}$"
"""What the code of a class looks like: `8H` is a crew of eight."""


def text(description: str, **rules: Any) -> dy.String:
    """Declare a text."""
    return dy.String(description=description, **rules)


def number(description: str, unit: str | None = None, **rules: Any) -> dy.Float64:
    """Declare a number.

    Args:
        description: its meaning.
        unit: only where the column's name does not say it (`pipeline.tables.display`): where
            another column does.
        rules: limits, as dataframely takes them.
    """
    return dy.Float64(description=description, metadata={"unit": unit} if unit else None, **rules)


def optional(description: str, unit: str | None = None, **rules: Any) -> dy.Float64:
    """Declare a number that is not always known."""
    return number(description, unit, nullable=True, **rules)


def lower(**rules: Any) -> dy.Float64:
    """Declare the lower end of the interval of the number before it."""
    return optional("lower end of its 95 % interval", **rules)


def upper(**rules: Any) -> dy.Float64:
    """Declare the upper end of that interval."""
    return optional("upper end", **rules)


def count(description: str, least: int = 0, **rules: Any) -> dy.Int32:
    """Declare how many there are of something."""
    return dy.Int32(description=description, min=least, **rules)


def flag(description: str, **rules: Any) -> dy.Bool:
    """Declare a yes or no."""
    return dy.Bool(description=description, **rules)


def day(description: str, **rules: Any) -> dy.Date:
    """Declare a day."""
    return dy.Date(description=description, **rules)


def texts(description: str, **rules: Any) -> dy.List:
    """Declare several texts, such as codes."""
    return dy.List(dy.String(), description=description, **rules)


tow_id: Final = partial(text, "tow, as named in the tow list")
fsn_no: Final = partial(text, "boat: its number with the federation")
method: Final = partial(text, "name of the method that made the row")
season: Final = partial(dy.Int32, description="year of the tow list", min=1990, max=2100)
run: Final = partial(dy.Int8, description="run", min=1, max=40)
rowers: Final = partial(dy.Int32, description="rowers the curve is valid for", min=1, max=30)
crew_class: Final = partial(
    text, "class of the crew: H men, D women, or what the archive declares", regex=CREW_CLASS
)
empty_thwart: Final = partial(
    text, "thwart that must be left free; empty text where all are manned"
)
declared_speed: Final = partial(number, "speed v0 the crew declared", min=0.5, max=6.0)

# Of these a table gives the meaning.
waterline_length: Final = partial(number, min=2.0, max=25.0)
beam: Final = partial(number, min=0.5, max=6.0)
bow_height: Final = partial(number, min=0.1, max=4.0)
boat_weight: Final = partial(number, min=50.0, max=20_000.0)
freeboard: Final = partial(number, nullable=True, min=-0.5, max=4.0)
thwart: Final = partial(number, nullable=True, min=0.0, max=25.0)
rudder: Final = partial(number, nullable=True, min=0.001, max=4.0)
speed: Final = partial(number, min=0.0, max=15.0)
sha256: Final = partial(text, regex="^[0-9a-f]{64}$")
