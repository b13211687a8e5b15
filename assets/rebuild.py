"""A rebuild: all assets in one run of Dagster, where any of them is stale; then a report.

What is stale is known from fingerprints. Dagster is imported when there is work to do: looking
that there is none takes a second, importing it two.
"""

import datetime as dt
import logging
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from assets import workers
from assets.report import Done, Report, write_report
from assets.settings import read_settings
from assets.site import SITE
from pipeline.errors import MissingKnowledgeError
from pipeline.messages import say
from pipeline.method.definition import Method
from warehouse.derive.graph import STEPS
from warehouse.derive.inputs import forget_other_methods
from warehouse.derive.mending import mending
from warehouse.intake import seasons as intake
from warehouse.queries.change_report import is_reported
from warehouse.store.lock import only_writer
from warehouse.store.machine_faults import machine_faults_explained
from warehouse.store.methods import KnownMethods
from warehouse.store.store import Store

if TYPE_CHECKING:
    import dagster as dg


def rebuild(
    archive: Path, data: Path, methods: Sequence[str], seasons: Collection[int] | None = None
) -> Report:
    """Brings the data folder up to date with the archive, and reports what that changed.

    Files of ours that turn out to be damaged are made again. Where the archive changes during the
    rebuild, it begins again. The logger `herijk` says how far it is.

    Args:
        archive: the archive folder.
        data: the data folder; made if it is not there.
        methods: names of methods; the first is what the others are compared with.
        seasons: seasons to read; None for all. Others stay as they are.

    Raises:
        HerijkError: there is no archive, a promise was broken, another rebuild is at work, or the
            machine is in the way.
    """
    check_apart(archive, data)
    with machine_faults_explained(data):
        dask = read_settings(data).dask
    with machine_faults_explained(data), only_writer(data):
        store, done = Store(data), Done()
        known = [KnownMethods.of(store).get(name) for name in methods]
        checks: list[dg.AssetCheckEvaluation] = []

        def work() -> None:
            logging.getLogger("herijk").info(say("looking at what the archive holds"))
            if is_stale(archive, store, known, seasons):
                workers.get_ready(dask)
                from assets.run import run_assets  # noqa: PLC0415 - see above

                checks[:] = run_assets(archive, data, methods, seasons, done)

        mending(store, work, again=lambda: None)
        return write_report(store, done, checks, dt.datetime.now().astimezone())


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


def is_stale(
    archive: Path, store: Store, methods: Sequence[Method], wanted: Collection[int] | None
) -> bool:
    """Looks through the archive, and whether anything made of it has to be made again.

    Raises:
        MissingKnowledgeError: there is no archive, or nothing of the seasons that are wanted.
    """
    intake.index(store, archive)
    intake.forget_unlisted_seasons(store)
    forget_other_methods(store, {method.name for method in methods})
    _check_listed(wanted, intake.listed_seasons(store))
    return (
        bool(intake.stale_seasons(store, archive, wanted))
        or any(step.stale(store, methods) for step in (*STEPS, SITE))
        or not is_reported(store)
    )


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
