"""The facts of tows and runs as `recompute` takes them, joined from the tables of the archive."""

import polars as pl

from pipeline.steps.window import HAND_COLUMNS


def with_boat_types(tows: pl.DataFrame, boats: pl.DataFrame) -> pl.DataFrame:
    """Rows of `tows` with the type of their boat."""
    return tows.join(
        boats.select("fsn_no", "boat_type"), on="fsn_no", how="left", maintain_order="left"
    )


def with_boats(tows: pl.DataFrame, boats: pl.DataFrame) -> pl.DataFrame:
    """Rows of `tows` with the type of their boat, and its length and breadth in the boat list."""
    listed = boats.select(
        "fsn_no",
        listed_length_m=pl.col("waterline_length_m"),
        listed_beam_m=pl.col("beam_m"),
    )
    return with_boat_types(tows, boats).join(listed, on="fsn_no", how="left", maintain_order="left")


def with_expected_water(tows: pl.DataFrame) -> pl.DataFrame:
    """Rows of `tows` with what recorded temperatures say of the water of their day.

    `expected_water_c`: their mean on that day, else in that month of that year, else in that month,
    else in all of the archive; null where none is recorded. `water_off_c`: how far a tow's own lies
    from the median of its day; 0 where it has none.
    """
    water, day = pl.col("water_temperature_c"), pl.col("tow_date")
    alike = ([day], [day.dt.year(), day.dt.month()], [day.dt.month()])
    means = [water.mean().over(group) for group in alike]
    return tows.with_columns(
        expected_water_c=pl.coalesce(*means, water.mean()),
        water_off_c=(water - water.median().over(day)).abs().fill_null(0.0),
    )


def with_hand_windows(runs: pl.DataFrame, windows: pl.DataFrame) -> pl.DataFrame:
    """Rows of `tow_runs` with the windows that were given by hand (`hand_windows`)."""
    given = windows.select("tow_id", "run", *HAND_COLUMNS).rename(HAND_COLUMNS)
    return runs.join(given, on=["tow_id", "run"], how="left", maintain_order="left")


def samples_files(tows: pl.DataFrame) -> pl.DataFrame:
    """The samples files of tows: `tow_id`, `path` and `sha256`, one or two rows per tow."""
    first = tows.select("tow_id", path="samples_path", sha256="samples_sha256")
    second = tows.select("tow_id", path="second_path", sha256="second_sha256").drop_nulls()
    return pl.concat([first, second])
