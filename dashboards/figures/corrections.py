"""Figures of what corrections do: log factors, the ladder of steps, choices of judgement."""

import altair as alt
import polars as pl

from dashboards import labels
from dashboards.figures.style import (
    HEIGHT,
    OKABE_ITO,
    WIDTH,
    Drawing,
    at_one,
    by_method,
    named,
    number,
    tips,
)
from pipeline.messages import Say
from pipeline.studies.ladder import STEP_ORDER
from pipeline.studies.options import CHOICES


def log_factors(frame: pl.DataFrame, say: Say) -> Drawing:
    """True speed / log speed per season and method, with 95 % intervals; `frame` is the table."""
    value = ("factor", say(labels.column("factor")))
    return _per_season(frame, say, value, ("lo", "hi"), ("season:O", "source:N"))


def season_change(frame: pl.DataFrame, say: Say) -> Drawing:
    """Cw re-based / as published: median and range per season; `frame` is `season_changes`."""
    value, ends = ("median_ratio", say("Cw after / Cw before")), ("lowest_ratio", "highest_ratio")
    return _per_season(frame, say, value, ends, ("season:O", "tows:Q"))


def _per_season(
    frame: pl.DataFrame,
    say: Say,
    value: tuple[str, str],
    ends: tuple[str, str],
    more: tuple[str, ...],
) -> Drawing:
    base = alt.Chart(frame).encode(alt.X("season:O", title=say(labels.column("season"))))
    layers = by_method(base, say, value, ends, more)
    return alt.layer(at_one(frame, "y"), *layers).properties(width=WIDTH, height=HEIGHT)


def season_ladder(frame: pl.DataFrame, say: Say) -> Drawing:
    """Factor on Cw of each step in each season, as a coloured table with its numbers.

    Args:
        frame: `season_ladder` of one pair of methods.
        say: gives texts.
    """
    order = alt.EncodingSortField("position", order="ascending")
    label = named(STEP_ORDER, say)
    base = alt.Chart(frame).encode(
        alt.X(
            "step:N",
            title=say(labels.column("step")),
            sort=order,
            axis=alt.Axis(labelExpr=label, labelAngle=-45, orient="top"),
        ),
        alt.Y("season:O", title=say(labels.column("season"))),
    )
    shades = alt.Scale(
        domain=[0.8, 1.0, 1.2],
        range=[OKABE_ITO[5], "#ffffff", OKABE_ITO[4]],
        clamp=True,
        interpolate="rgb",
    )
    return alt.layer(
        base.mark_rect(stroke="#dddddd").encode(
            alt.Color("factor:Q", title=say(labels.column("factor")), scale=shades),
            tooltip=tips(say, "season:O", "step:N", "factor:Q"),
        ),
        base.mark_text(color="black").encode(alt.Text("factor:Q", format=".3f")),
    ).properties(width=WIDTH, height=HEIGHT)


def sensitivity_study(frame: pl.DataFrame, say: Say) -> Drawing:
    """What other choices of judgement do to Cw; `frame` is `option_summary`."""
    label = named(list(CHOICES), say)
    base = alt.Chart(frame).encode(
        alt.Y(
            "option:N",
            title=say(labels.column("option")),
            axis=alt.Axis(labelExpr=label, labelLimit=260),
        )
    )
    return alt.layer(
        at_one(frame, "x"),
        base.mark_rule(strokeWidth=3, color=OKABE_ITO[0]).encode(
            number(alt.X, "lo_ratio", say("Cw after / Cw before")), alt.X2("hi_ratio:Q")
        ),
        base.mark_point(filled=True, size=80, color="black", opacity=1).encode(
            number(alt.X, "median_ratio", say("Cw after / Cw before")),
            tooltip=tips(say, "option:N", "median_ratio:Q"),
        ),
    ).properties(width=480, height=220)
