"""`herijk check`: how an archive, this machine and a data folder are."""

import shutil
import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Final

from assets.settings import applied
from herijk.cli.render import place
from pipeline.errors import HerijkError
from pipeline.messages import LANGUAGE, say, spoken, tell
from warehouse.archive.check import CauseReport, CheckReport, check_archive, check_report
from warehouse.queries.reports import RebuildReport, rebuild_report
from warehouse.store.lock import only_writer
from warehouse.store.methods import KnownMethods
from warehouse.store.store import Store

LEAST_FREE: Final = 2 * 2**30
"""Bytes: a rebuild writes some 4 MB per tow, and everything beside the old before it is swapped."""


@dataclass(frozen=True)
class Finding:
    """How one thing is.

    Attributes:
        what: what was looked at.
        sound: whether it is in order.
        found: what was found, or what to do.
    """

    what: str
    sound: bool
    found: str


@dataclass(frozen=True)
class Checked:
    """What `herijk check` found.

    Attributes:
        findings: how machine, settings and data folder are.
        archive: what is wrong in the archive; None where none was named.
    """

    findings: list[Finding]
    archive: CheckReport | None

    @property
    def sound(self) -> bool:
        """Whether everything is in order."""
        causes = self.archive.causes if self.archive else []
        return not causes and all(finding.sound for finding in self.findings)


def checked(archive: Path | None, data: Path) -> Checked:
    """Looks at everything, the archive only where one is named."""
    found = None
    if archive is not None:
        found = check_report(archive, check_archive(archive), LANGUAGE.get())
    return Checked(list(_findings(data)), found)


def _findings(data: Path) -> Iterator[Finding]:
    yield Finding("Herijk", True, f"{version('herijk')}, Python {sys.version.split()[0]}")
    yield _space(data)
    yield _tried(say("settings"), lambda: tell("applies {}", ", ".join(applied(data))))
    known = KnownMethods.of(Store(data))
    for name in known.own:
        yield _tried(tell("method {}", name), partial(_title, known, name))
    if data.is_dir():
        yield _tried(say("lock"), lambda: _taken(only_writer(data)))
        yield _tried(say("tables"), lambda: _tows(rebuild_report(Store(data))))
    else:
        there_later = tell("{} is not there yet; a rebuild makes it", data)
        yield Finding(say("data folder"), True, there_later)


def _space(data: Path) -> Finding:
    folders = (data.resolve(), *data.resolve().parents)
    nearest = next(folder for folder in folders if folder.exists())
    free = shutil.disk_usage(nearest).free
    said = tell("{:.1f} GB free at {}", free / 2**30, nearest)
    return Finding(say("disk"), free >= LEAST_FREE, said)


def _tried(what: str, look: Callable[[], str]) -> Finding:
    try:
        return Finding(what, True, look())
    except (HerijkError, OSError) as error:
        return Finding(what, False, spoken(error, LANGUAGE.get()))


def _title(known: KnownMethods, name: str) -> str:
    return known.get(name).title


def _taken(lock: AbstractContextManager[None]) -> str:
    with lock:
        return tell("free")


def _tows(report: RebuildReport) -> str:
    tows = sum(season["tows"] for season in report.seasons)
    return tell("{} tows in {} seasons", tows, len(report.seasons))


def text(report: Checked) -> str:
    """What is wrong in the archive, a paragraph per cause; then the machine, a line per finding."""
    findings = [
        f"{tell('ok' if f.sound else 'WRONG'):5}  {tell(f.what)}: {f.found}"
        for f in report.findings
    ]
    of_archive = [] if report.archive is None else archive_text(report.archive)
    return "\n\n".join([*of_archive, "\n".join(findings)])


def archive_text(report: CheckReport) -> list[str]:
    """What is wrong in an archive, a paragraph per cause."""
    if not report.causes:
        return [tell("Nothing is wrong in the lists and headers of {} tows.", report.tows)]
    head = tell(
        "Causes: {}; places: {}. As it is, {} tows are left for a rebuild to judge.",
        len(report.causes),
        sum(cause.number for cause in report.causes),
        report.tows,
    )
    return [head, *map(_cause, report.causes)]


def _cause(cause: CauseReport) -> str:
    lines = [f"{cause.number} x {cause.reason_code}: {cause.sentence}"]
    if len(cause.cells) > 1:
        cells = ", ".join(f"'{cell}'" for cell in cause.cells[1:9])
        lines.append(f"    {tell('There is also: {}', cells)}")
    lines += [f"    {place(vars(one))}" for one in cause.places]
    if cause.number > len(cause.places):
        lines.append(f"    {tell('and {} more', cause.number - len(cause.places))}")
    lines += [f"  > archief.toml: {line}" for line in cause.settings]
    return "\n".join(lines)
