"""What a column that nobody knows can mean: by its name, by its unit, and by what is in it.

A guess for a person to look at: `check` proposes it, and nothing is read by it.
"""

import difflib
import re
import unicodedata
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

from herijk.warehouse.archive.text import Column, split_header
from herijk.warehouse.archive.units import find_scale

ALIKE: Final = 0.6
"""So large a share of their words must two names have in common."""

ALIKE_IN_LETTERS: Final = 0.75
"""So large a share of their letters, where the words differ: a misspelling."""

FITS: Final = 0.8
"""So large a share of the cells must be what the column holds; the rest can be faults."""

_STOP_WORDS: Final = frozenset(
    {"de", "het", "een", "van", "der", "den", "the", "of", "a", "an", "das", "die", "dem"}
    | {"wel", "niet"}
)
_BY_CONTENT: Final = frozenset({"use_runs", "crew_class"})
"""Columns that need not be there, and that are recognised by their content."""
_SELDOM: Final = frozenset(
    {"weight_after_kg", "freeboard_lowest_m", "freeboard_bow_m", "freeboard_stern_m"}
)
"""Columns that few lists have."""
_DISTINCT: Final = frozenset({"tow_id", "file"})
_NUMBER_SIGN: Final = re.compile(
    r"(?:#|\b(?:n[°º]|num(?:[ée]ro|ber|mer)?|no)(?!\w)|(?:nummer|nr)\b)\.?", re.IGNORECASE
)
"""Ways to write that a number follows; all count as `nr`."""
_SHORTEST_START: Final = 3
"""Letters of an abbreviation: `opm.` is `opmerking`."""

Cells = Mapping[str, Sequence[str]]
"""The cells under each header that nobody knows."""
Fits = Callable[[Column, str], bool]
"""Whether a cell can stand in a column."""


@dataclass(frozen=True)
class Meaning:
    """What a header can mean.

    Attributes:
        header: the header as written.
        column: the column that it can be; None where it is like none.
        is_sure: name and content agree; otherwise only the content says so.
    """

    header: str
    column: Column | None
    is_sure: bool = True


def meanings(strange: Cells, free: Sequence[Column], fits: Fits) -> tuple[Meaning, ...]:
    """Return what each of the headers can mean, every column at most once.

    Args:
        strange: the cells under each header that nobody knows.
        free: the columns that no header has.
        fits: whether a cell can stand in a column.
    """
    meant: dict[str, Meaning] = {}
    needed = [column for column in free if column.required]
    by_content = [column for column in free if column.key in _BY_CONTENT]
    usual = [column for column in free if column.key not in _SELDOM]
    for guess, columns in (
        (_by_name, needed),
        (_by_content, needed),
        (_by_name, free),
        (_by_content, by_content),
        (_by_unit, free),
        (partial(_by_unit, is_shared=True), usual),
        (_by_name_alone, free),
    ):
        taken = {meaning.column for meaning in meant.values()}
        left = {header: cells for header, cells in strange.items() if header not in meant}
        meant |= guess(left, [column for column in columns if column not in taken], fits)
    return tuple(meant.get(header, Meaning(header, None)) for header in strange)


def _by_name(strange: Cells, free: Sequence[Column], fits: Fits) -> dict[str, Meaning]:
    """Return the headers that are like the name of a column that can hold their cells."""
    pairs = [
        (likeness(header, column), header, column)
        for header, cells in strange.items()
        for column in free
        if _may_hold(column, header)
        and _share(column, cells, fits) >= FITS
        and (column.key not in _DISTINCT or _differ(cells))
    ]
    meant: dict[str, Meaning] = {}
    taken: set[str] = set()
    for like, header, column in sorted(pairs, key=lambda pair: -pair[0]):
        if like > 0 and header not in meant and column.key not in taken:
            meant[header] = Meaning(header, column)
            taken.add(column.key)
    return meant


def _by_name_alone(strange: Cells, free: Sequence[Column], _: Fits) -> dict[str, Meaning]:
    """Return the headers that are like a name, whatever stands under them: only a person knows."""
    named = _by_name(dict.fromkeys(strange, ()), free, lambda *_: True)
    return {header: replace(meaning, is_sure=False) for header, meaning in named.items()}


def _by_content(strange: Cells, free: Sequence[Column], fits: Fits) -> dict[str, Meaning]:
    """Return the headers whose cells are what a column holds."""
    meant: dict[str, Meaning] = {}
    for column in free:
        for header, cells in strange.items():
            is_it = any(cells) and _share(column, cells, fits) == 1 and _may_hold(column, header)
            if is_it and header not in meant and (column.key not in _DISTINCT or _differ(cells)):
                meant[header] = Meaning(header, column, is_sure=False)
                break
    return meant


def _by_unit(
    strange: Cells, free: Sequence[Column], fits: Fits, is_shared: bool = False
) -> dict[str, Meaning]:
    """Return the headers with a unit that only one column can have.

    Where `is_shared`, several can have it: headers and columns are then paired in their order.
    """
    meant: dict[str, Meaning] = {}
    left = list(free)
    for header, cells in strange.items():
        if split_header(header)[1] is None:
            continue
        can_be = [c for c in left if _may_hold(c, header) and _share(c, cells, fits) >= FITS]
        if len(can_be) == 1 or (can_be and is_shared):
            meant[header] = Meaning(header, can_be[0], is_sure=False)
            left.remove(can_be[0])
    return meant


def _differ(cells: Sequence[str]) -> bool:
    return len(set(cells)) == len(cells)


def _may_hold(column: Column, header: str) -> bool:
    unit = split_header(header)[1]
    return unit is None or find_scale(column.dimension, unit) is not None


def _share(column: Column, cells: Sequence[str], fits: Fits) -> float:
    """Return the share of the cells that can stand in a column; 1 where all are empty."""
    filled = [cell for cell in cells if cell]
    return sum(fits(column, cell) for cell in filled) / len(filled) if filled else 1.0


def likeness(header: str, column: Column) -> float:
    """Return how much a header is like the names of a column, from 0, not at all, to 1."""
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
