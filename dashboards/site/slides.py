"""The page with every chart of the presentation of 2015, over all tows or a choice of them."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import product
from typing import Any, NamedTuple

import polars as pl

from dashboards.figures.slides import EXPLAINING, QUANTITIES
from dashboards.site.parts import (
    Chart,
    Page,
    Section,
    Select,
    listed,
    methods_select,
    tows_select,
)
from dashboards.slide_book import RECOMPUTED, Book, Slide, slides
from dashboards.slide_rows import (
    RECOMPUTED_SEASON,
    by_tows,
    compared_frame,
    lines_frame,
    methods_of,
    pair_of_types,
)
from dashboards.speech import Headline
from pipeline.words import LANGUAGES
from pipeline.words.catalogue import speaker
from warehouse.queries.chosen_tows import ALL, with_choices
from warehouse.queries.views import Views

PAIR_SELECTORS = ("pair_first", "pair_second")
WHOLE = {
    "slide_hull_speed": Book.b_and_hull_speed,
    "slide_towed_at": Book.part_of_hull_speed,
}
"""Figures that are not of a type, with what says what they show."""
SAID = ("figure", "tows", "boat_type", *LANGUAGES)
TOW_COLUMNS = (
    *("kind", "method", "boat_type", "crew_class", "label", "outside", "beyond_curve", "slow"),
    *("weight_kg", "declared_speed_m_s", "waterline_length_m", "deviation_sd"),
    *("hull_speed_m_s", "tow_hull_ratio", "b_hull_ratio"),
    *(column for columns in QUANTITIES.values() for column in columns),
)
NOT_DRAWN = (
    *("fsn_no", "tow_id", "rowers", "candidates", "reason", "study", "newest"),
    *("displacement_kg", "expected_cw_kg_m"),
)
OF_2014 = tuple(f"{y} {x} {RECOMPUTED_SEASON}" for y, x in RECOMPUTED)
CLAIMS = {
    "hull_speed": "boat_type tows n n_boats tow_ratio tow_share_60_70 b_ratio b_ratio_lo "
    "b_ratio_hi",
    "promise": "season tows share_stated_1pct share_stated_2pct n_pairs share_seen_1pct "
    "share_seen_2pct",
    "season_changes": "season tows median_ratio lowest_ratio highest_ratio",
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
    types, pair = sorted(by_tows(compared)), pair_of_types(compared)
    told = sentences(views)
    follows = {"tows": "tows", "boat_type": PAIR_SELECTORS}
    sections = [
        Section(
            f"slides_{x}",
            "slides_note" if x == "weight" else None,
            told_charts([f"slide_{y}_{x}" for y in QUANTITIES], told, pair, follows),
        )
        for x in EXPLAINING
    ]
    sections += [
        Section("slides_2014", "slides_2014_note", book.of(*OF_2014)),
        Section(
            "slides_hull_speed",
            charts=told_charts(WHOLE, told, [], {"tows": "tows"}),
        ),
        Section("slides_raced", charts=book.of("raced beyond")),
        Section("slides_eras", charts=book.of("eras")),
        Section("slides_years", charts=book.of("years")),
        Section("slides_ticks", "slides_ticks_note", book.of("ticks")),
        *_claims(views),
    ]
    return Page(
        "slides.html",
        "slides",
        [section for section in sections if section.charts or section.tables],
        selects=[
            tows_select(compared),
            Select("pair_first", "pair_first", types, pair[0]),
            Select("pair_second", "pair_second", types, pair[-1]),
            methods_select(methods),
        ],
        data={"slides": drawn_rows(views), "said": [told]} | book.data(),
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
        own = (*OF_2014, "raced beyond", "eras", "years", "ticks")
        return {_data_name(s): [_thin(s.rows)] for s in self.nl.values() if s.name.startswith(own)}


def _data_name(slide: Slide) -> str:
    return slide.name.replace(" ", "_")


def _thin(rows: pl.DataFrame) -> pl.DataFrame:
    """Without columns that no chart draws."""
    return rows.select(pl.exclude(NOT_DRAWN))


def drawn_rows(views: Views) -> list[pl.DataFrame]:
    """The tows that charts of types draw, with the choices each belongs to, and the lines."""
    compared = compared_frame(views)
    methods = methods_of(compared["method"].unique().to_list())
    own = pl.col("method").is_in(methods)
    tows = with_choices(compared).filter(own, pl.col("boat_type").is_in(by_tows(compared)))
    tows = tows.select(*TOW_COLUMNS, "tows", newest_method=pl.lit(methods[-1]))
    return [tows, lines_frame(views).filter(own).with_columns(pl.concat_list("tows"))]


def sentences(views: Views) -> pl.DataFrame:
    """What each figure shows of every choice of tows, and of every type where it is of a type.

    Returns:
        `figure, tows, boat_type` (empty: of all), and the sentence in each language.
    """
    books = [Book(views, speaker(language)) for language in LANGUAGES]
    rows: list[tuple[str | None, ...]] = []
    for tows in books[0].choices:
        for figure, told in WHOLE.items():
            rows.append((figure, tows, None, *(told(book, tows) for book in books)))
        for y, x, boat_type in product(QUANTITIES, EXPLAINING, sorted(by_tows(books[0].compared))):
            said = (book.line((y, x), boat_type, tows, book.ends()) for book in books)
            rows.append((f"slide_{y}_{x}", tows, boat_type, *said))
    return pl.DataFrame(rows, schema=dict.fromkeys(SAID, pl.String), orient="row")


def told_charts(
    figures: Iterable[str], said: pl.DataFrame, types: Sequence[str], follows: Mapping[str, Any]
) -> list[Chart]:
    """Charts of the page's tows, each below what it shows; at first all tows of these types."""
    own = said.filter(pl.col("boat_type").is_null() | pl.col("boat_type").is_in(types), tows=ALL)
    return [
        Chart(figure, "slides", figure, follows, _told(own.filter(figure=figure)), "said")
        for figure in figures
    ]


def _told(said: pl.DataFrame) -> Headline:
    return lambda speech: " ".join(said[speech.language])


def _claims(views: Views) -> Iterator[Section]:
    for name, columns in CLAIMS.items():
        frame = views.table(name)
        follows = ["method", *(["tows"] if frame["tows"].dtype == pl.String else [])]
        shown = ["method", *columns.split()]
        yield from listed(f"claim_{name}", name, frame, shown, follows=follows)
