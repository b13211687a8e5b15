"""The report of a rebuild in words: headlines, and a mail. Its page is in `report_page`.

What changed is found out in `warehouse.queries.change_report`; texts are in `dashboards.words`.
"""

import re
from collections.abc import Iterable
from typing import Any, Final

from herijk.words.catalogue import Say, speaker

Report = dict[str, Any]

LINES_IN_MAIL: Final = 20
PAGES: Final = {"nl": "latest.html", "en": "latest.en.html"}
"""The page of each language."""


def outcome_of(check: Report) -> str:
    """Code of how a check ended."""
    return "passed" if check["passed"] else str(check["severity"]).lower()


def found_in_words(check: Report, say: Say) -> str:
    """What a check found."""
    return ", ".join(f"{say('code.' + name)} {value}" for name, value in values_found(check))


def values_found(check: Report) -> list[tuple[str, str]]:
    """Code and text of each quantity that a check found."""
    return [
        (name, "; ".join(value) if isinstance(value, list) else str(value))
        for name, value in check["found"].items()
    ]


def mail(report: Report) -> tuple[str, str]:
    """Subject and text of the mail, in Dutch."""
    say = speaker("nl")
    lines = headlines(report, say)
    marked = f"{say('simulated')}\n\n" if report["simulated"] else ""
    moved = [_line(line) for line in report["lines"][:LINES_IN_MAIL]]
    more = len(report["lines"]) - len(moved)
    rest = [f"  + {more}"] if more > 0 else []
    return f"{say('site')}: {lines[0]}", marked + "\n".join([*lines, "", *moved, *rest]) + "\n"


def _line(line: Report) -> str:
    """A changed line of a register, on a line of text."""
    ratio = "" if line["cw_ratio"] is None else f"Cw x {line['cw_ratio']:.4f}"
    crew = f"{line['rowers']}{line['crew_class']}"
    return f"  {line['to_edition']}: {line['fsn_no']} {crew} {line['change']} {ratio}".rstrip()


def headlines(report: Report, say: Say) -> list[str]:
    """What happened in a few lines, the most important first."""
    sentences = [*_wrong(report, say), *_moved(report, say)]
    return sentences or [say("report_nothing")]


def in_short(report: Report, say: Say) -> str:
    """The headlines as sentences of one paragraph."""
    return " ".join(f"{line.rstrip('.')}." for line in headlines(report, say))


def with_later_rebuild(page: str, made_at: str, say: Say) -> str:
    """The page about a rebuild, saying that one after it changed nothing."""
    text = say("report_later").format(made_at=minutes_of(made_at))
    return _LATER.sub(f"{LATER}{text}", page)


def minutes_of(made_at: str) -> str:
    """A moment as people read it, to the minute."""
    return made_at.replace("T", " ")[:16]


LATER: Final = "<!-- later -->"
"""Where the page about a rebuild says what came after it."""

_LATER: Final = re.compile(f"{LATER}.*")


def _wrong(report: Report, say: Say) -> Iterable[str]:
    failed = [c for c in report["checks"] if not c["passed"]]
    for check in failed:
        outcome = say(f"code.{outcome_of(check)}")
        yield f"{outcome}: {say('failed.' + check['check'])} ({found_in_words(check, say)})"


def _moved(report: Report, say: Say) -> Iterable[str]:
    if report["first"]:
        yield say("report_first")
    counted = (("report_tows", "tows"), ("report_set_aside", "set_aside"))
    for title, kind in counted:
        by_what: dict[str, int] = {}
        for row in report[kind]:
            by_what[row["what"]] = by_what.get(row["what"], 0) + row["number"]
        if by_what:
            parts = (f"{number} {say('code.' + what)}" for what, number in by_what.items())
            yield f"{say(title)}: {', '.join(parts)}"
    if report["factors"]:
        yield f"{say('report_factors')}: {len(report['factors'])}"
    if report["lines"]:
        beyond = report["beyond_interval"]
        yield f"{say('report_lines')}: {len(report['lines'])}, {beyond} {say('report_beyond')}"
