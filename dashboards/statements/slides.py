"""The slides: what the presentation of 24 January 2015 asked, over this archive.

Each slide says one finding, shows it in one chart before and after correction, and explains its
marks. Does not belong here: what a chart looks like (`dashboards.figures.slides`), and the PDF and
the page (`dashboards.documents.slides`, `.site.slides`).
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import nullcontext
from functools import partial
from typing import Final, NamedTuple, TypeAlias

import polars as pl

from dashboards import labels
from dashboards.figures.slides import ENDS, PAIRS
from dashboards.statements import Number, Statement, Value, told
from dashboards.statements.method import voted_steps
from pipeline.consistency.lines import ALL_CREWS, LN_CW
from pipeline.consistency.observed import UNKNOWN_TYPE
from pipeline.errors import MissingKnowledgeError
from pipeline.messages import Sentence, ngettext, say
from pipeline.register.register import STUDIED_METHOD
from pipeline.studies.options import SPEEDS, TICKS
from pipeline.tables.row import Row
from warehouse.queries.views import ALL, NEWEST, Views
from warehouse.store.boats import choose_boat
from warehouse.store.unforeseen import Border

TYPES: Final = ("kromhout", "kuiken")
"""The types of the presentation; where an archive has others, the two with most tows."""
BOATS: Final = ("razende snol", "mare australis", "twirre")
"""The boats of the presentation; where an archive has others, the three towed most often."""

FEWEST: Final = 6
"""What fewer boats, tows or pairs than this say is no finding."""
CLEAR_R2: Final = 0.3
"""From here on a line without a clear slope is not called "no relation": too few boats tell."""

CONCLUDING: Final = ("eras", "cw_weight", "hull speed")
"""How the names of the slides begin whose findings the conclusion repeats."""

QUANTITIES: Final = {"a": say("A"), "b": say("B"), "cw": say("Cw at the standard speed")}
EXPLAINING: Final = {"weight": say("weight"), "speed": say("declared speed")}
COLUMNS: Final = {
    "a": "a_kg_m",
    "b": "b_m_s",
    "cw": "cw_standard_kg_m",
    "weight": "weight_kg",
    "speed": "declared_speed_m_s",
}
TOW_COLUMNS: Final = (
    *("method", "boat_type", "crew_class", "fsn_no", "label", "outside", "beyond_curve"),
    *("weight_kg", "declared_speed_m_s", "waterline_length_m", "hull_speed_m_s"),
    *("tow_hull_ratio", "b_hull_ratio"),
    *(column for quantity, ends in ENDS.items() for column in (quantity, *ends)),
)

CREWS_MARKED: Final = say("A circle is a men's crew, a triangle a women's crew.")
CLASSES: Final = {"men": say("men"), "women": say("women")}
"""Classes by the name that `type_lines` gives them."""

UNKNOWN: Final = say("not known")
LINE_MARKED: Final = say(
    "Drawn is the newest tow of each boat and crew. A line is the best straight fit among men or "
    "among women, with its 95 % interval. A bar is the 95 % interval of a tow; a dashed bar leaves "
    "out the error of the log. An open mark was towed too slowly or too fast for the standard "
    "speed. A tow that is an outlier in Cw is named."
)


Notes: TypeAlias = Sequence[Sentence | Statement]


class Slide(NamedTuple):
    """A finding, the figure that shows it with its rows, and what explains it."""

    name: str
    figure: str
    rows: pl.DataFrame
    finding: Statement
    notes: Notes

    @property
    def source(self) -> str:
        """The table that the finding comes from."""
        return self.finding.rests_on[0]


def slides(
    views: Views, types: Sequence[str] = (), boats: Sequence[str] = (), border: Border = nullcontext
) -> Iterator[Slide]:
    """Every slide of which the archive has something to show, each made within a border.

    Args:
        views: the tables.
        types: types of boat by the beginning of their name; those of the presentation when none.
        boats: by number or name; those of the presentation when none.
        border: stands round the work on each slide.

    Raises:
        MissingKnowledgeError: there is no such type or boat, or nothing to compare.
    """
    book = Book(views)
    made: list[Slide] = []
    for name, make in _makers(book, types, boats):
        with border(f"slide {name}"):
            for slide in make():
                made.append(slide)
                yield slide
    with border("slide conclusion"):
        yield from book.conclusion(made)


def _makers(
    book: "Book", types: Sequence[str], boats: Sequence[str]
) -> Iterator[tuple[str, Callable[[], Iterable[Slide]]]]:
    yield "eras", book.eras
    for boat_type in book.chosen_types(types):
        for figure in PAIRS:
            yield f"{figure} {boat_type}", partial(book.against, figure, boat_type)
    yield "hull speed", book.hull_speed
    yield "towed at", book.towed_at
    yield "options", book.options
    for fsn_no in book.chosen_boats(boats):
        yield fsn_no, partial(book.boat, fsn_no)


class Book:
    """The slides of an archive: its tows before and after correction."""

    def __init__(self, views: Views) -> None:
        self.views = views
        known = views.table("methods")["method"].to_list()
        label = pl.format("{} {}{} {}", "name", "rowers", "crew_class", "season")
        compared = views.ask("compared_tows").with_columns(label=label)
        held = compared["method"].unique().to_list()
        methods = [name for name in known if name in held]
        if not methods and not views.table("tows").is_empty():
            raise MissingKnowledgeError(
                "no type of boat has curves to compare: there are no slides"
            )
        wanted = [name for name in methods if name == STUDIED_METHOD]
        self.ends = (methods[0], [*methods, *wanted][-1]) if methods else ("", "")
        old_method, method = map(labels.method, self.ends)
        self.methods = {"old_method": old_method, "method": method}
        outside = (
            views.table("type_outliers")
            .filter("outside", quantity=LN_CW)
            .select("method", "tow_id", outside=True)
        )
        self.tows = (
            compared.filter(pl.col("method").is_in(self.ends))
            .drop("outside")
            .join(outside, on=["method", "tow_id"], how="left", maintain_order="left")
        )
        self._lines = views.table("type_lines").filter(tows=NEWEST)
        self._line_points = views.table("type_line_points").filter(tows=NEWEST)

    def chosen_types(self, wanted: Sequence[str]) -> list[str]:
        """The types asked for, or those of the presentation, or the two with most tows."""
        counts = self.tows.filter(pl.col("boat_type") != UNKNOWN_TYPE)["boat_type"].value_counts()
        known = counts.sort("count", "boat_type", descending=[True, False])["boat_type"].to_list()
        like = {
            name: [one for one in known if one.casefold().startswith(name.casefold())]
            for name in wanted or TYPES
        }
        for name in wanted:
            if not like[name]:
                raise MissingKnowledgeError(
                    "there is no type {!r}; the types are {}", name, ", ".join(sorted(known))
                )
        return [one for found in like.values() for one in found] or known[: len(TYPES)]

    def chosen_boats(self, wanted: Sequence[str]) -> list[str]:
        """FSN numbers of the boats asked for, or those of the presentation, or towed most often."""
        if wanted:
            return [choose_boat(self.views.table("boats"), name) for name in wanted]
        seasons = (
            self.tows.group_by("fsn_no", "name", maintain_order=True)
            .agg(pl.col("season").n_unique())
            .sort("season", "fsn_no", descending=[True, False])
        )
        presented = seasons.filter(pl.col("name").str.to_lowercase().is_in(BOATS))
        return (presented if presented.height else seasons.head(len(BOATS)))["fsn_no"].to_list()

    # -- Types ------------------------------------------------------------------------------------

    def drawn(self, boat_type: str, figure: str = "") -> pl.DataFrame:
        """The newest tows of a type and the lines fitted to them, of one figure or of all."""
        own = self.tows.filter("newest", boat_type=boat_type)
        lines = self._line_points.filter(pl.col("method").is_in(self.ends), boat_type=boat_type)
        if figure:
            y, x = (COLUMNS[name] for name in PAIRS[figure])
            lines = lines.filter(quantity=y, explaining=x)
        return pl.concat([own.select(TOW_COLUMNS), lines.drop("tows")], how="diagonal_relaxed")

    def against(self, figure: str, boat_type: str) -> Iterator[Slide]:
        """Whether a quantity follows what may explain it; of few boats nothing is said."""
        findings: list[Value] = []
        fits: list[Statement] = []
        for within in classes_of(figure):
            line = self.line(figure, boat_type, self.ends[1], within)
            if line and line["slope"] is not None and line["n_boats"] >= FEWEST:
                findings.append(_name_class(relation(figure, line), within))
                fits.append(self.fit(figure, boat_type, within))
        if findings:
            wording, of_type = say("{boat_type}: {relation}"), {"boat_type": boat_type}
            yield Slide(
                f"{figure} {boat_type}",
                f"slide_{figure}",
                self.drawn(boat_type, figure=figure),
                told("slide_type", wording, of_type, "type_lines", relation=findings),
                [*fits, CREWS_MARKED, LINE_MARKED],
            )

    def line(self, figure: str, boat_type: str, method: str, within: str = ALL_CREWS) -> Row | None:
        """The line fitted to the newest tows of a type, or of one class, under a method."""
        y, x = (COLUMNS[name] for name in PAIRS[figure])
        found = self._lines.filter(
            quantity=y, explaining=x, boat_type=boat_type, method=method, within=within
        )
        return found.row(0, named=True) if found.height else None

    def in_words(self, figure: str, boat_type: str) -> list[Statement]:
        """What the lines of a type say, and how well they fit."""
        found: list[Statement] = []
        for within in classes_of(figure):
            line = self.line(figure, boat_type, self.ends[1], within)
            if line is None or line["slope"] is None:
                none = told(
                    "no_line", say("Too few boats for a line ({boats})"), boats=_boats(line)
                )
                found.append(_finished(_name_class(none, within)))
            else:
                found.append(_finished(_name_class(relation(figure, line), within)))
                found.append(self.fit(figure, boat_type, within))
        return found

    def fit(self, figure: str, boat_type: str, within: str = ALL_CREWS) -> Statement:
        """The share of the spread that a line explains, before and after."""
        before, after = (self.line(figure, boat_type, method, within) for method in self.ends)
        assert after, "a line that is described was fitted"  # noqa: S101
        return told(
            "share_explained",
            say(
                "R² is {after} {method}, {before} {old_method}: the share of the spread that {x} "
                "explains, in {tows} of {boats}."
            ),
            self.methods,
            "type_lines",
            x=EXPLAINING[PAIRS[figure][1]],
            after=_explained(after),
            before=_explained(before),
            tows=ngettext("1 tow", "{n} tows", after["n"]),
            boats=_boats(after),
        )

    # -- All boats --------------------------------------------------------------------------------

    def eras(self) -> Iterator[Slide]:
        """Whether seasons with other instruments stand apart, before and after."""
        shifts = self.views.table("era_shifts").filter(
            pl.col("shift_ratio").is_not_null(), pl.col("method").is_in(self.ends), boat_type=ALL
        )
        of = {(row["method"], row["era"]): row for row in shifts.iter_rows(named=True)}
        wording = say("From a tow of {era} to the next of the same boat: {before}, {after}")
        said = [
            told("slide_era", wording, {}, "era_shifts", era=era, before=before, after=after)
            for era in shifts["era"].unique().sort()
            if all((method, era) in of for method in self.ends)
            for before, after in [[shift(of[method, era]) for method in self.ends]]
        ]
        if said:
            marks = say(
                "A point is the median over boats that were towed again, with ageing taken off; "
                "a bar is its 95 % interval. At 1 nothing differs."
            )
            rest = map(_finished, said[1:])
            yield Slide("eras", "eras", shifts, said[0], [*rest, marks])

    def hull_speed(self) -> Iterator[Slide]:
        """Whether B, which only the fit gives, is hull speed, which the length gives."""
        of_all = self._hull_speed()
        is_it = of_all["b_is_hull_speed"]
        if is_it is None or of_all["n_boats"] < FEWEST:
            return
        said = say("B may be hull speed") if is_it else say("B is not hull speed")
        wording = say("{said}: it lies at {ratio} times hull speed")
        ratio, low, high = (Number(of_all[f"b_ratio{end}"], unit="1") for end in ("", "_lo", "_hi"))
        finding = told("slide_hull", wording, {}, "hull_speed", said=said, ratio=ratio)
        wording = say(
            "Median of {boats} {method}, 95 % interval {low} to {high}; {share} % of the tows lie "
            "within 5 %."
        )
        words = self.methods | {"boats": _boats(of_all)}
        share = _share(of_all["b_share_within_5pct"])
        notes: Notes = [
            told("hull_ratio", wording, words, "hull_speed", low=low, high=high, share=share),
            say("On the dashed line B is hull speed."),
            CREWS_MARKED,
        ]
        yield Slide("hull speed", "slide_hull_speed", self._tows_with("b_m_s"), finding, notes)

    def towed_at(self) -> Iterator[Slide]:
        """At what part of hull speed boats are towed."""
        of_all = self._hull_speed()
        if of_all["n_boats"] < FEWEST:
            return
        wording = say("Half of the tows were made above {ratio} % of hull speed")
        ratio = _share(of_all["tow_ratio"])
        finding = told("slide_towed_at", wording, {}, "hull_speed", ratio=ratio)
        wording = say(
            "{share} % of the tows lie between 60 and 70 % of hull speed, where the presentation "
            "puts rowing: between the dashed lines."
        )
        share = _share(of_all["tow_share_60_70"])
        notes: Notes = [told("towed_at", wording, {}, "hull_speed", share=share), CREWS_MARKED]
        rows = self._tows_with("tow_hull_ratio").filter(method=self.ends[1])
        yield Slide("towed at", "slide_towed_at", rows, finding, notes)

    def _hull_speed(self) -> Row:
        """The statistics of all types together, after correction."""
        found = self.views.table("hull_speed")
        return found.filter(method=self.ends[1], boat_type=ALL).row(0, named=True)

    def _tows_with(self, column: str) -> pl.DataFrame:
        return self.tows.select(TOW_COLUMNS).filter(pl.col(column).is_not_null())

    def options(self) -> Iterator[Slide]:
        """What the options of the tool of 2015 do to all boats."""
        tool = pl.col("option").is_in([*TICKS, *SPEEDS])
        rows = self.views.table("option_summary").filter(tool, study="tool")
        rows = rows.filter(pl.col("tows") >= FEWEST, pl.col("method") == pl.col("method").max())
        if rows.is_empty():
            return
        most = rows.sort((pl.col("median_ratio") - 1).abs(), "option").row(-1, named=True)
        wording = say("Of the options of 2015, {option} changes Cw most: by {by} %")
        option, by = labels.code(most["option"]), _off(most["median_ratio"])
        finding = told("slide_options", wording, {}, "option_summary", option=option, by=by)
        wording = say(
            "A point is the median change of Cw over {tows} ({method}); a bar holds the middle "
            "90 % of the tows. At 1 an option changes nothing."
        )
        tows, method = ngettext("1 tow", "{n} tows", most["tows"]), labels.method(most["method"])
        notes = [told("options_marked", wording, tows=tows, method=method)]
        yield Slide("options", "options", rows, finding, notes)

    def boat(self, fsn_no: str) -> Iterator[Slide]:
        """How far the tows of one boat lie apart through the years."""
        own = pl.col("method").is_in(self.ends)
        pairs = self.views.ask("repeat_pairs").filter(own, fsn_no=fsn_no)
        points = self.views.ask("curve_points_of", fsn_no).filter(own)
        largest = [
            pairs.filter(method=method).sort((pl.col("cw_ratio") - 1).abs()).tail(1)
            for method in self.ends
        ]
        if any(frame.is_empty() for frame in largest):
            return
        before, after = (_off(frame["cw_ratio"][0]) for frame in largest)
        wording = say(
            "{name}: from one tow to the next Cw differs by up to {after} %, {old_method} by "
            "{before} %"
        )
        words = self.methods | {"name": points["name"][0]}
        finding = told("slide_boat", wording, words, "repeat_pairs", before=before, after=after)
        notes = [
            say(
                "The curves of all seasons; each from 85 to 115 % of the declared speed. Compared "
                "are successive tows of the same crew, without alteration between them."
            )
        ]
        rows = points.select("method", "tow_id", "season", "crew", "speed_m_s", "cw_kg_m")
        yield Slide(f"years {fsn_no}", "slide_boat_years", rows, finding, notes)

    def conclusion(self, made: Sequence[Slide]) -> Iterator[Slide]:
        """How well a tow repeats itself, before and after; then what other slides found."""
        rows = self.views.table("reproducibility").filter(pl.col("method").is_in(self.ends))
        known = rows.filter(
            pl.col("sd_ratio").is_not_null(), pl.col("n_pairs") >= FEWEST, scope=ALL
        )
        of_all = {row["method"]: row for row in known.iter_rows(named=True)}
        if len(of_all) < len(self.ends):
            return
        before, after = (of_all[method] for method in self.ends)
        wording = say("Conclusion: the random error of one tow is {after} %; it was {before} %")
        errors = {
            "after": _per_cent(after["sd_ratio"]),
            "before": _per_cent(before["sd_ratio"]),
        }
        finding = told("slide_conclusion", wording, errors, "reproducibility")
        wording = say(
            "Of {n_pairs} repeat tows {share} % lie within 2 % of the tow before; {old_method} it "
            "was {then} %. The presentation promised a large majority."
        )
        share, then = (_share(row["share_within_2pct"]) for row in (after, before))
        repeats = told(
            "repeats", wording, self.methods | after, "reproducibility", share=share, then=then
        )
        others = (slide.finding for slide in made if slide.name.startswith(CONCLUDING))
        notes = [repeats, *map(_finished, others), *voted_steps(self.views, self.ends[-1])]
        yield Slide("conclusion", "reproducibility", rows, finding, notes)


def classes_of(figure: str) -> Sequence[str]:
    """Return the classes among which a figure has a line: each its own against tow speed."""
    return tuple(CLASSES) if PAIRS[figure][1] == "speed" else (ALL_CREWS,)


def _name_class(finding: Statement, within: str) -> Statement:
    """Return a finding with the class that it is about, where it is about one."""
    if within == ALL_CREWS:
        return finding
    wording, crews = say("{finding} among {crews}"), CLASSES[within]
    return told("of_class", wording, {}, *finding.rests_on, crews=crews, finding=finding)


def _boats(line: Row | None) -> Sentence:
    return ngettext("1 boat", "{n} boats", line["n_boats"] if line else 0)


def _explained(line: Row | None) -> Value:
    """The share of the spread that a line explains, where one was fitted and there is a spread."""
    if line is None or line["r2"] is None:
        return UNKNOWN
    return told("share", say("{r2} %"), r2=_share(line["r2"]))


def _finished(finding: Statement) -> Statement:
    """A finding as a sentence among others."""
    return told("finding", say("{finding}."), finding=finding)


def _share(ratio: float) -> Number:
    return Number(100 * ratio, 0, "%")


def _per_cent(ratio: float) -> Number:
    return Number(100 * ratio, 1, "%")


def _off(ratio: float) -> Number:
    """How far from 1, whatever the side."""
    return _per_cent(abs(ratio - 1))


def relation(figure: str, line: Row) -> Statement:
    """Whether a slope's interval leaves out zero, and on which side; else whether it could."""
    quantity, explaining = PAIRS[figure]
    wording, verdict = say("no relation seen between {y} and {x}"), "none"
    if line["slope_lo"] > 0:
        wording, verdict = say("{y} rises with {x}"), "rises"
    elif line["slope_hi"] < 0:
        wording, verdict = say("{y} falls with {x}"), "falls"
    elif (line["r2"] or 0.0) >= CLEAR_R2:
        wording, verdict = say("too few boats to tell whether {y} goes with {x}"), "not known"
    y, x = QUANTITIES[quantity], EXPLAINING[explaining]
    return told("relation", wording, {}, "type_lines", verdict=verdict, y=y, x=x)


def shift(row: Row) -> Statement:
    """What becomes of Cw at the next tow of the same boat."""
    wording, verdict = say("{method} no difference is seen"), "none"
    if row["apart"] and row["shift_ratio"] < 1:
        wording, verdict = say("{method} Cw falls by {by} %"), "falls"
    elif row["apart"]:
        wording, verdict = say("{method} Cw rises by {by} %"), "rises"
    method, by = labels.method(row["method"]), _off(row["shift_ratio"])
    return told("shift", wording, {}, "era_shifts", verdict=verdict, method=method, by=by)
