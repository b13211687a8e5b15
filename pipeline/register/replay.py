"""Races replayed under a register: power, rank and podium, and what another register changes.

The formulas are in `pipeline.races.race` and `pipeline.curve`; here they are put together for a
whole race file. Which rules a race was rowed under is data: `RaceRules`. Wind, waves and depth are
no part of the handicap (presentation R. Pot, 24 January 2015).
"""

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
import polars as pl

from pipeline.arrays import FloatArray
from pipeline.crews import STANDARD_CREWS, TIME_ON_TIME, get_usual_power
from pipeline.curve import VALID_RATIO, cw
from pipeline.races.power import find_line_curves, speed_at_power
from pipeline.races.race import fatigue_factor, mean_speed_m_s, power_per_rower_w
from pipeline.register.register import LINE, NO_EMPTY_THWART

Fatigue = Literal["none", "known", "extend"]

RACE: Final = ("race", "race_date")
CREW: Final = LINE[:-1]
CLASSIFICATION: Final = RACE + ("crew_class",)
RESULT: Final = RACE + CREW + ("rowing_time_s",)
PODIUM: Final = 3

CURVE: Final = ("declared_speed_m_s", "a_kg_m", "b_m_s", "cw_kg_m")

NOT_IN_REGISTER = "not_in_register"
NO_LINE_THAT_DAY = "no_line_that_day"
THWART_NOT_GIVEN = "thwart_not_given"
ABOVE_B = "speed_not_below_b"
BEYOND_CURVE = "beyond_curve"


@dataclass(frozen=True)
class RaceRules:
    """How results are computed; the distance that the current carried a boat comes off first.

    Attributes:
        fatigue: `none`; `known`: between the two published points, refused outside; `extend`: the
            power law between them, for every time.
    """

    fatigue: Fatigue = "extend"


def replay(
    lines: pl.DataFrame,
    results: pl.DataFrame,
    rules: RaceRules,
    crew_classes: pl.DataFrame = STANDARD_CREWS,
) -> pl.DataFrame:
    """Return the power and rank of every result under the lines that counted on its day.

    Args:
        lines: `LINE`, `tow_id`, `tow_date`, `valid_until`, `declared_speed_m_s`, `a_kg_m`, `b_m_s`,
            `cw_kg_m`; of all days, those that take precedence last (`list_lines_of_all_days`).
        results: `race`, `race_date`, `LINE` (the thwart null where it is not given), `distance_m`,
            `rowing_time_s`, `stream_m`, `penalty_w` (watt per rower, taken off).
        rules: how they are computed.
        crew_classes: the handicap of each class, and the power that it takes.

    Returns:
        The results, sorted by race, class and rank. Added are `tow_id` and `declared_cw_kg_m` (Cw
        at the declared speed) of the line that counted, `speed_m_s`, `cw_kg_m`, `fatigue_factor`,
        `power_w` (per rower, corrected, less the penalty), `corrected_time_s` (null unless the
        handicap of the class is one of time) and `rank` within the race and class.
        `remark` says why there is no power (`not_in_register`, `no_line_that_day`,
        `thwart_not_given`, `speed_not_below_b`), or that the speed lies outside 85-115 % of the
        declared one, where the curve does not hold (`beyond_curve`); else it is empty.

    Raises:
        MissingKnowledgeError: a race time outside what is known of fatigue.
    """
    rowed = _add_lines(results.sort(pl.col(RACE), pl.col(LINE)), lines.drop_nulls("a_kg_m"))
    through_water = rowed["distance_m"] - rowed["stream_m"].fill_null(0.0)
    speed = mean_speed_m_s(through_water, rowed["rowing_time_s"])
    a, s = find_line_curves(rowed)
    resistance = cw(np.nan_to_num(a), np.nan_to_num(s), speed)
    has_line = np.isfinite(a)
    sound = has_line & np.isfinite(resistance)
    fatigue = _compute_fatigue(rowed, rules)
    power = power_per_rower_w(np.where(sound, resistance, 0.0), speed, rowed["rowers"]) * fatigue
    penalty = rowed["penalty_w"].fill_null(0.0).to_numpy()
    declared = rowed["declared_speed_m_s"].to_numpy()
    low, high = VALID_RATIO[0] * declared, VALID_RATIO[1] * declared
    beyond = (speed < low) | (speed > high)
    without = rowed["without"].to_numpy()
    timed = crew_classes.filter(handicap=TIME_ON_TIME)["crew_class"].to_list()
    is_timed = pl.col("crew_class").is_in(timed)
    corrected_s = np.full(rowed.height, np.nan)
    if timed:
        corrected_s = _correct_times(rowed, through_water, crew_classes, is_timed)
    remark = np.select([~has_line, ~sound, beyond], [without, ABOVE_B, BEYOND_CURVE], "")
    by_power = pl.col("power_w").rank("min", descending=True).over(CLASSIFICATION)
    by_time = pl.col("corrected_time_s").rank("min").over(CLASSIFICATION)
    rank = pl.when(is_timed).then(by_time).otherwise(by_power).cast(pl.Int32)
    return (
        rowed.drop("without", "tow_date", "valid_until", "declared_speed_m_s")
        .rename({"cw_kg_m": "declared_cw_kg_m"})
        .with_columns(
            pl.Series("speed_m_s", speed),
            pl.Series("fatigue_factor", fatigue),
            pl.Series("cw_kg_m", np.where(sound, resistance, np.nan)).fill_nan(None),
            pl.Series("power_w", np.where(sound, power - penalty, np.nan)).fill_nan(None),
            pl.Series("corrected_time_s", corrected_s).fill_nan(None),
            pl.Series("remark", remark, pl.String),
        )
        .with_columns(rank.alias("rank"))
        .sort(pl.col(CLASSIFICATION), "rank", pl.col(LINE), nulls_last=True)
    )


def _add_lines(results: pl.DataFrame, lines: pl.DataFrame) -> pl.DataFrame:
    """Add to each result the line that counted on its day, or why there is none (`without`).

    A result that names no empty thwart was rowed with all manned, where the boat has such a line;
    else with the one thwart free that its line asks for.
    """
    facts = ("tow_id", "tow_date", "valid_until") + CURVE
    numbered = results.with_row_index("result").rename({"empty_thwart": "given"})
    pairs = numbered.select("result", "race_date", pl.col(CREW), "given").join(
        lines.select(LINE + facts), on=CREW, maintain_order="left_right"
    )
    fits = pl.col("given").is_null() | (pl.col("given") == pl.col("empty_thwart"))
    begun = pl.col("tow_date").is_null() | (pl.col("tow_date") <= pl.col("race_date"))
    counts = pl.col("valid_until").is_null() | (pl.col("valid_until") >= pl.col("race_date"))
    newest = (
        pairs.filter(fits & begun)
        .group_by("result", "empty_thwart", maintain_order=True)
        .last()
        .filter(counts)
    )
    all_manned = (pl.col("empty_thwart") == NO_EMPTY_THWART).any().over("result")
    chosen = newest.filter(~all_manned | (pl.col("empty_thwart") == NO_EMPTY_THWART))
    told = chosen.filter(pl.len().over("result") == 1)
    known, several = pairs["result"].unique().implode(), chosen["result"].unique().implode()
    without = (
        pl.when(pl.col("result").is_in(several))
        .then(pl.lit(THWART_NOT_GIVEN))
        .when(pl.col("result").is_in(known))
        .then(pl.lit(NO_LINE_THAT_DAY))
        .otherwise(pl.lit(NOT_IN_REGISTER))
    )
    return (
        numbered.join(
            told.select("result", "empty_thwart", pl.col(facts)),
            on="result",
            how="left",
            maintain_order="left",
        )
        .with_columns(
            without.alias("without"),
            pl.coalesce("empty_thwart", "given", pl.lit(NO_EMPTY_THWART)).alias("empty_thwart"),
        )
        .drop("result", "given")
    )


def race_changes(old: pl.DataFrame, new: pl.DataFrame) -> pl.DataFrame:
    """Compare power, place and podium of every result under two registers.

    Places are among the crews of a class with a power under both registers: a crew that only one
    of them ranks would move all others.

    Args:
        old, new: `replay` of the same results under two registers.

    Returns:
        Per result `old_power_w`, `new_power_w`, `old_corrected_time_s`, `new_corrected_time_s`,
        `old_remark`, `new_remark`, `old_rank`, `new_rank`, and whether it is on the podium in one
        of the two only (`podium_changed`); the last three are null where a register has no power.
    """
    before, after = _rank_under_both(old, new), _rank_under_both(new, old)
    compared = ("power_w", "corrected_time_s", "rank", "remark")
    pairs = before.select(pl.col(RESULT), pl.col(compared)).join(
        after.select(pl.col(RESULT), "empty_thwart", pl.col(compared)),
        on=RESULT,
        suffix="_new",
        maintain_order="left",
    )
    was_on_podium, is_on_podium = pl.col("rank") <= PODIUM, pl.col("rank_new") <= PODIUM
    return pairs.select(
        pl.col(RACE),
        pl.col(LINE),
        "rowing_time_s",
        pl.col("power_w").alias("old_power_w"),
        pl.col("power_w_new").alias("new_power_w"),
        pl.col("corrected_time_s").alias("old_corrected_time_s"),
        pl.col("corrected_time_s_new").alias("new_corrected_time_s"),
        pl.col("remark").alias("old_remark"),
        pl.col("remark_new").alias("new_remark"),
        pl.col("rank").alias("old_rank"),
        pl.col("rank_new").alias("new_rank"),
        (was_on_podium != is_on_podium).alias("podium_changed"),
    ).sort(pl.col(CLASSIFICATION), "new_rank", "fsn_no", nulls_last=True)


def _rank_under_both(results: pl.DataFrame, others: pl.DataFrame) -> pl.DataFrame:
    """Rank results among those that have a rank in `others` too; null for the rest."""
    both = others.drop_nulls("rank").select(pl.col(RESULT), shared=pl.lit(True))
    placed = results.join(both, on=RESULT, how="left", maintain_order="left")
    among = pl.when(pl.col("shared")).then("rank")
    rank = among.rank("min").over(CLASSIFICATION).cast(pl.Int32)
    return placed.with_columns(rank.alias("rank")).drop("shared")


def compare_winners(old: pl.DataFrame, new: pl.DataFrame, members: pl.DataFrame) -> pl.DataFrame:
    """Find who wins each race and class under two registers, and how likely another wins.

    Of the crews that both registers rank, as in `race_changes`. How likely is the share of equally
    likely new registers in which another of them has the highest power. A line without members
    (carried over from print) is taken as it stands.

    Args:
        old, new: `replay` of the same results under two registers.
        members: rows of the table `ensemble` for tows of the new one; may be empty, then nothing is
            known.

    Returns:
        One row per race and class: `old_winner`, `new_winner` (boat; null where nobody has a
        power), `winner_changed` and `change_probability` (null where it is not known).
    """
    before, after = _rank_under_both(old, new), _rank_under_both(new, old)
    both = after.select(CLASSIFICATION).unique(maintain_order=True)
    for side, results in (("old", before), ("new", after)):
        first = results.filter(rank=1).sort(LINE).group_by(CLASSIFICATION, maintain_order=True)
        winners = first.agg(
            pl.col("fsn_no").first().alias(f"{side}_winner"), _CREW.first().alias(side)
        )
        both = both.join(winners, on=CLASSIFICATION, how="left", maintain_order="left")
    chances = _estimate_chances(after, both.select(pl.col(CLASSIFICATION), "old"), members)
    return (
        both.join(chances, on=CLASSIFICATION, how="left", maintain_order="left")
        .with_columns(winner_changed=pl.col("old").ne_missing(pl.col("new")))
        .select(
            pl.col(CLASSIFICATION),
            "old_winner",
            "new_winner",
            "winner_changed",
            "change_probability",
        )
        .sort(CLASSIFICATION)
    )


_CREW: Final = pl.concat_str(LINE, separator=" ")


def _estimate_chances(
    results: pl.DataFrame, old_winners: pl.DataFrame, members: pl.DataFrame
) -> pl.DataFrame:
    """Return how likely another than the old winner wins each race and class.

    Power is proportional to Cw, and the error of Cw at the declared speed is taken for that at the
    speed rowed: sound within the range in which a curve is valid. A penalty does not follow Cw.
    Of classes that race on corrected time it is not known.
    """
    results = results.filter(pl.col("corrected_time_s").is_null())
    if members.is_empty():
        schema = {name: results.schema[name] for name in CLASSIFICATION}
        return pl.DataFrame(schema=schema | {"change_probability": pl.Float64()})
    drawn = members.select("tow_id", "member", drawn="cw_kg_m")
    penalty = pl.col("penalty_w").fill_null(0.0)
    grows = (pl.col("drawn") / pl.col("declared_cw_kg_m")).fill_null(1.0)
    return (
        results.drop_nulls("rank")
        .with_columns(crew=_CREW)
        .join(old_winners, on=CLASSIFICATION, maintain_order="left")
        .filter((pl.col("crew") == pl.col("old")).any().over(CLASSIFICATION))
        .join(drawn.select("member").unique().sort("member"), how="cross", maintain_order="left")
        .join(drawn, on=["tow_id", "member"], how="left", maintain_order="left")
        .with_columns(power=(pl.col("power_w") + penalty) * grows - penalty)
        .group_by(pl.col(CLASSIFICATION), "member", maintain_order=True)
        .agg(pl.col("crew").get(pl.col("power").arg_max()), pl.col("old").first())
        .group_by(CLASSIFICATION, maintain_order=True)
        .agg((pl.col("crew") != pl.col("old")).mean().alias("change_probability"))
    )


def _correct_times(
    results: pl.DataFrame,
    through_water_m: pl.Series,
    crew_classes: pl.DataFrame,
    is_timed: pl.Expr,
) -> FloatArray:
    """Return race times corrected by the speed of each boat [s]; NaN where power decides.

    The speed is the one at which each rower of the crew gives the usual power of its class, by the
    boat's own curve; a penalty [W] comes on top of that power. The boat that is fastest by it, in
    its race and class, keeps its time; the time of another is multiplied by its speed over that of
    the fastest. What the current carried a boat is taken off as in the other handicap.
    """
    usual_power_w = get_usual_power(crew_classes)
    power_w = results["crew_class"].replace_strict(usual_power_w, return_dtype=pl.Float64)
    power_w = (power_w + results["penalty_w"].fill_null(0.0)) * results["rowers"]
    a, s = find_line_curves(results)
    has_line = np.isfinite(a) & np.isfinite(s)
    speed = speed_at_power(
        np.where(has_line, a, 1.0), np.where(has_line, s, 0.0), power_w.to_numpy()
    )
    seconds = results["rowing_time_s"] * results["distance_m"] / through_water_m
    timed = results.with_columns(
        seconds=seconds, speed=pl.Series(np.where(has_line, speed, np.nan)).fill_nan(None)
    )
    allowance = pl.col("speed") / pl.col("speed").max().over(CLASSIFICATION)
    corrected = pl.when(is_timed).then(pl.col("seconds") * allowance)
    return timed.select(corrected.cast(pl.Float64)).to_series().to_numpy()


def _compute_fatigue(results: pl.DataFrame, rules: RaceRules) -> FloatArray:
    """Return the factor against the fastest sloop of the race."""
    if rules.fatigue == "none":
        return np.ones(results.height)
    fastest = results.select(pl.col("rowing_time_s").min().over(RACE)).to_series()
    outside: Literal["refuse", "extend"] = "refuse" if rules.fatigue == "known" else "extend"
    return fatigue_factor(results["rowing_time_s"], fastest, outside)
