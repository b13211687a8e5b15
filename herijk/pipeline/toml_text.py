"""TOML of people: what it says, or a `ValueError`, whatever it is."""

import tomllib
from typing import Any, Final

LONGEST_TEXT: Final = 1_000_000
MOST_DOTS: Final = 1_000
"""In a line. A key of 20,000 parts takes 1.6 GB, and one of 100,000 minutes."""


def parse_toml(text: str) -> dict[str, Any]:
    """The tables of a text.

    Raises:
        ValueError: it is no TOML, or larger or deeper than a file of settings can be.
    """
    most = max((line.count(".") for line in text.splitlines()), default=0)
    if len(text) > LONGEST_TEXT or most > MOST_DOTS:
        raise ValueError(
            f"{len(text)} letters, up to {most} dots in a line; at most {LONGEST_TEXT} and "
            f"{MOST_DOTS} can be right"
        )
    try:
        return tomllib.loads(text)
    except RecursionError as error:
        raise ValueError("tables within tables, too deep to read") from error
