"""The lines of `archief.toml` that answer what a fault asks; what is not known is a `?` in them.

Only a person knows what a column of another name holds: the nearest names stand behind a `#`.
"""

import difflib
import json
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Final

from pipeline.messages import Sentence, innermost
from warehouse.archive.faults import Fault
from warehouse.archive.files.list_kinds import BOATS, LIST_KINDS
from warehouse.archive.files.names import SAMPLES
from warehouse.archive.profile.season import MAY_BE_ABSENT, SAMPLE_COLUMNS
from warehouse.archive.sheets.cells import BOAT_NUMBER
from warehouse.archive.spelling.headers import split_header
from warehouse.archive.spelling.text import fold, fold_word
from warehouse.archive.spelling.units import find_scale

Values = Mapping[str, Any]
"""What is filled in in the sentence of a fault."""

_SAMPLES: Final = {column.key: column for column in SAMPLE_COLUMNS}
_DATED: Final = [kind.name for kind in LIST_KINDS if kind != BOATS]
_STANDS_FOR: Final = ", ".join([BOATS.name, *(f"{name}_<jaar>" for name in (*_DATED, SAMPLES))])
_LONGEST_WORD: Final = 30
"""A cell longer than that is no word that stands for something."""


def settings_for(fault: Fault, season: int, boats: Iterable[str]) -> tuple[str, ...]:
    """The lines to fill in; none where `archief.toml` cannot settle it.

    Args:
        fault: what is wrong.
        season: of the samples file that it is in; 0 where that is not known, and for a list.
        boats: the names of the boats that are listed.
    """
    what = innermost(fault.message)
    if fault.reason_code == "unknown_boat" and isinstance(what, Sentence):
        return tuple(_of_boat(what.values["boat"], boats))
    rule = _RULES.get(fault.reason_code)
    if rule is None or not isinstance(what, Sentence):
        return ()
    in_profile = f'[[profile]] seasons = "{season}": ' if season else ""
    return tuple(rule(fault.path, what.values, in_profile))


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def _in_lines(path: str, in_profile: str = "") -> str:
    """Which lines a header takes."""
    key = f"{in_profile}header_lines" if in_profile else f"[header_lines] {_quoted(path)}"
    return f'{key} = "?"  # 1:3, 3:5'


def _of_headers(path: str, values: Values, in_profile: str) -> Iterator[str]:
    for header, near in values.get("near", ()):
        choices = [*(near or values["lacking"]), f"ignore = [{_quoted(header)}]"]
        yield f'[headers] {_quoted(header)} = "?"  # {", ".join(choices)}'
    if "number" in values:
        yield _in_lines(path)
    if "name" in values and in_profile:
        ignored = f"ignore = [{_quoted(values['name'])}]"
        yield f"{in_profile}columns.gps = {_quoted(_without_unit(values['name']))}  # {ignored}"


def _of_samples(path: str, values: Values, in_profile: str) -> Iterator[str]:
    """The columns that a file lacks; of samples with the headers whose unit does not forbid it.

    What a season can go without may be declared absent.
    """
    header = values.get("header", ())
    keys = ("run", "time") if values.get("keys") == ("run",) else values.get("keys", ())
    if not in_profile:
        yield _in_lines(path)
        return
    for key in keys:
        can_be = [_quoted(_without_unit(cell)) for cell in header if _may_be(cell, key)]
        absent = [name for name, channels in MAY_BE_ABSENT.items() if key in channels]
        choices = [*can_be, *(f'absent = ["{name}"]' for name in absent)]
        yield f'{in_profile}columns.{key} = "?"  # {", ".join(choices)}'.removesuffix("  # ")


def _may_be(cell: str, key: str) -> bool:
    unit = split_header(cell)[1]
    return unit is None or find_scale(_SAMPLES[key].dimension, unit) is not None


def _without_unit(cell: str) -> str:
    """The name in a header cell as it is written."""
    name, unit = split_header(cell)
    if unit is None:
        return cell
    return next((cell[:end] for end in range(1, len(cell)) if fold(cell[:end]) == name), cell)


def _of_value(_: str, values: Values, __: str) -> Iterator[str]:
    """A word where a number, a class or a choice belongs."""
    cell = values.get("cell")
    if isinstance(cell, str) and 0 < len(cell) <= _LONGEST_WORD and not _has_digit(cell):
        choices = values.get("choices", '""')
        yield f'[words] {_quoted(fold_word(cell))} = "?"  # {choices}'


def _of_boat(boat: str, boats: Iterable[str]) -> Iterator[str]:
    """A boat under a name, or a spelling of it, that no boat list has."""
    if BOAT_NUMBER.fullmatch(boat) is None:
        written = {fold(name): name for name in boats}
        near = [written[name] for name in difflib.get_close_matches(fold(boat), written)]
        yield f'[words] {_quoted(fold_word(boat))} = "?"  # {", ".join(near)}'.removesuffix("  # ")


def _has_digit(cell: str) -> bool:
    return any(map(str.isdigit, cell))


def _of_date(path: str, _: Values, __: str) -> Iterator[str]:
    yield f'[dates] {_quoted(path)} = "?"  # dmy, mdy'


def _of_decimals(path: str, values: Values, _: str) -> Iterator[str]:
    if len(values.get("mark", "")) == 1:
        yield f'[decimals] {_quoted(path)} = "?"  # ",", "."'


def _of_times(_: str, values: Values, in_profile: str) -> Iterator[str]:
    if in_profile and values.get("observed", 0) >= 1:
        yield f"{in_profile}sample_rate_hz = {values['observed']:.0f}"


def _of_unit(path: str, values: Values, in_profile: str) -> Iterator[str]:
    keys = set(values.get("keys", ()))
    absent = [name for name, channels in MAY_BE_ABSENT.items() if keys.intersection(channels)]
    if in_profile and absent:
        yield f"{in_profile}absent = {json.dumps(absent)}"
    elif in_profile and len(keys) == 1 and "known" in values:
        known = values["known"].replace("[", "").replace("]", "")
        yield f'{in_profile}units.{keys.pop()} = "?"  # {known}'
    if "can_be" in values:
        yield _in_lines(path, in_profile)


def _of_sign(_: str, values: Values, in_profile: str) -> Iterator[str]:
    if in_profile and values.get("turned"):
        yield f'{in_profile}reversed = ["force"]'


def _of_file(_: str, values: Values, __: str) -> Iterator[str]:
    if "path" in values:
        path, inside = _quoted(values["path"]), map(_quoted, values.get("inside", ()))
        choices = ", ".join([_STANDS_FOR, f"ignore = [{path}]", *inside])
        yield f'[files] {path} = "?"  # {choices}'


_RULES: Final = {
    "unknown_column": _of_headers,
    "missing_column": _of_samples,
    "ambiguous_date": _of_date,
    "ambiguous_number": _of_decimals,
    "bad_time": _of_times,
    "short_run": _of_times,
    "unknown_unit": _of_unit,
    "negative_force": _of_sign,
    "unrecognised_file": _of_file,
    **dict.fromkeys(
        ("bad_list_row", "bad_boat_row", "bad_race_row", "bad_register_row"), _of_value
    ),
}
