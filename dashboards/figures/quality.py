"""Figures of how many: curves by status."""

import altair as alt
import polars as pl

from dashboards import labels
from dashboards.figures.style import OKABE_ITO, WIDTH, named, tips
from pipeline.messages import Say

STATUSES = ["accepted", "flagged", "rejected"]


def statuses(frame: pl.DataFrame, say: Say) -> alt.Chart:
    """Curves per season by status, of one method; `frame` is `Views.status_counts`."""
    shades = alt.Scale(domain=STATUSES, range=[OKABE_ITO[5], OKABE_ITO[1], OKABE_ITO[6]])
    return (
        alt.Chart(frame)
        .mark_bar(stroke="black", strokeWidth=0.5)
        .encode(
            alt.X("season:O", title=say(labels.column("season"))),
            alt.Y("number:Q", title=say(labels.column("number"))),
            alt.Color(
                "status:N",
                title=say(labels.column("status")),
                scale=shades,
                legend=alt.Legend(labelExpr=named(STATUSES, say)),
            ),
            tooltip=tips(say, "season:O", "status:N", "number:Q"),
        )
        .properties(width=WIDTH, height=240)
    )
