"""The page with every chart of the presentation of 2015, over all tows or a choice of them."""

from collections.abc import Sequence

import polars as pl

from herijk.dashboards.figures.slides import EXPLAINING, METHODS, QUANTITIES
from herijk.dashboards.site.parts import Chart, Page, Section, Select, Table, default_method
from herijk.dashboards.slide_rows import boats_of_slides, compared_frame, lines_frame, pair_of_types
from herijk.pipeline.consistency.observed import UNKNOWN_TYPE
from herijk.warehouse.queries.views import Views

PAIR_SELECTORS = ("pair_first", "pair_second")
ALL_TOWS = "all"
TOW_COLUMNS = (
    *("kind", "method", "boat_type", "crew_class", "label", "outside", "beyond_curve"),
    *("weight_kg", "declared_speed_m_s", "waterline_length_m", "deviation_sd"),
    *("hull_speed_m_s", "tow_hull_ratio", "b_hull_ratio"),
    *(column for columns in QUANTITIES.values() for column in columns),
)
CLAIMS = {
    "hull_speed": "boat_type tows n n_boats tow_ratio tow_share_60_70 b_ratio b_ratio_lo "
    "b_ratio_hi",
    "promise": "season tows share_stated_1pct share_stated_2pct n_pairs share_seen_1pct "
    "share_seen_2pct",
    "print_summary": "season tows median_ratio lowest_ratio highest_ratio share_within_1pct",
}
"""Tables that hold a claim of the texts against the archive, with the columns shown."""


def slides_page(views: Views, methods: Sequence[str]) -> Page:
    """The charts, two types below each other; then what the texts claim."""
    if not views.has("compared_tows"):
        return Page("slides.html", "slides", [])
    compared = compared_frame(views)
    known = compared.filter(pl.col("method").is_in(METHODS), pl.col("boat_type") != UNKNOWN_TYPE)
    drawn = (known if known.height else compared).with_columns(newest_method=pl.lit(methods[-1]))
    types = drawn["boat_type"].unique().sort().to_list()
    pair = pair_of_types(compared)
    sections = [
        Section(f"slides_{x}", "slides_note" if x == "weight" else None, _charts(x))
        for x in EXPLAINING
    ]
    sections += [
        Section(
            "slides_hull_speed",
            charts=[
                Chart("slide_hull_speed", "slides", "slide_hull_speed", {"tows": "tows"}),
                Chart("slide_towed_at", "slides", "slide_towed_at", {"tows": "tows"}),
            ],
        ),
        Section("slides_years", charts=[Chart("slide_boat_years", "years", "slide_boat_years")]),
        *_claims(views),
    ]
    tows = [ALL_TOWS, "newest", *map(str, drawn["season"].unique().sort())]
    return Page(
        "slides.html",
        "slides",
        sections,
        selects=[
            Select("tows", "tows", tows, ALL_TOWS),
            Select("pair_first", "pair_first", types, pair[0]),
            Select("pair_second", "pair_second", types, pair[-1]),
            Select("method", "method", methods, default_method(methods)),
        ],
        data={"slides": [*_by_choice(drawn), _lines(views)], "years": [_years(views, compared)]},
    )


def _charts(explaining: str) -> list[Chart]:
    follows = {"tows": "tows", "boat_type": PAIR_SELECTORS}
    names = [f"slide_{quantity}_{explaining}" for quantity in QUANTITIES]
    return [Chart(name, "slides", name, follows) for name in names]


def _by_choice(compared: pl.DataFrame) -> list[pl.DataFrame]:
    """The tows once for every choice that they belong to."""
    chosen = compared.select(*TOW_COLUMNS, "newest_method", "newest", "season")
    parts = [
        chosen.with_columns(tows=pl.lit(ALL_TOWS)),
        chosen.filter("newest").with_columns(tows=pl.lit("newest")),
        chosen.with_columns(tows=pl.col("season").cast(pl.String)),
    ]
    return [part.drop("newest", "season") for part in parts]


def _lines(views: Views) -> pl.DataFrame:
    return lines_frame(views).filter(pl.col("method").is_in(METHODS))


def _years(views: Views, compared: pl.DataFrame) -> pl.DataFrame:
    """Curves of the boats of the presentation, or of those towed in most seasons."""
    speed = compared.select("method", "tow_id", "standard_speed_m_s")
    return pl.concat(
        views.curve_points_of(number).join(speed, on=["method", "tow_id"])
        for number in boats_of_slides(compared)
    ).filter(pl.col("method").is_in(METHODS))


def _claims(views: Views) -> list[Section]:
    sections = []
    for name, columns in CLAIMS.items():
        if views.has(name):
            frame = views.table(name)
            table = Table(name, frame, ["method", *columns.split()], f"claim_{name}", ["method"])
            sections.append(Section(f"claim_{name}", f"claim_{name}_note", tables=[table]))
    return sections
