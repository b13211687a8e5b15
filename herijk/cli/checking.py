"""`herijk check`: how an archive, this machine and a data folder are."""

import shutil
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Final

from assets.settings import choose_methods
from pipeline.errors import HerijkError
from pipeline.messages import LANGUAGE, say, tell, write_in_language
from warehouse.archive.check import CauseReport, CheckReport, check_archive
from warehouse.queries.reports import rebuild_report
from warehouse.store.lock import hold_write_lock
from warehouse.store.methods import KnownMethods
from warehouse.store.store import Store

MIN_FREE_BYTES: Final = 2 * 2**30
"""A rebuild writes some 4 MB per tow, and everything beside the old before it is swapped."""


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


def check_everything(archive: Path | None, store: Store) -> Checked:
    """Look at everything, at the archive only where one is named."""
    found = None if archive is None else check_archive(archive, LANGUAGE.get())
    return Checked(list(_list_findings(store)), found)


def _list_findings(store: Store) -> Iterator[Finding]:
    """Yield how the machine, the settings, each method and the tables are."""
    yield Finding("Herijk", True, f"{version('herijk')}, Python {sys.version.split()[0]}")
    folder = store.root.resolve()
    nearest = next(part for part in (folder, *folder.parents) if part.exists())
    free = shutil.disk_usage(nearest).free
    said = tell("{:.1f} GB free at {}", free / 2**30, nearest)
    yield Finding(say("disk"), free >= MIN_FREE_BYTES, said)
    known = KnownMethods.from_store(store)
    yield _look_at(
        say("settings"), lambda: tell("applies {}", ", ".join(choose_methods(store.root)))
    )
    for name in known.own:
        yield _look_at(tell("method {}", name), lambda: known.get(name).title)  # noqa: B023
    if store.root.is_dir():
        yield _look_at(say("lock"), lambda: _check_lock(store))
        yield _look_at(say("tables"), lambda: _count_tows(store))


def _look_at(what: str, look: Callable[[], str]) -> Finding:
    """Return what is found; an error says what is wrong."""
    try:
        return Finding(what, True, look())
    except (HerijkError, OSError) as error:
        return Finding(what, False, write_in_language(error, LANGUAGE.get()))


def _check_lock(store: Store) -> str:
    with hold_write_lock(store.root):
        return tell("free")


def _count_tows(store: Store) -> str:
    seasons = rebuild_report(store).seasons
    return tell("{} tows in {} seasons", sum(row["tows"] for row in seasons), len(seasons))


def list_answers(cause: CauseReport) -> list[str]:
    """Return the lines of `archief.toml` that would answer a cause, each heading once."""
    headings: dict[str, list[str]] = {}
    for block in cause.ask:
        heading, _, line = block.rpartition("\n")
        headings.setdefault(heading, []).append(line)
    lines = []
    for heading, answers in headings.items():
        lines += [*heading.split("\n"), *answers]
    return lines
