"""The slide book: every chart of the presentation of 24 January 2015 over this archive.

A slide is a figure with its rows, a title, and a sentence that says what it shows, made from the
figures of the tables. Does not belong here: what a figure looks like (`dashboards.figures.slides`),
the statistics behind a sentence (`pipeline.consistency`), and files (`dashboards.slides`).
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import nullcontext
from functools import cached_property, partial
from typing import Final, NamedTuple

import polars as pl

from dashboards import labels
from dashboards.figures.slides import EXPLAINING, QUANTITIES
from dashboards.slide_rows import (
    RECOMPUTED_SEASON,
    boats_of_slides,
    by_tows,
    compared_frame,
    lines_frame,
    methods_of,
    pair_of_types,
)
from pipeline.consistency.observed import UNKNOWN_TYPE
from pipeline.errors import MissingKnowledgeError
from pipeline.messages import Say, Sentence, ngettext, say
from pipeline.studies.options import AS_READ, SPEEDS, TICKS
from pipeline.tables.row import Row
from warehouse.queries.chosen_tows import ALL, STATED, rows_of, spoken_range, with_choices
from warehouse.queries.views import Views
from warehouse.store.unforeseen import Border

RECOMPUTED: Final = (("cw", "weight"), ("b", "speed"), ("cw", "speed"))
"""What the presentation shows of the recomputed season."""

RACED_COLUMNS: Final = (
    *("method", "label", "speed_case", "power_w", "raced_power_w"),
    *("power_ratio_raced", "power_ratio_raced_lo", "power_ratio_raced_hi"),
)

OF: Final = {
    "b": say("B"),
    "a": say("A"),
    "cw": say("Cw at the standard speed"),
}
AGAINST: Final = {
    "weight": say("{y} against weight: {types}"),
    "speed": say("{y} against tow speed: {types}"),
    "length": say("{y} against length: {types}"),
}
IN_SENTENCES: Final = {
    "weight": say("weight"),
    "speed": say("tow speed"),
    "length": say("length"),
}
IS_HULL_SPEED: Final = {
    True: say("It may be: B lies at {ratio} times hull speed ({lo} to {hi}; {boats}, {after})."),
    False: say(
        "No: B lies at {ratio} times hull speed ({lo} to {hi}; {boats}, {after}); "
        "{share} lie within 5 % of it."
    ),
    None: say("Too few boats with a B to tell ({boats})."),
}

CLEAR_R2: Final = 0.3
"""From here on a line without a clear slope is not called "no link": too few boats tell."""


class Slide(NamedTuple):
    """A figure by name, its rows, and what is said above it, in one part per line."""

    name: str
    figure: str
    rows: pl.DataFrame
    title: str
    said: Sequence[str]

    @property
    def sentence(self) -> str:
        """What is said, as one text."""
        return " ".join(self.said)


class Asked(NamedTuple):
    """What the slides are about: types, those of the presentation when none; tows; boats."""

    types: Sequence[str] = ()
    tows: str = ALL
    boats: Sequence[str] = ()


THE_PRESENTATION: Final = Asked()
"""Its types, boats, and all tows."""


def slides(
    views: Views, say: Say, asked: Asked = THE_PRESENTATION, border: Border = nullcontext
) -> Iterator[Slide]:
    """Every slide of which the archive has something to show, each made within a border.

    Raises:
        MissingKnowledgeError: there is no such type, boat or choice of tows.
    """
    for name, make in _makers(Book(views, say, asked.tows), asked):
        with border(f"slide {name}"):
            yield from make()


def _makers(about: "Book", asked: Asked) -> Iterator[tuple[str, Callable[[], Iterable[Slide]]]]:
    """What makes each slide, or those of a boat."""
    types = about.types(asked.types)
    pairs = [(y, x, about.tows) for y in QUANTITIES for x in EXPLAINING]
    if RECOMPUTED_SEASON in about.choices and about.tows == ALL:
        pairs += [(y, x, RECOMPUTED_SEASON) for y, x in RECOMPUTED]
    for y, x, tows in pairs:
        yield f"{y} {x} {tows}", partial(about.against, y, x, types, tows)
    yield "hull speed", about.hull_speed
    yield "towed at", about.towed_at
    yield "raced beyond", about.raced_beyond
    yield "eras", about.eras
    for boat in boats_of_slides(about.views, about.compared, asked.boats):
        yield boat, partial(about.boat, boat)
    yield "ticks fleet", about.tick_effects


class Book:
    """The slides of an archive in one language, over a choice of tows."""

    def __init__(self, views: Views, say: Say, tows: str = ALL) -> None:
        self.views, self.say, self.tows = views, say, tows
        held = views.table("compared_tows")["method"].unique().to_list()
        if not held and not views.table("tows").is_empty():
            raise MissingKnowledgeError(
                "no type of boat has curves to compare: there are no slides"
            )
        if tows not in STATED:
            views.choose(tows, list({*methods_of(held), *methods_of(held, tows)}))
        self.held, self.compared = held, compared_frame(views)
        lines = views.table("type_lines").filter(within="all")
        self.choices = lines["tows"].unique().sort().to_list()
        keys = ("boat_type", "tows", "quantity", "explaining", "method")
        self._lines = {tuple(row[k] for k in keys): row for row in lines.iter_rows(named=True)}

    def types(self, wanted: Sequence[str]) -> list[str]:
        """The types asked for, or those of the presentation."""
        known = by_tows(self.compared)
        chosen = []
        for name in wanted:
            like = [t for t in known if t.casefold().startswith(name.casefold())]
            if not like:
                raise MissingKnowledgeError(
                    "there is no type {!r}; the types are {}", name, ", ".join(sorted(known))
                )
            chosen.append(like[0])
        return chosen or pair_of_types(self.compared)

    def ends(self, tows: str = ALL) -> tuple[str, str]:
        """The methods before and after all corrections."""
        methods = methods_of(self.held, tows)
        return methods[0], methods[-1]

    def method(self, name: str) -> str:
        """A method as people call it."""
        return self.say(labels.method(name))

    def against(
        self, quantity: str, explaining: str, types: list[str], tows: str
    ) -> Iterator[Slide]:
        """A quantity against an explaining variable, of some types and tows."""
        own = pl.col("boat_type").is_in(types)
        own &= pl.col("method").is_in(methods_of(self.held, tows))
        drawn = self._line_points.filter(own, tows=self._stated(tows))
        rows = pl.concat([self.compared.filter(rows_of(tows), own), drawn], how="diagonal_relaxed")
        title = self.say(AGAINST[explaining], y=self.say(OF[quantity]), types=" / ".join(types))
        if tows != ALL:
            words = self.say(labels.code(tows)) if tows in STATED else spoken_range(tows)
            title += self.say(", {tows} only", tows=words)
        said = [self.line((quantity, explaining), name, tows, self.ends(tows)) for name in types]
        yield Slide(
            f"{quantity} {explaining} {tows}", f"slide_{quantity}_{explaining}", rows, title, said
        )

    @cached_property
    def _line_points(self) -> pl.DataFrame:
        return lines_frame(self.views)

    def _stated(self, tows: str) -> str:
        """The choice as tables have it: statistics of a range of seasons are over all its tows."""
        return tows if tows in self.choices else ALL

    def line(self, of: tuple[str, str], boat_type: str, tows: str, ends: tuple[str, str]) -> str:
        """What the line of a type says under the methods at both ends, and its outliers.

        `of` are quantity and explaining variable.
        """
        (quantity, *_), explaining = QUANTITIES[of[0]], EXPLAINING[of[1]]
        key = (boat_type, self._stated(tows), quantity, explaining)
        before, after = (self._lines.get((*key, method)) for method in ends)
        counted = self._counted(after)
        if after is None or after["slope"] is None:
            return self.say(
                "{type}: too few boats for a line ({counted}).", type=boat_type, counted=counted
            )
        words = {
            "y": self.say(OF[of[0]]),
            "x": self.say(IN_SENTENCES[of[1]]),
        }
        said = self.say(
            "{type}: {verdict}. R² {r2_after} {after}, {r2_before} {before}; {counted}.",
            type=boat_type,
            verdict=self.say(_verdict(after), **words),
            before=self.method(ends[0]),
            after=self.method(ends[1]),
            r2_before=_share(before["r2"] if before else None),
            r2_after=_share(after["r2"]),
            counted=counted,
        )
        names = self._outliers.get((boat_type, self._stated(tows)))
        return f"{said} {self.say('Outliers in Cw: {names}.', names=names)}" if names else said

    def _counted(self, line: Row | None) -> str:
        """How many tows of how many boats."""
        n, boats = (line["n"], line["n_boats"]) if line else (0, 0)
        return self.say("{tows} of {boats}", tows=self._tows(n), boats=self._boats(boats))

    def _tows(self, n: int) -> str:
        return self.say(ngettext("1 tow", "{n} tows", n))

    def _boats(self, n: int) -> str:
        return self.say(ngettext("1 boat", "{n} boats", n))

    @cached_property
    def _outliers(self) -> dict[tuple[str, str], str]:
        """Tows outside their type after correction, by type and choice: boat, crew and season."""
        names = (
            with_choices(self.compared)
            .filter(pl.col("outside"), method=self.ends()[1])
            .explode("tows")
            .group_by("boat_type", "tows", maintain_order=True)
            .agg(pl.col("label").str.join(", "))
        )
        return {(boat_type, tows): label for boat_type, tows, label in names.iter_rows()}

    def hull_speed(self) -> Iterator[Slide]:
        """B against length, and against hull speed."""
        own = rows_of(self.tows) & (pl.col("boat_type") != UNKNOWN_TYPE)
        known = self._compared_methods().filter(own)
        said = [self.b_and_hull_speed(self.tows)]
        yield Slide("hull speed", "slide_hull_speed", known, self.say("Is B hull speed?"), said)

    def b_and_hull_speed(self, tows: str) -> str:
        """Whether B is hull speed."""
        after, of_all = self.ends()[1], self._hull_speed(tows)
        return self.say(
            IS_HULL_SPEED[of_all["b_is_hull_speed"]],
            after=self.method(after),
            ratio=self._digits(of_all["b_ratio"]),
            lo=self._digits(of_all["b_ratio_lo"]),
            hi=self._digits(of_all["b_ratio_hi"]),
            boats=self._boats(of_all["n_boats"]),
            share=_share(of_all["b_share_within_5pct"]),
        )

    def _hull_speed(self, tows: str) -> Row:
        """The statistics of all types together."""
        return self._hull_speeds.row(by_predicate=pl.col("tows") == self._stated(tows), named=True)

    @cached_property
    def _hull_speeds(self) -> pl.DataFrame:
        return self.views.table("hull_speed").filter(method=self.ends()[1], boat_type=ALL)

    def _compared_methods(self) -> pl.DataFrame:
        return self.compared.filter(pl.col("method").is_in(methods_of(self.held)))

    def towed_at(self) -> Iterator[Slide]:
        """Tow speed as part of hull speed."""
        after = pl.col("method") == self.ends()[1]
        rows = self.compared.filter(rows_of(self.tows), after)
        rows = rows.with_columns(newest_method="method")
        said = [self.part_of_hull_speed(self.tows)]
        yield Slide(
            "towed at",
            "slide_towed_at",
            rows,
            self.say("At what part of hull speed are boats towed?"),
            said,
        )

    def part_of_hull_speed(self, tows: str) -> str:
        """At what part of hull speed boats are towed."""
        of_all = self._hull_speed(tows)
        return self.say(
            "Half of the tows lie above {ratio} of hull speed; {share} lie between 60 and "
            "70 %, where the presentation puts rowing.",
            ratio=_share(of_all["tow_ratio"]),
            share=_share(of_all["tow_share_60_70"]),
        )

    def raced_beyond(self) -> Iterator[Slide]:
        """Race power by curves that are used where they do not count."""
        label = pl.format("{} {}{} {}", "name", "rowers", "crew_class", "season")
        rows = self.views.ask("slow_tows").with_columns(label.alias("label"))
        rows = rows.filter(
            pl.col("power_ratio_raced").is_not_null(),
            pl.col("method").is_in(methods_of(self.held)),
        )
        after = rows.filter(method=self.ends()[1])
        if after.is_empty():
            return
        both = after.filter(pl.col("raced_high") & (pl.col("power_w") < _low_power()))
        sentence = self.say(
            "Towed with little power or raced off their own curve: {n}. The own curve of "
            "{up} of these gives too much power, of {down} too little (the interval leaves "
            "out 1). Towed under 70 W (women 40) and raced above 100 W (women 57): {both}.",
            n=self._tows(after.height),
            up=after.filter(pl.col("power_ratio_raced_lo") > 1).height,
            down=after.filter(pl.col("power_ratio_raced_hi") < 1).height,
            both=", ".join(both["label"]) or self.say("no tow"),
        )
        title = self.say("Boats that race faster than their curve holds")
        drawn = rows.select(RACED_COLUMNS)
        yield Slide("raced beyond", "slide_raced_beyond", drawn, title, [sentence])

    def eras(self) -> Iterator[Slide]:
        """Seasons that stand apart, before and after."""
        rows = self.views.table("era_shifts").filter(
            pl.col("shift_ratio").is_not_null(),
            pl.col("method").is_in(methods_of(self.held)),
            boat_type=ALL,
        )
        of = {(r["method"], r["era"]): r for r in rows.iter_rows(named=True)}
        ends = self.ends()
        said = [
            self.say(
                "From a tow of {era} to the next of the same boat: {before}; {after}.",
                era=era,
                before=self._apart(of[ends[0], era]),
                after=self._apart(of[ends[1], era]),
            )
            for era in rows["era"].unique().sort()
            if all((name, era) in of for name in ends)
        ]
        if said:
            yield Slide(
                "eras", "eras", rows, self.say("Do tows of an era differ from later ones?"), said
            )

    def _apart(self, row: Row) -> str:
        """Whether the next tow of the same boats stands apart from those of an era, old to new."""
        return self.say(
            "{method} it stands apart, Cw {shift} ({lo} to {hi})"
            if row["apart"]
            else "{method} no difference is seen, {shift} ({lo} to {hi})",
            method=self.method(row["method"]),
            shift=self._signed(row["shift_ratio"] - 1.0),
            lo=self._signed(row["lo"] - 1.0),
            hi=self._signed(row["hi"] - 1.0),
        )

    def boat(self, fsn_no: str) -> Iterator[Slide]:
        """One boat over the years, and what the tool's ticks do to one of its tows."""
        own = self._compared_methods().filter(fsn_no=fsn_no)
        if own.is_empty():
            return
        name = own["name"][0]
        common = own.select("method", "tow_id", "standard_speed_m_s")
        rows = self.views.ask("curve_points_of", fsn_no).join(
            common, on=["method", "tow_id"], maintain_order="left"
        )
        title = self.say("{name} through the years", name=name)
        yield Slide(f"years {name}", "slide_boat_years", rows, title, self._years(own))
        yield from self._ticks(own.sort("season", "tow_id"))

    def _ticks(self, own: pl.DataFrame) -> Iterator[Slide]:
        """The tow of 2014, as on the slide, or the boat's newest."""
        of_2014 = own.filter(season=int(RECOMPUTED_SEASON))
        tow = (of_2014 if of_2014.height else own).row(-1, named=True)
        rows = self.views.ask("option_curves_of", tow["tow_id"]).filter(
            pl.col("method") == self._ticked()
        )
        if rows.is_empty():
            return
        effects = self.views.table("option_effects").filter(
            method=self._ticked(), study="tool", tow_id=tow["tow_id"]
        )
        at_read = rows.filter(speed=AS_READ)["cw_kg_m"].to_numpy()
        sentence = self.say(
            "{tow}: the highest of {n} curves lies {spread} above the lowest (Cw at the "
            "declared speed, log as read, {method}). On average over the other choices: "
            "{effects}.",
            tow=tow["label"],
            spread=_share(float(at_read.max() / at_read.min()) - 1.0),
            n=len(at_read),
            method=self.method(self._ticked()),
            effects=self._effects(dict(effects.select("option", "cw_effect_ratio").rows())),
        )
        title = self.say("{tow}: all combinations of the four options of 2015", tow=tow["label"])
        yield Slide(f"ticks {tow['name']}", "slide_ticks", rows, title, [sentence])

    def _ticked(self) -> str:
        """The method under which the ticks are shown: the last of those studied."""
        held = self.views.table("option_summary").filter(study="tool")["method"].to_list()
        return ([name for name in methods_of(self.held) if name in held] or [""])[-1]

    def _effects(self, of: dict[str, float | None], tows: dict[str, int] | None = None) -> str:
        """What ticks and speeds do to Cw, the largest first.

        Args:
            of: the ratio that each makes.
            tows: over how many; told of those over fewer than the others.
        """
        most = max(tows.values()) if tows else 0
        fewer = {o: f" ({self._tows(n)})" for o, n in (tows or {}).items() if n < most}
        known = {o: e - 1.0 for o, e in of.items() if e is not None and o in (*TICKS, *SPEEDS)}
        largest = sorted(known, key=lambda option: -abs(known[option]))
        return ", ".join(
            f"{self.say(labels.code(o))} {self._signed(known[o])}{fewer.get(o, '')}"
            for o in largest
        )

    def tick_effects(self) -> Iterator[Slide]:
        """What the ticks do to all boats."""
        rows = self.views.table("option_summary").filter(study="tool")
        own = rows.filter(method=self._ticked())
        if own.is_empty():
            return
        sentence = self.say(
            "The median change of Cw over {tows}: {effects} ({method}). The bar holds the "
            "middle 90 % of the tows.",
            method=self.method(self._ticked()),
            tows=self._tows(max(own["tows"].to_list())),
            effects=self._effects(
                dict(own.select("option", "median_ratio").rows()),
                dict(own.select("option", "tows").rows()),
            ),
        )
        title = self.say("What the options of 2015 do to all boats")
        yield Slide("ticks fleet", "slide_tick_effects", rows, title, [sentence])

    def _years(self, own: pl.DataFrame) -> list[str]:
        """How far the tows of each crew lie apart at the common speed."""
        before, after = self.ends()
        cw = pl.col("cw_standard_kg_m")
        crews = (
            own.drop_nulls("cw_standard_kg_m")
            .group_by("method", crew=pl.format("{}{}", "rowers", "crew_class"), maintain_order=True)
            .agg(pl.len().alias("n"), (cw.max() / cw.min()).log().alias("spread"))
            .filter(pl.col("n") > 1)
        )
        spread = {(m, c): (n, value) for m, c, n, value in crews.sort("crew").iter_rows()}
        said = [
            self.say(
                "{crew}: Cw at {speed} m/s spreads by {after_spread} {after}, {before_spread} "
                "{before} (highest / lowest of {n}).",
                speed=self._digits(own["standard_speed_m_s"][0]),
                crew=crew,
                n=n,
                before=self.method(before),
                after=self.method(after),
                before_spread=_share(spread.get((before, crew), (0, None))[1]),
                after_spread=_share(value),
            )
            for (method, crew), (n, value) in spread.items()
            if method == after
        ]
        return said or [self.say("Every crew was towed once: there is nothing to compare.")]

    def _digits(self, value: float | None) -> str:
        """A number with two decimals, as this language writes it."""
        return "-" if value is None else self.say("{:.2f}", value)

    def _signed(self, ratio: float) -> str:
        """A change in per cent with one decimal, as this language writes it."""
        return self.say("{:+z.1f} %", 100 * ratio)


def _low_power() -> pl.Expr:
    return pl.col("crew_class").replace_strict({"H": 70.0, "D": 40.0}, return_dtype=pl.Float64)


def _verdict(line: Row) -> Sentence:
    """Whether a slope's interval leaves out zero, and on which side; else whether it could."""
    if line["slope_lo"] > 0:
        return say("{y} rises with {x}")
    if line["slope_hi"] < 0:
        return say("{y} falls with {x}")
    if (line["r2"] or 0.0) >= CLEAR_R2:
        return say("too few boats to tell whether {y} goes with {x}")
    return say("no relation seen between {y} and {x}")


def _share(ratio: float | None) -> str:
    return "-" if ratio is None else f"{100 * ratio:.0f} %"
