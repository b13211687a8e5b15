"""Types of boats: whether their boats are equal, what they follow, and their tows.

All of it is about the newest tow of each boat and crew. Verdicts are those of `type_consistency`.
"""

from collections.abc import Sequence
from math import floor, log10
from typing import Final

import polars as pl

from dashboards.addresses import boat_path
from dashboards.queries.pages import name_ends
from dashboards.queries.results import Data, Results
from pipeline.tables.keys import QUANTITIES, TERM_NAMES, UNKNOWN_TYPE
from pipeline.tables.row import Row
from warehouse.queries.types import find_type_differences, read_type_facts

DRAWN: Final = {
    "b_weight": ("b_m_s", "weight_kg"),
    "cw_weight": ("cw_standard_kg_m", "weight_kg"),
    "b_speed": ("b_m_s", "declared_speed_m_s"),
    "cw_speed": ("cw_standard_kg_m", "declared_speed_m_s"),
}
"""What is drawn against what on the page of a type, in order."""

INTERVALS: Final = {
    "a_kg_m": ("a_lo_kg_m", "a_hi_kg_m"),
    "b_m_s": ("b_lo_m_s", "b_hi_m_s"),
    "cw_standard_kg_m": ("cw_standard_lo_kg_m", "cw_standard_hi_kg_m"),
}
"""The columns of the interval of each quantity."""


def read_type(results: Results, boat_type: str) -> Data:
    """Return the data of the page of a type."""
    tows = _read_newest_tows(results).filter(boat_type=boat_type)
    ends = results.before_and_after
    lines = results.views.table("type_line_points")
    return {
        **_read_verdicts(results, boat_type, ends),
        "tows": tows,
        "before_and_after": tows.filter(pl.col("method").is_in(ends)),
        "line_points": lines.filter(pl.col("method").is_in(ends), boat_type=boat_type),
        "drawn": DRAWN,
        "intervals": INTERVALS,
        "methods": results.methods,
        "chosen": {"method": results.method},
    }


def _read_verdicts(results: Results, boat_type: str, methods: Sequence[str]) -> Data:
    """Return the verdicts on a type, and the boats that stand out.

    Args:
        results: the tables.
        boat_type: its name.
        methods: those that stand side by side in the table; the last gives the verdicts.
    """
    rows = _read_consistency(results, boat_type, methods)
    shown = methods[-1]
    outside = results.views.ask("outliers").filter(method=shown, boat_type=boat_type)
    return {
        "boat_type": boat_type,
        "verdicts": [row for row in rows if row["method"] == shown],
        "rows": rows,
        "outside": outside,
        "boat_names": {
            fsn_no: results.boat_names[fsn_no]
            for row in rows
            for fsn_no in (row["farthest"], *row["outside"])
            if fsn_no in results.boat_names
        },
        "terms": TERM_NAMES,
    }


def _read_consistency(results: Results, boat_type: str, methods: Sequence[str]) -> list[Row]:
    """Return the rows of `type_consistency` of a type, by quantity and then by method."""
    known = results.views.table("type_consistency").filter(
        pl.col("method").is_in(methods), boat_type=boat_type
    )
    rows = known.to_dicts()
    for row in rows:
        for term in TERM_NAMES.values():
            row[f"{term}_decimals"] = choose_decimals(row, term)
    return sorted(
        rows, key=lambda row: (QUANTITIES.index(row["quantity"]), methods.index(row["method"]))
    )


def choose_decimals(row: Row, term: str) -> int:
    """Return the decimals with which a slope in per cent has two digits that say something."""
    low, high = row[f"{term}_slope_lo"], row[f"{term}_slope_hi"]
    if low is None or high is None:
        return 0
    return max(0, 1 - floor(log10(100 * max(abs(low), abs(high)) or 1.0)))


def _read_newest_tows(results: Results) -> pl.DataFrame:
    """Return the newest tow of each boat and crew of a known type, with the page of its boat."""
    intervals = results.views.table("methods").select("method", "interval")
    is_shown = pl.col("method").is_in(results.methods)
    page = "../" + pl.col("fsn_no").map_elements(boat_path, pl.String)
    label = pl.format("{} {}{} {}", "name", "rowers", "crew_class", "season")
    return (
        results.views.ask("type_tows")
        .filter("newest", is_shown)
        .join(intervals, on="method", how="left", maintain_order="left")
        .with_columns(page=page, label=label)
    )


def read_types(results: Results) -> Data:
    """Return every type with its verdicts, all newest tows, and those that stand out."""
    ends = results.before_and_after
    types = [
        _read_verdicts(results, name, ends)
        for name in results.views.type_names()
        if results.views.has("compared_tows")
    ]
    judged = [
        one for one in types if any(row["spread_ratio"] is not None for row in one["verdicts"])
    ]
    outside = results.views.ask("outliers").filter(pl.col("method").is_in(results.methods))
    return {
        "types": types,
        "judged": judged,
        "tows": _read_newest_tows(results),
        "outside": outside,
        "methods": results.methods,
        "chosen": {"method": results.method},
    }


def compare_types(results: Results, types: Sequence[str], methods: Sequence[str]) -> Data:
    """Return the data of `herijk audit TYPE [TYPE]`: one type or two.

    Args:
        results: the tables.
        types: their names.
        methods: those that are shown; the last gives the verdicts.
    """
    with_names = results.views.table("compared_tows").join(
        results.views.table("boats").select("fsn_no", "name"),
        on="fsn_no", how="left", maintain_order="left",
    )  # fmt: skip
    is_shown = pl.col("method").is_in(methods)
    found = []
    for boat_type in types:
        tows = with_names.filter(is_shown, boat_type=boat_type)
        eras = results.views.table("era_shifts").filter(is_shown, boat_type=boat_type)
        stands_out = pl.col("cw_outside").fill_null(False) | pl.col("b_outside").fill_null(False)
        size = pl.col("cw_deviation_sd").abs()
        found.append(
            _read_verdicts(results, boat_type, methods)
            | {
                "facts": read_type_facts(results.views, boat_type),
                "stand_out": tows.filter("newest", stands_out).sort(
                    "method", size, "tow_id", descending=[False, True, False], nulls_last=True
                ),
                "slow_tows": tows.filter("slow").sort("method", "power_w", "tow_id"),
                "eras": eras,
                "repeats": _sum_up_repeats(results, boat_type, methods),
            }
        )
    differences = {}
    for method in methods:
        verdicts = []
        for one in found:
            rows = [row for row in one["rows"] if row["method"] == method]
            verdicts.append((rows, one["eras"].filter(method=method).to_dicts()))
        differences[method] = find_type_differences(*verdicts)
    spread = results.views.table("reproducibility").filter(is_shown).sort("method", "scope")
    return {
        "method": methods[-1],
        "methods": list(methods),
        "types": found,
        "differences": differences,
        "reproducibility": name_ends(spread),
    }


def _sum_up_repeats(results: Results, boat_type: str, methods: Sequence[str]) -> pl.DataFrame:
    """Return how well the boats of a type repeat, by method, over all their pairs of tows."""
    boats = results.views.table("boats").filter(
        pl.col("boat_type").fill_null(UNKNOWN_TYPE) == boat_type
    )
    pairs = results.views.table("repeat_pairs").filter(pl.col("method").is_in(methods))
    own = pairs.join(boats, on="fsn_no", how="semi", maintain_order="left")
    return own.group_by("method", maintain_order=True).agg(
        n_pairs=pl.len(),
        sd_ratio=((pl.col("ln_ratio") ** 2).mean() / 2).sqrt(),
        n_e_n=pl.col("e_n").count(),
        n_disagree=(pl.col("e_n").abs() > 1).sum(),
    )
