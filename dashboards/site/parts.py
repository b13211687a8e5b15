"""What a page is made of: sections with tables, charts and selectors, as plain data."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Final

import polars as pl
from markupsafe import Markup

from dashboards import labels
from dashboards.addresses import boat_path
from dashboards.html import keep_units
from dashboards.speech import Headline, Speech, Text
from dashboards.statements import EditionName, Statement
from dashboards.statements.boat import Answer
from pipeline.messages import Sentence, say
from pipeline.register.register import default_method, draft_name
from warehouse.queries.answers import newest_edition


@dataclass(frozen=True)
class Table:
    """A table on a page.

    Attributes:
        name: names the download.
        frame: its rows; columns keep the names they have in the warehouse.
        columns: what is shown, names with blanks between them, where it says something; the
            download holds the same.
        caption: the text above it; left out, the title of its section.
        follows: columns that a selector of the page filters on.
        search: whether it has a search box.
        linked: whether a selection in a chart filters it by boat.
        cards: on a narrow screen, the columns of a card: its name, then its numbers.
    """

    name: str
    frame: pl.DataFrame
    columns: str
    caption: Sentence | None = None
    follows: Sequence[str] = ()
    search: bool = False
    linked: bool = False
    cards: str = ""

    @cached_property
    def shown(self) -> list[str]:
        """The columns in which some row says something."""
        names = self.columns.split()
        return [n for n in names if self.frame.is_empty() or _says_something(self.frame[n])]

    @cached_property
    def numeric(self) -> set[str]:
        """Columns that hold numbers."""
        return {name for name, dtype in self.frame.schema.items() if dtype.is_numeric()}


def _says_something(column: pl.Series) -> bool:
    """Whether a column holds anything but nothing, no and empty texts and lists."""
    if column.dtype == pl.Boolean:
        return bool(column.any())
    if isinstance(column.dtype, pl.List):
        return bool((column.list.len() > 0).any())
    known = column.drop_nulls()
    return bool((known != "").any()) if known.dtype == pl.String else not known.is_empty()


@dataclass(frozen=True)
class Chart:
    """A chart on a page.

    Attributes:
        figure: name in `dashboards.figures.FIGURES`.
        rows: what it draws; of several frames, the rows come one below the other.
        caption: also what a screen reader says; left out, the title of its section.
        follows: selector, or several, by data column: only rows that hold what one of them says
            are drawn, and rows where the column is empty. A column may hold lists: then one of
            its values has to be chosen.
        says: what it shows, in one sentence.
    """

    figure: str
    rows: Sequence[pl.DataFrame]
    caption: Sentence | None = None
    follows: Mapping[str, str | Sequence[str]] = field(default_factory=dict)
    says: Headline | None = None


@dataclass(frozen=True)
class Grid:
    """A table of what is said, not of numbers.

    Attributes:
        heads: of its columns, after that of the names of rows.
        groups: the name of a group, and its rows: a name, then a text for each column.
    """

    heads: Sequence[Text]
    groups: Sequence[tuple[str, Sequence[tuple[Text, Sequence[Text]]]]]


@dataclass(frozen=True)
class Select:
    """A selector: what is chosen filters the charts and tables that follow it.

    Attributes:
        options: what each choice is called; the empty choice shows everything.
        asks: whether another choice is another question to the workbench; else it filters here.
    """

    name: str
    caption: Sentence
    options: Mapping[str, Text]
    chosen: str
    asks: bool = False


@dataclass(frozen=True)
class Section:
    """A heading, a note, and what is under them; nothing where its charts and tables have no rows.

    Attributes:
        name: by which links find it.
        links: path of a page, its name, and what is said of it.
        files: path of a file to download, and its name, which is data.
        empty: what is said, and the section kept, where there is nothing to show.
        folded: whether it opens only when asked for.
        headline: what it shows, in each language; see `dashboards.statements`.
        state: `good` or `bad`, where that is what the headline says.
        terms: a word and its meaning.
        key_figures: what is counted, and the figure.
        grid: a table of texts.
        prose: a text to read, as HTML.
    """

    name: str
    title: Sentence | Headline
    note: Sentence | None = None
    charts: Sequence[Chart] = ()
    tables: Sequence[Table] = ()
    links: Sequence[tuple[str, Text, Text]] = ()
    files: Sequence[tuple[str, str]] = ()
    empty: Sentence | None = None
    folded: bool = False
    headline: Headline | None = None
    state: str = ""
    terms: Sequence[tuple[Sentence, Text]] = ()
    key_figures: Sequence[tuple[Sentence, Text]] = ()
    grid: Grid | None = None
    prose: Callable[[Speech], Markup] | None = None

    @property
    def is_there(self) -> bool:
        """Whether it has something to show, or says that it has not."""
        frames = [*(rows for chart in self.charts for rows in chart.rows)]
        frames += [table.frame for table in self.tables]
        return bool(self.empty) or not frames or any(frame.height for frame in frames)


@dataclass(frozen=True)
class Page:
    """One HTML file.

    Attributes:
        path: within the site.
        sections: in order; those that have nothing to show are left out.
        name: of a boat, type or race, data rather than a text; empty elsewhere.
        subtitle: what tells a boat from one of the same name: its numbers and type.
        selects: selectors.
        site: the way to the site, of a page that lies outside it.
        answers: what an owner asks, of each crew of a boat.
        others: the same page in other languages, where it lies elsewhere.
    """

    path: str
    title: Sentence
    sections: Sequence[Section]
    name: str = ""
    selects: Sequence[Select] = ()
    site: str = ""
    answers: Sequence[Answer] = ()
    others: Mapping[str, str] = field(default_factory=dict)
    subtitle: str = ""

    @cached_property
    def shown(self) -> list[Section]:
        """The sections that have something to show."""
        return [section for section in self.sections if section.is_there]

    @cached_property
    def data(self) -> dict[str, Sequence[pl.DataFrame]]:
        """What charts draw, once for all that draw the same, by the figure that is the first."""
        drawn: dict[str, Sequence[pl.DataFrame]] = {}
        for chart in (chart for section in self.shown for chart in section.charts):
            if all(chart.rows is not rows for rows in drawn.values()):
                again = sum(name.split()[0] == chart.figure for name in drawn)
                drawn[f"{chart.figure} {again + 1}" if again else chart.figure] = chart.rows
        return drawn

    def name_of(self, chart: Chart) -> str:
        """The name of what a chart draws."""
        return next(name for name, rows in self.data.items() if rows is chart.rows)

    @property
    def chosen(self) -> dict[str, str]:
        """What each selector says at first."""
        return {select.name: select.chosen for select in self.selects}

    @property
    def root(self) -> str:
        """The way from this page to the first page of its language."""
        return self.site or "../" * self.path.count("/")


def as_paragraphs(statements: Sequence[Statement]) -> Callable[[Speech], Markup]:
    """Return the prose of a section: a paragraph for each statement."""
    paragraph = Markup("<p>{}</p>")
    return lambda speech: Markup("").join(
        paragraph.format(keep_units(statement(speech))) for statement in statements
    )


def is_chosen(value: object, *wanted: str) -> bool:
    """Whether selectors that say `wanted` show a value, or one of a list; "all" says nothing."""
    values = value if isinstance(value, (list, tuple)) else (value,)
    said = [text for text in wanted if text]
    return not said or any(str(one) in said for one in values)


def first_edition(editions: pl.Series, methods: Sequence[str]) -> str:
    """Of these editions what is shown first: the last that is published, or else the best draft."""
    draft = draft_name(default_method(methods))
    return newest_edition(editions.unique().sort().to_list(), draft)


METHOD_SELECTORS: Final = {"method": say("Method"), "before": say("Before"), "after": say("After")}


def methods_select(methods: Sequence[str], name: str = "method", chosen: str = "") -> Select:
    """A selector of methods, by what people call them."""
    options = {method: labels.method(method) for method in methods}
    return Select(name, METHOD_SELECTORS[name], options, chosen or default_method(methods))


def editions_select(name: str, editions: pl.Series, methods: Sequence[str]) -> Select:
    """A selector of the editions that rows are of."""
    options = {edition: EditionName(edition) for edition in editions.unique().sort()}
    return Select(name, say("Edition"), options, first_edition(editions, methods))


def types_select(types: pl.Series) -> Select:
    """A selector of the types that rows are of, or all of them."""
    names = {name: name for name in types.drop_nulls().unique().sort()}
    return Select("boat_type", say("Type"), {"": labels.code("all"), **names}, "")


def once_for_methods(rows: pl.DataFrame) -> pl.DataFrame:
    """Rows that are alike under several methods once, with all of these in `method`."""
    alike = [name for name in rows.columns if name != "method"]
    return rows.group_by(alike, maintain_order=True).agg("method")


def with_page(frame: pl.DataFrame, root: str = "") -> pl.DataFrame:
    """With the page of each boat, for charts whose points are links; `root` is the way to them."""
    paths = {fsn_no: root + boat_path(fsn_no) for fsn_no in frame["fsn_no"].unique()}
    page = pl.col("fsn_no").replace_strict(paths, return_dtype=pl.String)
    return frame.with_columns(page.alias("page"))
