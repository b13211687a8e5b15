"""How results look as text: a page of sentences and tables, in the language of this command.

What a number, a code or a column is called and how it is written is in `dashboards`.
"""

import io
import re
import shutil
import sys
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Final

from rich.console import Console
from rich.table import Table

from dashboards import labels
from dashboards.columns import written
from dashboards.speech import Speech
from pipeline.messages import LANGUAGE, say, tell
from pipeline.tables.row import Row

UNLIMITED: Final = 1000
"""Characters on a line of a table that is not for a terminal."""

CHANGES: Final = {
    *("cw_ratio", "power_ratio", "total", "median_factor", "lowest_factor", "highest_factor"),
    *("cw_effect_ratio", "shift_ratio"),
}
"""Columns with new over old, shown as a change in per cent."""

SHARES: Final = re.compile("share|_sd_ratio|^sd_|u_ratio|rmse|most_|r2|at_10pct|p_fault")
"""Columns with a part of a whole, shown in per cent."""

HEADS: Final = {
    "gross_cw_kg_m": say("gross kg/m"),
    "inertia_cw_kg_m": say("-inertia"),
    "air_cw_kg_m": say("-air"),
    "still_air_cw_kg_m": say("+still"),
    "temperature_cw_kg_m": say("+temp"),
    "cw_kg_m": say("Cw kg/m"),
    "fitted_cw_kg_m": say("curve"),
    "speed_factor": say("factor"),
    "cw_effect_ratio": say("Cw"),
    "pooling": say("bend"),
    "median_b_m_s": say("median B [m/s]"),
    "b_sd_ratio": say("spread of B"),
    "most_115": say("most that Cw moves"),
    "most_fsn_no": say("of boat"),
    "follows": say("follows"),
    "equal_possible": say("possible"),
    "n_disagree": say("disagree"),
    "in_words": say("in words"),
    "made_again": say("made again"),
    "equal": say("equal"),
    "lines": say("lines"),
    "title": say("title"),
    "total": say("total"),
    "median_factor": say("median"),
    "lowest_factor": say("lowest"),
    "highest_factor": say("highest"),
    "old_winner": say("old winner"),
    "new_winner": say("new winner"),
    "winner_changed": say("changes"),
    "chance": say("chance that another wins"),
    "where": say("where"),
    "old_a_kg_m": say("A old"),
    "new_a_kg_m": say("new"),
    "old_b_m_s": say("B old"),
    "new_b_m_s": say("new"),
    "old_cw_kg_m": say("Cw old"),
    "new_cw_kg_m": say("new"),
    "old_power_w": say("W old"),
    "new_power_w": say("new"),
    "power_ratio": say("W %"),
    "in_2_h": say("in 2 h"),
    "n_predicted": say("predicted"),
    "rmse_ratio": say("off by"),
    "tow_sd_ratio": say("error of the tow"),
}
"""Headings on the terminal that are shorter than those of pages, or are there alone."""

NO_HEADS: Final[Mapping[str, str]] = {}
_NUMBER: Final = re.compile(r"[-+\u2212]?[0-9]+([.,][0-9]+)?(\u00a0%|\u00a0s|\u00a0N)?\*?|-?")
"""A cell that is aligned to the right."""


def speech() -> Speech:
    """Numbers and names as the language of this command writes them."""
    return Speech(LANGUAGE.get())


def page(parts: Iterable[str], simulated: bool) -> str:
    """Paragraphs, without those that are empty; the first says so where the boats are simulated."""
    return "\n\n".join(filter(None, [tell(labels.SIMULATED) if simulated else "", *parts]))


def section(heading: str, *parts: str) -> str:
    """A heading with what belongs below it; nothing where there is nothing below it."""
    return "\n".join([heading, *filter(None, parts)]) if any(parts) else ""


def table(rows: Sequence[Row], columns: str, heads: Mapping[str, str] = NO_HEADS) -> str:
    """Rows as lines of text, numbers to the right; no text where there are none.

    Args:
        rows: each with a value by name of column; of a line of a register also with its `crew`.
        columns: names of the columns shown, with blanks between them.
        heads: headings of this table alone.
    """
    if not rows:
        return ""
    drawn = Table(box=None, pad_edge=False, header_style="", collapse_padding=True)
    shown = [with_crew(row) if "rowers" in row else row for row in rows]
    cells = {name: [cell(name, row.get(name)) for row in shown] for name in columns.split()}
    for name, texts in cells.items():
        to_the_right = all(map(_NUMBER.fullmatch, texts))
        heading = heads.get(name) or HEADS.get(name) or labels.column(name)
        drawn.add_column(
            labels.unbroken(tell(heading)),
            justify="right" if to_the_right else "left",
            overflow="fold",
        )
    for line in zip(*cells.values(), strict=True):
        drawn.add_row(*line)
    return _as_text(drawn)


def _as_text(drawn: Table) -> str:
    """As wide as the terminal, or as wide as it needs to be elsewhere."""
    width = shutil.get_terminal_size().columns if sys.stdout.isatty() else UNLIMITED
    console = Console(file=io.StringIO(), width=width - 2, markup=False, highlight=False)
    with console.capture() as captured:
        console.print(drawn)
    return "\n".join(f"  {line.rstrip()}" for line in captured.get().splitlines())


def cell(name: str, value: Any) -> str:
    """A value as it is shown in the column of this name."""
    if value is None:
        return "-"
    if isinstance(value, float) and name in CHANGES:
        return speech().per_cent(value)
    if isinstance(value, float) and SHARES.search(name):
        return f"{speech().number(100 * value, 1)}\u00a0%"
    return written(name, value, speech())


def codes(value: str | Iterable[str]) -> str:
    """A code, or several with commas or as a list, in words."""
    return written("flags", value, speech())


def with_crew(row: Row) -> Row:
    """A row with its crew as people write it: 8H."""
    return row | {"crew": f"{row['rowers']}{row['crew_class']}", "name": row.get("name") or "-"}


def place(fault: Row) -> str:
    """Where a fault is: its file, and the line and the tow where these are known."""
    said = fault["line"] is None or fault.get("message", "").startswith(f"Line {fault['line']}:")
    line = "" if said else tell(", line {}", fault["line"])
    tow = "" if fault["tow_id"] is None else tell(" (tow {})", fault["tow_id"])
    return f"{fault['path']}{line}{tow}"


def why_set_aside(fault: Row) -> str:
    """What is wrong with something that was set aside."""
    return str(fault["message_nl" if LANGUAGE.get() == "nl" else "message"])


def interval_of_runs_alone(whose: str) -> str:
    """That an interval is too small, as it leaves out the error of the log."""
    return tell(
        "The interval of {} is the spread of the runs alone: the log's error is not in it.", whose
    )
