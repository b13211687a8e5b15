"""Controls for the options of a method, made from the model of a method itself.

What an option may be is read from the JSON schema of `pipeline.method.definition.Steps`, so that a
new option appears by itself: as a choice, a number between bounds, or a list of codes. An option of
another kind is shown and cannot be changed here. Texts are in `dashboards.option_labels`.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final

from dashboards.columns import unit_of
from pipeline.method.definition import SeasonSteps, Steps


@dataclass(frozen=True)
class Control:
    """How one option is changed.

    Attributes:
        kind: `choice` and `several` of `values`; `number` from `least` to `most`, `whole` or not;
            `fixed`, which cannot be changed here.
    """

    step: str
    option: str
    kind: str
    values: Sequence[Any] = ()
    least: float = 0.0
    most: float = 0.0
    whole: bool = False

    @property
    def unit(self) -> str:
        """Its unit, by the ending of its name."""
        return unit_of(self.option)

    def read(self, written: str) -> object:
        """The value of an option as an address has it.

        Raises:
            ValueError: it is none of the choices, or no number.
        """
        if self.kind == "choice":
            return self.values[[write(value) for value in self.values].index(written)]
        if self.kind == "several":
            return [code for code in written.split(",") if code]
        if self.kind == "number":
            return int(written) if self.whole else float(written)
        raise ValueError(written)

    def held(self, ranges: Sequence[SeasonSteps]) -> str | None:
        """The value as an address has it; None where ranges of seasons differ."""
        found = {write(getattr(getattr(r.steps, self.step), self.option)) for r in ranges}
        return found.pop() if len(found) == 1 else None


def write(value: object) -> str:
    """A value as an address has it."""
    if isinstance(value, (list, tuple)):
        return ",".join(map(str, value))
    return str(value)


def _controls() -> Iterator[Control]:
    schema = Steps.model_json_schema()
    for step, place in schema["properties"].items():
        rules = schema["$defs"][place["$ref"].rsplit("/", 1)[1]]
        for option, rule in rules["properties"].items():
            yield control(step, option, rule)


def control(step: str, option: str, rule: dict[str, Any]) -> Control:
    """The control of an option by its rule in the schema."""
    if "enum" in rule:
        return Control(step, option, "choice", rule["enum"])
    if rule.get("type") == "boolean":
        return Control(step, option, "choice", (False, True))
    if rule.get("type") == "array" and "enum" in rule["items"]:
        return Control(step, option, "several", rule["items"]["enum"])
    least, most = rule.get("minimum"), rule.get("maximum")
    if rule.get("type") not in ("number", "integer") or least is None or most is None:
        return Control(step, option, "fixed")
    return Control(step, option, "number", (), least, most, rule["type"] == "integer")


CONTROLS: Final = {(one.step, one.option): one for one in _controls()}
"""Every option's control, in the order of the steps."""
