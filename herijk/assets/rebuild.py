"""A rebuild: the assets that are stale are made again, in one run of Dagster; then a report.

What is stale is known from fingerprints. Dagster is imported when there is work to do: looking
that there is none takes a second, importing it two.
"""

import datetime as dt
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from herijk.assets.progress import Progress
from herijk.assets.report import Done, Report, write_report
from herijk.assets.settings import read_settings
from herijk.assets.site_state import SITE_TABLE, site_is_stale
from herijk.pipeline.errors import MissingKnowledgeError
from herijk.pipeline.method.definition import Method
from herijk.warehouse.build.graph import DATABASE, STEPS
from herijk.warehouse.build.mending import mending
from herijk.warehouse.intake import seasons as intake
from herijk.warehouse.queries.change_report import is_reported
from herijk.warehouse.store.lock import only_writer
from herijk.warehouse.store.machine_faults import machine_faults_explained
from herijk.warehouse.store.methods import KnownMethods
from herijk.warehouse.store.store import Store

if TYPE_CHECKING:
    import dagster as dg


def rebuild(
    archive: Path,
    data: Path,
    methods: Sequence[str],
    progress: Progress,
    seasons: Collection[int] | None = None,
) -> Report:
    """Brings the data folder up to date with the archive, and reports what that changed.

    Files of ours that turn out to be damaged are made again. Where the archive changes during the
    rebuild, it begins again.

    Args:
        archive: the archive folder.
        data: the data folder; made if it is not there.
        methods: names of methods; the first is what the others are compared with.
        progress: is told what happens.
        seasons: seasons to read; None for all. Others stay as they are.

    Raises:
        HerijkError: there is no archive, a promise was broken, another rebuild is at work, or the
            machine is in the way.
    """
    check_apart(archive, data)
    with machine_faults_explained(data):
        read_settings(data)
    with machine_faults_explained(data), only_writer(data):
        store, done = Store(data), Done()
        known = [KnownMethods.of(store).get(name) for name in methods]
        checks: list[dg.AssetCheckEvaluation] = []

        def work() -> None:
            progress.step("looking at what the archive holds")
            stale = look(archive, store, known, seasons)
            if stale.assets:
                checks[:] = make_assets((archive, data), methods, progress, stale, done)

        mending(store, work, again=lambda: None)
        return write_report(store, done, checks, dt.datetime.now().astimezone())


@dataclass(frozen=True)
class Stale:
    """What has to be made again, or may have to be as what it is made from is.

    Attributes:
        seasons: whose samples are to be read.
        assets: names.
    """

    seasons: Sequence[int]
    assets: Sequence[str]


def look(
    archive: Path, store: Store, methods: Sequence[Method], wanted: Collection[int] | None
) -> Stale:
    """Looks through the archive, and at what was made of it.

    Raises:
        MissingKnowledgeError: there is no archive, or nothing of the seasons that are wanted.
    """
    intake.index(store, archive)
    intake.forget_unlisted_seasons(store)
    _check_listed(wanted, intake.listed_seasons(store))
    seasons = intake.stale_seasons(store, archive, wanted)
    made: list[str] = ["samples", "blocks"] if seasons else []
    again = {*intake.SEASON_TABLES} if seasons else set()
    others = _others_were_applied(store, methods)
    for step in STEPS:
        if others or not again.isdisjoint(step.reads) or step.stale(store, methods):
            again.update(step.outputs)
            made += step.outputs
    is_unreported = not is_reported(store)
    if is_unreported and not again.intersection(DATABASE.outputs):
        made += DATABASE.outputs
    if made or site_is_stale(store):
        made += [*intake.INDEXED, SITE_TABLE]
    return Stale(seasons, made)


def _others_were_applied(store: Store, methods: Sequence[Method]) -> bool:
    """Whether the last rebuild applied other methods than these."""
    if store.made_from("methods") is None:
        return True
    return list(store.read("methods")["method"]) != sorted(method.name for method in methods)


def make_assets(
    folders: tuple[Path, Path],
    methods: Sequence[str],
    progress: Progress,
    stale: Stale,
    done: Done,
) -> "Sequence[dg.AssetCheckEvaluation]":
    """Has Dagster make assets, and notes what was done; gives what the checks said."""
    from herijk.assets.instance import run_assets  # noqa: PLC0415 - see above
    from herijk.assets.resources import Setup  # noqa: PLC0415

    setup = Setup.of(*folders, methods, read_settings(folders[1]))
    return run_assets(setup, progress, stale, done)


def _check_listed(wanted: Collection[int] | None, listed: Sequence[int]) -> None:
    """Refuses seasons of which the archive lists no tow: a typing error would pass unseen.

    Raises:
        MissingKnowledgeError: it lists none in any of them.
    """
    if wanted is not None and listed and not set(wanted) & set(listed):
        raise MissingKnowledgeError(
            "the archive lists no tow in the seasons asked for; it has tows of {}",
            ", ".join(map(str, listed)),
        )


def check_apart(archive: Path, data: Path) -> None:
    """Refuses an archive in the data folder: a rebuild would write among what it reads.

    Raises:
        MissingKnowledgeError: the archive is the data folder, or lies in it.
    """
    if archive.resolve().is_relative_to(data.resolve()):
        raise MissingKnowledgeError(
            "the archive {} lies in the data folder {}, or is the same; name a data "
            "folder outside the archive with --data",
            archive,
            data,
        )
