"""The page with every chart of the presentation of 2015, over all tows or a choice of them."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import polars as pl

from herijk.dashboards.figures.slides import EXPLAINING, QUANTITIES
from herijk.dashboards.site.parts import (
    Chart,
    Headline,
    Page,
    Section,
    Select,
    Table,
    methods_select,
)
from herijk.dashboards.slide_book import Slide, slides
from herijk.dashboards.slide_rows import compared_frame, lines_frame, methods_of, pair_of_types
from herijk.dashboards.speech import Speech
from herijk.pipeline.consistency.observed import UNKNOWN_TYPE
from herijk.warehouse.queries.views import Views
from herijk.words import LANGUAGES
from herijk.words.catalogue import speaker

PAIR_SELECTORS = ("pair_first", "pair_second")
ALL_TOWS = "all"
TOW_COLUMNS = (
    *("kind", "method", "boat_type", "crew_class", "label", "outside", "beyond_curve"),
    *("weight_kg", "declared_speed_m_s", "waterline_length_m", "deviation_sd"),
    *("hull_speed_m_s", "tow_hull_ratio", "b_hull_ratio"),
    *(column for columns in QUANTITIES.values() for column in columns),
)
NOT_DRAWN = (
    *("fsn_no", "tow_id", "rowers", "candidates", "reason", "study", "newest", "slow"),
    *("displacement_kg", "expected_cw_kg_m"),
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
    """The charts with what they say, two types below each other; then what the texts claim."""
    if not views.has("compared_tows"):
        return Page("slides.html", "slides", [])
    said = [{s.name: s for s in slides(views, speaker(language))} for language in LANGUAGES]
    book = Drawn(said[0], said[1])
    compared = compared_frame(views)
    held = methods_of(compared["method"].unique().to_list())
    known = compared.filter(pl.col("method").is_in(held))
    typed = known.filter(pl.col("boat_type") != UNKNOWN_TYPE)
    drawn = (typed if typed.height else known).with_columns(newest_method=pl.lit(held[-1]))
    types = drawn["boat_type"].unique().sort().to_list()
    pair = pair_of_types(compared)
    sections = [
        Section(f"slides_{x}", "slides_note" if x == "weight" else None, _charts(x, book))
        for x in EXPLAINING
    ]
    chosen = {"tows": "tows"}
    sections += [
        Section("slides_2014", "slides_2014_note", book.of("cw weight 2014", "cw speed 2014")),
        Section(
            "slides_hull_speed",
            charts=[
                Chart("slide_hull_speed", "slides", "slide_hull_speed", chosen, book("hull speed")),
                Chart("slide_towed_at", "slides", "slide_towed_at", chosen, book("towed at")),
            ],
        ),
        Section("slides_raced", charts=book.of("raced beyond")),
        Section("slides_eras", charts=book.of("eras")),
        Section("slides_years", charts=book.of("years")),
        Section("slides_ticks", "slides_ticks_note", book.of("ticks")),
        *_claims(views),
    ]
    tows = [ALL_TOWS, "newest", *map(str, drawn["season"].unique().sort())]
    lines = lines_frame(views).filter(pl.col("method").is_in(held))
    return Page(
        "slides.html",
        "slides",
        [section for section in sections if section.charts or section.tables],
        selects=[
            Select("tows", "tows", tows, ALL_TOWS, named=_tows_named),
            Select("pair_first", "pair_first", types, pair[0]),
            Select("pair_second", "pair_second", types, pair[-1]),
            methods_select(methods),
        ],
        data={"slides": [*_by_choice(drawn), lines]} | book.data(),
    )


class Drawn(NamedTuple):
    """The slides by name, Dutch and English."""

    nl: Mapping[str, Slide]
    en: Mapping[str, Slide]

    def __call__(self, name: str) -> Headline:
        """What a slide says."""
        return lambda speech: {"nl": self.nl, "en": self.en}[speech.language][name].sentence

    def of(self, *names: str) -> list[Chart]:
        """The slides whose names begin so, each with its own rows."""
        return [
            Chart(s.figure, _data_name(s), s.figure, says=self(s.name))
            for s in self.nl.values()
            if s.name.startswith(names)
        ]

    def data(self) -> dict[str, list[pl.DataFrame]]:
        """The rows of slides that no selector changes."""
        own = ("cw weight 2014", "cw speed 2014", "raced beyond", "eras", "years", "ticks")
        return {_data_name(s): [_thin(s.rows)] for s in self.nl.values() if s.name.startswith(own)}


def _data_name(slide: Slide) -> str:
    return slide.name.replace(" ", "_")


def _tows_named(tows: str, speech: Speech) -> str:
    """A choice of tows in words; a season as it is."""
    words = {ALL_TOWS: "code.all", "newest": "newest_only"}
    return speech.say(words[tows]) if tows in words else tows


def _thin(rows: pl.DataFrame) -> pl.DataFrame:
    """Without columns that no chart draws."""
    return rows.select(pl.exclude(NOT_DRAWN))


def _charts(explaining: str, book: Drawn) -> list[Chart]:
    follows = {"tows": "tows", "boat_type": PAIR_SELECTORS}
    return [
        Chart(
            f"slide_{quantity}_{explaining}",
            "slides",
            f"slide_{quantity}_{explaining}",
            follows,
            book(f"{quantity} {explaining} {ALL_TOWS}"),
        )
        for quantity in QUANTITIES
    ]


def _by_choice(compared: pl.DataFrame) -> list[pl.DataFrame]:
    """The tows once for every choice that they belong to."""
    chosen = compared.select(*TOW_COLUMNS, "newest_method", "newest", "season")
    parts = [
        chosen.with_columns(tows=pl.lit(ALL_TOWS)),
        chosen.filter("newest").with_columns(tows=pl.lit("newest")),
        chosen.with_columns(tows=pl.col("season").cast(pl.String)),
    ]
    return [part.drop("newest", "season") for part in parts]


def _claims(views: Views) -> list[Section]:
    sections = []
    for name, columns in CLAIMS.items():
        if views.has(name):
            frame = views.table(name)
            table = Table(name, frame, ["method", *columns.split()], f"claim_{name}", ["method"])
            sections.append(Section(f"claim_{name}", f"claim_{name}_note", tables=[table]))
    return sections
