"""What is known of seasons: how far the log was off, how sound tows are, how well they repeat."""

from typing import Final

import polars as pl

from dashboards import labels
from dashboards.statements import Change, Number, Statement, told
from pipeline.messages import say

DIAGNOSIS: Final = say(
    "What may be wrong in a season with log, GPS, load cell, anemometer or temperature. Fault: "
    "likelier than not. Cannot be told: 10 to 50 %, or one boat alone shows it, which may have "
    "been altered instead. Alarm: 4 standard deviations from what is usual. Would not show: a "
    "fault of the usual size would be taken for something else. Size: in per cent, or in N; the "
    "interval counts how seldom such a fault is, so it can be 0 to 0. What is not in the table: no "
    "fault was seen, and a usual one would show."
)
"""How the table of faults of instruments is read."""

LEVEL: Final = say(
    "What all tows of a season have in common in Cw, with instruments corrected for what was found "
    "of them. Alarm: 2 % or more, and more than its interval (95 % for all seasons together). It "
    "may be mass on board, the depth of the water, waves, or a load cell that is not linear. Would "
    "not show: without GPS, only the bend of the curves tells it from the log."
)
"""How the table of levels of seasons is read."""


def log_factors(rows: pl.DataFrame) -> Statement | None:
    """Where the log was furthest off."""
    known = rows.drop_nulls("factor")
    if known.is_empty():
        return None
    off = known.sort((pl.col("factor") - 1).abs(), descending=True).row(0, named=True)
    by = {
        name: Change(1 / off[bound])
        for name, bound in {"by": "factor", "low": "hi", "high": "lo"}.items()
        if off[bound] is not None
    }
    wording = (
        say("The log was furthest off in {season}: {by}.")
        if off["lo"] is None
        else say("The log was furthest off in {season}: {by} (95 %: {low} to {high}).")
    )
    return told("log_off", wording, off | by, "log_factors")


def changes(rows: pl.DataFrame, method: str) -> Statement | None:
    """In which season a method changes Cw most."""
    known = rows.filter(method=method).drop_nulls("median_ratio")
    if known.is_empty():
        return None
    change = pl.col("median_ratio").log().abs()
    most = known.sort(change, "season", descending=[True, False]).row(0, named=True)
    wording = say(
        "By the method {method}, Cw changes most in {season}: {by} (median of {tows} tows)."
    )
    named, by = labels.method(method), Change(most["median_ratio"])
    return told("season_change", wording, most, "season_changes", method=named, by=by)


def statuses(rows: pl.DataFrame) -> Statement:
    """How many curves are sound."""
    counts = dict.fromkeys(("accepted", "flagged", "rejected"), 0)
    counts |= dict(rows.group_by("status", maintain_order=True).agg(pl.col("number").sum()).rows())
    wording = say(
        "Of {curves} curves {accepted} are sound, {flagged} need a look and {rejected} "
        "are rejected."
    )
    return told("statuses", wording, counts, "curves", curves=sum(counts.values()))


def reproducibility(rows: pl.DataFrame, method: str) -> Statement | None:
    """How well a tow repeats itself, as published and now."""
    known = rows.filter(scope="all").drop_nulls("sd_ratio")
    spread = {row["method"]: row for row in known.iter_rows(named=True)}
    if method not in spread:
        return None
    first, now = next(iter(spread)), spread[method]
    wording = say(
        "The random error of one tow is {now} % ({method}; 95 %: {low} to {high} %, "
        "from {n_pairs} pairs); it was {then} % ({first}). Within 2 % of each other lie "
        "{share} % of the pairs; it was {share_then} %."
    )
    ratios = {
        "now": (now["sd_ratio"], 1),
        "low": (now["lo"], 1),
        "high": (now["hi"], 1),
        "then": (spread[first]["sd_ratio"], 1),
        "share": (now["share_within_2pct"], 0),
        "share_then": (spread[first]["share_within_2pct"], 0),
    }
    per_cent = {name: Number(100 * ratio, digits, "%") for name, (ratio, digits) in ratios.items()}
    named = {"method": labels.method(method), "first": labels.method(first)}
    return told("reproducibility", wording, now | per_cent | named, "reproducibility")
