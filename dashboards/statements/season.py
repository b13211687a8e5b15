"""What is known of seasons: how far the log was off, how sound tows are, how well they repeat."""

import polars as pl

from dashboards import labels
from dashboards.statements import Change, Number, Statement, Value
from pipeline.messages import say


def log_factors(rows: pl.DataFrame) -> Statement | None:
    """Where the log was furthest off."""
    known = rows.drop_nulls("factor")
    if known.is_empty():
        return None
    off = known.sort((pl.col("factor") - 1).abs(), descending=True).row(0, named=True)
    values: dict[str, Value] = {
        name: Change(1 / off[bound])
        for name, bound in {"by": "factor", "low": "hi", "high": "lo"}.items()
        if off[bound] is not None
    }
    return Statement(
        "log_off",
        say("The log was furthest off in {season}: {by}.")
        if off["lo"] is None
        else say("The log was furthest off in {season}: {by} (95 %: {low} to {high})."),
        {"season": off["season"]} | values,
        rests_on=("log_factors",),
    )


def changes(rows: pl.DataFrame, method: str) -> Statement | None:
    """In which season a method changes Cw most."""
    known = rows.filter(method=method).drop_nulls("median_ratio")
    if known.is_empty():
        return None
    change = pl.col("median_ratio").log().abs()
    most = known.sort(change, "season", descending=[True, False]).row(0, named=True)
    return Statement(
        "season_change",
        say("By the method {method}, Cw changes most in {season}: {by} (median of {tows} tows)."),
        {
            "method": labels.method(method),
            "season": most["season"],
            "by": Change(most["median_ratio"]),
            "tows": most["tows"],
        },
        rests_on=("season_changes",),
    )


def statuses(rows: pl.DataFrame) -> Statement:
    """How many curves are sound."""
    counts = dict(rows.group_by("status", maintain_order=True).agg(pl.col("number").sum()).rows())
    kinds = ("accepted", "flagged", "rejected")
    return Statement(
        "statuses",
        say(
            "Of {curves} curves {accepted} are sound, {flagged} need a look and {rejected} "
            "are rejected."
        ),
        {"curves": sum(counts.values())} | {kind: counts.get(kind, 0) for kind in kinds},
        rests_on=("curves",),
    )


def reproducibility(rows: pl.DataFrame, method: str) -> Statement | None:
    """How well a tow repeats itself, as published and now."""
    known = rows.filter(scope="all").drop_nulls("sd_ratio")
    spread = {row["method"]: row for row in known.iter_rows(named=True)}
    if method not in spread:
        return None
    first, now = next(iter(spread)), spread[method]
    low, high = (100 * now[end] for end in ("lo", "hi"))
    return Statement(
        "reproducibility",
        say(
            "The random error of one tow is {now} % ({method}; 95 %: {low} to {high} %, "
            "from {pairs} pairs); it was {then} % ({first}). Within 2 % of each other lie "
            "{share} % of the pairs; it was {share_then} %."
        ),
        {
            "now": Number(100 * now["sd_ratio"], 1, "%", low, high),
            "method": labels.method(method),
            "low": Number(low, 1, "%"),
            "high": Number(high, 1, "%"),
            "pairs": now["n_pairs"],
            "then": Number(100 * spread[first]["sd_ratio"], 1, "%"),
            "first": labels.method(first),
            "share": Number(100 * now["share_within_2pct"], 0, "%"),
            "share_then": Number(100 * spread[first]["share_within_2pct"], 0, "%"),
        },
        rests_on=("reproducibility",),
    )
