"""`herijk check`: how an archive, this machine and a data folder are."""

import shutil
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Final

from assets.settings import applied
from herijk.cli.render import place
from pipeline.errors import HerijkError
from pipeline.messages import LANGUAGE, say, spoken, tell
from warehouse.archive.check import CauseReport, CheckReport, check_archive
from warehouse.queries.reports import rebuild_report
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
        found = check_archive(archive, LANGUAGE.get())
    return Checked(list(_findings(data)), found)


def _findings(data: Path) -> Iterator[Finding]:
    """How the machine, the settings, each method and the tables are."""
    yield Finding("Herijk", True, f"{version('herijk')}, Python {sys.version.split()[0]}")
    yield _space(data)
    known = KnownMethods.of(Store(data))
    looks: dict[str, Callable[[], str]] = {say("settings"): partial(_applied, data)}
    for name in known.own:
        looks[tell("method {}", name)] = partial(_title, known, name)
    if data.is_dir():
        looks |= {say("lock"): partial(_free, data), say("tables"): partial(_tows, data)}
    for what, look in looks.items():
        try:
            yield Finding(what, True, look())
        except (HerijkError, OSError) as error:
            yield Finding(what, False, spoken(error, LANGUAGE.get()))


def _space(data: Path) -> Finding:
    folders = (data.resolve(), *data.resolve().parents)
    nearest = next(folder for folder in folders if folder.exists())
    free = shutil.disk_usage(nearest).free
    said = tell("{:.1f} GB free at {}", free / 2**30, nearest)
    return Finding(say("disk"), free >= LEAST_FREE, said)


def _applied(data: Path) -> str:
    return tell("applies {}", ", ".join(applied(data)))


def _title(known: KnownMethods, name: str) -> str:
    return known.get(name).title


def _free(data: Path) -> str:
    with only_writer(data):
        return tell("free")


def _tows(data: Path) -> str:
    seasons = rebuild_report(Store(data)).seasons
    return tell("{} tows in {} seasons", sum(row["tows"] for row in seasons), len(seasons))


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
