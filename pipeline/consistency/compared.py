"""Every tow next to the others of its type: what the charts of the 2015 presentation plot.

All tows of all seasons, each marked: the newest of its boat and crew, towed too slowly, standing
out from its type (by `pipeline.consistency.types`), and where it lies beside hull speed, with the
three cases of Cw-kromme (R. Pot 2015): a boat that is raced faster than it was towed has a curve
where it was not measured.
"""

from collections.abc import Mapping
from typing import Final

import numpy as np
import polars as pl

from pipeline import curve
from pipeline.arrays import BoolArray, FloatArray, StrArray
from pipeline.consistency.observed import TOW, is_within_curve
from pipeline.consistency.types import CW, DIFFERENCES_THAT_MATTER, B, compare_types
from pipeline.crews import STANDARD_CREWS, get_limits
from pipeline.history import STEERED_STRAIGHT_FROM
from pipeline.quantiles import NORMAL
from pipeline.races.race import mean_speed_m_s, power_per_rower_w
from pipeline.tables.consistency import ComparedTows
from pipeline.tables.keys import LINE

MIDDLE_RATIO: Final = (0.67, 0.80)
"""Tow speed / hull speed: between these "the curve is relatively flat", below it the wave
resistance rises (Cw-kromme, R. Pot 2015, "Totale weerstand")."""

FROM_CURVES: Final = (
    "declared_speed_m_s", "weight_kg", "displacement_kg", "waterline_length_m",
    "a_kg_m", "b_m_s", "b_lo_m_s", "b_hi_m_s", "power_w",
)  # fmt: skip


def type_tables(
    observed: pl.DataFrame,
    repeat_pairs: pl.DataFrame,
    listed_races: pl.DataFrame,
    differences_that_matter: Mapping[str, float] = DIFFERENCES_THAT_MATTER,
    crew_classes: pl.DataFrame = STANDARD_CREWS,
) -> dict[str, pl.DataFrame]:
    """Return the tables of the comparison of boats of a type, by name, for all methods.

    Args:
        observed: rows of `observe`.
        repeat_pairs, listed_races: the tables of those names.
        differences_that_matter: ratio by quantity.
        crew_classes: the table of that name.
    """
    results = compare_types(observed, repeat_pairs, differences_that_matter)
    placed = place_beside_type(observed, crew_classes).hstack(
        compare_with_races(observed, results.consistency, listed_races, crew_classes)
    )
    return {
        "compared_tows": mark_outside(observed, placed, results.deviations),
        "type_consistency": results.consistency,
        "type_line_points": results.lines,
    }


def place_beside_type(observed: pl.DataFrame, crew_classes: pl.DataFrame) -> pl.DataFrame:
    """Return the columns of `compared_tows` that follow from a tow and its type's speed."""
    cw = observed["cw_standard_kg_m"].to_numpy().astype(np.float64)
    cw_half = NORMAL * np.sqrt(observed["ln_cw_variance"].to_numpy())
    a = observed["a_kg_m"].to_numpy()
    a_half = NORMAL * observed["ln_a_sd"].to_numpy()
    hull_speed = observed["hull_speed_m_s"].to_numpy()
    tow_hull_ratio = observed["declared_speed_m_s"].to_numpy() / hull_speed
    numbers = {
        "a_lo_kg_m": a * np.exp(-a_half),
        "a_hi_kg_m": a * np.exp(a_half),
        "hull_speed_m_s": hull_speed,
        "tow_hull_ratio": tow_hull_ratio,
        "b_hull_ratio": observed["b_m_s"].to_numpy().astype(np.float64) / hull_speed,
        "standard_speed_m_s": observed["standard_speed_m_s"].to_numpy(),
        "cw_standard_kg_m": cw,
        "cw_standard_lo_kg_m": cw * np.exp(-cw_half),
        "cw_standard_hi_kg_m": cw * np.exp(cw_half),
    }
    facts = observed.select(
        pl.col(TOW),
        "season",
        "newest",
        "beyond_curve",
        pl.col(FROM_CURVES).cast(pl.Float64),
    )
    columns = pl.DataFrame(numbers).fill_nan(None).get_columns()
    return facts.with_columns(columns).with_columns(
        pl.Series("speed_case", name_speed_cases(tow_hull_ratio), pl.String),
        pl.Series("slow", is_slow(observed, crew_classes), pl.Boolean),
    )


def is_slow(table: pl.DataFrame, crew_classes: pl.DataFrame) -> BoolArray:
    """Return whether each tow was made with less power per rower than its class's limit."""
    limit = pl.col("crew_class").replace_strict(
        get_limits(crew_classes, "slow_power_w"), return_dtype=pl.Float64
    )
    return table.select((pl.col("power_w") < limit).fill_null(value=False)).to_series().to_numpy()


def name_speed_cases(tow_hull_ratio: FloatArray) -> StrArray:
    """Return which of the three cases of Cw-kromme each tow is, by its speed / hull speed."""
    low, high = MIDDLE_RATIO
    return np.select([tow_hull_ratio < low, tow_hull_ratio < high], ["low", "middle"], "high")


def compare_with_races(
    observed: pl.DataFrame,
    consistency: pl.DataFrame,
    listed_races: pl.DataFrame,
    crew_classes: pl.DataFrame,
) -> pl.DataFrame:
    """Return Cw of each curve at the fastest speed that its crew raced until its next tow.

    Power by the tow's own curve is compared with that by a curve of the same height at the declared
    speed, with the mean bend of the type.

    Args:
        observed: rows of `observe`.
        consistency: rows of `type_consistency`, for the bend of the type.
        listed_races: `race_date`, `distance_m`, `stream_m`, `rowing_time_s` and the line.
        crew_classes: the table of that name.

    Returns:
        `races`, `raced_speed_m_s`, `raced_beyond_curve`, `raced_power_w`, `raced_high` and
        `power_ratio_raced`, a row per row of `observed`; empty without a race.
    """
    type_b = consistency.filter(quantity=B.name).select("method", "boat_type", type_b_m_s="mean")
    table = observed.join(
        find_fastest_races(observed, listed_races),
        on=["method", "tow_id"],
        how="left",
        maintain_order="left",
    ).join(type_b, on=["method", "boat_type"], how="left", maintain_order="left")
    speed = table["raced_speed_m_s"].to_numpy().astype(np.float64)
    declared = table["declared_speed_m_s"].to_numpy()
    is_beyond = ~is_within_curve(table, speed)
    s = curve.s_of_height(table["a_kg_m"].to_numpy(), table["cw_kg_m"].to_numpy(), declared)
    cw = curve.cw(table["a_kg_m"].to_numpy(), s, speed)
    power = power_per_rower_w(cw, speed, table["rowers"].to_numpy())

    # Cw(v) = C0 / (1 - q x) with x = (v / v0)^2 - 1 and q the bend at the declared speed v0.
    x = (speed / declared) ** 2 - 1.0
    own_left = 1.0 - table["q"].to_numpy() * x
    type_r = (declared / table["type_b_m_s"].to_numpy().astype(np.float64)) ** 2
    type_left = 1.0 - type_r / (1.0 - type_r) * x
    has_both = (own_left > 0.0) & (type_left > 0.0) & (type_r < 1.0)
    power_ratio = np.where(has_both, type_left, np.nan) / np.where(has_both, own_left, 1.0)

    is_raced = np.isfinite(speed)
    high_power = table["crew_class"].replace_strict(
        get_limits(crew_classes, "raced_power_w"), return_dtype=pl.Float64
    )
    return table.select(
        "races",
        "raced_speed_m_s",
        raced_beyond_curve=pl.when(pl.Series(is_raced)).then(pl.Series(is_beyond)),
        raced_power_w=pl.Series(np.where(np.isfinite(power), power, np.nan)).fill_nan(None),
        power_ratio_raced=pl.Series(power_ratio).fill_nan(None),
    ).with_columns(raced_high=pl.col("raced_power_w") > high_power)


def find_fastest_races(observed: pl.DataFrame, listed_races: pl.DataFrame) -> pl.DataFrame:
    """Return the fastest race of each boat and crew between a tow and its next.

    Returns:
        `method`, `tow_id`, `races` (how many) and `raced_speed_m_s` (through the water).
    """
    through_water = listed_races["distance_m"] - listed_races["stream_m"].fill_null(0.0)
    speed = mean_speed_m_s(through_water, listed_races["rowing_time_s"])
    races = listed_races.select(pl.col(LINE), "race_date", raced_speed_m_s=pl.Series(speed))
    after = pl.col("race_date") >= pl.col("tow_date")
    of_race = ("method",) + LINE + ("race_date",)
    last = pl.col("tow_date") == pl.col("tow_date").max().over(of_race)
    return (
        observed.select("method", "tow_id", "tow_date", pl.col(LINE))
        .join(races, on=LINE, maintain_order="left")
        .filter(after)
        .filter(last)
        .group_by("method", "tow_id", maintain_order=True)
        .agg(pl.len().cast(pl.Int32).alias("races"), pl.col("raced_speed_m_s").max())
    )


def mark_outside(
    observed: pl.DataFrame, placed: pl.DataFrame, deviations: pl.DataFrame
) -> pl.DataFrame:
    """Return rows of `compared_tows`: tows with their deviation from the type and its causes.

    Args:
        observed: rows of `observe`.
        placed: rows of `place_beside_type`, in the same order.
        deviations: rows of `types.find_deviations`.
    """
    key = ["method", "tow_id"]
    compared = placed
    for quantity, prefix, unit in ((CW, "cw", "kg_m"), (B, "b", "m_s")):
        own = deviations.filter(quantity=quantity.name).select(
            pl.col(key),
            pl.col("expected").alias(f"{prefix}_expected_{unit}"),
            pl.col("deviation_sd").alias(f"{prefix}_deviation_sd"),
            pl.col("outside").alias(f"{prefix}_outside"),
        )
        compared = compared.join(own, on=key, how="left", maintain_order="left")
    is_high = (pl.col("cw_deviation_sd") > 0.0) & pl.col("cw_outside").fill_null(value=False)
    is_unchecked = pl.col("season") < STEERED_STRAIGHT_FROM
    flags = pl.Series("flags", observed["flags"])
    length = pl.col("waterline_length_m") / pl.col("waterline_length_m").median().over("boat_type")
    causes = {
        "length": (length - 1.0).abs() > 0.02,
        "log": pl.col("flags").list.contains("unusual_calibration"),
        "altered": pl.col("altered"),
        "slow_tow": pl.col("slow"),
        "askew": pl.col("flags").list.contains("out_and_back_differ") | (is_high & is_unchecked),
        "b_at_cap": pl.col("b_capped"),
        "b_not_determined": pl.col("b_m_s").is_null(),
    }
    codes = [pl.when(applies).then(pl.lit(code)) for code, applies in causes.items()]
    judged = pl.col("cw_deviation_sd").is_not_null() | pl.col("b_deviation_sd").is_not_null()
    return (
        compared.with_columns(flags, observed["altered"], observed["b_capped"])
        .with_columns(candidates=pl.when(judged).then(pl.concat_list(codes).list.drop_nulls()))
        .select(ComparedTows.column_names())
        .sort("method", "tow_id")
    )
