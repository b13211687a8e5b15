"""Controls for the options of a method, made from the JSON schema of the model of a method itself.

A new option appears by itself. Texts are in `dashboards.words`.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final

from pipeline.method.definition import SeasonSteps
from pipeline.method.options import Steps
from pipeline.tables.display import get_column


@dataclass(frozen=True)
class Control:
    """How one option is changed.

    Attributes:
        kind: `choice` of one of `values`, `several` of them, or `number` from `least` to `most`.
    """

    step: str
    option: str
    kind: str
    values: Sequence[str] = ()
    least: float = 0.0
    most: float = 0.0

    @property
    def unit(self) -> str:
        """Its unit, by the ending of its name."""
        return get_column(self.option).unit

    def read(self, text: str) -> str | list[str]:
        """Return the value that an address has, for the model of a method to check."""
        return list(filter(None, text.split(","))) if self.kind == "several" else text

    def find_value(self, ranges: Sequence[SeasonSteps]) -> str | None:
        """Return the value as an address has it; None where ranges of seasons differ."""
        found = {write(getattr(getattr(r.steps, self.step), self.option)) for r in ranges}
        return found.pop() if len(found) == 1 else None


def write(value: object) -> str:
    """Return a value as an address has it."""
    return ",".join(value) if isinstance(value, (list, tuple)) else str(value)


def _make_controls() -> Iterator[Control]:
    schema = Steps.model_json_schema()
    for step, place in schema["properties"].items():
        rules = schema["$defs"][place["$ref"].rsplit("/", 1)[1]]
        for option, rule in rules["properties"].items():
            yield _make_control(step, option, rule)


def _make_control(step: str, option: str, rule: dict[str, Any]) -> Control:
    if "enum" in rule:
        return Control(step, option, "choice", rule["enum"])
    if rule["type"] == "array":
        return Control(step, option, "several", rule["items"]["enum"])
    return Control(step, option, "number", (), rule["minimum"], rule["maximum"])


CONTROLS: Final = {(one.step, one.option): one for one in _make_controls()}
"""Every option's control, in the order of the steps."""
