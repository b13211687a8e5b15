"""The rows of the tow lists: `sleeplijst_<jaar>.csv`.

What a row says by itself. What rows, boats and files say about each other belongs to the room
`index`.
"""

import re
from collections.abc import Iterable
from typing import Final

import polars as pl

from pipeline.channels import MOST_RUNS, SECOND_FILE_OFFSET
from pipeline.messages import say
from warehouse.archive.faults import Fault
from warehouse.archive.files.list_kinds import TOWS
from warehouse.archive.profile.definition import Profiles
from warehouse.archive.profile.season import Plan
from warehouse.archive.sheets.cells import WrongError, run_number
from warehouse.archive.sheets.rows import Problem, cell, check_year, header, sound_rows
from warehouse.archive.spelling.synonyms import ALL_RUNS
from warehouse.archive.spelling.text import fold_word, shorten

_DECISIVE: Final = frozenset({"speed_correction_ratio", "sample_rate_hz", "altered"})
"""Optional, but where one cannot be read an empty cell would say something else: no alteration."""
_DISPENSABLE: Final = frozenset(
    column.key for column in TOWS.columns if not column.required and column.key not in _DECISIVE
)
"""Values whose absence makes a tow less sure, and not wrong."""
_RANGE: Final = re.compile(r"(b?[0-9]+)\s*(?:-|\.\.|:|t/m|tm|tot en met|to|bis|à)\s*(b?[0-9]+)")
_TOW_ID: Final = re.compile(r"[^/\\\x00-\x1f]{1,64}")


def with_ids(rows: pl.DataFrame) -> pl.DataFrame:
    """The rows with the id of their tow; without a column of ids: day, boat and crew."""
    day = pl.coalesce(pl.col("tow_date").dt.strftime("%Y-%m-%d"), cell("tow_date"), pl.lit(""))
    others = [cell(key).fill_null("") for key in ("fsn_no", "rowers", "crew_class")]
    made = pl.format("{} {} {}{}", day, *others).str.replace_all("/", "-", literal=True)
    has_ids = pl.col("headers").struct.field("tow_id").is_not_null()
    tow_id = pl.when(has_ids).then("tow_id").otherwise(made)
    return rows.with_columns(tow_id=tow_id, of_tow=tow_id)


def readable(
    rows: pl.DataFrame,
    problems: Iterable[Problem],
    profiles: Profiles,
    faults: list[Fault],
    more: list[Fault],
) -> tuple[pl.DataFrame, dict[int, frozenset[int]], list[Problem]]:
    """The rows of which everything that a tow needs can be read; each other leaves a fault.

    Args:
        rows: as `with_ids` returns them.
        problems: what is wrong in their cells.
        profiles: the runs that the tows are meant to have.
        faults: the first fault of each other row is added.
        more: what else is wrong in it.

    Returns:
        The rows; the runs to use, by `row`, those of the second file from 21 on; and what is wrong
        in cells that a tow can do without, which count as empty.
    """
    known: dict[int, list[Problem]] = {}
    for problem in problems:
        known.setdefault(problem.row, []).append(problem)
    selections: dict[int, frozenset[int]] = {}
    costly: list[Problem] = []
    lost: list[Problem] = []
    facts = rows.select(
        *("row", "tow_id", "season", "second_file", "use_runs"),
        id_column=header("tow_id"),
        runs_column=header("use_runs"),
    )
    for row, tow_id, season, second, use_runs, id_column, runs_column in facts.iter_rows():
        own = known.get(row, [])
        if own and not own[0].key:
            costly += own
            continue
        found = [p for p in own if p.key not in _DISPENSABLE and p.key != "file"]
        can_lack = sorted((p for p in own if p.key in _DISPENSABLE), key=lambda p: p.key)
        found += can_lack if found else []
        wrong_id = _wrong_id(row, tow_id, id_column)
        found = [wrong_id] if wrong_id else found
        try:
            plan = profiles.plan_of(tow_id or "", season)
            selections[row] = read_selection(use_runs, second is not None, plan, runs_column)
        except WrongError as error:
            text = error.in_words(runs_column, use_runs or "")
            found.append(Problem(row, "use_runs", TOWS.reason_code, text))
        found += [p for p in own if p.key == "file"]
        costly += found
        lost += [] if found else can_lack
    rows = sound_rows(rows, costly, faults, more)
    rows = check_year(rows, faults, "tow_date", "date_outside_season")
    return rows, selections, lost


def _wrong_id(row: int, tow_id: str | None, named: str) -> Problem | None:
    if tow_id is None:
        text = say("column '{column}' is empty.", column=named)
    elif not _TOW_ID.fullmatch(tow_id):
        text = say("'{tow}' cannot be a sleep_id: it is too long, or has a slash.")
        text = say(text, tow=shorten(tow_id))
    else:
        return None
    return Problem(row, "tow_id", TOWS.reason_code, text)


def read_selection(
    written: str | None, has_second: bool, plan: Plan, column: str
) -> frozenset[int]:
    """The runs to use; runs of the second file are 21 and on.

    Args:
        written: what the list says; None for nothing.
        has_second: the tow has a second file.
        plan: its runs; where nothing is written all of the first file, and of the second where the
            plan has them.
        column: what the list calls it.

    Raises:
        WrongError: it cannot be read.
    """
    planned = plan.runs
    if written is None or fold_word(written) in ALL_RUNS:
        both = plan.second_directions and has_second
        return frozenset(planned) | {SECOND_FILE_OFFSET + run for run in planned if both}
    parts = re.split(r"[\s,;+&]+", _spelled_out(fold_word(written)).strip(" ,;"))
    runs = [run_number(part, column, planned) for part in parts]
    if len(set(runs)) < len(runs):
        raise WrongError(say("column '{column}' is '{cell}'; it names one run twice."))
    if max(runs) > SECOND_FILE_OFFSET and not has_second:
        raise WrongError(say("column '{column}' is '{cell}', but there is no meetfile2."))
    return frozenset(runs)


def _spelled_out(cell: str) -> str:
    """The cell with ranges such as 1-6 as single numbers, and commas for `en`."""

    def numbers(match: re.Match[str]) -> str:
        letter = "b" if match[1].startswith("b") else ""
        first, last = (int(end.lstrip("b")) for end in match.groups())
        return ",".join(f"{letter}{run}" for run in range(first, min(last, first + MOST_RUNS) + 1))

    return _RANGE.sub(numbers, cell).replace(" en ", ",").replace(" and ", ",").replace(" et ", ",")
