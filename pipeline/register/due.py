"""The due list: until when each boat's tow counts, and at what speed to tow the boat next.

The rule for the speed is the federation's (Sleepproef, R. Pot 2017, "Sleepsnelheid"): on the known
curve it takes 70-90 W per rower (men) or 40-55 W (women). Belongs here: that rule with its
exceptions. Does not: which tow counts (`pipeline.register.register`).
"""

import datetime as dt
from typing import Final

import polars as pl

from pipeline.crews import STANDARD_CREWS, get_limits
from pipeline.curve import VALID_RATIO
from pipeline.races.power import find_line_curves, speed_at_power
from pipeline.races.race import mean_speed_m_s, power_per_rower_w
from pipeline.register.register import LINE

CREW: Final = LINE[:-1]
"""A boat's crew, whichever thwart it leaves free: results of races seldom say."""

IN_RANGE = "in_range"
TOO_FAST = "brought_down"
ROWED_FASTER = "brought_up"
REALLY_ROWED_SO = "low_but_rowed"
NOT_RACED = "low_not_raced"
LIKE_BOATS = "like_boats"
NOTHING_KNOWN = "nothing_known"


def due_list(
    register: pl.DataFrame,
    boats: pl.DataFrame,
    results: pl.DataFrame,
    as_of: dt.date,
    crew_classes: pl.DataFrame = STANDARD_CREWS,
) -> pl.DataFrame:
    """Return every boat and crew with the day its tow expires and the speed of its next tow.

    The speed that the crew will declare is taken to be that of its last tow. It is kept where it is
    realistic, and brought down to the upper end where it takes more power. Where it takes less it
    is brought up to what the crew really rowed in the past year, if that was faster, but not beyond
    the upper end. A low speed that was really rowed stands, if the crew expects no more. Without a
    race the lower end is proposed. A boat without a curve gets the median of like boats. An
    alteration since then is a reason to depart from this, but no list records it.

    Args:
        register: lines of `pipeline.register.register.draft_register`; an expired curve is a known
            curve.
        boats: `fsn_no`, `boat_type`.
        results: races with `race_date`, `distance_m`, `stream_m`, `rowing_time_s` and the line.
        as_of: the day on which is looked.
        crew_classes: the table of that name.

    Returns:
        Per line `as_of`, `status`, `tow_id`, `tow_date`, `valid_until`, `declared_speed_m_s`,
        `power_w` (per rower, there) and `raced_speed_m_s` (fastest of the past year). Of the next
        tow `lowest_speed_m_s` and `highest_speed_m_s` (the realistic range), `tow_speed_m_s`,
        `speed_reason` and `beyond_curve` (that speed lies outside 85-115 % of the last one). Sorted
        by line.
    """
    lines = (
        register.join(
            boats.select("fsn_no", "boat_type"), on="fsn_no", how="left", maintain_order="left"
        )
        .join(_find_raced_speeds(results, as_of), on=CREW, how="left", maintain_order="left")
        .sort(LINE)
    )
    own = lines.filter(pl.col("a_kg_m").is_not_null())
    known = _add_realistic_speeds(own, crew_classes).with_columns(_find_speed_of_own_curve())
    without = _find_speed_of_like_boats(lines.join(own, on=LINE, how="anti"), known)
    low = pl.col("declared_speed_m_s") * VALID_RATIO[0]
    high = pl.col("declared_speed_m_s") * VALID_RATIO[1]
    return (
        pl.concat([known, without], how="diagonal_relaxed")
        .select(
            pl.col(LINE),
            pl.lit(as_of).alias("as_of"),
            "status",
            "tow_id",
            "tow_date",
            "valid_until",
            "declared_speed_m_s",
            "power_w",
            "raced_speed_m_s",
            "lowest_speed_m_s",
            "highest_speed_m_s",
            "tow_speed_m_s",
            "speed_reason",
            (~pl.col("tow_speed_m_s").is_between(low, high)).alias("beyond_curve"),
        )
        .sort(LINE)
    )


def _find_raced_speeds(results: pl.DataFrame, as_of: dt.date) -> pl.DataFrame:
    """Return the fastest mean speed through the water of each crew in the year up to a day."""
    day = pl.col("race_date")
    lately = results.filter(day > pl.lit(as_of).dt.offset_by("-1y"), day <= as_of)
    through_water = lately["distance_m"] - lately["stream_m"].fill_null(0.0)
    speed = mean_speed_m_s(through_water, lately["rowing_time_s"])
    raced = lately.with_columns(pl.Series("raced_speed_m_s", speed))
    return raced.group_by(CREW, maintain_order=True).agg(pl.col("raced_speed_m_s").max())


def _add_realistic_speeds(lines: pl.DataFrame, crew_classes: pl.DataFrame) -> pl.DataFrame:
    """Add the power at the declared speed, and both ends of the realistic range of speeds."""
    a, s = find_line_curves(lines)
    rowers = lines["rowers"].to_numpy()
    crew_class = lines["crew_class"]
    lowest = get_limits(crew_classes, "lowest_power_w")
    highest = get_limits(crew_classes, "highest_power_w")
    lowest_w = crew_class.replace_strict(lowest, return_dtype=pl.Float64).to_numpy()
    highest_w = crew_class.replace_strict(highest, return_dtype=pl.Float64).to_numpy()
    power = power_per_rower_w(lines["cw_kg_m"], lines["declared_speed_m_s"], rowers)
    return lines.with_columns(
        power_w=pl.Series(power),
        lowest_speed_m_s=pl.Series(speed_at_power(a, s, lowest_w * rowers)),
        highest_speed_m_s=pl.Series(speed_at_power(a, s, highest_w * rowers)),
    )


def _find_speed_of_own_curve() -> list[pl.Expr]:
    """Return the speed of the next tow by the boat's own curve, and why."""
    declared, raced = pl.col("declared_speed_m_s"), pl.col("raced_speed_m_s")
    lowest, highest = pl.col("lowest_speed_m_s"), pl.col("highest_speed_m_s")
    cases = [
        (declared > highest, highest, TOO_FAST),
        (declared >= lowest, declared, IN_RANGE),
        (raced.is_null(), lowest, NOT_RACED),
        (raced > declared, pl.min_horizontal(raced, highest), ROWED_FASTER),
    ]
    speed: pl.Expr = declared
    reason: pl.Expr = pl.lit(REALLY_ROWED_SO)
    for holds, chosen, why in reversed(cases):
        speed = pl.when(holds).then(chosen).otherwise(speed)
        reason = pl.when(holds).then(pl.lit(why)).otherwise(reason)
    return [speed.alias("tow_speed_m_s"), reason.alias("speed_reason")]


def _find_speed_of_like_boats(lines: pl.DataFrame, known: pl.DataFrame) -> pl.DataFrame:
    """Return medians of boats of the same type and crew, for lines without a curve."""
    like = ["boat_type", "rowers", "crew_class"]
    ends = ("lowest_speed_m_s", "highest_speed_m_s")
    typical = (
        known.drop_nulls("boat_type").group_by(like, maintain_order=True).agg(pl.col(ends).median())
    )
    middle = pl.mean_horizontal(ends)
    return lines.join(typical, on=like, how="left", maintain_order="left").with_columns(
        pl.when(pl.col(ends[0]).is_not_null()).then(middle).alias("tow_speed_m_s"),
        pl.when(pl.col(ends[0]).is_not_null())
        .then(pl.lit(LIKE_BOATS))
        .otherwise(pl.lit(NOTHING_KNOWN))
        .alias("speed_reason"),
    )
