"""The pages of boat types: are equal boats equal, as published and re-based.

All of them are about the newest tow of each boat and crew, as `herijk audit`; the workbench can
also judge types by all tows. Verdicts are those of the table `type_consistency`.
"""

from collections.abc import Iterator, Sequence

import polars as pl

from dashboards import labels
from dashboards.addresses import type_path
from dashboards.figures.types import ENDS, PAIRS
from dashboards.site.parts import (
    Chart,
    Grid,
    Page,
    Section,
    Table,
    methods_select,
    once_for_methods,
    types_select,
    with_page,
)
from dashboards.speech import Text
from dashboards.statements import Statement, together, told
from dashboards.statements.boat_type import (
    HEADINGS,
    TABLE,
    Names,
    describe_row,
    describe_slope,
    judge_type,
    name_relation,
    order_rows,
    sum_up_type,
)
from pipeline.consistency.types import TERM_NAMES
from pipeline.messages import Sentence, say
from pipeline.register.register import default_method
from pipeline.tables.row import Row
from warehouse.queries.views import Views

SCATTERS = ("b_weight", "b_speed", "cw_standard_weight", "cw_standard_speed", "a_weight")
SIDES = ("before", "after")
"""Selectors of the two methods that stand side by side."""
TOW_COLUMNS = (
    "name fsn_no boat_type rowers crew_class season weight_kg declared_speed_m_s a_kg_m b_m_s "
    "cw_standard_kg_m"
)
DRAWN_COLUMNS = (
    *("method", "page", "crew_class", "fsn_no", "label", "cw_outside", "beyond_curve"),
    *("weight_kg", "declared_speed_m_s"),
    *(column for quantity, ends in ENDS.items() for column in (quantity, *ends)),
)
OUTSIDE_COLUMNS = (
    "name fsn_no boat_type rowers crew_class season quantity value expected deviation_sd candidates"
)
OF_TYPE = ("after", "boat_type")

GRID_NOTE = say(
    "By the newest tow of each boat and crew (tows, boats), men and women each about their own "
    "mean. Equal: the spread between boats is under what matters, with 95 % certainty. Slopes with "
    "their 95 % interval, of the boats that do not stand out; R² is the share of the spread that a "
    "line on weight explains, and proves nothing by itself. Cw at the standard speed, the median "
    "declared speed of the type."
)


def types_page(views: Views, methods: Sequence[str]) -> Page:
    """Return the page of all types: the verdict on each, its tows, and who stands out."""
    if not views.has("compared_tows"):
        return Page("types.html", say("Types"), [])
    after = pl.col("method").alias("after")
    shown = pl.col("method").is_in(methods)
    tows = with_page(views.ask("type_tows")).filter("newest", shown).with_columns(after)
    table = Table("type_boats", tows, TOW_COLUMNS, say("Boats"), OF_TYPE, search=True, linked=True)
    follows = {"method": SIDES, "boat_type": "boat_type"}
    drawn = [tows.select("method", "page", *TOW_COLUMNS.split())]
    charts = [Chart(name, drawn, labels.FIGURES[name], follows) for name in SCATTERS]
    outliers = views.ask("outliers").filter(shown).with_columns(after)
    verdicts = views.table(TABLE).filter(method=default_method(methods))
    links = [
        (type_path(name), name, sum_up_type(verdicts.filter(boat_type=name).to_dicts()))
        for name in views.type_names()
    ]
    names = _name_boats(views)
    sections = [
        Section(
            "types_verdicts",
            say("Are equal boats equal?"),
            say("By the newest tow of each boat and crew; every type has a page."),
            links=links,
        ),
        _grid_section(views, methods, views.type_names(), names),
        Section(
            "types_charts",
            say("B and Cw per type"),
            say(
                "The newest tows under two methods, on the same axes. Standard speed: the "
                "median declared speed of the type. Drag over a chart to list the boats "
                "there; click a point to go to its boat."
            ),
            charts,
            [table],
        ),
        Section(
            "types_outliers",
            say("Newest tows that stand out from their type"),
            say(
                "Far from what the other boats of the type predict, in standard deviations "
                "(sd) of that prediction. A possible cause is something to look at, not "
                "proven."
            ),
            tables=[Table("type_outliers", outliers, OUTSIDE_COLUMNS, follows=OF_TYPE)],
        ),
    ]
    selects = [
        methods_select(methods, "before", methods[0]),
        methods_select(methods, "after"),
        types_select(tows["boat_type"]),
    ]
    return Page("types.html", say("Types"), sections, selects=selects)


def type_pages(views: Views, methods: Sequence[str]) -> Iterator[Page]:
    """Return a page for every type: the verdict, its charts, who stands out, its tows."""
    if not views.has("compared_tows"):
        return
    ends = list(dict.fromkeys([methods[0], default_method(methods)]))
    shown = pl.col("method").is_in(methods)
    label = pl.format("{} {}{} {}", "name", "rowers", "crew_class", "season")
    newest = with_page(views.ask("type_tows"), "../").filter("newest", shown)
    newest = newest.with_columns(label=label)
    listed = once_for_methods(newest.select("method", *TOW_COLUMNS.split()))
    is_end = pl.col("method").is_in(ends)
    drawn_tows = newest.filter(is_end).select("boat_type", *DRAWN_COLUMNS)
    lines = views.table("type_line_points").filter(is_end)
    outliers = views.ask("outliers").filter(method=ends[-1])
    consistency = views.table(TABLE)
    names = _name_boats(views)
    for boat_type in views.type_names():
        rows = consistency.filter(boat_type=boat_type)
        now = rows.filter(method=ends[-1]).to_dicts()
        outside = outliers.filter(boat_type=boat_type)
        tows = drawn_tows.filter(boat_type=boat_type).drop("boat_type")
        drawn = [
            pl.concat([tows, lines.filter(boat_type=boat_type)], how="diagonal_relaxed"),
        ]
        own_tows = Table(
            "type_boats",
            listed.filter(boat_type=boat_type),
            TOW_COLUMNS.replace("boat_type ", ""),
            say("Boats"),
            ["method"],
            search=True,
            cards="name fsn_no rowers crew_class season cw_standard_kg_m b_m_s",
        )
        sections = [
            Section(
                "type_verdict",
                sum_up_type(now),
                headline=together(judge_type(now, outside.to_dicts(), names), " "),
            ),
            _grid_section(views, methods, [boat_type], names),
            Section(
                "type_charts",
                say("B and Cw against weight and tow speed"),
                say(
                    "A circle is a men's crew, a triangle a women's crew. A line is the best "
                    "straight fit within its class, with its 95 % interval. A full bar is the "
                    "95 % interval of a tow; a dashed bar leaves out the error of the log. An "
                    "open mark was towed too slowly or too fast for the standard speed. A tow "
                    "that stands out in Cw is named."
                ),
                _draw_type(rows, ends, drawn),
            ),
            Section(
                "type_outliers",
                say("Boats that stand out"),
                say("A possible cause is something to look at, not proven."),
                tables=[Table("type_outliers", outside, OUTSIDE_COLUMNS.replace("boat_type ", ""))],
            ),
            Section("type_tows", say("Its tows"), tables=[own_tows]),
        ]
        yield Page(
            type_path(boat_type),
            say("Types"),
            sections,
            name=boat_type,
            selects=[methods_select(methods)],
        )


def _draw_type(
    rows: pl.DataFrame, ends: Sequence[str], drawn: Sequence[pl.DataFrame]
) -> list[Chart]:
    """Return the charts of a type: the finding as title, below it the slope under each method."""
    charts = []
    for name, (quantity, column) in PAIRS.items():
        term = TERM_NAMES[column]
        found = {row["method"]: row for row in rows.filter(quantity=quantity).to_dicts()}
        if ends[-1] not in found:
            continue
        slopes = [_name_slope(found[method], term) for method in ends if method in found]
        caption = name_relation(found[ends[-1]], term)
        charts.append(Chart(f"type_{name}", drawn, caption, says=together(slopes, " ")))
    return charts


def _name_slope(row: Row, term: str) -> Statement:
    return told(
        "slope_of_method",
        say("{method}: {slope}."),
        method=labels.method(row["method"]),
        slope=describe_slope(row, term),
    )


def _grid_section(
    views: Views, methods: Sequence[str], types: Sequence[str], names: Names
) -> Section:
    """Return Cw, B and A of these types, as published and re-based, as one table in words."""
    ends = list(dict.fromkeys([methods[0], default_method(methods)]))
    known = views.table(TABLE).filter(pl.col("method").is_in(ends))
    groups: list[tuple[str, list[tuple[Text, list[Text]]]]] = []
    for boat_type in types:
        rows = known.filter(boat_type=boat_type).to_dicts()
        rows.sort(key=lambda row: ends.index(row["method"]))
        groups.append((boat_type, [_grid_row(row, names) for row in order_rows(rows)]))
    return Section(
        "types_slopes", say("As published and re-based"), GRID_NOTE, grid=Grid(HEADINGS, groups)
    )


def _grid_row(row: Row, names: Names) -> tuple[Text, list[Text]]:
    return _row_name(row), list(describe_row(row, names))


def _row_name(row: Row) -> Sentence:
    return say(
        "{quantity}, {method} ({n} tows, {n_boats} boats; {matters:g} % matters)",
        quantity=labels.code(row["quantity"]),
        method=labels.method(row["method"]),
        n=row["n"],
        n_boats=row["n_boats"],
        matters=100.0 * row["difference_that_matters"],
    )


def _name_boats(views: Views) -> Names:
    """Return the name of each boat by its number."""
    return dict(views.table("boats").select("fsn_no", "name").drop_nulls().rows())
