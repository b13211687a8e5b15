"""Races replayed under a register: power, rank and podium, and what another register changes.

The formulas are in `pipeline.races.race` and `pipeline.curve`; here they are put together for a
whole race file. Which rules a race was rowed under is data: `RaceRules`. Wind, waves and depth are
no part of the handicap (presentation R. Pot, 24 January 2015).
"""

from dataclasses import dataclass
from typing import Final, Literal, get_args

import numpy as np
import polars as pl

from herijk.pipeline.arrays import FloatArray
from herijk.pipeline.curve import cw, s_of_b
from herijk.pipeline.errors import MissingKnowledgeError
from herijk.pipeline.races.race import (
    fatigue_factor,
    mean_speed_m_s,
    net_speed_over_legs_m_s,
    power_per_rower_w,
)
from herijk.pipeline.register.register import LINE
from herijk.pipeline.uncertainty.ensemble import share_first
from herijk.tables.frames import dtypes
from herijk.tables.register import RaceChanges

Fatigue = Literal["none", "known", "extend"]
Stream = Literal["distance_first", "net_speed_over_legs"]
FATIGUES: Final = get_args(Fatigue)
STREAMS: Final = get_args(Stream)

RACE: Final = ("race", "race_date")
CLASSIFICATION: Final = (*RACE, "crew_class")
PODIUM: Final = 3

WINNER_SCHEMA: Final = {
    **{name: dtypes(RaceChanges)[name] for name in CLASSIFICATION},
    "old_winner": pl.String(),
    "new_winner": pl.String(),
    "winner_changed": pl.Boolean(),
    "change_probability": pl.Float64(),
}

NOT_IN_REGISTER = "not_in_register"
ABOVE_B = "speed_not_below_b"


@dataclass(frozen=True)
class RaceRules:
    """How results are computed.

    Attributes:
        fatigue: `none`; `known`: between the two published points, refused outside; `extend`: the
            power law between them, for every time.
        stream: `distance_first`: the distance the stream carried the boat is taken off the
            distance; `net_speed_over_legs`: the mean of each leg's net speed, which needs legs.
        speed_decimals: decimals to which the speed is rounded first, as the federation's example
            does; None for none.
    """

    fatigue: Fatigue = "extend"
    stream: Stream = "distance_first"
    speed_decimals: int | None = None


def replay(
    register: pl.DataFrame,
    results: pl.DataFrame,
    rules: RaceRules,
    legs: pl.DataFrame | None = None,
) -> pl.DataFrame:
    """Power and rank of every result under one register.

    Args:
        register: lines with `fsn_no`, `rowers`, `crew_class`, `a_kg_m`, `b_m_s`; of one edition.
        results: `race`, `race_date`, `fsn_no`, `rowers`, `crew_class`, `distance_m`,
            `rowing_time_s`, `stream_m`, `penalty_w` (watt per rower, taken off).
        rules: how they are computed.
        legs: `race`, `race_date`, `fsn_no`, `rowers`, `crew_class`, `distance_m`, `time_s`,
            `stream_m`, one row per leg; for the rule over legs.

    Returns:
        The results with `speed_m_s`, `cw_kg_m`, `fatigue_factor`, `power_w` (a rower, corrected,
        less the penalty), `rank` within the race and class, and `reason` why there is no power
        (`not_in_register`, `speed_not_below_b`), else empty. Sorted by race, class and rank.

    Raises:
        MissingKnowledgeError: the rule over legs without legs, or a race time outside what is
            known of fatigue.
    """
    results = results.sort(*RACE, *LINE)
    speed = _speed_m_s(results, rules, legs)
    lines = register.filter(pl.col("a_kg_m").is_not_null()).select(*LINE, "a_kg_m", "b_m_s")
    rowed = results.join(lines, on=LINE, how="left", maintain_order="left")
    a = rowed["a_kg_m"].to_numpy()
    b = rowed["b_m_s"].fill_null(float("inf")).to_numpy()
    resistance = cw(np.nan_to_num(a), s_of_b(b), speed)
    sound = np.isfinite(a) & np.isfinite(resistance)
    fatigue = _fatigue(results, rules)
    power = power_per_rower_w(np.where(sound, resistance, 0.0), speed, rowed["rowers"]) * fatigue
    penalty = rowed["penalty_w"].fill_null(0.0).to_numpy()
    reason = np.select([~np.isfinite(a), ~sound], [NOT_IN_REGISTER, ABOVE_B], "")
    rank = pl.col("power_w").rank("min", descending=True).over(CLASSIFICATION).cast(pl.Int32)
    return (
        rowed.with_columns(
            pl.Series("speed_m_s", speed),
            pl.Series("fatigue_factor", fatigue),
            _where(sound, "cw_kg_m", resistance),
            _where(sound, "power_w", power - penalty),
            pl.Series("reason", reason, pl.String),
        )
        .with_columns(rank.alias("rank"))
        .sort(*CLASSIFICATION, "rank", *LINE, nulls_last=True)
    )


def race_changes(old: pl.DataFrame, new: pl.DataFrame) -> pl.DataFrame:
    """What another register does to races: power, rank and podium of every result.

    Args:
        old, new: `replay` of the same results under two registers.

    Returns:
        One row a result: `old_power_w`, `new_power_w`, `old_rank`, `new_rank`, and whether it is
        on the podium in one of the two only (`podium_changed`).
    """
    key = [*RACE, *LINE]
    columns = [*key, "rowing_time_s", "power_w", "rank"]
    pairs = old.select(columns).join(
        new.select(*key, "rowing_time_s", "power_w", "rank"),
        on=[*key, "rowing_time_s"],
        suffix="_new",
    )
    on_podium = (pl.col(name).fill_null(PODIUM + 1) <= PODIUM for name in ("rank", "rank_new"))
    before, after = on_podium
    return pairs.select(
        *key,
        "rowing_time_s",
        pl.col("power_w").alias("old_power_w"),
        pl.col("power_w_new").alias("new_power_w"),
        pl.col("rank").alias("old_rank"),
        pl.col("rank_new").alias("new_rank"),
        (before != after).alias("podium_changed"),
    ).sort(*CLASSIFICATION, "new_rank", "fsn_no", nulls_last=True)


def winner_changes(
    old: pl.DataFrame, new: pl.DataFrame, register: pl.DataFrame, members: pl.DataFrame
) -> pl.DataFrame:
    """Who wins each race and class under two registers, and how likely it is not the old winner.

    How likely is the share of equally likely new registers in which another crew has the highest
    power. A line without members (carried over from print) is taken as it stands.

    Args:
        old, new: `replay` of the same results under two registers.
        register: lines of the new one, with `tow_id` and `cw_kg_m`.
        members: rows of the table `ensemble` for its tows; may be empty, then nothing is known.

    Returns:
        One row a race and class: `old_winner`, `new_winner` (boat; null where nobody has a power),
        `winner_changed` and `change_probability` (null where it is not known).
    """
    rows = []
    for key, results in new.group_by(CLASSIFICATION, maintain_order=True):
        before = old.filter(*(pl.col(n) == k for n, k in zip(CLASSIFICATION, key, strict=True)))
        winners = [_winner(results_of) for results_of in (before, results)]
        rows.append(
            dict(zip(CLASSIFICATION, key, strict=True))
            | {
                "old_winner": None if winners[0] is None else winners[0][0],
                "new_winner": None if winners[1] is None else winners[1][0],
                "winner_changed": winners[0] != winners[1],
                "change_probability": _change_probability(results, winners[0], register, members),
            }
        )
    return pl.DataFrame(rows, schema=WINNER_SCHEMA).sort(CLASSIFICATION)


def _winner(results: pl.DataFrame) -> tuple[object, ...] | None:
    first = results.filter(pl.col("rank") == 1).sort(LINE).select(LINE)
    return None if first.is_empty() else first.row(0)


def _change_probability(
    results: pl.DataFrame,
    old_winner: tuple[object, ...] | None,
    register: pl.DataFrame,
    members: pl.DataFrame,
) -> float | None:
    crews = results.drop_nulls("power_w").select(*LINE, "power_w")
    if members.is_empty() or old_winner is None or old_winner not in crews.select(LINE).rows():
        return None
    lines = register.select(*LINE, "tow_id", "cw_kg_m").with_columns(
        pl.col("tow_id").fill_null(pl.concat_str(LINE, separator=" "))
    )
    crews = crews.join(lines, on=LINE)
    certain = crews.join(members, on="tow_id", how="anti").join(
        members.select("member").unique(), how="cross"
    )
    columns = ["tow_id", "member", "cw_kg_m"]
    drawn = pl.concat([members.select(columns), certain.select(columns)])
    shares = share_first(drawn, crews)
    mine = pl.all_horizontal(pl.col(n) == w for n, w in zip(LINE, old_winner, strict=True))
    return 1.0 - float(shares.filter(mine)["share"][0])


def _speed_m_s(results: pl.DataFrame, rules: RaceRules, legs: pl.DataFrame | None) -> FloatArray:
    if rules.stream == "net_speed_over_legs":
        speed = _over_legs(results, legs)
    else:
        distance = results["distance_m"] - results["stream_m"].fill_null(0.0)
        speed = mean_speed_m_s(distance, results["rowing_time_s"])
    return speed if rules.speed_decimals is None else np.round(speed, rules.speed_decimals)


def _over_legs(results: pl.DataFrame, legs: pl.DataFrame | None) -> FloatArray:
    key = [*RACE, *LINE]
    lacking = results if legs is None else results.join(legs, on=key, how="anti")
    if legs is None or lacking.height:
        first = lacking.row(0, named=True)
        raise MissingKnowledgeError(
            f"the stream rule net_speed_over_legs needs distance, time and stream of each leg; "
            f"{first['race']} of {first['race_date']} has none for {first['fsn_no']} (race files "
            "of the archive hold no legs). Use the rule distance_first"
        )
    columns = ("distance_m", "time_s", "stream_m")
    grouped = legs.group_by(key, maintain_order=True).agg(columns)
    own = results.select(key).join(grouped, on=key, how="left", maintain_order="left")
    return np.array(
        [
            float(net_speed_over_legs_m_s(*(np.array(values) for values in row)))
            for row in own.select(columns).rows()
        ]
    )


def _fatigue(results: pl.DataFrame, rules: RaceRules) -> FloatArray:
    """Factor against the fastest sloop of the race."""
    if rules.fatigue == "none":
        return np.ones(results.height)
    fastest = results.select(pl.col("rowing_time_s").min().over(RACE)).to_series()
    outside: Literal["refuse", "extend"] = "refuse" if rules.fatigue == "known" else "extend"
    return fatigue_factor(results["rowing_time_s"], fastest, outside)


def _where(known: np.ndarray, name: str, values: FloatArray) -> pl.Expr:
    return pl.when(pl.Series(known)).then(pl.Series(np.where(known, values, 0.0))).alias(name)
