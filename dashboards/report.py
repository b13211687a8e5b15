"""The report of a rebuild in words: headlines, and a mail. Its page is in `report_page`.

What changed is found out in `warehouse.queries.change_report`; texts are in `words`.
"""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from dashboards import labels
from pipeline.messages import Say, pgettext, say, speaker
from pipeline.tables.row import Row
from warehouse.queries.change_report import ChangeReport

LINES_IN_MAIL: Final = 20
PAGES: Final = {"nl": "latest.html", "en": "latest.en.html"}
"""The page of each language."""


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


def found_in_words(check: Check, say: Say) -> str:
    """What a check found."""
    return ", ".join(f"{say(labels.code(name))} {value}" for name, value in values_found(check))


def values_found(check: Check) -> list[tuple[str, str]]:
    """Code and text of each quantity that a check found."""
    return [
        (name, "; ".join(value) if isinstance(value, list) else str(value))
        for name, value in check.found.items()
    ]


def mail(changes: ChangeReport, checks: Sequence[Check], simulated: bool) -> tuple[str, str]:
    """Subject and text of the mail, in Dutch."""
    say = speaker("nl")
    lines = headlines(changes, checks, say)
    marked = f"{say(labels.SIMULATED)}\n\n" if simulated else ""
    moved = [_line(line) for line in changes.lines[:LINES_IN_MAIL]]
    more = len(changes.lines) - len(moved)
    rest = [f"  + {more}"] if more > 0 else []
    return f"{say('Tow tests re-based')}: {lines[0]}", marked + "\n".join(
        [*lines, "", *moved, *rest]
    ) + "\n"


def _line(line: Row) -> str:
    """A changed line of a register, on a line of text."""
    ratio = "" if line["cw_ratio"] is None else f"Cw {100 * (line['cw_ratio'] - 1):+z.2f} %"
    crew = f"{line['rowers']}{line['crew_class']}"
    return f"  {line['to_edition']}: {line['fsn_no']} {crew} {line['change']} {ratio}".rstrip()


def headlines(changes: ChangeReport, checks: Sequence[Check], say: Say) -> list[str]:
    """What happened in a few lines, the most important first."""
    sentences = [*_wrong(checks, say), *_moved(changes, say)]
    return sentences or [say("Nothing changed since the last report.")]


def in_short(changes: ChangeReport, say: Say) -> str:
    """What changed, as sentences of one paragraph."""
    return " ".join(f"{line.rstrip('.')}." for line in headlines(changes, (), say))


def verdict(checks: Sequence[Check], say: Say) -> str:
    """Whether all is well, in a line; what Herijk itself failed on comes first."""
    if all(check.passed for check in checks):
        return say("In order: all {number} checks passed.", number=len(checks))
    return say("Not in order: {wrong}.", wrong="; ".join(_wrong(checks, say)))


FAILED: Final = {
    "tables_fit_their_schemas": say("tables do not fit their schemas"),
    "few_tows_set_aside": say("many tows are set aside"),
    "nothing_unforeseen": say(
        "Herijk itself failed; report this to its maintainer, with the folder unforeseen"
    ),
    "log_factors_stayed": say("log factors moved"),
    "boats_stayed_within_their_intervals": say("boats moved beyond their intervals"),
    "editions_can_be_made_again": say(
        "editions, or the files that they were made from, are not what they were"
    ),
    "every_listed_tow_accounted_for": say("listed tows are not accounted for"),
    "every_tow_has_a_curve_row": say("tows have no row among the curves"),
}
"""What it means that a check failed."""


def _wrong(checks: Sequence[Check], say: Say) -> Iterable[str]:
    for check in sorted(checks, key=lambda check: check.check != "nothing_unforeseen"):
        if not check.passed:
            outcome = say(labels.code(outcome_of(check)))
            failed = say(FAILED.get(check.check, check.check))
            yield f"{outcome}: {failed} ({found_in_words(check, say)})"


def _moved(changes: ChangeReport, say: Say) -> Iterable[str]:
    if changes.first:
        yield say("First report: everything is new.")
    if changes.seasons_gone:
        gone = ", ".join(map(str, changes.seasons_gone))
        yield f"{say('Seasons of which the archive has no tow any more')}: {gone}"
    for row in changes.methods:
        yield f"{say('Method')} {row['method']}: {say(labels.code(row['what']))}"
    counted = ((pgettext("number", "Tows"), changes.tows), (say("Set aside"), changes.set_aside))
    for title, rows in counted:
        if by_what := Counter(row["what"] for row in rows):
            parts = (f"{number} {say(labels.code(what))}" for what, number in by_what.items())
            yield f"{say(title)}: {', '.join(parts)}"
    if changes.factors:
        yield f"{say('Log factors that moved')}: {len(changes.factors)}"
    if changes.lines:
        beyond = len(changes.beyond_interval)
        title, of_them = say("Changed lines of the drafts"), say("beyond their interval")
        yield f"{title}: {len(changes.lines)}, {beyond} {of_them}"
