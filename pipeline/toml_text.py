"""TOML that people write: its tables, or a `ValueError` that says in words what is wrong."""

import re
import tomllib
from typing import TYPE_CHECKING, Final

from pipeline.messages import Sentence, say

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

LONGEST_TEXT: Final = 1_000_000


def decode_toml(content: bytes) -> str:
    """Return the text of a file.

    Raises:
        ValueError: it is not UTF-8.
    """
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise ValueError(
            say("a letter in line {} is not in UTF-8; save the file as UTF-8", line)
        ) from error


def parse_toml(text: str) -> dict[str, object]:
    """Read the tables of a text.

    Raises:
        ValueError: it is not TOML, or larger or deeper than a file of settings can be.
    """
    if len(text) > LONGEST_TEXT:
        raise ValueError(say("{} letters; at most {} can be right", len(text), LONGEST_TEXT))
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        place = re.search(r"at line (\d+)", str(error))
        raise ValueError(
            say(
                "line {} cannot be read; a number has a decimal point, text is put between "
                "quotes, and a key occurs once in its table",
                int(place[1]) if place else len(text.splitlines()),
            )
        ) from error
    except RecursionError as error:
        raise ValueError(say("tables within tables, too deep to read")) from error


PROBLEMS: Final = {
    "missing": "missing",
    "extra_forbidden": say("unknown key"),
    "literal_error": say("must be one of {expected}"),
    "greater_than": say("must be more than {gt}"),
    "greater_than_equal": say("must be at least {ge}"),
    "less_than": say("must be less than {lt}"),
    "less_than_equal": say("must be at most {le}"),
    "finite_number": say("must be a number"),
    "float_type": say("must be a number"),
    "float_parsing": say("must be a number"),
    "int_type": say("must be a whole number"),
    "int_parsing": say("must be a whole number"),
    "int_from_float": say("must be a whole number"),
    "bool_type": say("must be true or false"),
    "bool_parsing": say("must be true or false"),
    "string_type": say("must be a text between quotes"),
    "string_pattern_mismatch": say("must have the form {pattern}"),
    "list_type": say("must be a list between [ and ]"),
    "tuple_type": say("must be a list between [ and ]"),
    "dict_type": say("must be a table"),
    "model_type": say("must be a table"),
}
"""What is wrong, by Pydantic's name for it."""


def describe_problem(problem: "ErrorDetails") -> Sentence:
    """Say what is wrong with a value, and the value if `problem` holds it."""
    kind, limits = problem["type"], problem.get("ctx", {})
    if kind == "value_error":  # of a check of our own
        what = say("{}", limits["error"])
    elif kind in PROBLEMS:
        # As text: a limit is written with a point in TOML, in any language.
        named = {key: str(value).replace(" or ", ", ") for key, value in limits.items()}
        what = say(PROBLEMS[kind], **named)
    else:
        what = say("{}", problem["msg"])
    if "input" not in problem or kind in {"missing", "extra_forbidden"}:
        return what
    return say("{}, not {!r}", what, problem["input"])
