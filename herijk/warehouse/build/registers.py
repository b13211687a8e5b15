"""Registers: a draft per method, what changes between them, and the published editions."""

import datetime as dt
from collections.abc import Sequence
from typing import TYPE_CHECKING

import polars as pl

from herijk.pipeline.method.definition import Method
from herijk.pipeline.register.changes import register_changes
from herijk.pipeline.register.due import due_list
from herijk.pipeline.register.register import (
    draft_name,
    draft_register,
    lines_of_all_days,
    reference_day,
)
from herijk.tables.editions import Editions
from herijk.tables.keys import SIZES
from herijk.tables.register import RegisterChanges
from herijk.tables.schemas import conform
from herijk.warehouse.build.published import history_rows, lineage_rows
from herijk.warehouse.build.version import code_version

if TYPE_CHECKING:
    from herijk.warehouse.build.inputs import Inputs


def register_tables(inputs: "Inputs") -> dict[str, pl.DataFrame]:
    """Draft registers, who is due, what changes between registers, and lineage.

    Drafts are compared with the first method's. The published editions stand beside the drafts.
    """
    methods = inputs.methods
    drafts = [_draft(method, inputs) for method in methods]
    histories = [_history(method, inputs) for method in methods]
    register = pl.concat(drafts)
    changes = [register_changes(drafts[0], draft) for draft in drafts[1:]]
    hashes = {method.name: method.content_hash for method in methods}
    made = {
        "register": register,
        "register_history": pl.concat(histories),
        "register_changes": pl.concat(changes) if changes else RegisterChanges.create_empty(),
        "lineage": lineage_rows(register, inputs["tows"], hashes, code_version()),
        "editions": Editions.create_empty(),
    }
    with_editions = {
        name: pl.concat([conform(name, frame), inputs[f"published_{name}"]])
        for name, frame in made.items()
    }
    return with_editions | {"due_list": _due_list(inputs), "methods": _methods(methods)}


def _draft(method: Method, inputs: "Inputs") -> pl.DataFrame:
    tows = inputs["tows"]
    lines = _register(method, inputs, reference_day(tows, inputs["listed_races"]))
    edition, name = pl.lit(draft_name(method.name)), pl.lit(method.name)
    code = pl.lit(None, pl.String).alias("verification_code")
    measured = lines.join(
        tows.select("tow_id", *SIZES), on="tow_id", how="left", maintain_order="left"
    )
    return measured.select(edition.alias("edition"), name.alias("method"), pl.all(), code)


def _register(method: Method, inputs: "Inputs", on_date: dt.date) -> pl.DataFrame:
    """The lines of a method on a day, after the decisions of people."""
    curves = inputs["curves"].filter(pl.col("method") == method.name)
    tows, crews = inputs["tows"], inputs["listed_boats"]
    return draft_register(curves, tows, crews, on_date, method.validity, inputs["decisions"])


def _history(method: Method, inputs: "Inputs") -> pl.DataFrame:
    curves = inputs["curves"].filter(pl.col("method") == method.name)
    lines = lines_of_all_days(curves, inputs["tows"], method.validity, inputs["decisions"])
    return history_rows(lines, draft_name(method.name), method.name)


def _due_list(inputs: "Inputs") -> pl.DataFrame:
    """Rows of the table `due_list` of every method."""
    results = inputs["listed_races"]
    as_of = reference_day(inputs["tows"], results)
    parts = []
    for method in inputs.methods:
        due = due_list(_register(method, inputs, as_of), inputs["boats"], results, as_of)
        parts.append(due.select(pl.lit(method.name).alias("method"), pl.all()))
    return pl.concat(parts)


def _methods(methods: Sequence[Method]) -> pl.DataFrame:
    return pl.DataFrame(
        {
            "method": [m.name for m in methods],
            "title": [m.title for m in methods],
            "title_en": [m.title_en for m in methods],
            "interval": [m.interval for m in methods],
            "content_hash": [m.content_hash for m in methods],
            "definition": [m.definition for m in methods],
        }
    )
