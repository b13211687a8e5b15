"""Registers: a draft per method, what changes between them, and the published editions."""

import datetime as dt
from collections.abc import Mapping, Sequence

import polars as pl

from pipeline.method.definition import Method
from pipeline.register import due
from pipeline.register.changes import register_changes
from pipeline.register.register import (
    draft_name,
    draft_register,
    lines_of_all_days,
    reference_day,
)
from pipeline.tables.editions import Editions
from pipeline.tables.keys import SIZES
from pipeline.tables.register import RegisterChanges
from pipeline.tables.schemas import conform
from warehouse.derive.published import history_rows, lineage_rows
from warehouse.store.code import code_version


def register_tables(
    curves: pl.DataFrame,
    tows: pl.DataFrame,
    boats: pl.DataFrame,
    listed_boats: pl.DataFrame,
    listed_races: pl.DataFrame,
    decisions: pl.DataFrame,
    published: Mapping[str, pl.DataFrame],
    methods: Sequence[Method],
) -> dict[str, pl.DataFrame]:
    """Draft registers, what changes between registers, lineage, and who is due to be towed.

    Drafts are compared with the first method's. The published editions stand beside the drafts.
    """
    as_of, known = reference_day(tows, listed_races), (curves, tows, listed_boats, decisions)
    lines = {method.name: lines_on(method, *known, as_of) for method in methods}
    drafts = [_draft(method, own, tows) for method, own in lines.items()]
    histories = [_history(method, curves, tows, decisions) for method in methods]
    register = pl.concat(drafts)
    changes = [register_changes(drafts[0], draft) for draft in drafts[1:]]
    hashes = {method.name: method.content_hash for method in methods}
    made = {
        "register": register,
        "register_history": pl.concat(histories),
        "register_changes": pl.concat(changes) if changes else RegisterChanges.create_empty(),
        "lineage": lineage_rows(register, tows, hashes, code_version()),
        "editions": Editions.create_empty(),
    }
    with_editions = {
        name: pl.concat([conform(name, frame), published[name]]) for name, frame in made.items()
    }
    return with_editions | {
        "methods": _methods(methods),
        "due_list": due_of_lines(lines, boats, listed_races, as_of),
    }


def due_of_lines(
    lines: Mapping[str, pl.DataFrame], boats: pl.DataFrame, races: pl.DataFrame, as_of: dt.date
) -> pl.DataFrame:
    """Rows of `due_list`, of the lines of each method."""
    parts = {method: due.due_list(own, boats, races, as_of) for method, own in lines.items()}
    named = (
        part.select(pl.lit(method).alias("method"), pl.all()) for method, part in parts.items()
    )
    return pl.concat(named)


def lines_on(
    method: Method,
    curves: pl.DataFrame,
    tows: pl.DataFrame,
    crews: pl.DataFrame,
    decisions: pl.DataFrame,
    on_date: dt.date,
) -> pl.DataFrame:
    """The lines of a method on a day, after the decisions of people."""
    own = curves.filter(pl.col("method") == method.name)
    return draft_register(own, tows, crews, on_date, method.validity, decisions)


def _draft(method: str, lines: pl.DataFrame, tows: pl.DataFrame) -> pl.DataFrame:
    edition, name = pl.lit(draft_name(method)), pl.lit(method)
    code = pl.lit(None, pl.String).alias("verification_code")
    measured = lines.join(
        tows.select("tow_id", *SIZES), on="tow_id", how="left", maintain_order="left"
    )
    return measured.select(edition.alias("edition"), name.alias("method"), pl.all(), code)


def _history(
    method: Method, curves: pl.DataFrame, tows: pl.DataFrame, decisions: pl.DataFrame
) -> pl.DataFrame:
    own = curves.filter(pl.col("method") == method.name)
    lines = lines_of_all_days(own, tows, method.validity, decisions)
    return history_rows(lines, draft_name(method.name), method.name)


def _methods(methods: Sequence[Method]) -> pl.DataFrame:
    facts = ("title", "title_en", "interval", "content_hash", "definition")
    return pl.DataFrame(
        [{"method": m.name} | {name: getattr(m, name) for name in facts} for m in methods]
    )
