"""`herijk doctor`: whether this machine and this data folder can do their work."""

import shutil
import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from herijk.cli.arguments import AsJson, DataFolder, show
from pipeline.errors import HerijkError
from pipeline.messages import LANGUAGE, say, spoken, tell

if TYPE_CHECKING:
    from warehouse.queries.reports import RebuildReport
    from warehouse.store.methods import KnownMethods

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
class Findings:
    """Everything that was looked at."""

    findings: list[Finding]


def doctor(
    data: DataFolder = Path("data"),
    archive: Annotated[
        Path | None,
        typer.Option(envvar="HERIJK_ARCHIVE", help="The archive folder, if any.", metavar="DIR"),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Check that machine, settings, data folder and archive are in order."""
    report = Findings(list(_findings(data, archive)))
    show(report, _text, as_json)
    if not all(finding.sound for finding in report.findings):
        raise typer.Exit(1)


def _findings(data: Path, archive: Path | None) -> Iterator[Finding]:
    from importlib.metadata import version

    from assets.settings import applied
    from herijk.cli.methods import known_methods
    from warehouse.queries.reports import rebuild_report
    from warehouse.store.lock import only_writer
    from warehouse.store.store import Store

    yield Finding("Herijk", True, version("herijk"))
    yield Finding("Python", True, sys.version.split()[0])
    yield _space(data)
    yield _tried(say("settings"), lambda: tell("applies {}", ", ".join(applied(data))))
    known = known_methods(data)
    for name in known.own:
        yield _tried(tell("method {}", name), partial(_title, known, name))
    if data.is_dir():
        yield _tried(say("lock"), lambda: _taken(only_writer(data)))
        yield _tried(say("tables"), lambda: _tows(rebuild_report(Store(data))))
    else:
        yield Finding(
            say("data folder"), True, tell("{} is not there yet; a rebuild makes it", data)
        )
    if archive is not None:
        there = archive.is_dir()
        said = str(archive) if there else tell("{} is not a folder", archive)
        yield Finding(say("archive"), there, said)


def _space(data: Path) -> Finding:
    nearest = next(
        folder for folder in (data.resolve(), *data.resolve().parents) if folder.exists()
    )
    free = shutil.disk_usage(nearest).free
    return Finding(
        say("disk"), free >= LEAST_FREE, tell("{:.1f} GB free at {}", free / 2**30, nearest)
    )


def _tried(what: str, look: Callable[[], str]) -> Finding:
    try:
        return Finding(what, True, look())
    except (HerijkError, OSError) as error:
        return Finding(what, False, spoken(error, LANGUAGE.get()))


def _title(known: "KnownMethods", name: str) -> str:
    return known.get(name).title


def _taken(lock: AbstractContextManager[None]) -> str:
    with lock:
        return tell("free")


def _tows(report: "RebuildReport") -> str:
    tows = sum(season["tows"] for season in report.seasons)
    return tell("{} tows in {} seasons", tows, len(report.seasons))


def _text(report: Findings) -> str:
    return "\n".join(
        f"{tell('ok' if f.sound else 'WRONG'):5}  {tell(f.what)}: {f.found}"
        for f in report.findings
    )
