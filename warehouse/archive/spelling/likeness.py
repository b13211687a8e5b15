"""How much a header is like the name of a column: by its words, and by its letters."""

import difflib
import re
import unicodedata
from collections.abc import Iterable, Sequence
from typing import Final

from warehouse.archive.spelling.columns import Column
from warehouse.archive.spelling.headers import split_header
from warehouse.archive.spelling.text import fold

ALIKE: Final = 0.6
"""The least share of their words that two names must have in common."""

ALIKE_IN_LETTERS: Final = 0.75
"""The least share of their letters, where the words differ: a misspelling."""

_STOP_WORDS: Final = frozenset(
    {"de", "het", "een", "van", "der", "den", "the", "of", "a", "an", "das", "die", "dem"}
    | {"wel", "niet"}
)
_NUMBER_SIGN: Final = re.compile(
    r"(?:#|\b(?:n[°º]|num(?:[ée]ro|ber|mer)?|no)(?!\w)|(?:nummer|nr)\b)\.?", re.IGNORECASE
)
"""Ways to write that a number follows; all count as `nr`."""
_SHORTEST_START: Final = 3
"""Letters of an abbreviation: `opm.` is `opmerking`."""


def likeness(header: str, column: Column) -> float:
    """How much a header is like the names of a column, from 0, not at all, to 1."""
    words = _words(header)
    others = [_words(other) for other in (column.header, *column.also)]
    by_words = max(_of_words(words, other) for other in others)
    by_letters = max(_of_letters(words, other) for other in others)
    return max(
        by_words if by_words >= ALIKE else 0.0,
        by_letters if by_letters >= ALIKE_IN_LETTERS else 0.0,
    )


def _words(name: str) -> list[str]:
    bare = _NUMBER_SIGN.sub(" nr", re.sub(r"\[[^\]]*\]|\([^)]*\)", " ", name))
    plain = unicodedata.normalize("NFKD", bare).casefold()
    words = re.findall(r"[a-z]+|[0-9]+", "".join(c for c in plain if not unicodedata.combining(c)))
    return [word for word in words if word not in _STOP_WORDS] or words


def _of_words(ones: Sequence[str], others: Sequence[str]) -> float:
    left = list(others)
    for one in ones:
        same = next((other for other in left if _same_word(one, other)), None)
        if same is not None:
            left.remove(same)
    matched = len(others) - len(left)
    return 2 * matched / (len(ones) + len(others)) if ones and others else 0.0


def _same_word(one: str, other: str) -> bool:
    short, long = sorted((one, other), key=len)
    if len(short) >= _SHORTEST_START and long.startswith(short):
        return True
    return difflib.SequenceMatcher(None, one, other).ratio() >= 0.8


def _of_letters(ones: Sequence[str], others: Sequence[str]) -> float:
    return difflib.SequenceMatcher(None, "".join(ones), "".join(others)).ratio()


def nearest_column(cell: str, columns: Iterable[Column]) -> Column | None:
    """The column whose name is most like a header; None when none is like it."""
    names = {fold(name): column for column in columns for name in (column.header, *column.also)}
    like = difflib.get_close_matches(split_header(cell)[0], names, n=1, cutoff=0.6)
    return names[like[0]] if like else None
