"""Figures of one boat: curve, history, traces, wind, out against back, and uncertainty."""

import json
from collections.abc import Sequence

import altair as alt
import polars as pl

from dashboards import labels
from dashboards.figures.style import (
    BACK,
    GREY,
    HEIGHT,
    OKABE_ITO,
    OUT,
    WIDTH,
    Drawing,
    by_method,
    interval_dash,
    named,
    number,
    tips,
)
from pipeline.messages import Say
from pipeline.method.definition import COMPLETE
from pipeline.steps.window import CUT_REASONS
from pipeline.uncertainty.propagation import COMPONENTS

DIRECTION = "datum.value == 1 ? '{out}' : '{back}'"


def _directions(say: Say) -> tuple[alt.Color, alt.Shape]:
    """Out and back apart by colour and shape, in one legend."""
    legend = alt.Legend(
        labelExpr=DIRECTION.format(
            out=say(labels.code("direction.1")), back=say(labels.code("direction.-1"))
        )
    )
    inks = alt.Scale(domain=[1, -1], range=[OUT, BACK])
    shapes = alt.Scale(domain=[1, -1], range=["circle", "triangle-up"])
    title = say(labels.column("direction"))
    return (
        alt.Color("direction:N", title=title, scale=inks, legend=legend),
        alt.Shape("direction:N", title=title, scale=shapes, legend=legend),
    )


def resistance_curve(frame: pl.DataFrame, say: Say) -> Drawing:
    """The curve with its run points, band, and interval at the declared speed.

    Args:
        frame: rows of `kind` line, point and declared, with `speed_m_s, cw_kg_m, cw_lo_kg_m,
            cw_hi_kg_m, run, direction, used`, and the `interval` of the method.
        say: gives texts.
    """
    x = number(alt.X, "speed_m_s", say("Speed through water [m/s]"))
    y = number(alt.Y, "cw_kg_m", say("Cw [kg/m]"))
    whole = alt.Chart(frame)
    line = whole.transform_filter("datum.kind == 'line'")
    point = whole.transform_filter("datum.kind == 'point'")
    declared = whole.transform_filter("datum.kind == 'declared'")
    low, high = alt.Y("cw_lo_kg_m:Q", title=say("Cw [kg/m]")), alt.Y2("cw_hi_kg_m:Q")
    point_tips = tips(say, "run:O", "speed_m_s:Q", ("cw_kg_m:Q", say("Cw [kg/m]")))
    declared_tips = tips(say, ("speed_m_s:Q", say("Declared speed [m/s]")), "cw_kg_m:Q")
    ink, form = _directions(say)
    dash, complete = interval_dash(say), f"datum.interval == '{COMPLETE}'"
    full, light = alt.value(0.35), alt.value(0.12)
    return alt.layer(
        line.mark_area(color=OKABE_ITO[5], line=False, stroke=OKABE_ITO[5]).encode(
            x, low, high, dash, fillOpacity=alt.when(complete).then(full).otherwise(light)
        ),
        line.mark_line(color="black").encode(x, y),
        declared.mark_rule(color="black", strokeWidth=3).encode(x, low, high, dash),
        declared.mark_point(shape="stroke", color="black", size=300, strokeWidth=2).encode(
            x, y, tooltip=declared_tips
        ),
        point.mark_point(size=90, strokeWidth=2).encode(
            x,
            y,
            ink,
            form,
            fillOpacity=alt.condition("datum.used", alt.value(0.9), alt.value(0)),
            fill=ink,
            tooltip=point_tips,
        ),
    ).properties(width=WIDTH, height=HEIGHT)


def history(frame: pl.DataFrame, say: Say) -> Drawing:
    """Cw at the declared speed of every tow under every method, with intervals.

    Args:
        frame: rows of `curves` with `tow` and the `interval` of their method.
        say: gives texts.
    """
    base = alt.Chart(frame).encode(alt.X("tow:O", title=say("Tow"), axis=alt.Axis(labelAngle=-30)))
    value, ends = ("cw_kg_m", say("Cw at the declared speed [kg/m]")), ("cw_lo_kg_m", "cw_hi_kg_m")
    more = ("tow:N", "a_kg_m:Q", "b_m_s:Q")
    bars = by_method(base, say, value, ends, more, dash=interval_dash(say))
    return alt.layer(*bars).properties(width=WIDTH, height=HEIGHT)


def traces(frame: pl.DataFrame, say: Say) -> alt.VConcatChart:
    """Speed, force and wind over each run, what does not count greyed out.

    Args:
        frame: rows of `kind` trace (`run, second, speed_m_s, gps_m_s, force_n, wind_m_s`) and
            window (`run, window_start_s, window_end_s, run_end_s, cut_reason`).
        say: gives texts.
    """
    rows = [
        (("speed_m_s", OKABE_ITO[0], [1, 0]), ("gps_m_s", OKABE_ITO[1], [3, 2])),
        (("force_n", OKABE_ITO[2], [1, 0]),),
        (("wind_m_s", OKABE_ITO[6], [1, 0]),),
    ]
    titles = (say("Speed [m/s]"), say(labels.column("force_n")), say("Apparent wind [m/s]"))
    first, *others = zip(rows, titles, strict=True)
    return alt.vconcat(
        _trace_row(frame, say, *first, _cut_reasons(say)),
        *(_trace_row(frame, say, *row) for row in others),
    )


def _cut_reasons(say: Say) -> list[alt.Chart]:
    """Why the rest of a run was cut, in words, a line a reason, in the room above the traces."""
    text = "datum.cut_reason"
    for code in CUT_REASONS:
        text = f"replace({text}, '{code}', {json.dumps(say(labels.code(code)))})"
    why = (
        alt.Chart()
        .transform_filter("datum.kind == 'window' && datum.cut_reason")
        .transform_calculate(why=text)
        .encode(x=alt.value(3), y=alt.value(2), text="why:N")
    )
    return [why.mark_text(align="left", baseline="top", fontSize=10, lineBreak=",")]


REASONS_PX = 40
"""Room above the traces of the first row, for three lines of reasons."""


def _cut_parts() -> list[alt.Chart]:
    """The parts of a run that do not count, greyed out."""
    window = alt.Chart().transform_filter("datum.kind == 'window'")
    counted = window.transform_filter("isValid(datum.window_start_s)")
    none = window.transform_filter("!isValid(datum.window_start_s)")
    parts = [
        (counted, "0", "datum.window_start_s"),
        (counted, "datum.window_end_s", "datum.run_end_s"),
        (none, "0", "datum.run_end_s"),
    ]
    return [
        which.transform_calculate(cut_from=start, cut_to=end)
        .mark_rect(color=GREY, opacity=0.3)
        .encode(alt.X("cut_from:Q"), alt.X2("cut_to:Q"))
        for which, start, end in parts
    ]


def _trace_row(
    frame: pl.DataFrame,
    say: Say,
    fields: tuple[tuple[str, str, list[int]], ...],
    title: str,
    above: Sequence[alt.Chart] = (),
) -> Drawing:
    x = alt.X("second:Q", title=say("Time in the run [s]"))
    height = 110 + (REASONS_PX if above else 0)
    scale = alt.Scale(zero=False, range=[height, REASONS_PX if above else 0])
    lines = [
        alt.Chart()
        .transform_filter("datum.kind == 'trace'")
        .mark_line(color=ink, strokeDash=dash, strokeWidth=1.3)
        .encode(x, alt.Y(f"{field}:Q", title=title, scale=scale), tooltip=tips(say, f"{field}:Q"))
        for field, ink, dash in fields
    ]
    return (
        alt.layer(*_cut_parts(), *lines, *above, data=frame)
        .properties(width=150, height=height)
        .facet(alt.Facet("run:O", title=say(labels.column("run"))), columns=6)
    )


def out_and_back(frame: pl.DataFrame, say: Say) -> Drawing:
    """Cw of the runs before and after the air correction, out and back.

    Args:
        frame: rows with `stage` (gross or net), `speed_m_s, cw_kg_m, direction, run`.
        say: gives texts.
    """
    label = f"datum.value == 'gross' ? '{say(labels.code('gross'))}' : '{say(labels.code('net'))}'"
    return (
        alt.Chart(frame)
        .mark_point(size=80, filled=True, opacity=0.9)
        .encode(
            number(alt.X, "speed_m_s", say("Speed through water [m/s]")),
            number(alt.Y, "cw_kg_m", say("Cw [kg/m]")),
            *_directions(say),
            tooltip=tips(say, "run:O", ("cw_kg_m:Q", say("Cw [kg/m]"))),
        )
        .properties(width=280, height=240)
        .facet(alt.Facet("stage:N", title=None, header=alt.Header(labelExpr=label)), columns=2)
    )


def wind(frame: pl.DataFrame, say: Say) -> alt.Chart:
    """Mean apparent wind of each run, by its angle: 0 is from ahead, minus from port.

    Args:
        frame: rows of `Views.run_points`.
        say: gives texts.
    """
    angles = alt.Scale(domain=[-180, 180])
    return (
        alt.Chart(frame)
        .mark_point(size=80, filled=True, opacity=0.9)
        .encode(
            alt.X(
                "wind_angle_deg:Q",
                title=say("Wind angle, 0 from ahead [deg]"),
                scale=angles,
                axis=alt.Axis(values=[-180, -135, -90, -45, 0, 45, 90, 135, 180]),
            ),
            number(alt.Y, "wind_m_s", say("Apparent wind [m/s]"), zero=True),
            *_directions(say),
            tooltip=tips(say, "run:O", "wind_m_s:Q"),
        )
        .properties(width=WIDTH, height=200)
    )


def budget(frame: pl.DataFrame, say: Say) -> alt.Chart:
    """What makes Cw uncertain, the largest first; `frame` is `uncertainty_budget`."""
    label = named(COMPONENTS, say)
    return (
        alt.Chart(frame)
        .mark_bar(color=OKABE_ITO[0])
        .encode(
            alt.X("u_ratio:Q", title=say("Standard uncertainty / Cw")),
            alt.Y(
                "component:N",
                title=say(labels.column("component")),
                sort="-x",
                axis=alt.Axis(labelExpr=label, labelLimit=220),
            ),
            tooltip=tips(say, "component:N", "u_ratio:Q"),
        )
        .properties(width=480, height=alt.Step(20))
    )
