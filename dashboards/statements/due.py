"""Who has to tow again, and whether towing more would be worth it."""

import datetime as dt
from typing import Final

import polars as pl

from dashboards.statements import Number, Statement, told
from pipeline.messages import say

MONTHS_AHEAD = dt.timedelta(days=365)
WORTH = 0.9
"""A set of tows is worth its trouble where it takes a tenth or more off the uncertainty."""

SPEEDS: Final = say(
    "Until when each tow counts, as judged on the day of the last tow or race, and the speed of "
    "the next one. Lowest and Highest: 70 to 90 W per rower (men) or 40 to 55 W (women) on the "
    "known curve; a boat that was altered since may be towed at another speed. Beyond the curve: "
    "outside 85 to 115 % of the declared speed, where it does not hold."
)
"""What a reader of the due list should know."""

RETOW_TITLE: Final = say("Which boats to tow again")
RETOW: Final = say(
    "Boats that, towed again with dGPS, reduce the uncertainty of the log factors most; the first "
    "one most. Sd: standard deviation of a factor, before and after."
)
"""What the most informative tows are."""


def due(lines: pl.DataFrame) -> Statement:
    """How many have to tow within a year."""
    as_of, until = lines.select(pl.col("as_of").max()).item(), pl.col("valid_until")
    wording = say(
        "Crews that have to tow within a year of {day}: {soon}; tows that have expired "
        "by that day: {over}."
    )
    soon = lines.filter(until.is_between(as_of, as_of + MONTHS_AHEAD)).height
    over = lines.filter(until < as_of).height
    return told("due", wording, {}, "due_list", day=as_of, soon=soon, over=over)


def retow(choice: pl.DataFrame) -> Statement:
    """Whether the most informative tows are worth it."""
    ends = pl.col("factor_sd_before_ratio").max(), pl.col("factor_sd_after_ratio").min()
    before, after = choice.select(ends).row(0)
    worth = after < WORTH * before
    wording = (
        say("These tows bring the uncertainty of the log factors from {before} to {after} %.")
        if worth
        else say(
            "For that alone it is not worth it: these tows bring the uncertainty of the "
            "log factors from {before} to {after} %."
        )
    )
    verdict = "worth it" if worth else "not worth it"
    ratios = {"before": Number(100 * before, unit="%"), "after": Number(100 * after, unit="%")}
    return told("retow", wording, {}, "retow_choice", verdict=verdict, **ratios)
