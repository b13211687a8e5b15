"""What a rebuild changed and what its checks say: headlines, a verdict, and the lines of a mail.

What changed is found out in `warehouse.queries.change_report`.
"""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from dashboards import labels
from dashboards.speech import Headline, Speech
from dashboards.statements import Change, EditionName, Statement, Value, together, told
from pipeline.messages import Sentence, pgettext, say
from pipeline.tables.row import Row
from warehouse.queries.change_report import ChangeReport

LINES_IN_MAIL: Final = 20
PAGES: Final = {"nl": "latest.html", "en": "latest.en.html"}
"""The page of each language."""
NOTHING: Final = say("Nothing changed since the last report.")


CHANGED, UNCHANGED, FAILED = "changed", "unchanged", "failed"
"""How a run can end."""


@dataclass(frozen=True)
class LastRun:
    """When and how the last run ended.

    Attributes:
        ended_at: when it ended, ISO 8601.
        outcome: `CHANGED`, `UNCHANGED` or `FAILED`.
        reason: why it failed; else empty.
        changed_at: when a run last changed something, ISO 8601.
    """

    ended_at: str
    outcome: str
    reason: str
    changed_at: str


@dataclass(frozen=True)
class Check:
    """How a check of a table ended.

    Attributes:
        asset: the table.
        check: code of the check.
        severity: Dagster's word.
        found: values by the code of their quantity.
    """

    asset: str
    check: str
    passed: bool
    severity: str
    found: Mapping[str, object]


def outcome_of(check: Check) -> str:
    """Code of how a check ended."""
    return "passed" if check.passed else str(check.severity).lower()


def values_found(check: Check) -> list[tuple[str, str]]:
    """Code and text of each quantity that a check found."""
    return [
        (name, "; ".join(value) if isinstance(value, list) else str(value))
        for name, value in check.found.items()
    ]


def found(check: Check) -> Headline:
    """What a check found."""
    wording = say("{name} {value}")
    parts = [
        told("found", wording, name=labels.code(name), value=value)
        for name, value in values_found(check)
    ]
    return together(parts, ", ")


def headlines(changes: ChangeReport, checks: Sequence[Check]) -> list[Statement]:
    """What happened in a few lines, the most important first."""
    return [*_wrong(checks), *_moved(changes)] or [told("nothing", NOTHING)]


def in_short(changes: ChangeReport) -> Headline:
    """What changed, as sentences of one paragraph."""
    return lambda speech: " ".join(
        f"{line(speech).rstrip('.')}." for line in headlines(changes, ())
    )


def verdict(changes: ChangeReport, checks: Sequence[Check]) -> Statement:
    """Return whether all is well, in a line; what Herijk itself failed on comes first.

    Tows with a flag are a person's work, so "in order" is not said while there are any.
    """
    if wrong := list(_wrong(checks)):
        return told("checks", say("Not in order: {wrong}."), verdict="wrong", wrong=wrong)
    if changes.judged["flagged"]:
        wording = say(
            "All {number} checks of the tables passed. Tows that still need a look: {flagged}."
        )
        return told("checks", wording, changes.judged, verdict="look", number=len(checks))
    wording = say("In order: all {number} checks passed, and no tow needs a look.")
    return told("checks", wording, verdict="passed", number=len(checks))


def judged(changes: ChangeReport) -> Statement:
    """Return how many tows are accepted, flagged and rejected now."""
    wording = say(
        "Tows by {method}: {accepted} accepted, {flagged} flagged for a look, {rejected} rejected."
    )
    return told(
        "judged", wording, changes.judged, "curves", method=labels.method(changes.judged["method"])
    )


OUTCOMES: Final = {
    CHANGED: say("Last run: {ended_at}. It changed tables."),
    UNCHANGED: say("Last run: {ended_at}. Nothing had changed."),
    FAILED: say("Last run: {ended_at}. It failed: {reason}"),
}


def describe_run(run: LastRun) -> list[Statement]:
    """Return when and how the last run ended, and when something last changed."""
    ended = told(
        "last_run", OUTCOMES[run.outcome], ended_at=show_minute(run.ended_at), reason=run.reason
    )
    changed = told(
        "last_change", say("Last change: {changed_at}."), changed_at=show_minute(run.changed_at)
    )
    return [ended, changed]


def show_minute(moment: str) -> str:
    """Return a moment of ISO 8601 as a date and a time in minutes."""
    return moment[:16].replace("T", " ")


def mail(
    changes: ChangeReport, checks: Sequence[Check], simulated: bool, run: LastRun
) -> tuple[str, str]:
    """Subject and text of the mail, in Dutch."""
    speech = Speech("nl")
    lines = [line(speech) for line in headlines(changes, checks)]
    marked = [speech.say(labels.SIMULATED), ""] if simulated else []
    moved = [f"  {_line(line)(speech)}" for line in changes.lines[:LINES_IN_MAIL]]
    more = len(changes.lines) - len(moved)
    rest = [f"  + {more}"] if more > 0 else []
    text = "\n".join(
        [
            *marked,
            *lines,
            judged(changes)(speech),
            *(line(speech) for line in describe_run(run)),
            "",
            *moved,
            *rest,
        ]
    )
    return f"{speech.say('Tow tests re-based')}: {lines[0]}", f"{text}\n"


def _line(line: Row) -> Statement:
    """A changed line of a draft."""
    by: Value = labels.code(line["change"])
    if line["cw_ratio"] is not None:
        by = told("by", say("Cw {by}"), by=Change(line["cw_ratio"]))
    wording, edition = say("{edition}: {fsn_no} {crew} {by}"), EditionName(line["to_edition"])
    crew = f"{line['rowers']}{line['crew_class']}"
    return told("changed_line", wording, line, edition=edition, crew=crew, by=by)


WHY_WRONG: Final = {
    "tables_fit_their_schemas": say("tables do not fit their schemas"),
    "few_tows_set_aside": say("many tows are set aside"),
    "nothing_unforeseen": say(
        "Herijk itself failed; report this to its maintainer, with the folder unforeseen"
    ),
    "log_factors_stayed": say("log factors moved"),
    "boats_stayed_within_their_intervals": say("boats moved beyond their intervals"),
    "editions_can_be_made_again": say(
        "editions, or the files that they were made from, have changed"
    ),
    "every_listed_tow_accounted_for": say("listed tows are not accounted for"),
    "every_tow_has_a_curve_row": say("tows have no row among the curves"),
}
"""What it means that a check failed."""


def _wrong(checks: Sequence[Check]) -> Iterator[Statement]:
    wording = say("{outcome}: {failed} ({found})")
    for check in sorted(checks, key=lambda check: check.check != "nothing_unforeseen"):
        if not check.passed:
            outcome, failed = (
                labels.code(outcome_of(check)),
                WHY_WRONG.get(check.check, check.check),
            )
            yield told("check", wording, outcome=outcome, failed=failed, found=found(check))


def _moved(changes: ChangeReport) -> Iterator[Statement]:
    if changes.first:
        yield told("first", say("First report: everything is new."))
    if changes.seasons_gone:
        wording = say("Seasons of which the archive has no tow any more: {seasons}")
        yield told("gone", wording, seasons=", ".join(map(str, changes.seasons_gone)))
    for row in changes.editions:
        wording = say("Edition {edition}: {done}")
        edition, done = EditionName(row["edition"]), labels.code(row["what"])
        yield told("edition", wording, row, edition=edition, done=done)
    for row in changes.methods:
        yield told("method", say("Method {method}: {done}"), row, done=labels.code(row["what"]))
    yield from _counted(pgettext("number", "Tows"), changes.tows)
    yield from _counted(say("Set aside"), changes.set_aside)
    if changes.factors:
        yield told("factors", say("Log factors that moved: {n}"), n=len(changes.factors))
    if changes.lines:
        wording = say("Changed lines of the drafts: {lines}, {beyond} beyond their interval")
        counts = {"lines": len(changes.lines), "beyond": len(changes.beyond_interval)}
        yield told("lines", wording, counts)


def _counted(title: Sentence, rows: Sequence[Row]) -> Iterator[Statement]:
    """How many rows there are of each kind; nothing of none."""
    counts = Counter(row["what"] for row in rows)
    parts = [
        told("number", say("{n} {what}"), n=number, what=labels.code(what))
        for what, number in counts.items()
    ]
    if parts:
        yield told("counts", say("{title}: {parts}"), title=title, parts=together(parts, ", "))
