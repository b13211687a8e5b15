"""Find a boat by its FSN number or name, or a type by its name, as people write them."""

import unicodedata
from collections.abc import Iterable
from difflib import get_close_matches
from typing import Final

import polars as pl

from pipeline.errors import MissingKnowledgeError
from pipeline.messages import say

MIN_SIMILARITY: Final = 0.75
"""Similarity, as `difflib` measures it, from which a name is offered for a misspelt one."""

MAX_NAMES_SHOWN: Final = 8
"""Largest number of boats that a message lists."""


def normalize_name(name: str) -> str:
    """Return a name without blanks, case and accents."""
    letters = unicodedata.normalize("NFD", "".join(name.split()).casefold())
    return "".join(letter for letter in letters if not unicodedata.combining(letter))


def match_names(wanted: str, names: Iterable[str]) -> list[str]:
    """Return the names that equal `wanted`, else those that begin with it, in their order.

    Case, blanks and accents do not count. An empty `wanted` matches nothing.
    """
    start = normalize_name(wanted)
    if not start:
        return []
    forms = {name: normalize_name(name) for name in names}
    equal = [name for name, form in forms.items() if form == start]
    return equal or [name for name, form in forms.items() if form.startswith(start)]


def suggest_names(wanted: str, names: Iterable[str]) -> str:
    """Return a question that offers the name nearest to `wanted`; empty if none is near.

    The text begins with a blank, so that it can end another sentence.
    """
    forms = {normalize_name(name): name for name in names}
    near = get_close_matches(normalize_name(wanted), forms, n=1, cutoff=MIN_SIMILARITY)
    return say(" Did you mean {}?", forms[near[0]]) if near else ""


def find_boats(boats: pl.DataFrame, wanted: str, *, whole: bool = False) -> list[str]:
    """Return the FSN numbers of the boats that `wanted` may stand for, sorted; perhaps none.

    A whole number or name goes before the beginning of one, and a number before a name.

    Args:
        boats: columns `fsn_no` and `name`; a boat may have several names.
        wanted: an FSN number, a name, or the beginning of either.
        whole: do not match the beginning of a number or name.
    """
    start = normalize_name(wanted)
    if not start:
        return []
    forms = {
        column: boats[column].fill_null("").map_elements(normalize_name, pl.String())
        for column in ("fsn_no", "name")
    }
    for form in forms.values():
        if (form == start).any():
            return boats.filter(form == start)["fsn_no"].unique().sort().to_list()
    if whole:
        return []
    for form in forms.values():
        begins = form.str.starts_with(start)
        if begins.any():
            return boats.filter(begins)["fsn_no"].unique().sort().to_list()
    return []


def choose_boat(boats: pl.DataFrame, wanted: str) -> str:
    """Return the FSN number of the one boat that `wanted` stands for.

    Args:
        boats: columns `fsn_no` and `name`.
        wanted: an FSN number, a name, or the beginning of either.

    Raises:
        MissingKnowledgeError: no boat has that number or name, or several have.
    """
    numbers = find_boats(boats, wanted)
    if len(numbers) == 1:
        return numbers[0]
    if numbers:
        more = ", ..." if len(numbers) > MAX_NAMES_SHOWN else ""
        raise MissingKnowledgeError(
            "{!r} may be any of {} boats: {}; give its number",
            wanted,
            len(numbers),
            ", ".join(numbers[:MAX_NAMES_SHOWN]) + more,
        )
    number, example = boats.sort("fsn_no").select("fsn_no", "name").row(0)
    known = boats["fsn_no"].to_list() + boats["name"].drop_nulls().to_list()
    raise MissingKnowledgeError(
        "there is no boat {!r}; boats go by number or name, for example {} or {}.{}",
        wanted,
        number,
        example,
        suggest_names(wanted, known),
    )
