"""The page with every chart of the presentation of 2015, over all tows or a choice of them."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import product
from typing import Any, NamedTuple

import polars as pl

from dashboards import labels
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
from pipeline.messages import LANGUAGES, say, speaker
from warehouse.queries.chosen_tows import ALL, with_choices
from warehouse.queries.views import Views

AGAINST = {
    "weight": say("Against weight"),
    "speed": say("Against tow speed"),
    "length": say("Against length"),
}
NOTE = say(
    "The methods stand side by side on equal axes. Circles are men, triangles "
    "women. An open mark is a tow too slow or too fast for the standard speed, a "
    "black dot one with too little power. The line is the straight line that fits "
    "best, with its 95 % interval; against weight and length one per crew class. "
    "R² is the share of the spread that the line explains, each tow weighted by "
    "its error and tows of one boat as repeats. A tow whose Cw is an outlier of "
    "its type is named. A bar is a tow's 95 % interval; a dashed one the spread of "
    "the runs alone: the log's error is not in it."
)
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
    "displacement_kg",
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
        return Page("slides.html", say("Presentation 2015"), [])
    said = [{s.name: s for s in slides(views, speaker(language))} for language in LANGUAGES]
    book = Drawn(said[0], said[1])
    compared = compared_frame(views)
    types, pair = sorted(by_tows(compared)), pair_of_types(compared)
    told = sentences(views)
    follows = {"tows": "tows", "boat_type": PAIR_SELECTORS}
    sections = [
        Section(
            f"slides_{x}",
            AGAINST[x],
            NOTE if x == "weight" else None,
            told_charts([f"slide_{y}_{x}" for y in QUANTITIES], told, pair, follows),
        )
        for x in EXPLAINING
    ]
    sections += [
        Section(
            "slides_2014",
            say("2014 recomputed"),
            say(
                "The tows of 2014 as they came out that year, recomputed early in 2015 after "
                "all improvements, and as computed today."
            ),
            book.of(*OF_2014),
        ),
        Section(
            "slides_hull_speed",
            say("Is B hull speed?"),
            charts=told_charts(WHOLE, told, [], {"tows": "tows"}),
        ),
        Section("slides_raced", say("Towed slowly, raced fast"), charts=book.of("raced beyond")),
        Section(
            "slides_eras",
            say("Do seasons with other instruments stand apart?"),
            charts=book.of("eras"),
        ),
        Section("slides_years", say("One boat through the years"), charts=book.of("years")),
        Section(
            "slides_ticks",
            say("The four options of 2015"),
            say(
                "Optimisation, trimming, wind-vane correction and B from length: all sixteen "
                "combinations overlaid, with the log's speed and after correction. Each panel "
                "colours one option."
            ),
            book.of("ticks"),
        ),
        *_claims(views),
    ]
    return Page(
        "slides.html",
        say("Presentation 2015"),
        [section for section in sections if section.charts or section.tables],
        selects=[
            tows_select(compared),
            Select("pair_first", say("Compare"), types, pair[0]),
            Select("pair_second", say("with"), types, pair[-1]),
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
            Chart(s.figure, _data_name(s), labels.FIGURES[s.figure], says=self(s.name))
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
        Chart(
            figure,
            "slides",
            labels.FIGURES[figure],
            follows,
            _told(own.filter(figure=figure)),
            "said",
        )
        for figure in figures
    ]


def _told(said: pl.DataFrame) -> Headline:
    return lambda speech: " ".join(said[speech.language])


CLAIM_TEXTS = {
    "hull_speed": Section(
        "claim_hull_speed",
        say("B and hull speed per type"),
        say(
            "Tow speed and B as parts of hull speed, 1.25 times the root of the waterline. "
            "Of B the median of the boats with its 95 % interval: if 1 lies outside it, B "
            "is not hull speed."
        ),
    ),
    "promise": Section(
        "claim_promise",
        say("Within 2 %, and within 1 %?"),
        say(
            "The presentation: a large majority within 2 %, after the improvements all "
            "within 1 %. First what the tows state themselves (half the 95 % interval; "
            "under the old methods the spread of the runs alone), then what repeat tows "
            "show."
        ),
    ),
    "season_changes": Section(
        "claim_season_changes",
        say("Is 6 % in speed 20-30 % in Cw?"),
        say(
            "The presentation: the logs of 2009-2011 corrected by up to 6 %, 20-30 % in "
            "Cw. Here Cw at the declared speed under the chosen method over that as "
            "published: the median of the season and the extremes."
        ),
    ),
    "print_summary": Section(
        "claim_print_summary",
        say("Does print come out again?"),
        say(
            "Printed Cw divided by the recomputed one, per season. Look here before "
            "anything is re-based: what is left is unexplained."
        ),
    ),
}


def _claims(views: Views) -> Iterator[Section]:
    for name, columns in CLAIMS.items():
        frame = views.table(name)
        follows = ["method", *(["tows"] if frame["tows"].dtype == pl.String else [])]
        shown = ["method", *columns.split()]
        yield from listed(CLAIM_TEXTS[name], name, frame, shown, follows=follows)
