"""Controls for the options of a method, made from the model of a method itself.

What an option may be is read from the JSON schema of `pipeline.method.definition.Steps`, so that a
new option appears by itself: as a choice, a number between bounds, or a list of codes. An option of
another kind is shown and cannot be changed here. Texts are in `dashboards.workbench.texts`.
"""

from math import floor, log10
from typing import Any, Final

from pipeline.method.definition import Steps

Schema = dict[str, Any]
Control = dict[str, Any]

POSITIONS: Final = 100
"""A slider has at least so many positions."""

UNITS: Final = {"_m_s": "m/s", "_s": "s", "_c": "°C", "_sd": "sd", "_ratio": "", "": ""}
"""Unit of an option by the ending of its name, as in columns."""


def controls() -> list[Control]:
    """The steps in order, each with the controls of its options.

    Returns:
        Per step `step`, `meaning` (its docstring) and `options`: each with its name in `option`,
        its `unit` and `kind`: `choice` and `several` with `values`; `number` with `least`, `most`,
        `by` (a step of the slider) and `whole`; `fixed` with nothing more.
    """
    schema = Steps.model_json_schema()
    steps = []
    for step, place in schema["properties"].items():
        rules = schema["$defs"][place["$ref"].rsplit("/", 1)[1]]
        options = [
            {"option": name, "unit": unit_of(name)} | _kind(rule)
            for name, rule in rules["properties"].items()
        ]
        steps.append({"step": step, "meaning": rules["description"], "options": options})
    return steps


def _kind(rule: Schema) -> Control:
    if "enum" in rule:
        return {"kind": "choice", "values": rule["enum"]}
    if rule.get("type") == "boolean":
        return {"kind": "choice", "values": [False, True]}
    if rule.get("type") == "array" and "enum" in rule["items"]:
        return {"kind": "several", "values": rule["items"]["enum"]}
    if rule.get("type") in ("number", "integer"):
        return _number(rule)
    return {"kind": "fixed"}


def _number(rule: Schema) -> Control:
    """A slider where both bounds are known; a bound that is itself excluded is one step away."""
    low, above = rule.get("minimum"), rule.get("exclusiveMinimum")
    high, below = rule.get("maximum"), rule.get("exclusiveMaximum")
    least, most = (low if above is None else above), (high if below is None else below)
    if least is None or most is None:
        return {"kind": "fixed"}
    whole = rule["type"] == "integer"
    by = 1 if whole else 10.0 ** floor(log10((most - least) / POSITIONS))
    return {
        "kind": "number",
        "least": least if above is None else least + by,
        "most": most if below is None else most - by,
        "by": by,
        "whole": whole,
    }


def unit_of(option: str) -> str:
    """The unit of an option, by the ending of its name."""
    return next(unit for ending, unit in UNITS.items() if option.endswith(ending))
