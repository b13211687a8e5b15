"""The slide book: every chart of the presentation of 24 January 2015 over this archive.

A slide is a figure with its rows, a title, and a sentence that says what it shows, made from the
figures of the tables. Does not belong here: what a figure looks like (`dashboards.figures.slides`),
and the statistics behind a sentence (`pipeline.consistency`).
"""

import io
from collections.abc import Iterator, Sequence
from math import log
from pathlib import Path
from typing import Any, Final, Literal, NamedTuple

import altair as alt
import polars as pl
import pypdf
import vl_convert

from herijk.dashboards.audit_plots import VEGA_LITE, file_name
from herijk.dashboards.figures import FIGURES
from herijk.dashboards.figures.slides import EXPLAINING, METHODS, QUANTITIES
from herijk.dashboards.slide_rows import (
    boats_of_slides,
    by_tows,
    compared_frame,
    lines_frame,
    method_order,
    pair_of_types,
)
from herijk.dashboards.words import Say, speaker
from herijk.pipeline.consistency.observed import UNKNOWN_TYPE
from herijk.pipeline.errors import MissingKnowledgeError
from herijk.warehouse.queries.views import Views
from herijk.warehouse.store.database import choice_of
from herijk.warehouse.store.files import written_beside
from herijk.warehouse.store.store import Store

ALL_TOWS: Final = "all"
RECOMPUTED_SEASON: Final = "2014"
"""The slide "2014 opnieuw berekend"."""

WIDTH_OF_TEXT: Final = 140
LOCALES: Final[dict[str, Literal["nl-NL", "en-GB"]]] = {"nl": "nl-NL", "en": "en-GB"}
"""How numbers on axes are written."""


class Slide(NamedTuple):
    """A figure by name, its rows, and what is said above it."""

    name: str
    figure: str
    rows: pl.DataFrame
    title: str
    sentence: str


def write_slides(
    store: Store, folder: Path, language: str, types: Sequence[str] = (), tows: str = ALL_TOWS
) -> list[Path]:
    """Writes every slide as SVG and PNG, and all of them as one PDF.

    Args:
        store: where the database lies.
        folder: where they go; made if it is not there.
        language: nl or en.
        types: one or two types of boat; those of the presentation when none.
        tows: `all`, `newest`, or a season.

    Raises:
        MissingKnowledgeError: there is no such type or choice of tows, or no database.
    """
    say = speaker(language)
    with Views(store) as views:
        simulated = views.about().get("simulated") == "true"
        made = list(slides(views, say, types, tows))
    folder.mkdir(parents=True, exist_ok=True)
    book, written = pypdf.PdfWriter(), []
    for number, slide in enumerate(made, 1):
        svg = _svg(slide, language, simulated)
        stem = file_name(f"{number:02d} {slide.name}")
        png = vl_convert.svg_to_png(svg, scale=2.0)
        written += [_put(folder / f"{stem}.svg", svg.encode()), _put(folder / f"{stem}.png", png)]
        book.append(io.BytesIO(vl_convert.svg_to_pdf(svg)))
    pages = io.BytesIO()
    book.write(pages)
    return [*written, _put(folder / f"slides-{language}.pdf", pages.getvalue())]


def _put(path: Path, content: bytes) -> Path:
    with written_beside(path) as beside:
        beside.write_bytes(content)
    return path


def _svg(slide: Slide, language: str, simulated: bool) -> str:
    say = speaker(language)
    lines = [*_wrapped(slide.sentence), *([say("simulated")] if simulated else [])]
    title = alt.Title(slide.title, subtitle=lines, anchor="start", offset=12)
    chart = FIGURES[slide.figure](slide.rows, say).properties(title=title)
    spec = chart.to_dict()
    locale = LOCALES[language]
    return str(vl_convert.vegalite_to_svg(spec, vl_version=VEGA_LITE, format_locale=locale))


def _wrapped(text: str) -> list[str]:
    """Lines of a chart's subtitle, one or more a sentence."""
    lines = [""]
    for word in text.split():
        if len(lines[-1]) + len(word) > WIDTH_OF_TEXT:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".strip()
    return lines


def slides(
    views: Views, say: Say, types: Sequence[str] = (), tows: str = ALL_TOWS
) -> Iterator[Slide]:
    """Every slide of which the archive has something to show."""
    compared = compared_frame(views)
    lines = views.table("type_lines").with_columns(method_order())
    known_choices = lines["tows"].unique().to_list()
    if tows not in known_choices:
        raise MissingKnowledgeError(f"there are no tows {tows!r}; {choice_of(known_choices)}")
    chosen = _types(compared, types)
    about = _About(views, say, compared, lines)
    for quantity in QUANTITIES:
        for explaining in EXPLAINING:
            yield about.against(quantity, explaining, chosen, tows)
    if RECOMPUTED_SEASON in known_choices and tows == ALL_TOWS:
        for explaining in ("weight", "speed"):
            yield about.against("cw", explaining, chosen, RECOMPUTED_SEASON)
    yield about.hull_speed()
    yield about.towed_at()
    yield from about.raced_beyond()
    yield from about.eras()
    yield from about.boats()


def _types(compared: pl.DataFrame, wanted: Sequence[str]) -> list[str]:
    """The types asked for, or those of the presentation."""
    known = by_tows(compared)
    types = []
    for name in wanted:
        like = [t for t in known if t.casefold().startswith(name.casefold())]
        if not like:
            raise MissingKnowledgeError(
                f"there is no type {name!r}; the types are {', '.join(sorted(known))}"
            )
        types.append(like[0])
    return types or pair_of_types(compared)


class _About:
    """The slides of an archive in one language."""

    def __init__(self, views: Views, say: Say, compared: pl.DataFrame, lines: pl.DataFrame) -> None:
        self.views, self.say, self.compared, self.lines = views, say, compared, lines
        methods = compared.select("method", "order").unique().sort("order", "method")
        self.before, self.after = methods["method"][0], _last_method(methods["method"].to_list())

    def against(self, quantity: str, explaining: str, types: list[str], tows: str) -> Slide:
        """A quantity against an explaining variable, of some types and tows."""
        own = pl.col("boat_type").is_in(types)
        rows = pl.concat(
            [
                _of_choice(self.compared, tows).filter(own),
                lines_frame(self.views).filter(own, tows=tows),
            ],
            how="diagonal_relaxed",
        )
        title = self.say(f"slide.{explaining}").format(
            y=self.say(f"slide.{quantity}"), types=" / ".join(types)
        )
        if tows != ALL_TOWS:
            words = self.say("newest_only") if tows == "newest" else tows
            title += self.say("slide.of_season").format(tows=words)
        said = [self._line(quantity, explaining, name, tows) for name in types]
        name = f"{quantity} {explaining} {tows}"
        sentence = " ".join(said) + self._outside(rows)
        return Slide(name, f"slide_{quantity}_{explaining}", rows, title, sentence)

    def _line(self, quantity: str, explaining: str, boat_type: str, tows: str) -> str:
        own = self.lines.filter(
            boat_type=boat_type,
            tows=tows,
            quantity=QUANTITIES[quantity][0],
            explaining=EXPLAINING[explaining],
        )
        by_method = {row["method"]: row for row in own.iter_rows(named=True)}
        before, after = by_method.get(self.before), by_method.get(self.after)
        if after is None or after["slope"] is None:
            n, boats = (after["n"], after["n_boats"]) if after else (0, 0)
            return self.say("slide.no_line").format(type=boat_type, n=n, boats=boats)
        words = {
            "y": self.say(f"slide.{quantity}"),
            "x": self.say(f"slide.x.{explaining}"),
        }
        verdict = _direction(after)
        return self.say("slide.line").format(
            type=boat_type,
            verdict=self.say(f"slide.{verdict}").format(**words),
            before=self.before,
            after=self.after,
            r2_before=_share(before["r2"] if before else None),
            r2_after=_share(after["r2"]),
            n=after["n"],
            boats=after["n_boats"],
        )

    def _outside(self, rows: pl.DataFrame) -> str:
        """The tows outside their type after correction, by boat, crew and season."""
        names = rows.filter(pl.col("outside"), method=self.after)["label"].to_list()
        if not names:
            return ""
        return " " + self.say("slide.outside").format(after=self.after, names=", ".join(names))

    def hull_speed(self) -> Slide:
        """B against length, and against hull speed."""
        row = self.views.table("hull_speed").filter(
            method=self.after, tows=ALL_TOWS, boat_type=ALL_TOWS
        )
        line = row.row(0, named=True)
        key = {None: "b_unknown", True: "b_is", False: "b_is_not"}[line["b_is_hull_speed"]]
        sentence = self.say(f"slide.{key}").format(
            after=self.after,
            ratio=self._digits(line["b_ratio"]),
            lo=self._digits(line["b_ratio_lo"]),
            hi=self._digits(line["b_ratio_hi"]),
            boats=line["n_boats"],
            share=_share(line["b_share_within_5pct"]),
        )
        known = self.compared.filter(pl.col("boat_type") != UNKNOWN_TYPE)
        return Slide(
            "hull speed", "slide_hull_speed", known, self.say("slide.hull_speed"), sentence
        )

    def towed_at(self) -> Slide:
        """Tow speed as part of hull speed."""
        row = self.views.table("hull_speed").filter(
            method=self.after, tows=ALL_TOWS, boat_type=ALL_TOWS
        )
        line = row.row(0, named=True)
        sentence = self.say("slide.towed").format(
            ratio=_share(line["tow_ratio"]), share=_share(line["tow_share_60_70"])
        )
        rows = self.compared.with_columns(newest_method=pl.lit(self.after))
        return Slide("towed at", "slide_towed_at", rows, self.say("slide.towed_at"), sentence)

    def raced_beyond(self) -> Iterator[Slide]:
        """Race power by curves that are used where they do not count."""
        label = pl.format("{} {}{} {}", "name", "rowers", "crew_class", "season")
        rows = self.views.slow_tows().with_columns(label.alias("label"))
        rows = rows.filter(pl.col("power_ratio_raced").is_not_null())
        after = rows.filter(method=self.after)
        if after.is_empty():
            return
        both = after.filter(pl.col("raced_high") & (pl.col("power_w") < _low_power()))
        sentence = self.say("slide.raced").format(
            n=after.height,
            up=after.filter(pl.col("power_ratio_raced_lo") > 1).height,
            down=after.filter(pl.col("power_ratio_raced_hi") < 1).height,
            both=", ".join(both["label"]) or "-",
        )
        title = self.say("slide.raced_beyond")
        yield Slide("raced beyond", "slide_raced_beyond", rows, title, sentence)

    def eras(self) -> Iterator[Slide]:
        """Seasons that stand apart, before and after."""
        rows = self.views.table("era_shifts").filter(
            pl.col("shift_ratio").is_not_null(), boat_type=ALL_TOWS
        )
        of = {(r["method"], r["era"]): r for r in rows.iter_rows(named=True)}
        eras = rows["era"].unique().sort().to_list()
        said = [
            self._apart(of[self.before, era], of[self.after, era])
            for era in eras
            if (self.before, era) in of and (self.after, era) in of
        ]
        if said:
            yield Slide("eras", "eras", rows, self.say("slide.eras"), " ".join(said))

    def _apart(self, before: dict[str, Any], after: dict[str, Any]) -> str:
        """How far an era's tows lie above the next of the same boats."""
        return self.say("slide.apart").format(
            era=before["era"],
            before=self.before,
            after=self.after,
            before_shift=_signed(-log(before["shift_ratio"])),
            after_shift=_signed(-log(after["shift_ratio"])),
            verdict=self.say("slide.is_apart" if after["apart"] else "slide.not_apart"),
        )

    def boats(self) -> Iterator[Slide]:
        """One boat over the years, for the boats of the presentation."""
        for name in boats_of_slides(self.compared):
            own = self.compared.filter(pl.col("fsn_no") == name)
            curves = self.views.curve_points_of(name)
            rows = curves.join(
                own.select("method", "tow_id", "standard_speed_m_s"), on=["method", "tow_id"]
            )
            title = self.say("slide.boat_years").format(name=own["name"][0])
            yield Slide(
                f"years {own['name'][0]}", "slide_boat_years", rows, title, self._years(own)
            )

    def _years(self, own: pl.DataFrame) -> str:
        """How far the tows of each crew lie apart at the common speed."""
        cw = pl.col("cw_standard_kg_m")
        crews = (
            own.drop_nulls("cw_standard_kg_m")
            .group_by("method", crew=pl.format("{}{}", "rowers", "crew_class"))
            .agg(pl.len().alias("n"), (cw.max() / cw.min()).log().alias("spread"))
            .filter(pl.col("n") > 1)
        )
        spread = {(m, c): (n, value) for m, c, n, value in crews.sort("crew").iter_rows()}
        said = [
            self.say("slide.years").format(
                speed=self._digits(own["standard_speed_m_s"][0]),
                crew=crew,
                n=n,
                before=self.before,
                after=self.after,
                before_spread=_share(spread.get((self.before, crew), (0, None))[1]),
                after_spread=_share(value),
            )
            for (method, crew), (n, value) in spread.items()
            if method == self.after
        ]
        return " ".join(said)

    def _digits(self, value: float | None) -> str:
        """A number with two decimals, as this language writes it."""
        text = "-" if value is None else f"{value:.2f}"
        return text.replace(".", self.say("decimal_mark"))


def _of_choice(compared: pl.DataFrame, tows: str) -> pl.DataFrame:
    """The tows of a choice: all, the newest of each boat and crew, or a season."""
    if tows == ALL_TOWS:
        return compared
    if tows == "newest":
        return compared.filter("newest")
    return compared.filter(pl.col("season") == int(tows))


def _low_power() -> pl.Expr:
    return pl.col("crew_class").replace_strict({"H": 70.0, "D": 40.0}, return_dtype=pl.Float64)


def _last_method(methods: Sequence[str]) -> str:
    """The newest of the four methods that the archive has, else the last."""
    known = [name for name in METHODS if name in methods]
    return (known or list(methods))[-1]


def _direction(line: dict[str, Any]) -> str:
    """Whether a slope's interval leaves out zero, and on which side."""
    if line["slope_lo"] > 0:
        return "rises"
    return "falls" if line["slope_hi"] < 0 else "none"


def _share(ratio: float | None) -> str:
    return "-" if ratio is None else f"{100 * ratio:.0f} %"


def _signed(ratio: float) -> str:
    return f"{100 * ratio:+.0f} %"
