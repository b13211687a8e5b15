"""The page of boat types: are equal boats equal, before and after."""

from collections.abc import Iterator, Sequence

import polars as pl

from dashboards import labels
from dashboards.site.parts import (
    Chart,
    Page,
    Section,
    Select,
    Table,
    default_method,
    listed,
    methods_select,
    once_for_methods,
    tows_select,
    type_path,
    with_page,
)
from dashboards.site.slides import drawn_rows, sentences, told_charts
from dashboards.statements.boat_type import homogeneity
from pipeline.messages import say
from warehouse.queries.chosen_tows import with_choices
from warehouse.queries.views import Views

SCATTERS = ("b_weight", "b_speed", "a_weight", "cw_standard_weight", "cw_standard_speed")
SIDES = ("before", "after")
"""Selectors of the two methods that stand side by side."""


def types_page(views: Views, methods: Sequence[str]) -> Page:
    """A, B and Cw at one speed of every tow against weight and speed, and what differs."""
    if not views.has("compared_tows"):
        return Page("types.html", say("Types"), [])
    tows = with_choices(with_page(views.type_tows()))
    types = tows["boat_type"].unique().sort().to_list()
    columns = (
        *("name", "fsn_no", "boat_type", "rowers", "crew_class", "season", "weight_kg"),
        *("declared_speed_m_s", "a_kg_m", "b_m_s", "b_lo_m_s", "b_hi_m_s", "cw_standard_kg_m"),
        *("cw_standard_lo_kg_m", "cw_standard_hi_kg_m"),
    )
    newest = tows.filter("newest").with_columns(after="method")
    table = Table(
        "type_boats", newest, columns, say("Boats"), ["after", "boat_type"],
        search=True, linked=True,
    )  # fmt: skip
    links = [(type_path(name), name) for name in types]
    follows = {"method": SIDES, "boat_type": "boat_type", "tows": "tows"}
    charts = [Chart(name, "type_boats", labels.FIGURES[name], follows) for name in SCATTERS]
    return Page(
        "types.html",
        say("Types"),
        [
            Section(
                "types_pages",
                say("One type"),
                say("Every type has a page: are the boats equal, and how do they compare?"),
                pages=links,
            ),
            Section(
                "types_charts",
                say("B and Cw per type"),
                say(
                    "The chosen tows under two methods, on the same axes. Boats without a type are "
                    "left out. Standard speed: the median declared speed of the type. Drag over a "
                    "chart to select boats, or fill in from and to below it: the list shows them, "
                    "each with its newest tow. Lowest and highest are a 95 % interval, or with a "
                    "method that does not estimate the log's error the spread of the runs alone: "
                    "that error is then not in it. Click a point to go to the boat. Two types by "
                    "four methods are on the page Presentation 2015. Any range of seasons can be "
                    "chosen in the workbench (herijk workbench), which computes its statistics "
                    "anew."
                ),
                charts,
            ),
            Section("types_list", say("Boats"), tables=[table]),
            *_type_tables(views, tows),
        ],
        selects=[
            tows_select(tows),
            methods_select(methods, "before", methods[0]),
            methods_select(methods, "after"),
            Select("boat_type", say("Type"), types, "", with_all=True),
        ],
        data={"type_boats": [tows.select("method", "page", "tows", *columns)]},
    )


TYPE_COLUMNS = (
    *("name", "fsn_no", "rowers", "crew_class", "season", "weight_kg", "cw_standard_kg_m"),
    *("declared_speed_m_s", "cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m", "a_kg_m", "b_m_s"),
)
TYPE_CARDS = ("name", "fsn_no", "rowers", "crew_class", "season", "cw_standard_kg_m", "cw_kg_m")
LINE_COLUMNS = (
    *("quantity", "explaining", "within", "n", "n_boats", "slope", "slope_lo", "slope_hi", "r2"),
    "residual_sd_ratio",
)
TYPE_FIGURES = ("slide_cw_weight", "slide_cw_speed", "slide_b_weight")


def type_pages(views: Views, methods: Sequence[str]) -> Iterator[Page]:
    """A page for every type: the verdict, its tows, the fitted lines."""
    if not views.has("compared_tows"):
        return
    tows = views.type_tows().select("method", "boat_type", "newest", *TYPE_COLUMNS)
    listed_tows = with_choices(once_for_methods(tows))
    lines, tests = views.table("type_lines"), views.table("type_homogeneity")
    drawn, said = drawn_rows(views), sentences(views)
    for boat_type in views.type_names():
        own = pl.col("boat_type") == boat_type
        charts = told_charts(TYPE_FIGURES, said, [boat_type], {"tows": "tows"})
        listed = Table(
            "type_boats", listed_tows.filter(own), TYPE_COLUMNS, say("Boats"), ["method", "tows"],
            search=True, exact=False, cards=TYPE_CARDS,
        )  # fmt: skip
        fitted = Table(
            "type_lines",
            lines.filter(own),
            LINE_COLUMNS,
            say("Does it follow weight or speed?"),
            ["method", "tows"],
        )
        verdict = homogeneity(tests.filter(own, method=default_method(methods)))
        yield Page(
            type_path(boat_type),
            say("Types"),
            [
                Section(
                    "type_verdict",
                    say("Are these boats equal?"),
                    say(
                        "The verdict is about the newest tow of each boat and crew, charts and "
                        "tables about the tows that you choose. Standard speed: the median "
                        "declared speed of the type, at which Cw can be compared; the declared "
                        "speed differs by crew. The line is the best straight fit with its 95 % "
                        "interval. A full bar through a point is its 95 % interval; a dashed one "
                        "is the spread of the runs alone: the log's error is not in it."
                    ),
                    charts,
                    [listed],
                    headline=verdict,
                ),
                Section(
                    "types_lines",
                    say("Does it follow weight or speed?"),
                    say(
                        "A straight line per type through n tows; tows of one boat count as "
                        "repeats. The page of a type also has those through all tows and per "
                        "season. The slope is the change of the quantity per kg or per m/s (of a "
                        "power: the exponent); a slope whose interval holds 0 is not shown to "
                        "exist. R²: share of the spread that the line explains. q is (v/B)²/(1 - "
                        "(v/B)²) at the standard speed, the median declared speed of the type."
                    ),
                    tables=[fitted],
                    folded=True,
                ),
            ],
            name=boat_type,
            selects=[tows_select(tows), methods_select(methods)],
            data={"slides": [f.filter(own) for f in drawn], "said": [said.filter(own)]},
        )


OUTLIER_COLUMNS = (
    *("name", "fsn_no", "boat_type", "rowers", "crew_class", "season", "cw_standard_kg_m"),
    *("expected_cw_kg_m", "deviation_sd", "candidates"),
)


OF_TYPE = ("after", "boat_type")
NEWEST_COLUMNS = (
    *("name", "fsn_no", "boat_type", "rowers", "crew_class", "season", "quantity", "value"),
    *("expected", "deviation_sd", "candidates"),
)
TEST_COLUMNS = (
    *("boat_type", "n", "n_boats", "p_value", "power_at_10pct", "noise_share", "shared_b_m_s"),
)


def _type_tables(views: Views, tows: pl.DataFrame) -> list[Section]:
    """What differs: tows of the choice, then the newest with the bend, lines and tests."""
    after = pl.col("method").alias("after")
    outside, newest = tows.filter("outside").with_columns(after), views.outliers()
    tables = [
        Table(
            "compared_tows",
            outside,
            OUTLIER_COLUMNS,
            say("Chosen tows whose Cw differs from their type"),
            [*OF_TYPE, "tows"],
        )
    ]
    if newest.height:
        newest = newest.with_columns(after)
        tables.append(
            Table(
                "type_outliers",
                newest,
                NEWEST_COLUMNS,
                say("Newest tows that differ from their type"),
                OF_TYPE,
                exact=False,
            )
        )
    tests = views.table("type_homogeneity").with_columns(after)
    fitted = views.table("type_consistency").with_columns(after)
    columns = ("boat_type", *LINE_COLUMNS)
    lines = Table(
        "type_consistency",
        fitted,
        columns,
        say("Does it follow weight or speed? The newest tow of each crew"),
        OF_TYPE,
    )
    return [
        Section(
            "types_outliers",
            say("Newest tows that differ from their type"),
            say(
                "Far from what the other boats of the type predict, in standard deviations "
                "(sd) of that prediction. A possible cause is something to look at, not proven."
            ),
            tables=tables,
        ),
        Section(
            "types_lines_newest",
            say("Does it follow weight or speed? The newest tow of each crew"),
            say(
                "A straight line per type through n tows; tows of one boat count as repeats. "
                "The page of a type also has those through all tows and per season. The slope "
                "is the change of the quantity per kg or per m/s (of a power: the exponent); a "
                "slope whose interval holds 0 is not shown to exist. R²: share of the spread "
                "that the line explains. q is (v/B)²/(1 - (v/B)²) at the standard speed, the "
                "median declared speed of the type."
            ),
            tables=[lines],
        ),
        *listed(
            Section(
                "types_homogeneity",
                say("Could one B serve the type?"),
                say(
                    "Of the newest tow of each boat and crew (n). p: chance of so large a "
                    "difference between the bends if all boats have the same B; a small p says "
                    "that they have not. Chance to see 10 %: how likely a true spread of B of 10 % "
                    "would have been noticed here. Share of noise: share of the spread that the "
                    "runs alone give."
                ),
            ),
            "type_homogeneity",
            tests,
            TEST_COLUMNS,
            follows=OF_TYPE,
        ),
    ]
