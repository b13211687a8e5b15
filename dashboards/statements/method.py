"""A method: what each step of it does here and on what authority, the vote, and one boat."""

from collections.abc import Callable, Iterator, Sequence
from typing import Final, NamedTuple

import polars as pl

from dashboards import labels
from dashboards.columns import unit_of
from dashboards.option_labels import range_in_words, text, value_in_words
from dashboards.speech import Headline
from dashboards.statements import Change, Number, Statement, Value, number, told
from dashboards.statements.edition import NEGLIGIBLE
from pipeline.messages import Sentence, ngettext, pgettext, say
from pipeline.method.definition import COMPLETE, Method
from pipeline.method.options import Steps, find_basis
from pipeline.method.variant import Difference, differences
from pipeline.studies.ladder import START, STEP_ORDER
from pipeline.tables.row import Row
from warehouse.queries.views import Views, curve_figure
from warehouse.store.methods import KnownMethods

EACH_STEP: Final = say("What each step does here")
WORKED: Final = say("One boat worked through")
VOTE: Final = say("What is put to the vote")
BASES: Final = say(
    "What differs from the numbers as first published. Decided: in a text of the federation. "
    "Proposed: put forward. Inferred: our reading where the texts are silent. P2015: presentation "
    "of R. Pot, 24 January 2015. S2017: his text \u201cSleepproef\u201d, 2017."
)
"""What the status and the sources of a step mean."""
LADDER: Final = ("correction_steps",)


class Explained(NamedTuple):
    """What there is to say of a method, against the first of this archive.

    Attributes:
        method: the method.
        steps: every step, what it does otherwise and what comes of it here.
        uncertainty: how wide an interval of Cw is here.
        vote: what a meeting decides with it.
        worked: a tow worked through; None where no tow changes.
    """

    method: Method
    steps: Sequence["Step"]
    uncertainty: Sequence[Statement]
    vote: Sequence[Statement]
    worked: "Worked | None"


def explained(views: Views, name: str) -> Explained:
    """A method of the last rebuild, explained.

    Raises:
        MissingKnowledgeError: there is no such method.
    """
    first, method = _ends(views, name)
    ends = {"from_method": first.name, "to_method": name}
    ladder = views.table("correction_steps").filter(**ends)
    return Explained(
        method,
        _steps(method, first, ladder),
        _uncertainty(views, method),
        _vote(method, first),
        _worked(views, method, ladder),
    )


def _ends(views: Views, name: str) -> tuple[Method, Method]:
    """The first method of this archive, and the one of this name."""
    known = KnownMethods.of(views.store)
    return known.get(views.table("methods")["method"][0]), known.get(name)


class Step(NamedTuple):
    """A step of a method: its name, then what it does otherwise, and what comes of it here."""

    name: Sentence
    statements: Sequence[Statement]


def _steps(method: Method, first: Method, ladder: pl.DataFrame) -> list[Step]:
    """Every step, in the order in which steps are exchanged.

    Args:
        method: what is explained.
        first: the method that it is compared with.
        ladder: rows of `correction_steps` from the one to the other.
    """
    changed = differences(method, first)
    effects = _effects(ladder)
    return [
        Step(
            text(f"step.{step}"),
            [
                *([effects[step]] if step in effects else []),
                *(_rule(one) for one in changed if one.step == step),
                *_kept(method, step, changed),
            ],
        )
        for step in dict.fromkeys((*STEP_ORDER, *Steps.model_fields))
    ]


def _rule(one: Difference) -> Statement:
    """What an option is set to, what it was, and where that comes from."""
    before: list[Value] = [_value(one.option, value) for value in one.before]
    wording = say("{option}, {seasons}: {after}; it was: {before} ({status}: {source}).")
    words = _words(one.step, one.option, one.after)
    seasons = range_in_words(one.first, one.last)
    return told("rule", wording, words, seasons=seasons, before=before)


def _kept(method: Method, step: str, changed: Sequence[Difference]) -> Iterator[Statement]:
    """What the first option of a step is, where the step is as it was."""
    if any(one.step == step for one in changed):
        return
    options: type = Steps.model_fields[step].annotation  # type: ignore[assignment]
    option = next(iter(options.model_fields))  # type: ignore[attr-defined]
    value = getattr(getattr(method.ranges[-1].steps, step), option)
    wording = say("{option}: {after}, as it was ({status}: {source}).")
    yield told("kept", wording, _words(step, option, value))


def _words(step: str, option: str, value: object) -> dict[str, Value]:
    basis = find_basis(step, option, value)
    return {
        "option": text(f"{step}.{option}"),
        "after": _value(option, value),
        "status": text(f"status.{basis.status}"),
        "source": basis.source,
    }


def _value(option: str, value: object) -> Headline:
    """The value of an option with its unit."""
    return lambda speech: f"{value_in_words(value, speech)} {unit_of(option)}".rstrip()


def _effects(ladder: pl.DataFrame) -> dict[str, Statement]:
    """By step, how many tows it changes: their median, and the tow that it changes most."""
    size = pl.col("factor").log().abs()
    moved = pl.col("factor").filter((pl.col("factor") - 1).abs() >= NEGLIGIBLE)
    found = (
        ladder.filter(pl.col("step") != START)
        .sort("tow_id")
        .group_by("step", maintain_order=True)
        .agg(
            tows=pl.len(),
            moved=moved.len(),
            median=moved.median(),
            largest=pl.col("factor").sort_by(size).last(),
            tow=pl.col("tow_id").sort_by(size).last(),
        )
    )
    return {row["step"]: _effect(row) for row in found.to_dicts()}


def _effect(row: Row) -> Statement:
    if not row["moved"]:
        return told("no_effect", say("It changes no tow of this archive."), {}, *LADDER)
    wording = say(
        "It changes {moved} of {tows} tows: median {median}, largest {largest} (tow {tow})."
    )
    changes = {name: Change(row[name]) for name in ("median", "largest")}
    return told("effect", wording, row | changes, *LADDER)


VOTED: Final = {
    "decided": say("Follows from texts of the federation: {options}."),
    "proposed": say("Put to the vote: {options}."),
    "inferred": say("Our reading, for the meeting to confirm: {options}."),
}
"""What the meeting is asked about changes, by their status."""
ESTIMATES: Final = {
    "as_measured": say(
        "The register takes Cw as measured, and a tow counts for {years} calendar years after it."
    ),
    "best_estimate": say(
        "The register takes the best estimate, and a tow counts for {years} calendar years after "
        "it."
    ),
}


def _vote(method: Method, first: Method) -> list[Statement]:
    """What a meeting decides with this method: its changes by status, and the register's rule."""
    rule = method.validity
    wording, years = ESTIMATES[rule.estimate], rule.valid_years
    decided = told("register_rule", wording, verdict=rule.estimate, years=years)
    return [*_by_status(method, first, _of_step), decided]


def voted_steps(views: Views, name: str) -> list[Statement]:
    """By status the steps in which a method differs from the first, for where room is scarce."""
    first, method = _ends(views, name)
    return _by_status(method, first, lambda step, _: text(f"step.{step}"))


def _by_status(
    method: Method, first: Method, shown: Callable[[str, list[Value]], Value]
) -> list[Statement]:
    """What changes by status: of each step its name and options, as they are shown."""
    changed: dict[str, dict[str, list[Value]]] = {status: {} for status in VOTED}
    for one in differences(method, first):
        words = _words(one.step, one.option, one.after)
        named = told("option", say("{option}: {after}"), words)
        status = find_basis(one.step, one.option, one.after).status
        changed[status].setdefault(one.step, []).append(named)
    return [
        told(status, VOTED[status], options=[shown(*one) for one in steps.items()])
        for status, steps in changed.items()
        if steps
    ]


def _of_step(step: str, options: list[Value]) -> Statement:
    """Options of a step, in brackets."""
    return told("step", say("{step} ({options})"), step=text(f"step.{step}"), options=options)


def _uncertainty(views: Views, method: Method) -> list[Statement]:
    """How wide an interval of Cw is here, and what it consists of most; none without a curve."""
    known = views.table("curves").filter(method=method.name).drop_nulls("cw_lo_kg_m")
    if known.is_empty():
        return []
    half = (pl.col("cw_hi_kg_m") - pl.col("cw_lo_kg_m")) / 2 / pl.col("cw_kg_m")
    width = Number(100 * known.select(half.median()).item(), 1, "%")
    if method.interval != COMPLETE:
        wording = say(
            "In this archive the runs of a tow scatter by \u00b1{width} % of Cw (median of {tows} "
            "tows); the error of the log comes on top of that."
        )
        return [told("runs_alone", wording, width=width, tows=known.height)]
    parts = views.table("uncertainty_budget").filter(method=method.name)
    largest = parts.group_by("component", maintain_order=True).agg(pl.col("u_ratio").median())
    by_size = largest.sort("u_ratio", "component")["component"].reverse()
    wording = say(
        "In this archive the 95 % interval of Cw is \u00b1{width} % (median of {tows} "
        "tows), most of it from: {first}; then: {second}."
    )
    first, second = map(labels.code, by_size[:2])
    values = {"width": width, "tows": known.height, "first": first, "second": second}
    return [told("interval_width", wording, values, "curves", "uncertainty_budget")]


class Worked(NamedTuple):
    """A tow worked through, from a run to its number and from its old number to the new.

    Attributes:
        statements: the steps in order.
        drawn: rows of the figure `resistance_curve`.
    """

    statements: Sequence[Statement]
    drawn: pl.DataFrame


def _worked(views: Views, method: Method, ladder: pl.DataFrame) -> Worked | None:
    """A tow on which most steps act, and that changes as much as such tows do.

    Args:
        ladder: rows of `correction_steps` to the method.
    """
    tow_id = _typical(ladder)
    if tow_id is None:
        return None
    key = {"method": method.name, "tow_id": tow_id}
    curves = views.ask("curves").filter(**key)
    curve = curves.row(0, named=True)
    tow = views.table("tows").filter(tow_id=tow_id).row(0, named=True)
    boat = views.table("boats").filter(fsn_no=curve["fsn_no"]).row(0, named=True)
    run = views.table("run_points").filter("used", **key).sort("run").row(0, named=True)
    own = ladder.filter(tow_id=tow_id).sort("position")
    said = [_tow(boat | tow, curve), _force(run), _corrections(run), *_curve(curve), _change(own)]
    drawn = curve_figure(views.table("curve_points"), views.table("run_points"), curves)
    return Worked(said, pl.concat(drawn.values(), how="diagonal_relaxed"))


def _typical(ladder: pl.DataFrame) -> str | None:
    """The tow that most steps change, of several the one nearest to their median."""
    change = pl.col("change")
    tows = (
        ladder.group_by("tow_id", maintain_order=True)
        .agg(
            steps=((pl.col("factor") - 1).abs() >= NEGLIGIBLE).sum(),
            change=pl.col("factor").log().sum(),
        )
        .filter(pl.col("steps") == pl.col("steps").max())
        .sort((change - change.median()).abs().round(9), "tow_id")
    )
    return None if tows.is_empty() else str(tows["tow_id"][0])


def _tow(boat: Row, curve: Row) -> Statement:
    wording = say(
        "{name} ({fsn_no}), {rowers} rowers ({people}), towed on {tow_date}: {runs} that count."
    )
    runs = ngettext("1 run", "{n} runs", curve["runs_used"])
    people = labels.crew(boat["crew_class"])
    return told("worked_tow", wording, boat, "tows", "curves", people=people, runs=runs)


def _force(run: Row) -> Statement:
    return told(
        "worked_run",
        say(
            "Run {run}, from {window_start_s} to {window_end_s} s: {force} N at {speed_m_s} m/s, "
            "the speed of the log times {factor}. Force divided by speed squared is "
            "{gross_cw_kg_m} kg/m."
        ),
        run,
        "run_points",
        force=Number(run["gross_cw_kg_m"] * run["speed_m_s"] ** 2, 0, "N"),
        speed_m_s=number(run, "speed_m_s", 3),
        factor=Number(run["speed_factor"], 3, "1"),
    )


CORRECTIONS: Final = (
    (pgettext("correction", "acceleration"), "inertia_cw_kg_m", -1),
    (pgettext("correction", "wind"), "air_cw_kg_m", -1),
    (pgettext("correction", "still air"), "still_air_cw_kg_m", 1),
    (pgettext("correction", "water of 15 \u00b0C"), "temperature_cw_kg_m", 1),
)
"""What is added to the gross Cw of a run: its name, column and sign."""


def _corrections(run: Row) -> Statement:
    parts: list[Value] = [
        told("correction", say("{name} {by}"), name=name, by=Number(sign * by, sign="+"))
        for name, column, sign in CORRECTIONS
        if (by := run[column])
    ]
    wording = say("Corrected for {parts}, it is {cw_kg_m} kg/m.")
    named = parts or labels.code("none")
    return told("worked_corrections", wording, run, "run_points", parts=named)


def _curve(curve: Row) -> Iterator[Statement]:
    wording = say(
        "Through the runs goes the curve with A {a_kg_m} kg/m and B {b_m_s} m/s: at the declared "
        "{declared_speed_m_s} m/s that is Cw = A / (1 \u2212 (v/B)\u00b2) = {cw_kg_m} kg/m."
    )
    yield told("worked_curve", wording, curve, "curves")
    wording = say("Rowing at that speed takes {power} W per rower: Cw v³ / n.")
    yield told("worked_power", wording, {}, "curves", power=number(curve, "power_w", 0))


def _change(ladder: pl.DataFrame) -> Statement:
    causes: list[Value] = [
        told(
            "worked_cause",
            say("{step} {by}"),
            step=labels.code(row["step"]),
            by=Change(row["factor"]),
        )
        for row in ladder.to_dicts()
        if abs(row["factor"] - 1) >= NEGLIGIBLE
    ]
    wording = say("As first published it was {old} kg/m. From there: {causes}.")
    old, named = Number(ladder["cw_kg_m"][0]), causes or labels.code("none")
    return told("worked_change", wording, {}, *LADDER, old=old, causes=named)
