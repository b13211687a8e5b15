"""Facts about types of boats, and what differs between two of them."""

from collections.abc import Sequence
from math import log
from typing import Final, TypeAlias

import polars as pl

from pipeline.errors import MissingKnowledgeError
from pipeline.quantiles import differ_beyond_intervals
from pipeline.tables.keys import TERM_NAMES, UNKNOWN_TYPE
from pipeline.tables.row import Row
from warehouse.queries.views import Views
from warehouse.store.boats import (
    choose_boat,
    find_boats,
    match_names,
    normalize_name,
    suggest_names,
)

USUAL_METHODS: Final = ("as-published", "rebased-2015", "rebased")
"""Methods by which types are compared when none is asked for: before, rules of 2015, and now."""

Judged: TypeAlias = tuple[Sequence[Row], Sequence[Row]]
"""A type under a method: its rows of `type_consistency` and those of `era_shifts`."""


def find_boat(views: Views, wanted: str) -> str | None:
    """Return the number of the boat that a name stands for, unless a type answers to it.

    A whole number or name of a boat goes before the beginning of a type, and that before the
    beginning of a boat.

    Raises:
        MissingKnowledgeError: several boats answer to the name, and no type.
    """
    boats, types = views.table("boats"), _read_type_names(views)
    is_whole_type = normalize_name(wanted) in set(map(normalize_name, types))
    begins_type = bool(match_names(wanted, types))
    is_whole_boat = bool(find_boats(boats, wanted, whole=True))
    if is_whole_type or (begins_type and not is_whole_boat) or not find_boats(boats, wanted):
        return None
    return choose_boat(boats, wanted)


def choose_type(views: Views, wanted: str) -> str:
    """Return the type that a name, or its beginning, stands for.

    Raises:
        MissingKnowledgeError: no type answers to the name, or several do.
    """
    types = _read_type_names(views)
    found = match_names(wanted, types)
    if len(found) == 1:
        return found[0]
    if found:
        raise MissingKnowledgeError(
            "{!r} may be any of {} types: {}; write more of the name",
            wanted,
            len(found),
            ", ".join(found),
        )
    boats = views.table("boats")
    if find_boats(boats, wanted):
        fsn_no = choose_boat(boats, wanted)
        raise MissingKnowledgeError(
            "{} is a boat, not a type; a boat has a page of its own: herijk audit {}",
            fsn_no,
            fsn_no,
        )
    known = list(types) + boats["fsn_no"].to_list() + boats["name"].drop_nulls().to_list()
    raise MissingKnowledgeError(
        "there is no boat and no type {!r}; the types, and how many boats: {}; boats are named by "
        "number or name, for example {}.{}",
        wanted,
        ", ".join(f"{name} ({n})" for name, n in types.items()),
        views.table("tows")["fsn_no"].min(),
        suggest_names(wanted, known),
    )


def _read_type_names(views: Views) -> dict[str, int]:
    """Return how many boats each type has, by its name."""
    types = views.table("boats")["boat_type"].fill_null(UNKNOWN_TYPE)
    return dict(types.value_counts(name="n").sort("boat_type").rows())


def read_type_facts(views: Views, boat_type: str) -> Row:
    """Return how many boats and tows a type has, and how they differ in size and speed."""
    is_of_type = pl.col("boat_type").fill_null(UNKNOWN_TYPE) == boat_type
    boats = views.table("boats").filter(is_of_type)
    tows = views.table("tows").join(boats, on="fsn_no", how="semi")
    facts = tows.select(
        n_towed=pl.col("fsn_no").n_unique(),
        n_tows=pl.len(),
        first_season=pl.col("season").min(),
        last_season=pl.col("season").max(),
        lightest_kg=pl.col("weight_kg").min(),
        heaviest_kg=pl.col("weight_kg").max(),
        slowest_m_s=pl.col("declared_speed_m_s").min(),
        fastest_m_s=pl.col("declared_speed_m_s").max(),
    )
    return {"boat_type": boat_type, "n_boats": boats.height} | facts.row(0, named=True)


def find_type_differences(first: Judged, *others: Judged) -> list[str]:
    """Return the quantities in which two types differ by more than both intervals.

    Returns:
        `quantity term` of slopes, `quantity verdict` where boats of one type are equal and those of
        the other are not, and the names of eras; of one type, nothing.
    """
    found = []
    for second in others:
        own, other = _list_intervals(first), _list_intervals(second)
        both = own.keys() & other.keys()
        found += [n for n in own if n in both and differ_beyond_intervals(own[n], other[n])]
        verdicts = {row["quantity"]: row["verdict"] for row in second[0]}
        for row in first[0]:
            if {row["verdict"], verdicts.get(row["quantity"])} == {"equal", "differ"}:
                found.append(f"{row['quantity']} verdict")
    return found


def _list_intervals(judged: Judged) -> dict[str, tuple[float, float, float]]:
    """Return every slope and shift with its interval; shifts as logarithms."""
    consistency, eras = judged
    found = {}
    for row in consistency:
        for term, name in TERM_NAMES.items():
            if row[f"{name}_slope"] is not None:
                found[f"{row['quantity']} {term}"] = (
                    row[f"{name}_slope"],
                    row[f"{name}_slope_lo"],
                    row[f"{name}_slope_hi"],
                )
    for era in eras:
        if not era["reason"]:
            found[era["era"]] = (log(era["shift_ratio"]), log(era["lo"]), log(era["hi"]))
    return found
