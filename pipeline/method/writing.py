"""A method as the text of a method file; reading one is in `pipeline.method.definition`."""

import json
from collections.abc import Mapping

from pipeline.method.definition import LAST_SEASON, Method


def write_method_text(method: Method) -> str:
    """Return a method as TOML that stands alone: every option of every season, nothing inherited.

    Reading it gives a method with the same content hash and register rule.
    """
    head = {
        "name": method.name,
        "title": method.title,
        "title_en": method.title_en,
        "description": method.description,
        "description_en": method.description_en,
        "seasons": write_covered_seasons(method),
    }
    if method.published_in is not None:
        first, last = method.published_in
        head["published_in"] = range_text(first, last)
    rule = key_lines(method.validity.model_dump(exclude_none=True))
    blocks = [key_lines(head), ["[register]"] + rule]
    for block in method.ranges:
        steps = block.steps.model_dump(mode="json", exclude_none=True)
        blocks.append(write_override_lines(range_text(block.first, block.last), steps))
    return "\n\n".join("\n".join(block) for block in blocks) + "\n"


BEGINNING = """
# For all seasons: a line such as
#   [steps.wind]
#   side = 0.3
# For some of them:
#   [[overrides]]
#   range = "2009:2011"
#   wind = { side = 0.3 }
"""


def write_new_method_text(name: str, base: Method) -> str:
    """Return the text of a new method file that extends `base`, with its options as comments."""
    head = {
        "name": name,
        "title": name,
        "description": "",
        "extends": base.name,
        "seasons": write_covered_seasons(base),
    }
    lines = key_lines(head) + [BEGINNING, f"# What {base.name} says:"]
    for block in base.ranges:
        lines += ["#", f"# Seasons {range_text(block.first, block.last)}"]
        steps = step_lines(block.steps.model_dump(mode="json", exclude_none=True))
        lines += [f"# {line}" for line in steps]
    return "\n".join(lines) + "\n"


def write_override_lines(range_of: str, steps: Mapping[str, Mapping[str, object]]) -> list[str]:
    """Return the lines of an `[[overrides]]` block."""
    return ["[[overrides]]"] + key_lines({"range": range_of}) + step_lines(steps)


def step_lines(steps: Mapping[str, Mapping[str, object]]) -> list[str]:
    """Return one line per step, with its options."""
    return [
        f"{step} = {{ {', '.join(key_lines(options))} }}"
        for step, options in steps.items()
        if options
    ]


def key_lines(values: Mapping[str, object]) -> list[str]:
    """Return texts, numbers, truth values and lists as lines of TOML."""
    return [
        f"{key} = {json.dumps(value, ensure_ascii=False)}".replace("\x7f", "\\u007f")
        for key, value in values.items()
    ]


def write_covered_seasons(method: Method) -> str:
    """Return all seasons of a method, as method files write them."""
    return range_text(method.ranges[0].first, method.ranges[-1].last)


def range_text(first: int, last: int) -> str:
    """Return a season range as method files write it."""
    return f"{first}:" if last == LAST_SEASON else f"{first}:{last}"
