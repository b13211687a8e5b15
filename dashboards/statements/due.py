"""Who has to tow again."""

import datetime as dt
from typing import Final

import polars as pl

from dashboards.statements import Statement, told
from pipeline.messages import say

MONTHS_AHEAD = dt.timedelta(days=365)

SPEEDS: Final = say(
    "Until when each tow counts, as judged on the day of the last tow or race, and the speed of "
    "the next one. Lowest and Highest: 70 to 90 W per rower (men) or 40 to 55 W (women) on the "
    "known curve; a boat that was altered since may be towed at another speed. Beyond the curve: "
    "outside 85 to 115 % of the declared speed, where it does not hold."
)
"""What a reader of the due list should know."""


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
