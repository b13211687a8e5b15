"""`herijk check`: how an archive, this machine and a data folder are."""

import shutil
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Final

from assets.settings import applied
from herijk.cli.render import place
from pipeline.errors import HerijkError
from pipeline.messages import LANGUAGE, say, spoken, tell
from warehouse.archive.check import CauseReport, CheckReport, check_archive
from warehouse.queries.reports import rebuild_report
from warehouse.store.lock import hold_write_lock
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


def checked(archive: Path | None, store: Store) -> Checked:
    """Looks at everything, the archive only where one is named."""
    found = None if archive is None else check_archive(archive, LANGUAGE.get())
    return Checked(list(_findings(store)), found)


def _findings(store: Store) -> Iterator[Finding]:
    """How the machine, the settings, each method and the tables are."""
    yield Finding("Herijk", True, f"{version('herijk')}, Python {sys.version.split()[0]}")
    folder = store.root.resolve()
    nearest = next(part for part in (folder, *folder.parents) if part.exists())
    free = shutil.disk_usage(nearest).free
    said = tell("{:.1f} GB free at {}", free / 2**30, nearest)
    yield Finding(say("disk"), free >= LEAST_FREE, said)
    known = KnownMethods.of(store)
    yield _looked(say("settings"), lambda: tell("applies {}", ", ".join(applied(store.root))))
    for name in known.own:
        yield _looked(tell("method {}", name), lambda: known.get(name).title)  # noqa: B023
    if store.root.is_dir():
        yield _looked(say("lock"), lambda: _free(store))
        yield _looked(say("tables"), lambda: _tows(store))


def _looked(what: str, look: Callable[[], str]) -> Finding:
    """What is found; an error says what is wrong."""
    try:
        return Finding(what, True, look())
    except (HerijkError, OSError) as error:
        return Finding(what, False, spoken(error, LANGUAGE.get()))


def _free(store: Store) -> str:
    with hold_write_lock(store.root):
        return tell("free")


def _tows(store: Store) -> str:
    seasons = rebuild_report(store).seasons
    return tell("{} tows in {} seasons", sum(row["tows"] for row in seasons), len(seasons))


def text(report: Checked) -> list[str]:
    """What is wrong in the archive, a paragraph per cause; then the machine, a line per finding."""
    findings = [
        f"{tell('ok' if f.sound else 'WRONG'):5}  {tell(f.what)}: {f.found}"
        for f in report.findings
    ]
    of_archive = [] if report.archive is None else archive_text(report.archive)
    return [*of_archive, "\n".join(findings)]


def archive_text(report: CheckReport) -> list[str]:
    """What is wrong in an archive, a paragraph per cause."""
    if not report.causes:
        return [tell("Nothing is wrong in lists and headers. Tows: {}.", report.tows)]
    head = tell(
        "Causes: {}; places: {}. Tows that are left for a rebuild to judge: {}.",
        len(report.causes),
        sum(cause.number for cause in report.causes),
        report.tows,
    )
    asks = any(cause.ask for cause in report.causes)
    told = tell(
        "Lines with a > are for archief.toml: replace each ? by the answer, and leave out a line "
        "that is not needed. A heading such as [words] stands there once."
    )
    return [head, *([told] if asks else []), *map(_cause, report.causes)]


def _cause(cause: CauseReport) -> str:
    lines = [
        f"{cause.number} x {cause.reason_code}: {cause.sentence}",
        f"    {tell('What to do: {}', cause.remedy)}",
    ]
    if cause.tows:
        lines.append(f"    {tell('Tows that this costs: {}', cause.tows)}")
    if len(cause.cells) > 1:
        cells = ", ".join(f"'{cell}'" for cell in cause.cells[1:9])
        lines.append(f"    {tell('There is also: {}', cells)}")
    lines += [f"    {place(vars(one))}" for one in cause.places]
    if cause.number > len(cause.places):
        lines.append(f"    {tell('and {} more', cause.number - len(cause.places))}")
    headings: dict[str, list[str]] = {}
    for block in cause.ask:
        heading, _, line = block.rpartition("\n")
        headings.setdefault(heading, []).append(line)
    for heading, answers in headings.items():
        lines += [f"  > {line}" for line in [*heading.split("\n"), *answers]]
    return "\n".join(lines)
