"""What a section shows, in one computed sentence: the main point first.

Each function takes the rows that are shown at first and gives a sentence per language.
"""

import datetime as dt
import json
from collections import Counter

import polars as pl

from dashboards import labels
from dashboards.speech import Headline, Speech
from pipeline.messages import say

CLEAR_P = 0.05
STRONG_POWER = 0.8
WORTH = 0.9
"""A set of tows is worth its trouble where it takes a tenth or more off the uncertainty."""
MONTHS_AHEAD = dt.timedelta(days=365)


def register(lines: pl.DataFrame) -> Headline:
    """How many lines have a curve, and on which day that was judged."""
    known, day = lines["cw_kg_m"].drop_nulls().len(), lines["as_of"].max()
    return lambda speech: speech.say(
        "{known} of {lines} lines have a valid curve on {day}.",
        lines=lines.height,
        known=known,
        day=day,
    )


def changes(lines: pl.DataFrame) -> Headline:
    """How many lines change, by more than their uncertainty, and mostly why."""
    changed = lines.filter(pl.col("change") == "changed")
    causes = Counter(filter(None, (_largest(text) for text in changed["causes"].to_list())))

    def sentence(speech: Speech) -> str:
        text = _from_to(lines, speech) + speech.say(
            "{changed} of {lines} lines change", changed=changed.height, lines=lines.height
        )
        text += beyond_interval(changed, speech)
        if causes:
            cause = causes.most_common(1)[0][0]
            text += speech.say(
                "; why is not known, as how the printed register was computed is not recorded"
                if cause == "printed"
                else "; most often mainly: {cause}",
                cause=speech.say(labels.code(cause)),
            )
        return f"{text}.{_log_unknown(changed, speech)}"

    return sentence


def beyond_interval(changed: pl.DataFrame, speech: Speech) -> str:
    """How many lines change by more than their uncertainty, and of how many that is not known."""
    known = changed["exceeds_interval"].drop_nulls()
    if known.is_empty():
        return (
            speech.say("; whether by more than the uncertainty is not known of any")
            if changed.height
            else ""
        )
    text = speech.say(
        "; {beyond} by more than the uncertainty",
        beyond=known.sum() or speech.say(labels.code("none")),
    )
    unknown = changed.height - known.len()
    return text + (
        speech.say(", and of {unknown} that is not known", unknown=unknown) if unknown else ""
    )


def _log_unknown(changed: pl.DataFrame, speech: Speech) -> str:
    """Of which editions the uncertainty is too small, as it leaves out the error of the log."""
    known = changed.drop_nulls("exceeds_interval")
    unknown = [
        speech.edition(known[f"{to}_edition"][0])
        for side, to in (("old", "from"), ("new", "to"))
        if not known[f"{side}_log_known"].fill_null(False).all()
    ]
    if not unknown:
        return ""
    return speech.say(
        " The uncertainty of {editions} leaves out the error of the log: it is really larger.",
        editions=speech.say(" and ").join(unknown),
    )


def _from_to(lines: pl.DataFrame, speech: Speech) -> str:
    """Which two editions are compared."""
    if lines.is_empty():
        return ""
    old, new = (speech.edition(lines[f"{side}_edition"][0]) for side in ("from", "to"))
    return speech.say("From \u201c{old}\u201d to \u201c{new}\u201d: ", old=old, new=new)


def _largest(causes: str) -> str | None:
    parts = json.loads(causes)
    if not parts:
        return None
    most = max(parts, key=lambda cause: abs(cause["factor"] - 1))
    return str(most.get("step", most["cause"]))


def due(lines: pl.DataFrame) -> Headline:
    """How many have to tow within a year."""
    as_of = lines.select(pl.col("as_of").max()).item()
    soon = lines.filter(pl.col("valid_until").is_between(as_of, as_of + MONTHS_AHEAD)).height
    over = lines.filter(pl.col("valid_until") < as_of).height
    return lambda speech: speech.say(
        "Crews that have to tow within a year of {day}: {soon}; tows that have expired "
        "by that day: {over}.",
        soon=soon,
        over=over,
        day=as_of,
    )


def retow(choice: pl.DataFrame) -> Headline:
    """Whether the most informative tows are worth it."""
    ends = pl.col("factor_sd_before_ratio").max(), pl.col("factor_sd_after_ratio").min()
    before, after = choice.select(ends).row(0)

    def sentence(speech: Speech) -> str:
        return speech.say(
            "These tows bring the uncertainty of the log factors from {before} to {after} %."
            if after < WORTH * before
            else "For that alone it is not worth it: these tows bring the uncertainty of the "
            "log factors from {before} to {after} %.",
            before=speech.number(100 * before, 2),
            after=speech.number(100 * after, 2),
        )

    return sentence


def statuses(rows: pl.DataFrame) -> Headline:
    """How many curves are sound."""
    counts = dict(rows.group_by("status", maintain_order=True).agg(pl.col("number").sum()).rows())
    return lambda speech: speech.say(
        "Of {curves} curves {accepted} are sound, {flagged} need a look and {rejected} "
        "are rejected.",
        curves=sum(counts.values()),
        accepted=counts.get("accepted", 0),
        flagged=counts.get("flagged", 0),
        rejected=counts.get("rejected", 0),
    )


def reproducibility(rows: pl.DataFrame, method: str) -> Headline | None:
    """How well a tow repeats itself, as published and now."""
    known = rows.filter(scope="all").drop_nulls("sd_ratio")
    spread = {row["method"]: row for row in known.iter_rows(named=True)}
    if method not in spread:
        return None
    first, now = next(iter(spread)), spread[method]
    return lambda speech: speech.say(
        "The random error of one tow is {now} % ({method}; 95 %: {low} to {high} %, "
        "from {pairs} pairs); it was {then} % ({first}).",
        now=speech.number(100 * now["sd_ratio"], 1),
        method=speech.say(labels.method(method)),
        low=speech.number(100 * now["lo"], 1),
        high=speech.number(100 * now["hi"], 1),
        pairs=now["n_pairs"],
        then=speech.number(100 * spread[first]["sd_ratio"], 1),
        first=speech.say(labels.method(first)),
    )


def log_factors(rows: pl.DataFrame) -> Headline | None:
    """Where the log was furthest off."""
    known = rows.drop_nulls("factor")
    if known.is_empty():
        return None
    off = known.sort((pl.col("factor") - 1).abs(), descending=True).row(0, named=True)
    return lambda speech: speech.say(
        "The log was furthest off in {season}: {by}."
        if off["lo"] is None
        else "The log was furthest off in {season}: {by} (95 %: {low} to {high}).",
        season=off["season"],
        **{
            name: speech.per_cent(1 / off[bound])
            for name, bound in {"by": "factor", "low": "hi", "high": "lo"}.items()
            if off[bound] is not None
        },
    )


def homogeneity(test: pl.DataFrame) -> Headline:
    """Whether the boats of a type have equal curves: yes, no, or not to be told."""
    if test.is_empty() or test["p_value"][0] is None:
        return lambda speech: speech.say("Too few boats to tell whether they are equal.")
    p_value, power = test["p_value"][0], test["power_at_10pct"][0] or 0.0
    verdict = say(
        "Whether the bends of the curves of these {n} tows differ cannot be told: the "
        "test is too weak."
    )
    if p_value < CLEAR_P:
        verdict = say(
            "The bends of the curves of these {n} tows differ by more than noise explains "
            "(p = {p})."
        )
    elif power >= STRONG_POWER:
        verdict = say("No sign that the bends of the curves of these {n} tows differ (p = {p}).")
    return lambda speech: speech.say(verdict, n=test["n"][0], p=speech.number(p_value, 2))
