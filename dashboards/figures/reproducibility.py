"""Figures of agreement: repeat tows, causes of spread, prediction, and editions compared."""

import altair as alt
import polars as pl

from dashboards.figures.style import GREY, HEIGHT, WIDTH, colour, number, shape, stroke, tips
from dashboards.words import Say


def spread(frame: pl.DataFrame, say: Say) -> alt.LayerChart:
    """Standard deviation of one tow per era and method; `frame` is `reproducibility`."""
    base = alt.Chart(frame).encode(
        alt.X("scope:N", title=say("scope"), axis=alt.Axis(labelAngle=0)),
        xOffset="method:N",
    )
    interval = number(alt.Y, "lo", say("sd_ratio"), zero=True), alt.Y2("hi:Q")
    return alt.layer(
        base.mark_rule(strokeWidth=2).encode(*interval, stroke=stroke("method")),
        base.mark_point(filled=True, size=70, opacity=1).encode(
            number(alt.Y, "sd_ratio", say("sd_ratio"), zero=True),
            colour("method", say("method")),
            shape("method", say("method")),
            tooltip=tips(
                ("method:N", say("method")),
                ("scope:N", say("scope")),
                ("sd_ratio:Q", say("sd_ratio")),
                ("n_pairs:Q", say("number")),
            ),
        ),
    ).properties(width=WIDTH, height=HEIGHT)


def era_shifts(frame: pl.DataFrame, say: Say) -> alt.LayerChart:
    """Next tow of the same boats against the tows of an era; `frame` is `era_shifts`."""
    base = alt.Chart(frame).encode(
        alt.X("era:N", title=say("scope"), axis=alt.Axis(labelAngle=0)), xOffset="method:N"
    )
    ends = number(alt.Y, "lo", say("shift_ratio")), alt.Y2("hi:Q")
    return alt.layer(
        alt.Chart(frame).mark_rule(color=GREY, strokeDash=[4, 3]).encode(y=alt.datum(1.0)),
        base.mark_rule(strokeWidth=2).encode(*ends, stroke=stroke("method")),
        base.mark_point(filled=True, size=70, opacity=1).encode(
            number(alt.Y, "shift_ratio", say("shift_ratio")),
            colour("method", say("method")),
            shape("method", say("method")),
            tooltip=tips(
                ("method:N", say("method")),
                ("shift_ratio:Q", say("shift_ratio")),
                ("n:Q", say("number")),
            ),
        ),
    ).properties(width=WIDTH, height=HEIGHT)


def repeat_pairs(frame: pl.DataFrame, say: Say) -> alt.LayerChart:
    """Every pair of repeat tows, by the season of the newer; `frame` has `page`."""
    zero = alt.Chart(frame).mark_rule(color=GREY, strokeDash=[4, 3]).encode(y=alt.datum(0.0))
    points = (
        alt.Chart(frame)
        .mark_point(size=45, filled=True, opacity=0.8, cursor="pointer")
        .encode(
            alt.X("season:O", title=say("season")),
            number(alt.Y, "ln_ratio", say("ln_ratio")),
            colour("method", say("method")),
            shape("method", say("method")),
            xOffset="method:N",
            href="page:N",
            tooltip=tips(
                ("name:N", say("name")),
                ("fsn_no:N", "FSN"),
                ("method:N", say("method")),
                ("season_before:O", say("season")),
                ("ln_ratio:Q", say("ln_ratio")),
            ),
        )
    )
    return alt.layer(zero, points).properties(width=WIDTH, height=HEIGHT)


def components(frame: pl.DataFrame, say: Say) -> alt.FacetChart:
    """Spread by cause; `frame` is `variance_components`."""
    names = {c: say(f"code.{c}") for c in ("boat", "season", "boat_season", "run")}
    scopes = {c: say(f"code.{c}") for c in ("fleet", "within_type")}
    base = alt.Chart().encode(
        alt.X(
            "component:N",
            title=say("component"),
            axis=alt.Axis(labelExpr=f"({names})[datum.value] || datum.value", labelAngle=0),
        ),
        xOffset="method:N",
    )
    return (
        alt.layer(
            base.mark_rule(strokeWidth=2).encode(
                number(alt.Y, "lo", say("sd_ratio"), zero=True),
                alt.Y2("hi:Q"),
                stroke=stroke("method"),
            ),
            base.mark_point(filled=True, size=60, opacity=1).encode(
                number(alt.Y, "sd_ratio", say("sd_ratio"), zero=True),
                colour("method", say("method")),
                shape("method", say("method")),
                tooltip=tips(("method:N", say("method")), ("sd_ratio:Q", say("sd_ratio"))),
            ),
            data=frame,
        )
        .properties(width=300, height=240)
        .facet(
            alt.Facet(
                "scope:N",
                title=None,
                header=alt.Header(labelExpr=f"({scopes})[datum.value] || datum.value"),
            ),
            columns=2,
        )
    )


def predicted(frame: pl.DataFrame, say: Say) -> alt.LayerChart:
    """Cw of the tow against Cw predicted without towing; `frame` has `page`."""
    equal = (
        alt.Chart(frame)
        .mark_line(color=GREY, strokeDash=[4, 3])
        .encode(number(alt.X, "cw_kg_m", say("tow_cw")), number(alt.Y, "cw_kg_m", ""))
    )
    points = (
        alt.Chart(frame)
        .mark_point(size=60, filled=True, opacity=0.85, cursor="pointer")
        .encode(
            number(alt.X, "cw_kg_m", say("tow_cw")),
            number(alt.Y, "predicted_cw_kg_m", say("predicted_cw")),
            colour("boat_type", say("type")),
            shape("boat_type", say("type")),
            href="page:N",
            tooltip=tips(
                ("name:N", say("name")),
                ("fsn_no:N", "FSN"),
                ("cw_kg_m:Q", say("tow_cw")),
                ("predicted_cw_kg_m:Q", say("predicted_cw")),
            ),
        )
    )
    return alt.layer(equal, points).properties(width=480, height=360)


def register_changes(frame: pl.DataFrame, say: Say) -> alt.LayerChart:
    """Time and Cw of every changed register line, new / old; `frame` has `page`."""
    one = alt.Chart(frame).mark_rule(color=GREY, strokeDash=[4, 3])
    points = (
        alt.Chart(frame)
        .mark_point(size=60, filled=True, opacity=0.85, cursor="pointer")
        .encode(
            number(alt.X, "cw_ratio", say("ratio_cw")),
            number(alt.Y, "time_ratio", say("time_ratio")),
            colour("to_edition", say("edition")),
            shape("to_edition", say("edition")),
            href="page:N",
            tooltip=tips(
                ("name:N", say("name")),
                ("fsn_no:N", "FSN"),
                ("cw_ratio:Q", say("ratio_cw")),
                ("time_ratio:Q", say("time_ratio")),
            ),
        )
    )
    return alt.layer(one.encode(x=alt.datum(1.0)), one.encode(y=alt.datum(1.0)), points).properties(
        width=WIDTH, height=HEIGHT
    )
