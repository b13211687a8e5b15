"""The pages of boat types: are equal boats equal, before and after.

All of them are about the newest tow of each boat and crew, as `herijk audit` and the page of the
presentation; the workbench can also judge types by all tows.
"""

from collections.abc import Callable, Iterator, Sequence
from itertools import groupby

import polars as pl

from dashboards import labels
from dashboards.addresses import type_path
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
from dashboards.speech import Headline, Text
from dashboards.statements import together
from dashboards.statements.boat_type import LINES, SPREAD, Slopes, homogeneity, level, slopes
from dashboards.statements.slides import Book
from pipeline.messages import Sentence, say
from pipeline.register.register import default_method
from warehouse.queries.audit import WEIGHT_LINE
from warehouse.queries.views import NEWEST, Views

SCATTERS = ("b_weight", "b_speed", "cw_standard_weight", "cw_standard_speed", "a_weight")
SIDES = ("before", "after")
"""Selectors of the two methods that stand side by side."""
TOW_COLUMNS = (
    "name fsn_no boat_type rowers crew_class season weight_kg declared_speed_m_s a_kg_m b_m_s "
    "cw_standard_kg_m"
)
TYPE_FIGURES = {
    "cw_weight": "cw_standard_weight",
    "cw_speed": "cw_standard_speed",
    "b_weight": "b_weight",
}
"""Of `dashboards.figures.slides`, with the figure that has its caption."""
OF_TYPE = ("after", "boat_type")


def types_page(views: Views, methods: Sequence[str]) -> Page:
    """The verdict on every type; A, B and Cw at one speed against weight and speed; outliers."""
    if not views.has("compared_tows"):
        return Page("types.html", say("Types"), [])
    book = Book(views)
    judge = _judged(views, default_method(methods))
    after = pl.col("method").alias("after")
    shown = pl.col("method").is_in(methods)
    tows = with_page(views.ask("type_tows")).filter("newest", shown).with_columns(after)
    table = Table("type_boats", tows, TOW_COLUMNS, say("Boats"), OF_TYPE, search=True, linked=True)
    follows = {"method": SIDES, "boat_type": "boat_type"}
    drawn = [tows.select("method", "page", *TOW_COLUMNS.split())]
    charts = [Chart(name, drawn, labels.FIGURES[name], follows) for name in SCATTERS]
    outliers = views.ask("outliers").filter(shown).with_columns(after)
    sections = [
        _slopes_section(views, book, book.chosen_types(())),
        Section(
            "types_verdicts",
            say("Are equal boats equal?"),
            say("By the newest tow of each boat and crew; every type has a page."),
            links=[(type_path(name), name, judge(name)) for name in views.type_names()],
        ),
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
            say("Newest tows that differ from their type"),
            say(
                "Far from what the other boats of the type predict, in standard deviations "
                "(sd) of that prediction. A possible cause is something to look at, not "
                "proven."
            ),
            tables=[
                Table(
                    "type_outliers",
                    outliers,
                    "name fsn_no boat_type rowers crew_class season quantity value expected "
                    "deviation_sd candidates",
                    follows=OF_TYPE,
                )
            ],
        ),
    ]
    selects = [
        methods_select(methods, "before", methods[0]),
        methods_select(methods, "after"),
        types_select(tows["boat_type"]),
    ]
    return Page("types.html", say("Types"), sections, selects=selects)


def _judged(views: Views, method: str) -> Callable[[str], Headline]:
    """Gives whether the boats of a type are equal in level and in bend, under a method."""
    tows = views.table("compared_tows").filter("newest", method=method)
    lines = views.table("type_lines").filter(method=method, tows=NEWEST, **WEIGHT_LINE)
    outliers = views.table("type_outliers").filter(method=method)
    tests = views.table("type_homogeneity").filter(method=method)

    def judge(name: str) -> Headline:
        own = (frame.filter(boat_type=name) for frame in (tows, lines, outliers))
        return together([level(*own), homogeneity(tests.filter(boat_type=name))], " ")

    return judge


def type_pages(views: Views, methods: Sequence[str]) -> Iterator[Page]:
    """A page for every type: the verdict, its tows, the fitted lines."""
    if not views.has("compared_tows"):
        return
    shown = pl.col("method").is_in(methods)
    tows = views.ask("type_tows").filter("newest", shown)
    tows = once_for_methods(tows.select("method", *TOW_COLUMNS.split()))
    judge = _judged(views, default_method(methods))
    book = Book(views)
    for boat_type in views.type_names():
        drawn = [book.drawn(boat_type)]
        charts = [
            Chart(
                f"slide_{name}",
                drawn,
                labels.FIGURES[caption],
                says=together(book.in_words(name, boat_type), " "),
            )
            for name, caption in TYPE_FIGURES.items()
        ]
        listed_tows = Table(
            "type_boats",
            tows.filter(boat_type=boat_type),
            TOW_COLUMNS.replace("boat_type ", ""),
            say("Boats"),
            ["method"],
            search=True,
            cards="name fsn_no rowers crew_class season cw_standard_kg_m b_m_s",
        )
        yield Page(
            type_path(boat_type),
            say("Types"),
            [
                Section(
                    "type_verdict",
                    say("Are these boats equal?"),
                    say(
                        "All of this is about the newest tow of each boat and crew. Standard "
                        "speed: the median declared speed of the type, at which Cw can be "
                        "compared; the declared speed differs by crew. A line is the best "
                        "straight fit with its 95 % interval; against tow speed men and women "
                        "each have their own. A full bar through a point is its "
                        "95 % interval; a dashed one is the spread of the runs alone: the log's "
                        "error is not in it."
                    ),
                    charts,
                    [listed_tows],
                    headline=judge(boat_type),
                ),
                _slopes_section(views, book, [boat_type]),
            ],
            name=boat_type,
            selects=[methods_select(methods)],
        )


def _slopes_section(views: Views, book: Book, types: Sequence[str]) -> Section:
    """What B, A and Cw of these types follow, before and after, as one table."""
    lines = views.table("type_lines").filter(pl.col("method").is_in(book.ends), tows=NEWEST)
    rows = [row for name in types for row in lines.filter(boat_type=name).to_dicts()]
    rows.sort(key=lambda row: book.ends.index(row["method"]))
    return Section(
        "types_slopes",
        say("Does it follow weight or speed?"),
        say(
            "The slope of the best straight line through the newest tow of each boat and crew (n), "
            "with its 95 % interval; spread about that line, and R², the share of the spread that "
            "it explains. Cw at the standard speed."
        ),
        grid=Grid([*LINES.values(), SPREAD], list(_groups(slopes(rows)))),
    )


def _groups(found: Sequence[Slopes]) -> Iterator[tuple[str, list[tuple[Text, list[Text]]]]]:
    """A group of rows per type, a row per quantity and method."""
    for boat_type, of_type in groupby(found, key=lambda one: one.boat_type):
        yield boat_type, [(_row_name(one), [*one.slopes, one.spread]) for one in of_type]


def _row_name(one: Slopes) -> Sentence:
    return say(
        "{quantity}, {method} (n = {n})",
        quantity=labels.code(one.quantity),
        method=labels.method(one.method),
        n=one.n,
    )
