"""The facts of tows and runs as `recompute` takes them, joined from the tables of the archive."""

from collections.abc import Iterable
from typing import Final

import polars as pl

from pipeline.tables.keys import HAND_COLUMNS

UNKNOWN_WEIGHT_LN_SD: Final = 0.2
"""Standard deviation of ln weight where too few tows have one to show it (inferred)."""


def add_boat_types(tows: pl.DataFrame, boats: pl.DataFrame) -> pl.DataFrame:
    """Rows of `tows` with the type of their boat."""
    return tows.join(
        boats.select("fsn_no", "boat_type"), on="fsn_no", how="left", maintain_order="left"
    )


def add_boats(tows: pl.DataFrame, boats: pl.DataFrame) -> pl.DataFrame:
    """Rows of `tows` with the type of their boat, and its length and breadth in the boat list."""
    listed = boats.select(
        "fsn_no",
        listed_length_m=pl.col("waterline_length_m"),
        listed_beam_m=pl.col("beam_m"),
    )
    return add_boat_types(tows, boats).join(listed, on="fsn_no", how="left", maintain_order="left")


def add_expected_water(tows: pl.DataFrame) -> pl.DataFrame:
    """Rows of `tows` with what recorded temperatures say of the water of their day.

    `expected_water_c`: their mean on that day, else in that month of that year, else in that month,
    else in all of the archive; null where none is recorded. `water_off_c`: how far a tow's own lies
    from the median of its day; 0 where it has none.
    """
    water, day = pl.col("water_temperature_c"), pl.col("tow_date")
    mean = water.mean()
    return tows.with_columns(
        expected_water_c=pl.coalesce(
            mean.over(day),
            mean.over(day.dt.year(), day.dt.month()),
            mean.over(day.dt.month()),
            mean,
        ),
        water_off_c=(water - water.median().over(day)).abs().fill_null(0.0),
    )


def add_expected_mass(tows: pl.DataFrame) -> pl.DataFrame:
    """Return `tows` with the mass of boat and crew, as expected where a weight is not recorded.

    A boat weighs what it weighs in its other tows (median), else what boats of its type with as
    many rowers weigh, else all boats with as many rowers. A crew weighs what the boat's other crews
    of that size weigh, else crews of that size and class. Last comes the mean weight per rower of
    the archive.

    Args:
        tows: rows of the table `tows` with `boat_type`.

    Returns:
        The rows with `mass_kg`, null where no tow has a weight, and `mass_ln_sd`, the standard
        deviation of its logarithm among the tows that it is expected from, 0 where both weights
        are recorded.
    """
    boat_groups = ["fsn_no"], ["boat_type", "rowers"], ["rowers"]
    crew_groups = ["fsn_no", "rowers"], ["rowers", "crew_class"], ["rowers"]
    boat_kg, boat_ln_sd = _expect_from_like_tows("weight_kg", boat_groups)
    crew_kg, crew_ln_sd = _expect_from_like_tows("crew_weight_kg", crew_groups)
    mass_kg = boat_kg + crew_kg
    mass_sd_kg = ((boat_kg * boat_ln_sd) ** 2 + (crew_kg * crew_ln_sd) ** 2).sqrt()
    return tows.with_columns(mass_kg=mass_kg, mass_ln_sd=mass_sd_kg / mass_kg)


def _expect_from_like_tows(column: str, groups: Iterable[list[str]]) -> tuple[pl.Expr, pl.Expr]:
    """Return a weight, by the first group of tows that has one, and its ln standard deviation."""
    recorded = pl.col(column)
    per_rower = recorded / pl.col("rowers")
    medians = [recorded.median().over(group) for group in groups]
    spreads = [recorded.log().std().over(group) for group in groups]
    by_archive = per_rower.median() * pl.col("rowers")
    expected = pl.coalesce([recorded] + medians + [by_archive])
    ln_sd = pl.coalesce(spreads + [per_rower.log().std(), pl.lit(UNKNOWN_WEIGHT_LN_SD)])
    return expected, pl.when(recorded.is_null()).then(ln_sd).otherwise(0.0)


def add_hand_windows(runs: pl.DataFrame, windows: pl.DataFrame) -> pl.DataFrame:
    """Rows of `tow_runs` with the windows that were given by hand (`hand_windows`)."""
    given = windows.select("tow_id", "run", pl.col(list(HAND_COLUMNS))).rename(HAND_COLUMNS)
    return runs.join(given, on=["tow_id", "run"], how="left", maintain_order="left")


def list_samples_files(tows: pl.DataFrame) -> pl.DataFrame:
    """Return the samples files of tows: `tow_id`, `path` and `sha256`, one or two rows per tow."""
    first = tows.select("tow_id", path="samples_path", sha256="samples_sha256")
    second = tows.select("tow_id", path="second_path", sha256="second_sha256").drop_nulls()
    return pl.concat([first, second])
