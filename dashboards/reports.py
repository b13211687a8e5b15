"""What a rebuild changed and what its checks say: headlines, a page beside the site, and a mail."""

import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Final

import polars as pl

from dashboards import words
from dashboards.document import Document
from dashboards.language import Language, get_other_language
from dashboards.page import render_page
from dashboards.reading import read_blocks
from pipeline.messages import LANGUAGES
from warehouse.queries.change_report import ChangeReport
from warehouse.queries.views import Views
from warehouse.store.store import Store

PAGES: Final = {"nl": "latest.html", "en": "latest.en.html"}
"""The page of each language."""

MAX_LINES_IN_MAIL: Final = 20

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
        passed: whether it found nothing.
        severity: Dagster's word.
        found: values by the code of their quantity.
    """

    asset: str
    check: str
    passed: bool
    severity: str
    found: Mapping[str, object]

    @property
    def outcome(self) -> str:
        """The code of how the check ended."""
        return "passed" if self.passed else str(self.severity).lower()

    @property
    def values(self) -> list[tuple[str, str]]:
        """Code and text of each quantity that the check found."""
        return [
            (name, "; ".join(value) if isinstance(value, list) else str(value))
            for name, value in self.found.items()
        ]


def write_headlines(
    changes: ChangeReport, checks: Sequence[Check], language: str = "en"
) -> list[str]:
    """Return the news of a rebuild in a few lines, the most important first."""
    return _read_texts("news", language, changes=changes, checks=order_checks(checks))


def write_check(check: Check, language: str) -> str:
    """Return the findings of a check as text."""
    name_code = Language(language).name_code
    return ", ".join(f"{name_code(name)} {value}" for name, value in check.values)


def order_checks(checks: Sequence[Check]) -> list[Check]:
    """Return checks with what Herijk itself failed on first."""
    return sorted(checks, key=lambda check: check.check != "nothing_unforeseen")


def make_report_pages(
    store: Store, changes: ChangeReport, checks: Sequence[Check], run: LastRun
) -> dict[str, str]:
    """Return the page about a rebuild by its file name, in each language.

    It has what came in, what was set aside, what changed and why, what the checks say, and when and
    how the last run ended.
    """
    of_checks = [
        {"check": check.check, "outcome": check.outcome, "number": name, "value": value}
        for check in sorted(checks, key=lambda check: check.passed)
        for name, value in ([("", "")] if check.passed else check.values)
    ]
    data = {
        "changes": changes,
        "checks": order_checks(checks),
        "run": run,
        "moment": show_minute(run.changed_at),
        "rows_of_checks": of_checks,
    }
    to_frame = partial(pl.DataFrame, infer_schema_length=None)
    frames = {
        "lines": to_frame(changes.lines),
        "tows": to_frame(changes.tows),
        "set_aside": to_frame(changes.set_aside),
        "factors": to_frame(changes.factors),
    }
    with Views(store) as views:
        about = views.about()
    pages = {}
    for language in LANGUAGES:
        other = get_other_language(language)
        pages[PAGES[language]] = render_page(
            PAGES[language], "report", data | frames, language, about, "../site/", PAGES[other]
        )
    return pages


def write_mail(
    changes: ChangeReport, checks: Sequence[Check], simulated: bool, run: LastRun
) -> tuple[str, str]:
    """Return subject and text of the mail about a rebuild, in Dutch."""
    dutch = Language("nl")
    headlines = write_headlines(changes, checks, "nl")
    lines = _read_texts("mail", "nl", changes=changes, checks=order_checks(checks), run=run)
    moved = _read_texts("mail_lines", "nl", lines=changes.lines[:MAX_LINES_IN_MAIL])
    n_more = len(changes.lines) - len(moved)
    text = [
        *([dutch.say(words.SIMULATED), ""] if simulated else []),
        *lines,
        "",
        textwrap.indent("\n".join(moved), "  "),
        *([f"  + {n_more}"] if n_more > 0 else []),
    ]
    return f"{dutch.fill_in('Tow tests re-based')}: {headlines[0]}", "\n".join([*text, ""])


def _read_texts(template: str, language: str, **data: object) -> list[str]:
    """Return the texts of a document, one a block."""
    html = Document(Language(language)).render(template, **data)
    return [block.text for block in read_blocks(html)]


def show_minute(moment: str) -> str:
    """Return a moment of ISO 8601 as a date and a time in minutes."""
    return moment[:16].replace("T", " ")
