"""What a rebuild did, when, and how it ended; what changed; and the pages that say so.

`report/latest.json` is about the last run, also one that changed nothing or failed. Each change has
a dated file of its own beside it. The page shows the last change, and when and how the last run
ended: a quiet night differs from one on which nothing ran.
"""

import datetime as dt
import json
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import Any, Final

import polars as pl

from dashboards.reports import (
    CHANGED,
    FAILED,
    UNCHANGED,
    Check,
    LastRun,
    make_report_pages,
    write_check,
    write_headlines,
)
from pipeline.errors import HerijkError
from pipeline.messages import LANGUAGE
from warehouse.queries.change_report import ChangeReport, change_report, read_last_changes, remember
from warehouse.store.code import code_version
from warehouse.store.files import write_beside
from warehouse.store.store import Store

ERROR: Final = "ERROR"
"""Dagster's word for a check whose failing means that a table is not what it promises."""


@dataclass
class Done:
    """What a rebuild did: seasons read again, methods applied again, database made again."""

    seasons: list[int] = field(default_factory=list)
    methods: list[str] = field(default_factory=list)
    database: bool = False


@dataclass(frozen=True, kw_only=True)
class Report(ChangeReport):
    """What a rebuild did, what that changed, and what the checks say.

    Attributes:
        nothing_changed: whether that is so.
        made_at: when the last run ended, ISO 8601.
        outcome: how it ended: changed, unchanged or failed.
        reason: why it failed; else empty.
        changed_at: when a run last changed something, ISO 8601.
        archive: where it is.
        simulated: whether the archive is.
        code_version: of the code that made the tables.
        headlines: the news in English.
    """

    nothing_changed: bool
    made_at: str
    outcome: str
    reason: str
    changed_at: str
    archive: str
    simulated: bool
    code_version: str
    done: Done
    checks: list[Check]
    headlines: list[str]

    @property
    def last_run(self) -> LastRun:
        """When and how the last run ended, and when one last changed something."""
        return LastRun(self.made_at, self.outcome, self.reason, self.changed_at)


def write_report(store: Store, check_results: pl.DataFrame, now: dt.datetime) -> Report:
    """Report on the tables as they are: what changed since the last report, and the checks."""
    changes = change_report(store)
    about = store.read("about_archive")
    checks = read_checks(check_results)
    moment = now.isoformat(timespec="seconds")
    before = _read_latest(store)
    report = Report(
        **vars(changes),
        nothing_changed=changes.nothing,
        made_at=moment,
        outcome=UNCHANGED if changes.nothing else CHANGED,
        reason="",
        changed_at=str(before["changed_at"]) if changes.nothing and before else moment,
        archive=about["root"][0],
        simulated=about["simulated"][0],
        code_version=code_version(),
        done=Done(),
        checks=checks,
        headlines=write_headlines(changes, checks),
    )
    if not changes.nothing:
        _write(store.root / "report" / f"{now:%Y-%m-%dT%H%M%S}.json", _to_json(report))
    _publish(store, report, changes if not changes.nothing else read_last_changes(store))
    remember(store)
    return report


def confirm_report(store: Store, now: dt.datetime) -> Report:
    """Report on a run that found nothing to do."""
    return _end_run(store, now, UNCHANGED, "")


def record_failure(store: Store, now: dt.datetime, reason: str) -> None:
    """Note that a run failed, and why; do nothing where no run ever ended well.

    What made the run fail may also prevent the note, such as a full disk: it is then left out.
    """
    with suppress(HerijkError, OSError):
        if _read_latest(store) is not None:
            _end_run(store, now, FAILED, reason)


def read_report(store: Store, done: Done) -> Report:
    """Return the report of the last run, with what the run did."""
    stored = _read_latest(store)
    if stored is None:
        raise FileNotFoundError(_latest_path(store))
    checks = [Check(**check) for check in stored.pop("checks")]
    stored.pop("done")
    return Report(**stored, checks=checks, done=done)


def read_checks(check_results: pl.DataFrame) -> list[Check]:
    """Return the rows of `check_results` as checks."""
    checks = []
    for row in check_results.iter_rows(named=True):
        passed = row["number"] == 0
        found_there = {"number": row["number"], "first": row["first"]}
        checks.append(Check(row["asset"], row["check"], passed, row["severity"], found_there))
    return checks


def failed_checks(checks: Sequence[Check]) -> list[str]:
    """Return a sentence for each check whose failing breaks a promise of a table."""
    broken = [check for check in checks if not check.passed and check.severity == ERROR]
    return [f"{check.check}: {write_check(check, LANGUAGE.get())}" for check in broken]


def _end_run(store: Store, now: dt.datetime, outcome: str, reason: str) -> Report:
    """Report on a run that changed no table."""
    last = read_last_changes(store)
    nothing: dict[str, Any] = {
        one.name: [] for one in fields(ChangeReport) if one.name not in ("first", "judged")
    }
    report = replace(
        read_report(store, Done()),
        **nothing,
        first=False,
        nothing_changed=True,
        made_at=now.isoformat(timespec="seconds"),
        outcome=outcome,
        reason=reason,
    )
    report = replace(report, headlines=write_headlines(report, report.checks))
    _publish(store, report, last)
    return report


def _publish(store: Store, report: Report, shown: ChangeReport | None) -> None:
    """Write the report of the last run, and the page with the last change.

    Args:
        store: the data folder.
        report: the last run.
        shown: the last change.
    """
    _write(_latest_path(store), _to_json(report))
    if shown is None or not store.database.exists():
        return
    for name, page in make_report_pages(store, shown, report.checks, report.last_run).items():
        _write(store.root / "report" / name, page)


def _latest_path(store: Store) -> Path:
    return store.root / "report" / "latest.json"


def _read_latest(store: Store) -> dict[str, Any] | None:
    """Return the report of the last run; None where none ended well or the file is not ours."""
    try:
        stored: Mapping[str, Any] = json.loads(_latest_path(store).read_text(encoding="utf-8"))
    except (FileNotFoundError, ValueError):
        return None
    known = {one.name for one in fields(Report)}
    return dict(stored) if set(stored) == known else None


def _to_json(report: Report) -> str:
    return json.dumps(asdict(report), default=str, indent=1)


def _write(path: Path, text: str) -> None:
    with write_beside(path) as beside:
        beside.write_text(text, encoding="utf-8")
