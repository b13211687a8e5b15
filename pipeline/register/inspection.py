"""Inspection on the day of a race: what was last measured of each boat, and what is allowed now.

The measurements of a tow serve checks that are made at races, to find changes of a boat that could
change its curve (Sleepproef, R. Pot 2017, "Opmetingen en keuring"). Belongs here: which measurement
counts, and its limits. Does not: how far a measure may differ, which `beheer.toml` says.
"""

from collections.abc import Mapping
from typing import Final

import polars as pl

from pipeline.assessment.checks import MAX_FREEBOARD_CHANGE_M, MAX_WEIGHT_CHANGE
from pipeline.tables.display import find_number_form
from pipeline.tables.keys import MAX_THWARTS

WEIGHT: Final = "weight_kg"
MEASURES: Final[Mapping[str, tuple[str, ...]]] = {
    "weight": (WEIGHT,),
    "freeboard": ("freeboard_lowest_m", "freeboard_bow_m", "freeboard_stern_m"),
    "thwart": tuple(f"thwart_{number}_m" for number in range(1, MAX_THWARTS + 1)),
    "rudder": ("rudder_height_m", "rudder_breadth_m", "rudder_thickness_m"),
    "photo": ("photo_boat", "photo_rudder"),
}
"""What is inspected: columns of tow lists by their kind, in the order of the sheet."""

TOLERANCES: Final[Mapping[str, float]] = {
    "weight": MAX_WEIGHT_CHANGE,
    "freeboard": MAX_FREEBOARD_CHANGE_M,
    "thwart": 0.02,
    "rudder": 0.01,
}
"""How far a measure may differ where nobody set it (all inferred): weight as a ratio, sizes in m.

Weight and freeboards may differ by what a check allows between two tows; thwarts and rudder by what
two people with a tape find of the same boat."""

ROWERS_PER_THWART: Final = 2


def list_inspections(
    tows: pl.DataFrame, boats: pl.DataFrame, tolerances: pl.DataFrame
) -> pl.DataFrame:
    """Return what was last measured of each boat, and between which limits it may be now.

    A later tow goes before an earlier one, for each measure by itself. A weight that no tow list
    holds is that of the boat list. A measure that nobody took has a row without numbers; of thwarts
    there are as many as the largest crew needs, or as were measured.

    Args:
        tows: rows of `listed_tows`.
        boats: rows of `listed_boats`.
        tolerances: by `kind` of `TOLERANCES` the `size`, and whether it is `inferred`.

    Returns:
        Rows of `inspections`.
    """
    key = ["fsn_no", "measure"]
    listed = boats.select("fsn_no", measure=pl.lit(WEIGHT), listed=WEIGHT).unique("fsn_no")
    rows = (
        boats.select("fsn_no").unique(maintain_order=True).join(_describe_measures(), how="cross")
    )
    rows = rows.join(_find_last_measured(tows), on=key, how="left", maintain_order="left")
    rows = rows.join(listed, on=key, how="left", maintain_order="left")
    n_thwarts = _count_thwarts(tows, boats)
    rows = rows.join(n_thwarts, on="fsn_no", how="left", maintain_order="left")
    rows = rows.join(tolerances, on="kind", how="left", maintain_order="left")
    is_measured = pl.col("tow_id").is_not_null()
    is_listed = ~is_measured & pl.col("listed").is_not_null()
    source = pl.when(is_measured).then(pl.lit("tow_list")).when(is_listed).then(pl.lit("boat_list"))
    value = pl.coalesce("value", "listed")
    of_weight = pl.when(pl.col("measure") == WEIGHT).then(value * pl.col("size"))
    tolerance = pl.when(value.is_not_null()).then(of_weight.otherwise("size"))
    is_no_thwart = pl.col("thwart").is_null()
    is_on_board = is_no_thwart | is_measured | (pl.col("thwart") <= pl.col("n_thwarts"))
    return rows.filter(is_on_board).select(
        "fsn_no",
        "measure",
        "position",
        "unit",
        value.alias("value"),
        "photo",
        source.alias("source"),
        "measured_on",
        "tow_id",
        tolerance.alias("tolerance"),
        _round_as_read(value - tolerance).alias("lowest"),
        _round_as_read(value + tolerance).alias("highest"),
        "inferred",
    )


def _describe_measures() -> pl.DataFrame:
    """Return every measure with its kind, position on the sheet, unit and number of the thwart."""
    rows = []
    for kind, measures in MEASURES.items():
        for number, measure in enumerate(measures, start=1):
            unit = "" if kind == "photo" else find_number_form(measure).unit
            thwart = number if kind == "thwart" else None
            rows.append({"measure": measure, "kind": kind, "unit": unit, "thwart": thwart})
    frame = pl.DataFrame(rows, schema_overrides={"thwart": pl.Int32})
    return frame.with_row_index("position", offset=1)


def _find_last_measured(tows: pl.DataFrame) -> pl.DataFrame:
    """Return the last value or photograph of each boat and measure, with its day and tow."""
    in_time = tows.sort("tow_date", "tow_id")
    photos = MEASURES["photo"]
    sizes = [measure for kind in TOLERANCES for measure in MEASURES[kind]]
    of_tow = ["fsn_no", "tow_date", "tow_id"]
    values = in_time.unpivot(sizes, index=of_tow, variable_name="measure", value_name="value")
    names = in_time.unpivot(photos, index=of_tow, variable_name="measure", value_name="photo")
    taken = pl.concat([values.drop_nulls("value"), names.drop_nulls("photo")], how="diagonal")
    last = taken.group_by("fsn_no", "measure", maintain_order=True).last()
    return last.rename({"tow_date": "measured_on"})


def _count_thwarts(tows: pl.DataFrame, boats: pl.DataFrame) -> pl.DataFrame:
    """Return `n_thwarts` of each boat, by the largest crew that any list gives it."""
    crews = pl.concat([tows.select("fsn_no", "rowers"), boats.select("fsn_no", "rowers")])
    most = crews.group_by("fsn_no", maintain_order=True).agg(pl.col("rowers").max())
    return most.select("fsn_no", n_thwarts=(pl.col("rowers") / ROWERS_PER_THWART).ceil())


def _round_as_read(limit: pl.Expr) -> pl.Expr:
    """Return a limit as finely as scales and a tape are read on the quay: in whole kg or mm."""
    return pl.when(pl.col("unit") == "kg").then(limit.round()).otherwise(limit.round(3))
