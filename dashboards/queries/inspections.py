"""Inspection sheets: what was last measured of boats, for a person on the quay of a race."""

from collections.abc import Collection
from typing import Final

import polars as pl

from dashboards.addresses import make_key
from dashboards.queries.results import Data, Results
from pipeline.errors import MissingKnowledgeError
from pipeline.register.inspection import MEASURES, WEIGHT
from pipeline.tables.row import Row, pick_columns

KIND_OF_MEASURE: Final = {name: kind for kind, names in MEASURES.items() for name in names}

READING_ERROR: Final = 1e-6
"""By how much [cm] a size in whole cm can seem to be none: that of binary fractions."""


def read_inspections(results: Results) -> Data:
    """Return the sheets of all boats with a valid line, or with a result in a last race."""
    races = results.last_races
    named = races.select("race", "race_date", "key").unique(maintain_order=True)
    sheets = read_sheets(results, results.valid_boats | set(races["fsn_no"]))
    return sheets | {"races": named.to_dicts(), "chosen": {"race": ""}}


def read_sheets(results: Results, boats: Collection[str]) -> Data:
    """Return the inspection sheets of boats, sorted by their names.

    Returns:
        `boats`, a row each with its valid `crews`, the keys of the last `races` that it rowed, the
        `groups` of measures that were taken together, the names of `photos`, and the kinds of which
        nothing is `not_measured`. `tolerances`, a row for each kind with numbers: its `size` (of
        the weight as a ratio) and whether it is `inferred`.
    """
    rows = results.views.table("inspections").filter(pl.col("fsn_no").is_in(list(boats)))
    rows = rows.sort("fsn_no", "position").with_columns(
        kind=pl.col("measure").replace_strict(KIND_OF_MEASURE)
    )
    of_boats = rows.partition_by("fsn_no", as_dict=True, maintain_order=True)
    listed = results.views.table("boats").filter(pl.col("fsn_no").is_in(list(boats)))
    lines = results.valid_lines.partition_by("fsn_no", as_dict=True, maintain_order=True)
    raced = results.last_races.partition_by("fsn_no", as_dict=True, maintain_order=True)
    sheets = []
    for boat in listed.sort(pl.col("name").str.to_lowercase(), "fsn_no").to_dicts():
        key = (boat["fsn_no"],)
        about = {
            "fsn_no": boat["fsn_no"],
            "key": make_key(boat["fsn_no"]),
            "name": boat["name"] or boat["fsn_no"],
            "boat_type": boat["boat_type"],
            "crews": lines[key].to_dicts() if key in lines else [],
            "races": raced[key]["key"].to_list() if key in raced else [],
        }
        sheets.append(about | _describe_measures(of_boats[key]))
    return {"boats": sheets, "tolerances": _list_tolerances(rows)}


def choose_race(results: Results, name: str) -> Row:
    """Return the last race of a name, in any case: `race`, `race_date`, its `key` and `boats`.

    Raises:
        MissingKnowledgeError: no race has that name.
    """
    races = results.last_races
    own = races.filter(pl.col("race").str.to_lowercase() == name.lower())
    if own.is_empty():
        known = ", ".join(races["race"].unique(maintain_order=True)) or "-"
        raise MissingKnowledgeError("there is no race {}; there are: {}", name, known)
    first = own.row(0, named=True)
    return pick_columns(first, ("race", "race_date", "key")) | {"boats": set(own["fsn_no"])}


def _describe_measures(rows: pl.DataFrame) -> Data:
    """Return the measures of a boat by the tow at which they were taken, the last tow first.

    A kind of which nothing was ever measured is named alone; else what is missing of it is a group
    without a source.
    """
    has_any = pl.any_horizontal(pl.col("value", "photo").is_not_null()).any().over("kind")
    known = rows.filter(has_any)
    numbers = known.filter(pl.col("unit") != "")
    taken = ["source", "measured_on", "tow_id"]
    is_missing = pl.col("source").is_null()
    in_order = numbers.sort(
        is_missing, "measured_on", descending=[False, True], nulls_last=True, maintain_order=True
    )
    in_cm = pl.col("value", "lowest") * 100
    is_in_cm = pl.all_horizontal((in_cm - in_cm.round()).abs() < READING_ERROR)
    decimals = pl.when(pl.col("unit") == "kg").then(0).when(is_in_cm).then(2).otherwise(3)
    in_order = in_order.with_columns(decimals=decimals)
    parts = in_order.partition_by(taken, maintain_order=True)
    groups = [own.select(taken).row(0, named=True) | {"rows": own.to_dicts()} for own in parts]
    return {
        "groups": groups,
        "photos": known["photo"].drop_nulls().to_list(),
        "not_measured": rows.filter(~has_any)["kind"].unique(maintain_order=True).to_list(),
    }


def _list_tolerances(rows: pl.DataFrame) -> list[Row]:
    """Return how far each kind of measure may differ, and whether that is inferred."""
    ratio = pl.col("tolerance") / pl.col("value")
    size = pl.when(pl.col("measure") == WEIGHT).then(ratio).otherwise("tolerance")
    known = rows.drop_nulls("tolerance").sort("position", maintain_order=True)
    of_kinds = known.group_by("kind", maintain_order=True)
    return of_kinds.agg(size.first().alias("size"), pl.col("inferred").first()).to_dicts()
