"""A method as the text of a method file; reading one is in `pipeline.method.definition`."""

import json
from collections.abc import Mapping

from herijk.pipeline.method.definition import LAST_SEASON, Method


def method_text(method: Method) -> str:
    """A method as TOML that stands alone: every option of every season, nothing inherited.

    Reading it gives a method with the same content hash and register rule.
    """
    years = {k: v for k, v in method.validity.model_dump().items() if v is not None}
    seasons = range_text(method.ranges[0].first, method.ranges[-1].last)
    lines = [
        *(
            f"{key} = {toml_value(value)}"
            for key, value in (
                ("name", method.name),
                ("title", method.title),
                ("title_en", method.title_en),
                ("description", method.description),
                ("seasons", seasons),
            )
        ),
        "",
        "[register]",
        *(f"{key} = {toml_value(value)}" for key, value in years.items()),
    ]
    for block in method.ranges:
        steps = block.steps.model_dump(mode="json", exclude_none=True)
        lines += ["", *override_lines(range_text(block.first, block.last), steps)]
    return "\n".join(lines) + "\n"


def beginning_text(name: str, base: Method) -> str:
    """A new method file that extends another, with every option of the other as a comment."""
    seasons = range_text(base.ranges[0].first, base.ranges[-1].last)
    listed = [
        f"# {line}".rstrip()
        for block in base.ranges
        for line in (
            f"Seasons {range_text(block.first, block.last)}",
            *step_lines(block.steps.model_dump(mode="json", exclude_none=True)),
            "",
        )
    ]
    return (
        "\n".join(
            [
                f"name = {toml_value(name)}",
                f"title = {toml_value(name)}",
                'description = ""',
                f"extends = {toml_value(base.name)}",
                f"seasons = {toml_value(seasons)}",
                "",
                "# For all seasons: a line such as",
                "#   [steps.wind]",
                "#   side = 0.3",
                "# For some of them:",
                "#   [[overrides]]",
                '#   range = "2009:2011"',
                "#   wind = { side = 0.3 }",
                "",
                f"# What {base.name} says:",
                "#",
                *listed,
            ]
        ).rstrip("#\n ")
        + "\n"
    )


def override_lines(range_of: str, steps: Mapping[str, Mapping[str, object]]) -> list[str]:
    """The lines of an `[[overrides]]` block."""
    return ["[[overrides]]", f"range = {toml_value(range_of)}", *step_lines(steps)]


def step_lines(steps: Mapping[str, Mapping[str, object]]) -> list[str]:
    """One line per step, with its options."""
    lines = []
    for step, options in steps.items():
        pairs = ", ".join(f"{key} = {toml_value(value)}" for key, value in options.items())
        lines.append(f"{step} = {{ {pairs} }}")
    return lines


def toml_value(value: object) -> str:
    """A text, number, truth value or list as TOML, which differs from JSON in one character."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def range_text(first: int, last: int) -> str:
    """A season range as method files write it."""
    return f"{first}:" if last == LAST_SEASON else f"{first}:{last}"
