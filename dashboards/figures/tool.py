"""What the ticks on the screen of the tool of 2015 did to a curve."""

import altair as alt
import polars as pl

from dashboards import labels
from dashboards.colours import OKABE_ITO
from dashboards.figures.slides import SIDE, in_words, small
from dashboards.figures.style import Drawing, number
from pipeline.messages import Say
from pipeline.studies.options import SPEED_NAMES, TICKS


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
