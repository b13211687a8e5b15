"""Columns that many tables share, each declared once: meaning, unit and limits."""

from typing import Any, Final

from herijk.tables.declare import dy

LOWER_END: Final = (
    "lower end of its 95 % interval; where methods.interval is runs_alone, of the spread of the "
    "runs alone: the log's error is not in it"
)
"""Of an interval of Cw or B."""


def text(description: str, **rules: Any) -> dy.String:
    """Text."""
    return dy.String(description=description, **rules)


def number(unit: str, description: str, **rules: Any) -> dy.Float64:
    """A number with its unit; `1` for a ratio."""
    return dy.Float64(description=description, metadata={"unit": unit}, **rules)


def tow_id(**rules: Any) -> dy.String:
    """Which tow."""
    return text("tow, as named in the tow list", **rules)


def fsn_no(**rules: Any) -> dy.String:
    """Which boat."""
    return text("boat: its number with the federation", **rules)


def method(**rules: Any) -> dy.String:
    """Which method."""
    return text("name of the method that made the row", **rules)


def season(**rules: Any) -> dy.Int32:
    """Which season."""
    return dy.Int32(description="year of the tow list", min=1990, max=2100, **rules)


def run(**rules: Any) -> dy.Int8:
    """Which run of a tow."""
    return dy.Int8(description="run", min=1, max=40, **rules)


def rowers(**rules: Any) -> dy.Int32:
    """How many rowers."""
    return dy.Int32(description="rowers the curve is valid for", min=1, max=30, **rules)


def crew_class(**rules: Any) -> dy.String:
    """Men or women."""
    return text("H men, D women", regex="^[HD]$", **rules)


def empty_thwart(**rules: Any) -> dy.String:
    """Which thwart nobody sits on."""
    return text("thwart that must be left free; empty text where all are manned", **rules)


def declared_speed(**rules: Any) -> dy.Float64:
    """The speed for which a crew is towed."""
    return number("m/s", "speed v0 the crew declared", min=0.5, max=6.0, **rules)


def waterline_length(description: str, **rules: Any) -> dy.Float64:
    """The length of a boat."""
    return number("m", description, min=2.0, max=25.0, **rules)


def beam(description: str, **rules: Any) -> dy.Float64:
    """The breadth of a boat."""
    return number("m", description, min=0.5, max=6.0, **rules)


def bow_height(description: str, **rules: Any) -> dy.Float64:
    """The height of a boat's bow."""
    return number("m", description, min=0.1, max=4.0, **rules)


def boat_weight(description: str, **rules: Any) -> dy.Float64:
    """The weight of a boat."""
    return number("kg", description, min=50.0, max=20_000.0, **rules)


def freeboard(description: str, **rules: Any) -> dy.Float64:
    """A freeboard, negative where a boat lies under water."""
    return number("m", description, nullable=True, min=-0.5, max=4.0, **rules)


def speed(description: str, **rules: Any) -> dy.Float64:
    """A speed of a boat."""
    return number("m/s", description, min=0.0, max=15.0, **rules)


def sha256(description: str, **rules: Any) -> dy.String:
    """A content hash."""
    return text(description, regex="^[0-9a-f]{64}$", **rules)


def unseen_error() -> dy.Float64:
    """Which errors of Cw nobody would see."""
    return number(
        "1",
        "smallest relative error of Cw that other tows would show in 19 of 20 cases; empty where "
        "nothing tells",
        nullable=True,
        min=0,
    )
