"""The traces of a tow: what its instruments measured, second by second."""

import json
from typing import Final

import altair as alt
import polars as pl

from dashboards import labels
from dashboards.figures.style import GREY, OKABE_ITO, Drawing, tips
from pipeline.messages import Say, say
from pipeline.steps.window import CUT_REASONS

ROWS: Final = (
    (say("Speed [m/s]"), (("speed_m_s", OKABE_ITO[0], [1, 0]), ("gps_m_s", OKABE_ITO[1], [3, 2]))),
    (labels.column("force_n"), (("force_n", OKABE_ITO[2], [1, 0]),)),
    (say("Apparent wind [m/s]"), (("wind_m_s", OKABE_ITO[6], [1, 0]),)),
)
"""From top to bottom: the title of a row, and per line its column, colour and dash."""
REASONS_PX: Final = 40
"""Room above the traces of the first row, for three lines of reasons."""


def traces(frame: pl.DataFrame, say: Say) -> alt.VConcatChart:
    """Speed, force and wind over each run, what does not count greyed out.

    Args:
        frame: rows of `kind` trace (`run, second, speed_m_s, gps_m_s, force_n, wind_m_s`) and
            window (`run, window_start_s, window_end_s, run_end_s, cut_reason`).
        say: gives texts.
    """
    return alt.vconcat(*(_row(frame, say, place) for place in range(len(ROWS))))


def _row(frame: pl.DataFrame, say: Say, place: int) -> Drawing:
    title, fields = ROWS[place]
    room = 0 if place else REASONS_PX
    height = 110 + room
    x = alt.X("second:Q", title=say("Time in the run [s]"))
    scale = alt.Scale(zero=False, range=[height, room])
    trace = alt.Chart().transform_filter("datum.kind == 'trace'")
    lines = [
        trace.mark_line(color=ink, strokeDash=dash, strokeWidth=1.3).encode(
            x, alt.Y(f"{field}:Q", title=say(title), scale=scale), tooltip=tips(say, f"{field}:Q")
        )
        for field, ink, dash in fields
    ]
    above = [] if place else [_cut_reasons(say)]
    return (
        alt.layer(*_cut_parts(), *lines, *above, data=frame)
        .properties(width=150, height=height)
        .facet(alt.Facet("run:O", title=say(labels.column("run"))), columns=6)
    )


def _cut_reasons(say: Say) -> alt.Chart:
    """Why the rest of a run was cut, in words, a line a reason, in the room above the traces."""
    text = "datum.cut_reason"
    for code in CUT_REASONS:
        text = f"replace({text}, '{code}', {json.dumps(say(labels.code(code)))})"
    return (
        alt.Chart()
        .transform_filter("datum.kind == 'window' && datum.cut_reason")
        .transform_calculate(why=text)
        .encode(x=alt.value(3), y=alt.value(2), text="why:N")
        .mark_text(align="left", baseline="top", fontSize=10, lineBreak=",")
    )


def _cut_parts() -> list[alt.Chart]:
    """The parts of a run that do not count, greyed out: all of it where it has no window."""
    window = alt.Chart().transform_filter("datum.kind == 'window'")
    has_window = "isValid(datum.window_start_s)"
    parts = (
        ("0", f"{has_window} ? datum.window_start_s : datum.run_end_s"),
        (f"{has_window} ? datum.window_end_s : datum.run_end_s", "datum.run_end_s"),
    )
    return [
        window.transform_calculate(cut_from=start, cut_to=end)
        .mark_rect(color=GREY, opacity=0.3)
        .encode(alt.X("cut_from:Q"), alt.X2("cut_to:Q"))
        for start, end in parts
    ]
