"""What a rebuild leaves to be read: a page and JSON.

They are under `report/` in the data folder: `latest.json` about the last rebuild; `latest.html`
about the last that changed something, and a dated JSON for each that did.
"""

import datetime as dt
import json
from collections.abc import Collection, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Final

from dashboards.speech import Speech
from dashboards.statements.rebuild import Check, found, headlines
from pipeline.messages import LANGUAGE
from warehouse.queries.change_report import ChangeReport, change_report, remember
from warehouse.store.code import code_version
from warehouse.store.files import written_beside
from warehouse.store.store import Store

if TYPE_CHECKING:  # Dagster takes two seconds, and only a rebuild with work to do needs it
    import dagster as dg

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
        made_at: the moment, ISO 8601.
        archive: where it is.
        simulated: whether the archive is.
        code_version: of the code that made the tables.
        headlines: the news in English.
    """

    nothing_changed: bool
    made_at: str
    archive: str
    simulated: bool
    code_version: str
    done: Done
    checks: list[Check]
    headlines: list[str]


def write_report(store: Store, now: dt.datetime) -> Report:
    """Finds out what changed, and writes page and JSON; the page about the last change stays."""
    changes = change_report(store)
    about = store.read("about_archive")
    checks: list[Check] = []
    report = Report(
        **vars(changes),
        nothing_changed=changes.nothing,
        made_at=now.isoformat(timespec="seconds"),
        archive=about["root"][0],
        simulated=about["simulated"][0],
        code_version=code_version(),
        done=Done(),
        checks=checks,
        headlines=[line(Speech("en")) for line in headlines(changes, checks)],
    )
    text = json.dumps(asdict(report), default=str, indent=1)
    folder = store.root / "report"
    if not changes.nothing:
        from dashboards.report_page import report_pages  # noqa: PLC0415 - Altair takes a second

        for name, page in report_pages(store, changes, checks, f"{now:%Y-%m-%d %H:%M}").items():
            _write(folder / name, page)
        _write(folder / f"{now:%Y-%m-%dT%H%M%S}.json", text)
    _write(folder / "latest.json", text)
    remember(store)
    return report


def read_report(
    store: Store,
    checks: Sequence[Check] = (),
    nothing_changed: bool = False,
    made: Collection[str] = (),
) -> Report:
    """The last report, with what a run made and checked; or that nothing changed since."""
    kept = json.loads((store.root / "report" / "latest.json").read_text(encoding="utf-8"))
    seasons = {tow["season"] for tow in kept["tows"]} if "samples" in made else ()
    methods = store.read("methods")["method"].to_list() if "curves" in made else []
    kept["done"] = Done(sorted(seasons), methods, "warehouse_database" in made)
    kept["checks"] = list(checks)
    if nothing_changed:
        empty = ("tows", "seasons_gone", "methods", "set_aside", "factors", "lines", "headlines")
        kept |= {"nothing_changed": True, "first": False} | {name: [] for name in empty}
    return Report(**kept)


def check_of(evaluated: "dg.AssetCheckEvaluation") -> Check:
    """What a check said."""
    return Check(
        asset=evaluated.asset_key.to_user_string(),
        check=evaluated.check_name,
        passed=evaluated.passed,
        severity=evaluated.severity.value,
        found={name: value.value for name, value in evaluated.metadata.items()},
    )


def _write(path: Path, text: str) -> None:
    with written_beside(path) as beside:
        beside.write_text(text, encoding="utf-8")


def failed_checks(checks: Sequence[Check]) -> list[str]:
    """Checks whose failing means that a table is not what it promises."""
    speech = Speech(LANGUAGE.get())
    return [
        f"{check.check}: {found(check)(speech)}"
        for check in checks
        if not check.passed and check.severity == ERROR
    ]
