"""Figures of agreement: repeat tows, causes of spread, prediction, and editions compared."""

from collections.abc import Mapping

import altair as alt
import polars as pl

from dashboards import labels
from dashboards.figures.style import (
    GREY,
    HEIGHT,
    WIDTH,
    Drawing,
    at_one,
    by_method,
    crews,
    editions_legend,
    kinds,
    methods,
    named,
    number,
    tips,
    type_legend,
)
from pipeline.messages import Say


def spread(frame: pl.DataFrame, say: Say) -> Drawing:
    """Standard deviation of one tow per era and method; `frame` is `reproducibility`."""
    base = alt.Chart(frame).encode(
        alt.X(
            "scope:N",
            title=say(labels.column("era")),
            axis=alt.Axis(labelAngle=0, labelExpr=named(["all"], say)),
        )
    )
    value, more = ("sd_ratio", say("Standard deviation / Cw")), ("scope:N", "n_pairs:Q")
    layers = by_method(base, say, value, ("lo", "hi"), more, zero=True)
    return alt.layer(*layers).properties(width=WIDTH, height=HEIGHT)


def era_shifts(frame: pl.DataFrame, say: Say) -> Drawing:
    """Next tow of the same boats against the tows of an era; `frame` is `era_shifts`."""
    base = alt.Chart(frame).encode(
        alt.X("era:N", title=say(labels.column("era")), axis=alt.Axis(labelAngle=0))
    )
    layers = by_method(
        base,
        say,
        ("shift_ratio", say("Cw new / old without ageing, median")),
        ("lo", "hi"),
        ("n:Q",),
    )
    return alt.layer(at_one(frame, "y"), *layers).properties(width=WIDTH, height=HEIGHT)


def repeat_pairs(frame: pl.DataFrame, say: Say) -> Drawing:
    """Every pair of repeat tows, by the season of the newer; `frame` has `page`."""
    points = (
        alt.Chart(frame)
        .mark_point(size=45, filled=True, opacity=0.8, cursor="pointer")
        .encode(
            alt.X("season:O", title=say(labels.column("season"))),
            number(alt.Y, "cw_ratio", say(labels.column("cw_ratio"))),
            *methods(say),
            xOffset="method:N",
            href="page:N",
            tooltip=tips(say, "name:N", "fsn_no:N", "method:N", "season_before:O", "cw_ratio:Q"),
        )
    )
    return alt.layer(at_one(frame, "y"), points).properties(width=WIDTH, height=HEIGHT)


def components(frame: pl.DataFrame, say: Say) -> Drawing:
    """Spread by cause; `frame` is `variance_components`."""
    base = alt.Chart().encode(
        alt.X(
            "component:N",
            title=say(labels.column("component")),
            axis=alt.Axis(
                labelExpr=named(["boat", "season", "boat_season", "run"], say), labelAngle=0
            ),
        )
    )
    layers = by_method(
        base, say, ("sd_ratio", say("Standard deviation / Cw")), ("lo", "hi"), zero=True
    )
    header = alt.Header(labelExpr=named(["fleet", "within_type"], say))
    return (
        alt.layer(*layers, data=frame)
        .properties(width=300, height=240)
        .facet(alt.Facet("scope:N", title=None, header=header), columns=2)
    )


def predicted(frame: pl.DataFrame, say: Say) -> Drawing:
    """Cw of the tow against Cw predicted without towing; `frame` has `page`."""
    equal = (
        alt.Chart(frame)
        .mark_line(color=GREY, strokeDash=[4, 3])
        .encode(number(alt.X, "cw_kg_m", say("Cw of the tow [kg/m]")), number(alt.Y, "cw_kg_m", ""))
    )
    places = {
        "cw_kg_m": say("Cw of the tow [kg/m]"),
        "predicted_cw_kg_m": say("Predicted Cw [kg/m]"),
    }
    by = ("boat_type", say("Type"), type_legend(say))
    points = _boats(frame, say, places, by)
    return alt.layer(equal, points).properties(width=480, height=360)


def register_changes(frame: pl.DataFrame, say: Say) -> Drawing:
    """Time and Cw of every changed register line, new / old; `frame` has `page`."""
    places = {
        "cw_ratio": say(labels.column("cw_ratio")),
        "time_ratio": say(labels.column("time_ratio")),
    }
    points = _boats(frame, say, places, ("to_edition", say("Edition"), editions_legend(say)))
    return alt.layer(at_one(frame, "x"), at_one(frame, "y"), points).properties(
        width=WIDTH, height=HEIGHT
    )


def _boats(
    frame: pl.DataFrame, say: Say, places: Mapping[str, str], by: tuple[str, str, alt.Legend]
) -> alt.Chart:
    """A point per boat that leads to its page, at two named columns, in colour and shape by one."""
    (x, x_title), (y, y_title) = places.items()
    column, title, legend = by
    return (
        alt.Chart(frame)
        .mark_point(size=60, filled=True, opacity=0.85, cursor="pointer")
        .encode(
            number(alt.X, x, x_title),
            number(alt.Y, y, y_title),
            *kinds(column, title, legend=legend),
            href="page:N",
            tooltip=tips(say, "name:N", "fsn_no:N", (f"{x}:Q", x_title), (f"{y}:Q", y_title)),
        )
    )


def race_ranks(frame: pl.DataFrame, say: Say) -> Drawing:
    """Place of every result under the old and the new edition; `frame` is `race_changes`."""
    same = (
        alt.Chart(frame)
        .mark_line(color=GREY, strokeDash=[4, 3])
        .encode(
            alt.X("old_rank:Q", title=say(labels.column("old_rank"))), alt.Y("old_rank:Q", title="")
        )
    )
    points = (
        alt.Chart(frame)
        .mark_point(size=60, filled=True, opacity=0.85, cursor="pointer")
        .encode(
            alt.X(
                "old_rank:Q",
                title=say(labels.column("old_rank")),
                axis=alt.Axis(tickMinStep=1, format="d"),
            ),
            alt.Y(
                "new_rank:Q",
                title=say(labels.column("new_rank")),
                axis=alt.Axis(tickMinStep=1, format="d"),
            ),
            *crews(say),
            href="page:N",
            tooltip=tips(
                say,
                *("race:N", "name:N", "fsn_no:N", "old_rank:Q", "new_rank:Q"),
                *(
                    ("old_power_w:Q", say("Power before [W/rower]")),
                    ("new_power_w:Q", say("Power after [W/rower]")),
                ),
            ),
        )
    )
    return alt.layer(same, points).properties(width=480, height=360)
