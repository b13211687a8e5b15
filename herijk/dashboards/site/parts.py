"""What a page is made of: sections with tables, charts and selectors, as plain data."""

import hashlib
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import polars as pl

from herijk.pipeline.register.register import draft_name
from herijk.warehouse.build.studies import STUDIED_METHOD


@dataclass(frozen=True)
class Table:
    """A table on a page.

    Attributes:
        name: names the download.
        frame: its rows; columns keep the names they have in the warehouse.
        columns: what is shown, in order; the download holds the same.
        caption: key of the text above it.
        follows: columns that a selector of the page filters on.
        search: whether it has a search box.
        linked: whether a selection in a chart filters it by boat.
    """

    name: str
    frame: pl.DataFrame
    columns: Sequence[str]
    caption: str
    follows: Sequence[str] = ()
    search: bool = False
    linked: bool = False


@dataclass(frozen=True)
class Chart:
    """A chart on a page.

    Attributes:
        figure: name in `dashboards.figures.FIGURES`.
        data: name of the page's data it draws.
        caption: key of its caption; also what a screen reader says.
        follows: selector, or several, by data column: only rows that hold what one of them says
            are drawn, and rows where the column is empty.
    """

    figure: str
    data: str
    caption: str
    follows: Mapping[str, str | Sequence[str]] = field(default_factory=dict)


@dataclass(frozen=True)
class Select:
    """A selector: what is chosen filters the charts and tables that follow it."""

    name: str
    caption: str
    options: Sequence[str]
    chosen: str
    with_all: bool = False


@dataclass(frozen=True)
class Section:
    """A heading, a note, and what stands under them.

    Attributes:
        links: path of a page, key of its name and key of a sentence about it.
        files: path of a file to download, and its name, which is data.
        empty: key of what is said where there is nothing to show.
    """

    title: str
    note: str | None = None
    charts: Sequence[Chart] = ()
    tables: Sequence[Table] = ()
    links: Sequence[tuple[str, str, str]] = ()
    files: Sequence[tuple[str, str]] = ()
    empty: str | None = None


@dataclass(frozen=True)
class Page:
    """One HTML file.

    Attributes:
        path: within the site.
        title: key of its title.
        sections: in order.
        name: of the boat, data rather than a text; empty elsewhere.
        selects: selectors.
        data: frames that charts draw, by name; of several, the rows come one below the other.
        site: the way to the site, of a page that lies outside it.
    """

    path: str
    title: str
    sections: Sequence[Section]
    name: str = ""
    selects: Sequence[Select] = ()
    data: Mapping[str, Sequence[pl.DataFrame]] = field(default_factory=dict)
    site: str = ""

    @property
    def chosen(self) -> dict[str, str]:
        """What each selector says at first."""
        return {select.name: select.chosen for select in self.selects}

    @property
    def has_charts(self) -> bool:
        """Whether the page needs Vega."""
        return any(section.charts for section in self.sections)

    @property
    def root(self) -> str:
        """The way from this page to the site's root."""
        return self.site or "../" * self.path.count("/")


def default_method(names: Sequence[str]) -> str:
    """What is shown first: the default method or its draft, else the last."""
    wanted = [n for n in names if n in (STUDIED_METHOD, draft_name(STUDIED_METHOD))]
    return [*names, *wanted][-1]


def boat_path(fsn_no: str) -> str:
    """The page of a boat: its number if that can be a file name, else with a hash of it."""
    safe = re.sub(r"[^A-Za-z0-9-]+", "-", fsn_no)
    if safe != fsn_no:
        safe += "-" + hashlib.sha256(fsn_no.encode()).hexdigest()[:8]
    return f"boats/{safe}.html"


def with_page(frame: pl.DataFrame) -> pl.DataFrame:
    """With the page of each boat, for charts whose points are links."""
    page = pl.col("fsn_no").map_elements(boat_path, return_dtype=pl.String)
    return frame.with_columns(page.alias("page"))
