"""Figures of what corrections do: log factors, the ladder of steps, choices of judgement."""

import altair as alt
import polars as pl

from dashboards.figures.style import (
    GREY,
    HEIGHT,
    OKABE_ITO,
    WIDTH,
    colour,
    number,
    shape,
    stroke,
    tips,
)
from dashboards.words import Say
from pipeline.ladder import STEP_ORDER


def _at_one(frame: pl.DataFrame, channel: str) -> alt.Chart:
    line = alt.Chart(frame).mark_rule(color=GREY, strokeDash=[4, 3])
    return line.encode(**{channel: alt.datum(1.0)})


def log_factors(frame: pl.DataFrame, say: Say) -> alt.LayerChart:
    """True speed / log speed per season and method, with 95 % intervals; `frame` is the table."""
    base = alt.Chart(frame).encode(
        alt.X("season:O", title=say("season")),
        xOffset="method:N",
    )
    y = number(alt.Y, "factor", say("factor"))
    interval = number(alt.Y, "lo", say("factor")), alt.Y2("hi:Q")
    return alt.layer(
        _at_one(frame, "y"),
        base.mark_rule(strokeWidth=2).encode(*interval, stroke=stroke("method")),
        base.mark_point(filled=True, size=60, opacity=1).encode(
            y,
            colour("method", say("method")),
            shape("method", say("method")),
            tooltip=tips(
                ("method:N", say("method")),
                ("season:O", say("season")),
                ("factor:Q", say("factor")),
                ("source:N", say("source")),
            ),
        ),
    ).properties(width=WIDTH, height=HEIGHT)


def season_ladder(frame: pl.DataFrame, say: Say) -> alt.LayerChart:
    """Factor on Cw of each step in each season, as a coloured table with its numbers.

    Args:
        frame: `Views.season_ladder` of one pair of methods, with `step_name` per language.
        say: gives texts.
    """
    order = alt.EncodingSortField("position", order="ascending")
    names = {step: say(f"code.{step}") for step in STEP_ORDER}
    label = f"({names!s})[datum.value] || datum.value"
    base = alt.Chart(frame).encode(
        alt.X(
            "step:N",
            title=say("step"),
            sort=order,
            axis=alt.Axis(labelExpr=label, labelAngle=0, orient="top"),
        ),
        alt.Y("season:O", title=say("season")),
    )
    shades = alt.Scale(
        domain=[0.8, 1.0, 1.2],
        range=[OKABE_ITO[5], "#ffffff", OKABE_ITO[4]],
        clamp=True,
        interpolate="rgb",
    )
    return alt.layer(
        base.mark_rect(stroke="#dddddd").encode(
            alt.Color("factor:Q", title=say("factor"), scale=shades),
            tooltip=tips(
                ("season:O", say("season")), ("step:N", say("step")), ("factor:Q", say("factor"))
            ),
        ),
        base.mark_text(color="black").encode(alt.Text("factor:Q", format=".3f")),
    ).properties(width=WIDTH, height=HEIGHT)


def season_change(frame: pl.DataFrame, say: Say) -> alt.LayerChart:
    """Cw re-based / as published: median and range per season; `frame` is `season_change`."""
    base = alt.Chart(frame).encode(
        alt.X("season:O", title=say("season")),
        xOffset="method:N",
    )
    span = number(alt.Y, "lowest_ratio", say("ratio_cw")), alt.Y2("highest_ratio:Q")
    return alt.layer(
        _at_one(frame, "y"),
        base.mark_rule(strokeWidth=2).encode(*span, stroke=stroke("method")),
        base.mark_point(filled=True, size=60, opacity=1).encode(
            number(alt.Y, "median_ratio", say("ratio_cw")),
            colour("method", say("method")),
            shape("method", say("method")),
            tooltip=tips(
                ("method:N", say("method")),
                ("season:O", say("season")),
                ("median_ratio:Q", say("ratio_cw")),
                ("tows:Q", say("number")),
            ),
        ),
    ).properties(width=WIDTH, height=HEIGHT)


def option_study(frame: pl.DataFrame, say: Say) -> alt.LayerChart:
    """What other choices of judgement do to Cw; `frame` is `Views.option_spread`."""
    base = alt.Chart(frame).encode(
        alt.Y("option:N", title=say("option"), axis=alt.Axis(labelLimit=220))
    )
    return alt.layer(
        _at_one(frame, "x"),
        base.mark_rule(strokeWidth=3, color=OKABE_ITO[0]).encode(
            number(alt.X, "lo_ratio", say("ratio_cw")), alt.X2("hi_ratio:Q")
        ),
        base.mark_point(filled=True, size=80, color="black", opacity=1).encode(
            number(alt.X, "median_ratio", say("ratio_cw")),
            tooltip=tips(("option:N", say("option")), ("median_ratio:Q", say("ratio_cw"))),
        ),
    ).properties(width=480, height=220)
