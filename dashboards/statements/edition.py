"""What an edition holds, and what it changes against another: how many lines, why, for whom."""

import json
from collections import Counter
from collections.abc import Iterator
from math import prod
from typing import Final, NamedTuple

import polars as pl

from dashboards import labels
from dashboards.speech import Headline
from dashboards.statements import Change, EditionName, Number, Statement, Value, together, told
from pipeline.messages import Sentence, say
from pipeline.register.words import CAUSES
from pipeline.tables.row import Row

NEGLIGIBLE: Final = 5e-4
"""A cause that moves Cw by less than this is 0.0 % and is summed with the others."""

REGISTER: Final = say(
    "A and B hold from 85 to 115 % of the declared speed; Cw holds at that speed. Its interval is "
    "a 95 % interval for a method that estimates the log's error. For other methods it is the "
    "spread of the runs alone: the log's error is not in it. An expired line has no A, B and Cw. A "
    "draft is not published."
)
"""What a reader of a register should know."""


def register(lines: pl.DataFrame) -> Statement:
    """How many lines have a curve, and on which day that was judged."""
    wording = say("{known} of {lines} lines have a valid curve on {day}.")
    known = lines["cw_kg_m"].drop_nulls().len()
    day = lines.select(pl.col("as_of").max()).item()
    return told("register", wording, {}, "register", known=known, lines=lines.height, day=day)


def causes_of_line(line: Row) -> list[tuple[Sentence, float]]:
    """Name and factor of what made a line change, the largest first; small ones as one."""
    causes = json.loads(line["causes"] or "[]")
    large = [one for one in causes if abs(one["factor"] - 1) >= NEGLIGIBLE]
    rest = prod(one["factor"] for one in causes if one not in large)
    large.sort(key=lambda one: -abs(one["factor"] - 1))
    others = [{"cause": "rest", "factor": rest}] if abs(rest - 1) >= NEGLIGIBLE else []
    return [(labels.cause(one), float(one["factor"])) for one in (*large, *others)]


def changes(lines: pl.DataFrame) -> Headline:
    """How many lines change, by more than their uncertainty, and mostly why."""
    return together(list(_changes(lines)))


def _changes(lines: pl.DataFrame) -> Iterator[Statement]:
    changed = lines.filter(change="changed")
    if lines.height:
        old, new = (EditionName(lines[f"{side}_edition"][0]) for side in ("from", "to"))
        wording = say("From \u201c{old}\u201d to \u201c{new}\u201d: ")
        yield told("from_to", wording, old=old, new=new)
    counts = {"changed": changed.height, "lines": lines.height}
    wording = say("{changed} of {lines} lines change")
    yield told("changed_lines", wording, counts, "register_changes")
    yield from _beyond_interval(changed)
    yield from _main_cause(changed)
    yield told("stop", say("."))
    yield from _log_unknown(changed)


def _beyond_interval(changed: pl.DataFrame) -> Iterator[Statement]:
    """How many lines change by more than their uncertainty, and of how many that is not known."""
    known = changed["exceeds_interval"].drop_nulls()
    if known.is_empty():
        if changed.height:
            wording = say("; none can be compared with the uncertainty")
            yield told("beyond_unknown", wording)
        return
    wording = say("; {beyond} by more than the uncertainty")
    beyond = int(known.sum()) or labels.code("none")
    yield told("beyond", wording, {}, "register_changes", beyond=beyond)
    unknown = changed.height - known.len()
    if unknown:
        wording = say(", and for {unknown} that is not known")
        yield told("beyond_unknown_of", wording, unknown=unknown)


def _main_cause(changed: pl.DataFrame) -> Iterator[Statement]:
    """What most lines change by most."""
    most = Counter(
        labels.cause(max(causes, key=lambda one: abs(one["factor"] - 1)))
        for causes in map(json.loads, changed["causes"])
        if causes
    ).most_common(1)
    if not most:
        return
    wording = (
        say(
            "; the cause is not known, because nobody recorded how the printed register was "
            "computed"
        )
        if most[0][0] == CAUSES["printed"]
        else say("; mostly because of {cause}")
    )
    yield told("main_cause", wording, {}, "register_changes", cause=most[0][0])


def _log_unknown(changed: pl.DataFrame) -> Iterator[Statement]:
    """Of which editions the uncertainty is too small, as it leaves out the error of the log."""
    known = changed.drop_nulls("exceeds_interval")
    unknown = [
        EditionName(known[f"{to}_edition"][0])
        for side, to in (("old", "from"), ("new", "to"))
        if not known[f"{side}_log_known"].fill_null(False).all()
    ]
    if not unknown:
        return
    first, last = unknown[0], unknown[-1]
    editions: Value = first
    if unknown[1:]:
        both: dict[str, Value] = {"old": first, "and": say(" and "), "new": last}
        editions = told("both", say("{old}{and}{new}"), both)
    wording = say(
        " The uncertainty of {editions} leaves out the error of the log: it is really larger."
    )
    yield told("log_unknown", wording, editions=editions)


def undecided(lines: pl.DataFrame, flagged: pl.Series) -> list[Statement]:
    """Of how many lines nothing can be told, and how many have a flag to look at.

    Args:
        lines: rows of `warehouse.queries.answers.line_changes` of two editions.
        flagged: tows with a flag under the method of the new one.
    """
    unknown = int(lines["exceeds_interval"].null_count())
    wording = (
        say("Lines whose change cannot be compared with the uncertainty: {unknown}.")
        if unknown
        else say("Every change can be compared with its uncertainty.")
    )
    voted = lines.drop_nulls("new_cw_kg_m")["new_tow_id"]
    of_flags = say(
        "Lines with a flag that the committee still has to look at: {flagged} of "
        "{lines}. Old numbers often have too small an uncertainty: the error of the "
        "log is not in it."
    )
    counts = {"flagged": int(voted.is_in(flagged.implode()).sum()), "lines": voted.len()}
    return [
        told("undecided", wording, {}, "register_changes", unknown=unknown),
        told("flagged", of_flags, counts, "flagged_boats"),
    ]


class Effect(NamedTuple):
    """What a change of register does to some of its lines.

    Attributes:
        of: which lines: a type with its class, or a method.
        lines: how many are compared.
        median, lowest, highest: Cw new / old.
        seconds: median gain over a race of two hours [s].
        beyond: how many change by more than their uncertainty, where that is known.
    """

    of: tuple[str, ...]
    lines: int
    median: Change
    lowest: Change
    highest: Change
    seconds: Number
    beyond: int | Sentence


def effects(lines: pl.DataFrame, *by: str) -> list[Effect]:
    """What happens to the lines with a number on both sides, by the values of these columns.

    Men come before women.
    """
    ratio = pl.col("cw_ratio")
    beyond = pl.col("exceeds_interval")
    found = (
        lines.filter(ratio.is_not_null())
        .with_columns(pl.col("boat_type").fill_null("").replace("", "unknown"))
        .group_by(by, maintain_order=True)
        .agg(
            pl.len().alias("lines"),
            ratio.median().alias("median"),
            ratio.min().alias("lowest"),
            ratio.max().alias("highest"),
            pl.col("gain_in_two_hours_s").median().alias("seconds"),
            pl.when(beyond.count() > 0).then(beyond.sum()).alias("beyond"),
        )
        .sort(by, descending=[name == "crew_class" for name in by])
        .filter(pl.col("lines") > 0)  # without `by` there is a row of nothing
    )
    return [
        Effect(
            tuple(row[name] for name in by),
            row["lines"],
            Change(row["median"]),
            Change(row["lowest"]),
            Change(row["highest"]),
            Number(row["seconds"], 0, "s", sign="+"),
            say("not known") if row["beyond"] is None else row["beyond"],
        )
        for row in found.to_dicts()
    ]
