"""What in `archief.toml` would settle a fault, and that file with it written in.

A proposal is for a person to look at. One that would be a guess (is 1/3 in January or in March?) is
written as a comment, with its choices.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any, Final

import tomlkit
from tomlkit.items import Table

from herijk.warehouse.archive.faults import Fault
from herijk.warehouse.archive.lists import fold_word
from herijk.warehouse.archive.messages import Sentence, innermost
from herijk.warehouse.archive.profile import MAY_BE_ABSENT, SAMPLE_COLUMNS
from herijk.warehouse.archive.text import fold, nearest_column, split_header
from herijk.warehouse.archive.units import find_scale

_SAMPLES: Final = {column.key: column for column in SAMPLE_COLUMNS}
_ONE_WORD: Final = 30
"""A cell longer than that is no word that stands for something."""


@dataclass(frozen=True)
class Proposal:
    """One line for `archief.toml`.

    Attributes:
        section: `words`, `headers`, `ignore`, `dates`, or `columns`, `absent` of a season.
        key: its key there; empty for `ignore` and `absent`.
        value: its value.
        season: the season of a profile, else 0.
        is_active: it is no guess; otherwise it is written as a comment.
    """

    section: str
    key: str
    value: str
    season: int = 0
    is_active: bool = True

    @property
    def line(self) -> str:
        """The line as it is in the file, its section first."""
        if self.section in {"ignore", "absent"}:
            body = f'{self.section} = ["{self.value}"]'
        elif self.section == "columns":
            body = f'columns = {{ {self.key} = "{self.value}" }}'
        else:
            body = f'[{self.section}] "{self.key}" = "{self.value}"'
        return f'[[profile]] seasons = "{self.season}": {body}' if self.season else body


def propose(fault: Fault) -> tuple[Proposal, ...]:
    """Return what would settle a fault; nothing where only a person can."""
    what = innermost(fault.message)
    if not isinstance(what, Sentence):
        return ()
    rule = _RULES.get(fault.reason_code)
    return () if rule is None else tuple(rule(fault, what.values))


def _of_headers(_: Fault, values: Any) -> Iterator[Proposal]:
    """A header that nobody knows: the nearest that is not there yet, else to be ignored."""
    for header, nearest in values.get("meant", ()):
        if nearest:
            yield Proposal("headers", _without_unit(header), nearest)
        else:
            yield Proposal("ignore", "", header)


def _of_value(_: Fault, values: Any) -> Iterator[Proposal]:
    """A word where a number, a class or a choice belongs."""
    cell = str(values.get("cell", ""))
    if not cell or len(cell) > _ONE_WORD or any(letter.isdigit() for letter in cell):
        return
    word = fold_word(cell)
    if "expected" in values:
        meant = next(
            (
                v
                for k, v in {"h": "H", "m": "H", "d": "D", "v": "D", "w": "D"}.items()
                if word.startswith(k)
            ),
            "",
        )
        sure = bool(meant) and len(word) > 1
        yield Proposal("words", word, meant or "H", is_active=sure)
    else:
        yield Proposal("words", word, "")


def _of_date(fault: Fault, _: Any) -> Iterator[Proposal]:
    yield Proposal("dates", fault.path, "dmy", is_active=False)


def _of_samples(fault: Fault, values: Any) -> Iterator[Proposal]:
    """Columns that a samples file lacks: the one column that can be it, or declared absent."""
    keys, header = values.get("keys", ()), values.get("header", ())
    season = _season(fault.path)
    if not season or not set(keys) <= set(_SAMPLES):
        return
    free = list(header)
    for key in keys:
        column = _SAMPLES[key]
        fitting = [cell for cell in header if _can_be(cell, column)]
        near = [cell for cell in fitting if nearest_column(cell, [column])] or fitting
        left = [cell for cell in near if cell in free]
        if left:
            free.remove(left[0])  # of several, only a person can tell which is which
            name = _without_unit(left[0])
            yield Proposal("columns", key, name, season, is_active=len(near) == 1)
        elif not near:
            absent = [name for name, channels in MAY_BE_ABSENT.items() if key in channels]
            yield from (Proposal("absent", "", name, season) for name in absent)


def _of_unknown_samples(fault: Fault, values: Any) -> Iterator[Proposal]:
    season = _season(fault.path)
    if "name" in values and season:
        yield Proposal("columns", "gps", _without_unit(str(values["name"])), season)


def _can_be(cell: str, column: Any) -> bool:
    name, unit = split_header(cell)
    taken = any(other.answers_to(name) for other in _SAMPLES.values())
    if taken:
        return False
    if unit is None:
        return nearest_column(cell, [column]) is not None
    return find_scale(column.dimension, unit) is not None


def _without_unit(cell: str) -> str:
    """Return the name in a header cell as it is written."""
    name = split_header(cell)[0]
    for end in range(len(cell), 0, -1):
        if fold(cell[:end]) == name:
            return cell[:end].rstrip(" [(,")
    return cell


def _season(path: str) -> int:
    digits = "".join(letter for letter in path.partition("/")[0] if letter.isdigit())
    return int(digits) if len(digits) == 4 else 0


_RULES: Final = {
    "unknown_column": lambda f, v: (_of_headers if "meant" in v else _of_unknown_samples)(f, v),
    "missing_column": lambda f, v: (_of_headers if "meant" in v else _of_samples)(f, v),
    "ambiguous_date": _of_date,
    "bad_list_row": _of_value,
    "bad_boat_row": _of_value,
    "bad_race_row": _of_value,
    "bad_register_row": _of_value,
}


def merged(text: str, proposals: Iterable[Proposal]) -> str:
    """Return `archief.toml` with proposals written in; what is there stays."""
    document = tomlkit.parse(text)
    for proposal in proposals:
        if proposal.section == "ignore":
            _add(document, "ignore", proposal.value)
        elif proposal.season:
            _in_profile(document, proposal)
        else:
            _in_section(document, proposal)
    return str(tomlkit.dumps(document))


def _in_section(document: Any, proposal: Proposal) -> None:
    section = document.setdefault(proposal.section, tomlkit.table())
    if proposal.is_active:
        section.setdefault(proposal.key, proposal.value)
    else:
        section.add(tomlkit.comment(f'"{proposal.key}" = "{proposal.value}"'))


def _add(table: Any, key: str, value: str) -> None:
    """Add to a list; a new one goes before the tables, where TOML wants it."""
    if key in table:
        if value not in table[key]:
            table[key].append(value)
        return
    fresh = tomlkit.array()
    fresh.append(value)
    if isinstance(table, Table):
        table.add(key, fresh)
        return
    rest = tomlkit.dumps(table)
    made = tomlkit.parse(f"{key} = {fresh.as_string()}\n{rest}")
    table.clear()
    for name, item in made.items():
        table[name] = item


def _in_profile(document: Any, proposal: Proposal) -> None:
    profiles = document.setdefault("profile", tomlkit.aot())
    mine = next((p for p in profiles if _covers(str(p.get("seasons", "")), proposal.season)), None)
    if mine is None:
        mine = tomlkit.table()
        mine.add("seasons", str(proposal.season))
        profiles.append(mine)
        mine = profiles[-1]
    if not proposal.is_active:
        key = "absent" if proposal.section == "absent" else f"columns.{proposal.key}"
        mine.add(tomlkit.comment(f'{key} = "{proposal.value}"'))
    elif proposal.section == "absent":
        _add(mine, "absent", proposal.value)
    else:
        columns = mine.setdefault("columns", tomlkit.inline_table())
        columns.setdefault(proposal.key, proposal.value)


def _covers(seasons: str, season: int) -> bool:
    first, _, last = seasons.partition(":")
    return first.isdigit() and int(first) <= season <= int(last or first)
