"""What the screen of the tool of 2015 showed: its ticks, and the figures of each run."""

from typing import Final

import altair as alt
import polars as pl

from dashboards import labels
from dashboards.figures.slides import SIDE, in_words, panels, small
from dashboards.figures.style import GREY, OKABE_ITO, Drawing, number, tips
from pipeline.messages import Say
from pipeline.studies.claims import CHANNELS
from pipeline.studies.options import CHOICES, SPEED_NAMES, SPEEDS, TICKS

MOST_SCATTER: Final = 0.10
"""Sleepproef 2017: "standaard-deviatie < 10% van de meetwaarde"."""


def ticks(frame: pl.DataFrame, say: Say) -> Drawing:
    """Curves of a tow under every combination of the tool's ticks, overlaid.

    Each panel draws all of them and colours one tick: on or off. `frame` holds rows of
    `option_curves` with `declared_speed_m_s`; the points of a curve are made from A and Cw.
    """
    seen = f"{{'true': '{say('yes')}', 'false': '{say('no')}'}}[datum.value]"
    used = in_words("datum.value", say)
    curve = (
        alt.Chart()
        .transform_fold(list(TICKS), as_=["tick", "on"])
        .transform_calculate(
            curve="datum.speed + datum.optimisation + datum.trimming + datum.vane "
            "+ datum.b_from_length",
            ratio="sequence(0.85, 1.16, 0.03)",
        )
        .transform_flatten(["ratio"])
        .transform_calculate(
            speed_m_s="datum.ratio * datum.declared_speed_m_s",
            cw_curve_kg_m="datum.a_kg_m "
            "/ (1 - (1 - datum.a_kg_m / datum.cw_kg_m) * pow(datum.ratio, 2))",
        )
        .mark_line(strokeWidth=1.2, opacity=0.8)
        .encode(
            small("speed_m_s", say("Speed [m/s]")),
            number(alt.Y, "cw_curve_kg_m", say("Cw [kg/m]")),
            alt.Color(
                "on:N",
                title=say("Ticked"),
                # Dark and light: apart in grey print too.
                scale=alt.Scale(domain=[False, True], range=[OKABE_ITO[0], OKABE_ITO[4]]),
                legend=alt.Legend(labelExpr=seen, orient="bottom"),
            ),
            alt.StrokeDash(
                "speed:N",
                title=say(labels.column("speed")),
                scale=alt.Scale(range=[[1, 0], [5, 2], [2, 2]]),
                sort=list(SPEED_NAMES),
                legend=alt.Legend(labelExpr=used, orient="bottom"),
            ),
            alt.Detail("curve:N"),
        )
    )
    drawing = alt.layer(curve, data=frame).properties(width=SIDE, height=SIDE)
    label = in_words("datum.value", say)
    return drawing.facet(
        alt.Facet(
            "tick:N",
            title=None,
            sort=list(TICKS),
            header=alt.Header(labelExpr=label, labelLimit=260),
        ),
        columns=len(TICKS),
    )


def tick_effects(frame: pl.DataFrame, say: Say) -> Drawing:
    """What each choice does to Cw: median and middle 90 % of tows.

    `frame` holds rows of `option_summary`; of a single tow without the bar.
    """
    order = [*TICKS, *SPEEDS, *CHOICES]
    base = alt.Chart().encode(
        alt.Y(
            "option:N",
            title=say(labels.column("option")),
            sort=order,
            axis=alt.Axis(labelExpr=in_words("datum.value", say), labelLimit=260),
        )
    )
    ratio = say("Cw after / Cw before")
    bar = base.mark_rule(strokeWidth=3, color=OKABE_ITO[0]).encode(
        small("lo_ratio", ratio), alt.X2("hi_ratio:Q")
    )
    point = base.mark_point(filled=True, size=70, color="black", opacity=1).encode(
        small("median_ratio", ratio),
        tooltip=tips(say, "option:N", "median_ratio:Q", "tows:Q"),
    )
    one = alt.Chart().mark_rule(color=GREY, strokeDash=[3, 3]).encode(x=alt.datum(1.0))
    drawing = alt.layer(one, bar, point, data=frame)
    return panels(drawing, say, columns=2, width=260, height=alt.Step(24))


def run_statistics(frame: pl.DataFrame, say: Say) -> Drawing:
    """Spread of each channel within each run, as part of its mean; `frame` is `run_statistics`."""
    point = (
        alt.Chart()
        .mark_point(filled=True, size=60, color=OKABE_ITO[0])
        .encode(
            alt.X("run:O", title=say(labels.column("run"))),
            number(alt.Y, "sd_ratio", say("Standard deviation / mean"), zero=True),
            tooltip=tips(
                say,
                *("run:O", "mean:Q", "sd:Q", "median:Q"),
                *(("median_ratio:Q", say("Median / mean")), "log1_ratio:Q"),
            ),
        )
    )
    limit = alt.Chart().mark_rule(color=GREY, strokeDash=[3, 3])
    drawing = alt.layer(limit.encode(y=alt.datum(MOST_SCATTER)), point, data=frame)
    label = in_words("'channel.' + datum.value", say)
    header = alt.Header(labelExpr=label, labelLimit=260)
    panel = alt.Facet("channel:N", title=None, sort=list(CHANNELS), header=header)
    return drawing.properties(width=SIDE, height=120).facet(panel, columns=3)
