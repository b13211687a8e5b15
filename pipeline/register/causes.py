"""The causes of a change: factors on Cw that multiply to it, one per cause.

Known parts come from print and from the ladder of a method's steps; the ground names what they
leave over. `pipeline.tables.causes` has the words.
"""

from collections.abc import Collection
from typing import Final

import polars as pl

from pipeline.choice import SAME_SHARE
from pipeline.register.register import LINE, MEASURED
from pipeline.tables.row import Row, get_key

NO_FACTOR: Final = SAME_SHARE
"""A factor this near to 1 is rounding and is not listed as a cause."""

CAUSE: Final = pl.Struct({"cause": pl.String(), "step": pl.String(), "factor": pl.Float64()})
"""What `register_changes.causes` says of each cause: its code, the step of the method where that is
the cause, and its factor on Cw."""

REPRODUCTION: Final = "reproduction"
"""From a printed line to its tow by the method then in force: what print does not explain."""
CLOSED_FORM: Final = "closed_form"
"""The log error of the season, on a printed line whose tow has no samples."""


def assign_steps(register: pl.DataFrame, ladder: pl.DataFrame) -> pl.DataFrame:
    """Return the steps of a ladder as parts of the changes of the lines whose tow they are of.

    Args:
        register: lines of the old register, with their `tow_id`: its tow is re-based first.
        ladder: `tow_id`, `position`, `step`, `factor`.
    """
    steps = (
        register.select(pl.col(LINE), "tow_id")
        .join(ladder, on="tow_id", maintain_order="left")
        .sort(pl.col(LINE), "position")
    )
    factor = pl.col("factor").cast(pl.Float64)
    return steps.select(pl.col(LINE), pl.lit("method").alias("cause"), "step", factor)


def name_grounds(
    old: pl.DataFrame,
    new: pl.DataFrame,
    same: Collection[str],
    *,
    others: bool,
    method: bool,
    code: bool,
    rebased: pl.DataFrame | None = None,
) -> pl.DataFrame:
    """Name the factor of each line that its known causes leave over.

    Args:
        old, new: the registers; a line of which the `basis` is not `MEASURED` is of print.
        same: tows with the same input in both.
        others: whether any tow has another input.
        method, code: whether these differ.
        rebased: parts of changes; a line that has any was re-based to the new method.

    Returns:
        `LINE` and its `ground`.
    """
    facts = LINE + ("tow_id", "tow_date", "basis")
    pairs = old.select(facts).join(
        new.select(facts), on=LINE, suffix="_new", nulls_equal=True, maintain_order="left"
    )
    rebased_lines = set() if rebased is None else set(rebased.select(LINE).rows())
    named = []
    for pair in pairs.iter_rows(named=True):
        line = get_key(pair, LINE)
        is_print = pair["basis"] != MEASURED or pair["basis_new"] != MEASURED
        is_other_tow = (
            pair["tow_date" if is_print else "tow_id"]
            != (pair["tow_date_new" if is_print else "tow_id_new"])
        )
        is_other_input = pair["tow_id_new"] not in same
        if line in rebased_lines or not (method or is_print):
            if is_other_tow:
                ground = "tow"
            elif is_print:
                ground = REPRODUCTION if pair["tow_id"] else CLOSED_FORM
            else:
                ground = _name_input_or_code(is_other_input, others, code)
        elif is_print:
            ground = "printed_and_tow" if is_other_tow else "printed"
        else:
            ground = "unseparated" if is_other_tow or is_other_input or code else "method"
        named.append(line + (ground,))
    schema = {name: old.schema[name] for name in LINE} | {"ground": pl.String()}
    return pl.DataFrame(named, schema=schema, orient="row")


def _name_input_or_code(is_other_input: bool, others: bool, code: bool) -> str:
    if is_other_input:
        return "input_and_code" if code else "input"
    if others:
        return "code_or_other_input" if code else "other_input"
    return "code" if code else "unexplained"


def explode_causes(lines: pl.DataFrame) -> pl.DataFrame:
    """Return the causes of lines, one a row: `LINE`, `cause`, `step` and `factor`."""
    causes = pl.col("causes").str.json_decode(pl.List(CAUSE))
    return lines.select(pl.col(LINE), causes).explode("causes").unnest("causes")


def summarise_causes(lines: pl.DataFrame) -> list[Row]:
    """Return the effect of each cause, or step of a method; that with the most lines first.

    Returns:
        Rows of `cause`, `step` (where a method is the cause), `lines` (how many it moved), and of
        its factors on Cw there `median_factor`, `lowest_factor`, `highest_factor`.
    """
    factor = pl.col("factor")
    return (
        explode_causes(lines)
        .filter((factor - 1.0).abs() > NO_FACTOR)
        .group_by("cause", "step", maintain_order=True)
        .agg(
            pl.len().alias("lines"),
            factor.median().alias("median_factor"),
            factor.min().alias("lowest_factor"),
            factor.max().alias("highest_factor"),
        )
        .sort("lines", "cause", "step", descending=[True, False, False])
        .to_dicts()
    )
