"""What in `archief.toml` would settle a fault.

A proposal is for a person to look at. One that would be a guess (is 1/3 in January or in March?) is
written as a comment, with its choices.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from pipeline.messages import Sentence, innermost
from warehouse.archive.faults import Fault
from warehouse.archive.files.names import PARTS
from warehouse.archive.profile.season import MAY_BE_ABSENT, SAMPLE_COLUMNS
from warehouse.archive.spelling.columns import Column
from warehouse.archive.spelling.headers import split_header
from warehouse.archive.spelling.likeness import nearest_column
from warehouse.archive.spelling.text import fold, fold_word
from warehouse.archive.spelling.units import find_scale
from warehouse.archive.spelling.wording import Wording

_SAMPLES: Final = {column.key: column for column in Wording().with_names(SAMPLE_COLUMNS)}
_OF_THE_SECOND: Final = re.compile(r"(2|b|ii|stb|sb|starboard|stuurboord)$", re.IGNORECASE)
_SHORTEST_STEM: Final = 4
"""Letters of a name by which a longer one can begin."""

_ONE_WORD: Final = 30
"""A cell longer than that is no word that stands for something."""

OF_NAMES: Final = frozenset({"ignore", "absent", "reversed"})
"""Keys of `archief.toml` that hold a list of names."""

_CLASS_OF_LETTER: Final = {"h": "H", "m": "H", "d": "D", "v": "D", "w": "D", "f": "D"}
"""The class that a word most likely means, by its first letter."""


@dataclass(frozen=True)
class Proposal:
    """One line for `archief.toml`.

    Attributes:
        section: `words`, `headers`, `ignore`, `dates`, `decimals`, `files`, or `columns`,
            `absent`, `reversed`, `sample_rate_hz` of a season.
        key: its key there; empty for `ignore`, `absent` and `reversed`.
        value: its value.
        season: the season of a profile, else 0.
        is_active: it is not a guess; otherwise it is written as a comment.
    """

    section: str
    key: str
    value: str
    season: int = 0
    is_active: bool = True

    @property
    def assignment(self) -> str:
        """The key with its value, as `archief.toml` has them."""
        if self.section in OF_NAMES:
            return f'{self.section} = ["{self.value}"]'
        if self.section == "sample_rate_hz":
            return f"sample_rate_hz = {self.value}"
        key = f"columns.{self.key}" if self.section == "columns" else f'"{self.key}"'
        return f'{key} = "{self.value}"'

    @property
    def line(self) -> str:
        """Key and value on one line, with their table before them."""
        if self.season:
            return f'[[profile]] seasons = "{self.season}": {self.assignment}'
        return (
            self.assignment if self.section == "ignore" else f"[{self.section}] {self.assignment}"
        )


def propose(
    fault: Fault, named: Mapping[str, str], seasons: Mapping[str, int]
) -> tuple[Proposal, ...]:
    """What would settle a fault; nothing where only a person can.

    Args:
        fault: what is wrong.
        named: what files and folders stand for, by their path (`[files]`).
        seasons: of samples files, by the rows that name them.
    """
    what = innermost(fault.message)
    if not isinstance(what, Sentence):
        return ()
    rule = _RULES.get(fault.reason_code)
    season = seasons.get(fault.path.split(PARTS)[0]) or _season(fault.path, named)
    return () if rule is None else tuple(rule(fault.path, what.values, season))


def _of_headers(_: str, values: Any, season: int) -> Iterator[Proposal]:
    """A header that nobody knows: the nearest that is not there yet, else to be ignored.

    One of a samples file can be the GPS.
    """
    if "name" in values and season:
        yield Proposal("columns", "gps", _without_unit(str(values["name"])), season)
    for header, nearest, is_sure in values.get("meant", ()):
        if nearest:
            is_active = is_sure and not _has_other_brackets(header)
            yield Proposal("headers", _without_unit(header), nearest, is_active=is_active)
        else:
            yield Proposal("ignore", "", header)


def _of_value(_: str, values: Any, __: int) -> Iterator[Proposal]:
    """A word where a number, a class or a choice belongs."""
    cell = str(values.get("cell", ""))
    if not cell or len(cell) > _ONE_WORD or any(letter.isdigit() for letter in cell):
        return
    word = fold_word(cell)
    if "choice" in values:
        yield Proposal("words", word, str(values["choice"]), is_active=False)
    elif "expected" in values:
        meant = _CLASS_OF_LETTER.get(word[:1], "")
        sure = bool(meant) and len(word) > 1 and not word.startswith("mi")  # mixed, mixte
        yield Proposal("words", word, meant or "H", is_active=sure)
    else:
        yield Proposal("words", word, "")


def _of_date(path: str, _: object, __: int) -> Iterator[Proposal]:
    yield Proposal("dates", path, "dmy", is_active=False)


def _of_decimals(path: str, values: Any, _: int) -> Iterator[Proposal]:
    if len(values.get("mark", "")) == 1:
        yield Proposal("decimals", path, values["mark"], is_active=False)


def _of_samples(_: str, values: Any, season: int) -> Iterator[Proposal]:
    """Columns that a samples file lacks: the one column that can be it, or declared absent.

    A file without a column that can be log 1 or the force is not a samples file: notes, say.
    """
    keys, header = values.get("keys", ()), values.get("header", ())
    if not season or not set(keys) <= set(_SAMPLES):
        return
    offered = list(_of_columns(keys, header, season))
    if {"log1", "force"} <= set(keys) and all(p.section == "absent" for p in offered):
        return
    yield from offered


def _of_columns(keys: Sequence[str], header: Sequence[Any], season: int) -> Iterator[Proposal]:
    free, unmatched = list(header), list[str]()
    if keys == ("run",):  # each of these tells the runs
        is_one = len(header) == 1
        yield from (Proposal("columns", key, name, season, is_one) for key, name in header)
        return
    for key in keys:
        column = _SAMPLES[key]
        fitting = [cell for cell in header if _can_be(cell, column) and not _anothers(cell, key)]
        is_told = key != "log2" or "log1" in keys  # any speed could be it otherwise: a target
        near = [cell for cell in fitting if _is_like(cell, column)] or fitting * is_told
        left = _own_log_first(key, [cell for cell in near if cell in free])
        if left:
            free.remove(left[0])  # of several, only a person can tell which is which
            name = _without_unit(left[0])
            is_sure = len(near) == 1 and not _has_other_brackets(left[0])
            yield Proposal("columns", key, name, season, is_sure)
        elif not near:
            absent = [name for name, channels in MAY_BE_ABSENT.items() if key in channels]
            is_sure = not any(_is_open(cell, column) for cell in free)
            yield from (Proposal("absent", "", name, season, is_sure) for name in absent)
            unmatched += [] if absent else [key]
    if len(unmatched) == len(free) == 1:
        yield Proposal("columns", unmatched[0], _without_unit(free[0]), season, is_active=False)


def _has_other_brackets(cell: str) -> bool:
    """Whether a header has brackets that are no known unit: they can be an unknown one."""
    return split_header(cell)[1] is None and any(mark in cell for mark in "([")


def _own_log_first(key: str, cells: list[str]) -> list[str]:
    """Headers that can be a log: of the second log first those that say so."""
    if key not in {"log1", "log2"}:
        return cells
    is_second = [bool(_OF_THE_SECOND.search(_without_unit(cell).strip())) for cell in cells]
    order = sorted(range(len(cells)), key=lambda i: is_second[i] != (key == "log2"))
    return [cells[i] for i in order]


def _is_open(cell: str, column: Column) -> bool:
    """Whether a header that nobody knows can be a column: its unit does not rule it out."""
    unit = split_header(cell)[1]
    is_it = unit is None or find_scale(column.dimension, unit) is not None
    return is_it and not _anothers(cell, column.key)


def _of_times(_: str, values: Any, season: int) -> Iterator[Proposal]:
    """Times that say another rate than the profile does."""
    if season and "observed" in values:
        rate = f"{values['observed']:.0f}"
        yield Proposal("sample_rate_hz", "", rate, season, is_active="planned" not in values)


def _of_unit(_: str, values: Any, season: int) -> Iterator[Proposal]:
    """A unit that cannot be converted: what it is of can be declared absent."""
    for name in values.get("absent", ()) if season else ():
        yield Proposal("absent", "", name, season, is_active=False)


def _of_sign(_: str, values: Any, season: int) -> Iterator[Proposal]:
    """A force that is right but for its sign: of this tow, and maybe of its season."""
    if season and values.get("turned"):
        yield Proposal("reversed", "", "force", season, is_active=False)


def _of_stranger(_: str, values: Any, __: int) -> Iterator[Proposal]:
    """A file or folder of another name: what it can be."""
    for file, stands_for in values.get("can_be", ()):
        yield Proposal("files", file, stands_for)


def _is_like(cell: str, column: Column) -> bool:
    """Whether a header's name is like a column's, or begins with it: `Windgeschw.`."""
    name = split_header(cell)[0]
    names = (fold(own) for own in (column.header, *column.also))
    begins = any(len(own) >= _SHORTEST_STEM and name.startswith(own) for own in names)
    return begins or nearest_column(cell, [column]) is not None


def _anothers(cell: str, key: str) -> bool:
    """Whether a header is another column's by its name: wind is not a log, also in knots."""
    others = (column for other, column in _SAMPLES.items() if other != key)
    like_another = any(_is_like(cell, c) and _can_be(cell, c) for c in others)
    return like_another and not _is_like(cell, _SAMPLES[key])


def _can_be(cell: str, column: Column) -> bool:
    name, unit = split_header(cell)
    taken = any(other.answers_to(name) for other in _SAMPLES.values())
    if taken:
        return False
    if unit is None:
        return nearest_column(cell, [column]) is not None
    return find_scale(column.dimension, unit) is not None


def _without_unit(cell: str) -> str:
    """The name in a header cell as it is written."""
    name, unit = split_header(cell)
    if unit is None:
        return cell
    return next((cell[:end] for end in range(1, len(cell)) if fold(cell[:end]) == name), cell)


def _season(path: str, named: Mapping[str, str]) -> int:
    """The season of a samples file, 0 where its folder does not tell it."""
    own = (name for folder, name in named.items() if path.startswith(f"{folder}/"))
    name = next(own, path.partition("/")[0])
    digits = "".join(letter for letter in name if letter.isdigit())
    return int(digits) if len(digits) == 4 else 0


_RULES: Final = {
    "unknown_column": _of_headers,
    "missing_column": _of_samples,
    "ambiguous_date": _of_date,
    "ambiguous_number": _of_decimals,
    "bad_time": _of_times,
    "short_run": _of_times,
    "unknown_unit": _of_unit,
    "negative_force": _of_sign,
    "unrecognised_file": _of_stranger,
    "bad_list_row": _of_value,
    "bad_boat_row": _of_value,
    "bad_race_row": _of_value,
    "bad_register_row": _of_value,
}
