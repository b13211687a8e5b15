"""The rows of the slide book: which tows, types and boats, for the files and for the page."""

from collections.abc import Sequence
from typing import Final

import polars as pl

from dashboards.figures.slides import METHODS, OF_2014
from pipeline.consistency.observed import UNKNOWN_TYPE
from warehouse.queries.views import Views
from warehouse.store.boats import the_boat

PAIR: Final = ("kromhout", "kuiken")
"""The two types of the presentation; where an archive has others, its two largest."""

RECOMPUTED_SEASON: Final = "2014"
"""The slide "2014 opnieuw berekend"."""

SLIDE_BOATS: Final = ("razende snol", "mare australis", "twirre")
"""The boats of the presentation; where an archive has others, those towed most often."""


def methods_of(held: Sequence[str], tows: str = "all") -> list[str]:
    """The four methods that are compared, of those that are held; of 2014 what was done to it."""
    wanted = OF_2014 if tows == RECOMPUTED_SEASON else METHODS
    return [name for name in wanted if name in held] or sorted(held)


def compared_frame(views: Views) -> pl.DataFrame:
    """Tows of `compared_tows` with a label, "Vecht 8D 2012", as the charts draw them."""
    label = pl.format("{} {}{} {}", "name", "rowers", "crew_class", "season")
    return views.ask("compared_tows").with_columns(label.alias("label"), kind=pl.lit("tow"))


def lines_frame(views: Views) -> pl.DataFrame:
    """Points of the fitted lines, as the charts draw them."""
    return views.table("type_line_points").with_columns(kind=pl.lit("line"))


def pair_of_types(compared: pl.DataFrame) -> list[str]:
    """The two types of the presentation, or the two with most tows."""
    known = by_tows(compared)
    pair = [t for name in PAIR for t in known if t.casefold().startswith(name)]
    return pair if len(pair) == len(PAIR) else known[: len(PAIR)]


def by_tows(compared: pl.DataFrame) -> list[str]:
    """Types of boat, that with most tows first; without any, the boats of no type."""
    counts = (
        compared.group_by("boat_type", maintain_order=True)
        .len()
        .sort("len", "boat_type", descending=[True, False])["boat_type"]
    )
    return [t for t in counts if t != UNKNOWN_TYPE] or counts.to_list()


def boats_of_slides(views: Views, compared: pl.DataFrame, wanted: Sequence[str] = ()) -> list[str]:
    """FSN numbers of the boats asked for, else those of the presentation, else towed most often.

    Raises:
        MissingKnowledgeError: there is no such boat, or several of that name.
    """
    if wanted:
        return [the_boat(views.table("boats"), name) for name in wanted]
    seasons = (
        compared.group_by("fsn_no", "name", maintain_order=True)
        .agg(pl.col("season").n_unique().alias("seasons"))
        .sort("seasons", "fsn_no", descending=[True, False])
    )
    named = seasons.filter(pl.col("name").str.to_lowercase().is_in(SLIDE_BOATS))
    chosen = named if named.height else seasons.head(len(SLIDE_BOATS))
    return [str(number) for number in chosen["fsn_no"]]
