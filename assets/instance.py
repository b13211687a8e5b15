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
from warehouse.store.files import written_beside
from warehouse.store.store import Store

INSTANCE_SETTINGS: Final = Path(__file__).with_name("dagster.yaml")
"""Dagster's settings for a new data folder."""

OF_A_COMMAND: Final = {"herijk/by": "rebuild"}
"""Marks runs that live and die with the process of a rebuild."""


def end_lost_runs(instance: dg.DagsterInstance, tags: Mapping[str, str]) -> None:
    """Records runs as failed whose process was killed: nobody else would, and others wait.

    Rebuilds ask it of their own kind, as holders of the lock; a new server of all that began.
    """
    begun = [
        dg.DagsterRunStatus.STARTED,
        dg.DagsterRunStatus.STARTING,
        dg.DagsterRunStatus.CANCELING,
    ]
    for run in instance.get_runs(dg.RunsFilter(tags=tags, statuses=begun)):
        instance.report_run_failed(run, "The process it was part of was stopped or killed.")


@contextmanager
def instance_of(store: Store) -> Iterator[dg.DagsterInstance]:
    """Dagster's own records: where `DAGSTER_HOME` says, or under the data folder."""
    home = prepare_home(store)
    try:
        os.environ["DAGSTER_HOME"] = str(home)
        opened = dg.DagsterInstance.get()
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
    """Dagster's folder, with settings that may be changed by hand afterwards."""
    home = Path(os.environ.get("DAGSTER_HOME") or store.dagster_home)
    settings = home / "dagster.yaml"
    if not settings.exists():
        with written_beside(settings) as beside:
            shutil.copyfile(INSTANCE_SETTINGS, beside)
    return home.resolve()
