"""Dagster's records of a data folder."""

import os
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Final

import dagster as dg
import yaml  # type: ignore[import-untyped]

from pipeline.errors import MissingKnowledgeError
from warehouse.store.files import TEMPORARY_PREFIX, write_beside
from warehouse.store.store import Store

INSTANCE_SETTINGS: Final = Path(__file__).with_name("dagster.yaml")
"""Dagster's settings for a new data folder."""

OF_A_COMMAND: Final = {"herijk/by": "rebuild"}
"""Marks runs that live and die with the process of a rebuild."""


def end_lost_runs(instance: dg.DagsterInstance, tags: Mapping[str, str]) -> None:
    """Record runs as failed whose process was killed: nothing else does, and other runs wait.

    A rebuild does this for runs of its own kind, because it holds the lock; a new server for all.
    """
    begun = [
        dg.DagsterRunStatus.STARTED,
        dg.DagsterRunStatus.STARTING,
        dg.DagsterRunStatus.CANCELING,
    ]
    for run in instance.get_runs(dg.RunsFilter(tags=tags, statuses=begun)):
        instance.report_run_failed(run, "The process it was part of was stopped or killed.")


@contextmanager
def open_instance(store: Store) -> Iterator[dg.DagsterInstance]:
    """Open Dagster's records: where `DAGSTER_HOME` says, or in the data folder."""
    home = prepare_home(store)
    try:
        opened = dg.DagsterInstance.from_config(str(home))
    except (yaml.YAMLError, dg.DagsterError) as error:
        what = " ".join(str(error).split())[:200]
        raise MissingKnowledgeError(
            "{} cannot be understood: {}. Mend it, or remove it: it is made again "
            "with the usual settings",
            home / "dagster.yaml",
            what,
        ) from error
    with opened as instance:
        yield instance


def prepare_home(store: Store) -> Path:
    """Return Dagster's folder; write its settings there if it has none."""
    home = Path(os.environ.get("DAGSTER_HOME") or store.dagster_home)
    settings = home / "dagster.yaml"
    if not settings.exists():
        for left in home.glob(f"{TEMPORARY_PREFIX}*"):  # of a process that was killed here
            left.unlink()
        with write_beside(settings) as beside:
            shutil.copyfile(INSTANCE_SETTINGS, beside)
    return home.resolve()
