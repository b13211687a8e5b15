"""What a rebuild leaves to be read: a page, JSON, and a message to anyone who wants one.

They are under `report/` in the data folder: `latest.json` about the last rebuild; `latest.html`
about the last that changed something, with the day of the last one after it that changed nothing;
and a dated JSON for each that changed something.
"""

import datetime as dt
import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from herijk.assets.notify import Message, Notifier
from herijk.dashboards.report import (
    PAGES,
    found_in_words,
    headlines,
    mail,
    with_later_rebuild,
)
from herijk.warehouse.build.version import code_version
from herijk.warehouse.queries.change_report import as_plain, change_report, remember
from herijk.warehouse.store.files import written_beside
from herijk.warehouse.store.store import Store
from herijk.words import LANGUAGE
from herijk.words.catalogue import speaker

if TYPE_CHECKING:  # Dagster takes two seconds, and only a rebuild with work to do needs it
    import dagster as dg

Report = dict[str, Any]

ERROR: Final = "ERROR"
"""Dagster's word for a check whose failing means that a table is not what it promises."""


def write_report(
    store: Store, done: Report, checks: Sequence["dg.AssetCheckEvaluation"], now: dt.datetime
) -> Report:
    """Finds out what changed, writes page and JSON, and returns the JSON as plain data.

    Where nothing changed, the page about the last change stays, and says so.
    """
    changes = change_report(store)
    about = store.read("about_archive")
    report = {
        "made_at": now.isoformat(timespec="seconds"),
        "archive": about["root"][0],
        "simulated": about["simulated"][0],
        "code_version": code_version(),
        "done": done,
        **as_plain(changes),
        "checks": [_plain(check) for check in checks],
    }
    report["headlines"] = headlines(report, speaker("en"))
    text = json.dumps(report, default=str, indent=1)
    folder = store.root / "report"
    if not changes.nothing:
        from herijk.dashboards.report_page import report_pages  # noqa: PLC0415 - Altair takes a second

        for name, page in report_pages(store, changes, report).items():
            _write(folder / name, page)
        _write(folder / f"{now:%Y-%m-%dT%H%M%S}.json", text)
    else:
        for language, name in PAGES.items():
            path = folder / name
            if path.exists():
                shown = path.read_text(encoding="utf-8")
                _write(path, with_later_rebuild(shown, report["made_at"], speaker(language)))
    _write(folder / "latest.json", text)
    remember(store)
    return report


def _plain(check: "dg.AssetCheckEvaluation") -> Report:
    return {
        "asset": check.asset_key.to_user_string(),
        "check": check.check_name,
        "passed": check.passed,
        "severity": check.severity.value,
        "found": {name: value.value for name, value in check.metadata.items()},
    }


def _write(path: Path, text: str) -> None:
    with written_beside(path) as beside:
        beside.write_text(text, encoding="utf-8")


def failed_checks(report: Report) -> list[str]:
    """Checks whose failing means that a table is not what it promises."""
    return [
        f"{check['check']}: {found_in_words(check, speaker(LANGUAGE.get()))}"
        for check in report["checks"]
        if not check["passed"] and check["severity"] == ERROR
    ]


def tell(notifier: Notifier, report: Report) -> list[str]:
    """Sends the report to those who want it, where something changed or a check failed.

    Returns:
        A sentence for each message that could not be sent.
    """
    if report["nothing_changed"] and not failed_checks(report):
        return []
    subject, text = mail(report)
    return notifier.send(Message(subject, text, report, _now()))


def tell_failure(notifier: Notifier, failure: str) -> list[str]:
    """Says that a rebuild that nobody watched could not be done."""
    subject = speaker("nl")("report_failed")
    return notifier.send(Message(subject, f"{failure}\n", {"failed": failure}, _now()))


def _now() -> dt.datetime:
    return dt.datetime.now().astimezone()
