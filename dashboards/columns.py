"""How a value is written in the column of a name: the same on pages and in the terminal."""

import datetime as dt
import json
import re
from typing import Any, Final

from dashboards import labels
from dashboards.speech import Speech
from pipeline.tables.row import Row

DIGITS: Final = (
    ("_kg_m", 2), ("_m_s", 2), ("_deg", 0), ("_kg", 0), ("_w", 1), ("_s", 0), ("cw_sd", 2),
    ("_m", 2), ("step_sd", 4), ("_sd", 1), ("dof", 1), ("before_percent", 3), ("after_percent", 3),
    ("_seconds", 0), ("_percent", 1), ("size", 1), ("size_lo", 1), ("e_n", 2), ("p_value", 3),
    ("size_hi", 1), ("_1pct", 2), ("_2pct", 2), ("cw_ratio", 3),
)  # fmt: skip
"""Decimals shown by the ending of a column's name; 4 otherwise."""

UNITS: Final = {
    "_kg_m": "kg/m", "_m_s": "m/s", "_kg": "kg", "_m": "m", "_s": "s", "_w": "W", "_n": "N",
    "_c": "°C", "_deg": "°", "_sd": "sd", "_percent": "%",
}  # fmt: skip
"""Unit of a number by the ending of the name of its column or option; others have none."""

CODES: Final = {
    *("status", "flags", "reason", "cut_reason", "change", "source", "step", "component", "code"),
    *("quantity", "explaining", "within", "severity", "check", "shared", "kind", "scope"),
    *("old_remark", "new_remark", "choice", "pooling"),
    *("option", "speed_reason", "cause", "log", "flag", "what", "outcome", "reason_code", "lost"),
    *("instrument", "verdict", "confused_with", "rule"),
    *("rest_verdict", "weight_verdict", "tow_speed_verdict"),
}
"""Columns that hold codes of the warehouse, shown as words."""


def written(name: str, value: Any, speech: Speech) -> str:
    """A value of the column of this name; codes, causes and lists of them in words."""
    if isinstance(value, bool):
        return speech.say("yes" if value else "no")
    if isinstance(value, float):
        return speech.number(value, digits_of(name))
    if name == "causes":
        return causes(json.loads(value) if isinstance(value, str) else value, speech)
    several = re.split(", ?", value) if name in CODES and isinstance(value, str) else value
    if isinstance(value, dt.date):
        return str(value)
    if not isinstance(several, list | tuple):
        return speech.words(several)
    word = {"candidates": labels.candidate}.get(name, labels.code if name in CODES else str)
    return ", ".join(speech.words(word(one)) for one in several if one != "")


def unit_of(name: str) -> str:
    """The unit of what has this name; empty where it has none."""
    return UNITS.get(_ending(name), "")


def ends_of(name: str) -> tuple[str, str]:
    """The columns with the lower and upper end of the interval of a column."""
    ending = _ending(name)
    stem = name.removesuffix(ending)
    return f"{stem}_lo{ending}", f"{stem}_hi{ending}"


def _ending(name: str) -> str:
    return next((ending for ending in UNITS if name.endswith(ending)), "")


def digits_of(name: str) -> int:
    """Decimals of a number in the column of this name."""
    return next((shown for ending, shown in DIGITS if name.endswith(ending)), 4)


def causes(found: list[Row], speech: Speech) -> str:
    """What a change is attributed to (a method's step by its name), each in per cent."""
    return "; ".join(
        f"{speech.say(labels.cause(cause))} {speech.per_cent(cause['factor'])}" for cause in found
    )
