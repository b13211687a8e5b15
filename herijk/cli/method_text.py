"""A method in words for a committee member: every step with its options, per range of seasons.

Steps, options and values are called as on the workbench.
"""

import textwrap

from pydantic import BaseModel

from dashboards.labels import code_in_words
from dashboards.workbench.form import unit_of
from dashboards.workbench.texts import text
from pipeline.messages import LANGUAGE, number, tell
from pipeline.method.definition import LAST_SEASON, Method, SeasonSteps, basis_of

DIFFERS = "*"
WIDTH = 100


def method_in_words(shown: Method, parent: Method | None) -> str:
    """The whole method; options that differ from those of `parent` are marked."""
    lines = [f"{shown.name}: {shown.titled(LANGUAGE.get())}", "", shown.description.strip(), ""]
    if parent is not None:
        lines += [tell("Extends {}; what differs from it is marked {}.", parent.name, DIFFERS), ""]
    for block in shown.ranges:
        before = block.steps if parent is None else parent.for_season(block.first)
        steps = (_step(step, options, getattr(before, step)) for step, options in block.steps)
        lines += [_seasons(block), *steps, ""]
    lines.append(tell("Content hash {}", shown.content_hash))
    return "\n".join(lines)


def _seasons(block: SeasonSteps) -> str:
    if block.first == block.last:
        return tell("Season {}", block.first)
    last = tell("the present") if block.last == LAST_SEASON else str(block.last)
    return tell("Seasons {} to {}", block.first, last)


def _step(step: str, options: BaseModel, before: BaseModel) -> str:
    """A step with its options, marked where they are not what they were before."""
    said = "; ".join(
        f"{_text(f'{step}.{option}')}: {_value(option, value)}"
        f"{'' if value == getattr(before, option) else f' {DIFFERS}'}"
        f" ({_text(f'status.{basis_of(step, option).status}')})"
        for option, value in options
    )
    return textwrap.fill(
        f"{_text(f'step.{step}')}. {said}", WIDTH, initial_indent="  ", subsequent_indent="    "
    )


def _value(option: str, value: object) -> str:
    """What an option is set to, with its unit."""
    if isinstance(value, str):
        return _text(f"choice.{value}")
    if isinstance(value, tuple):
        return ", ".join(map(code_in_words, value)) or _text("nothing")
    assert isinstance(value, int | float), "options are choices, codes and numbers"  # noqa: S101
    return f"{number(value, 'g')} {unit_of(option)}".strip()


def _text(key: str) -> str:
    return tell(text(key))
