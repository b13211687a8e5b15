"""A boat found by its FSN number or by its name, as people write it."""

import unicodedata

import polars as pl

from pipeline.errors import MissingKnowledgeError


def plain(name: str) -> str:
    """A name without blanks, case and accents: what two ways of writing it share."""
    letters = unicodedata.normalize("NFD", "".join(name.split()).casefold())
    return "".join(letter for letter in letters if not unicodedata.combining(letter))


def boats_named(boats: pl.DataFrame, name: str) -> list[str]:
    """FSN numbers of the boats with that number, else of those with that name; perhaps none."""
    wanted = plain(name)
    for column in ("fsn_no", "name"):
        like = [plain(text or "") == wanted for text in boats[column]]
        if any(like):
            return boats.filter(pl.Series(like, dtype=pl.Boolean))["fsn_no"].sort().to_list()
    return []


def the_boat(boats: pl.DataFrame, name: str) -> str:
    """The FSN number of the one boat with that number or name.

    Raises:
        MissingKnowledgeError: there is none, or there are several of that name.
    """
    numbers = boats_named(boats, name)
    if len(numbers) == 1:
        return numbers[0]
    if numbers:
        raise MissingKnowledgeError(
            "{} boats are called {!r}: {}; give the FSN number",
            len(numbers),
            name,
            ", ".join(numbers),
        )
    number, example = boats.sort("fsn_no").select("fsn_no", "name").row(0)
    raise MissingKnowledgeError(
        "there is no boat {!r}; boats go by FSN number or name, for example {} or {}",
        name,
        number,
        example,
    )
