"""Seasons read on a Dask cluster, each as one step of one run, by Dagster's own executor.

The process of the rebuild holds the lock and decides what is stale, as always; the workers read
seasons and do nothing else. Scheduler, workers and this process hand each other pickles, so they
have to trust each other. How to start them is in docs/operations.md.
"""

import secrets
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import dagster as dg
from dagster_dask import dask_executor
from distributed.scheduler import KilledWorker, NoWorkerError

from herijk.assets.archive import blocks_result, samples_result
from herijk.assets.events import events_of
from herijk.assets.resources import QUIET_LOG
from herijk.assets.side_by_side import Reading
from herijk.pipeline.errors import UnavailableError


class Season(dg.Config):
    """One season, the archive it comes from and the data folder it goes to."""

    archive: str
    data: str
    season: int


@dg.op
def read_season(context: dg.OpExecutionContext, config: Season) -> None:
    """The samples and blocks of one season; who asked for it holds the lock."""
    read = Reading(Path(config.archive), Path(config.data), config.season).do()
    for result in (samples_result(read.index), blocks_result(read.blocks)):
        for event in events_of(result, str(config.season)):
            context.log_event(event)  # type: ignore[arg-type]  # it takes checks too


def seasons_job(name: str, seasons: Sequence[int]) -> dg.JobDefinition:
    """A job of one step per season, none of which waits for another."""

    @dg.job(name=name, executor_def=dask_executor)
    def job() -> None:
        for season in seasons:
            read_season.alias(_step(season))()

    return job


def _step(season: int) -> str:
    return f"season_{season}"


def read_seasons(
    instance: dg.DagsterInstance,
    address: str,
    folders: tuple[Path, Path],
    seasons: Sequence[int],
    tags: Mapping[str, str],
) -> tuple[Sequence[dg.AssetCheckEvaluation], dict[int, str]]:
    """Reads seasons on a cluster; a step whose worker is killed goes to another worker.

    Args:
        instance: Dagster's records; the workers write in them too.
        address: of the Dask scheduler: `tcp://host:8786`.
        folders: archive and data folder, under the same paths on every worker.
        seasons: to read.
        tags: of the run.

    Returns:
        What the checks said, and why for each season that a worker could not read.

    Raises:
        UnavailableError: there is no scheduler there, it has been without workers for as long as
            it was told to wait, or they are killed time and again.
    """
    archive_root, data = (str(folder.resolve()) for folder in folders)
    # Dask knows a step by the names of job and step: two rebuilds on one cluster must differ.
    name = f"read_seasons_{secrets.token_hex(4)}"
    instance.add_dynamic_partitions("season", [str(season) for season in seasons])
    arguments: Any = (name, tuple(seasons))  # Dagster's annotation allows one argument only
    job = dg.build_reconstructable_job(__name__, seasons_job.__name__, arguments)
    config: dict[str, Any] = {
        "ops": {
            _step(season): {"config": {"archive": archive_root, "data": data, "season": season}}
            for season in seasons
        },
        **QUIET_LOG,
        "execution": {"config": {"cluster": {"existing": {"address": address}}}},
    }
    try:
        with dg.execute_job(job, instance, config, tags=tags, raise_on_error=True) as result:
            failures = {event.step_key: event for event in result.get_step_failure_events()}
            checks = result.get_asset_check_evaluations()
    except (OSError, KilledWorker, NoWorkerError) as error:
        raise UnavailableError(
            "the Dask cluster at {} did not finish: {}. Check that its scheduler "
            "and workers are up, and run it again: what was finished is kept",
            address,
            error,
        ) from error
    return checks, {s: _reason(failures[_step(s)]) for s in seasons if _step(s) in failures}


def _reason(event: dg.DagsterEvent) -> str:
    """First line of what went wrong in a step."""
    error = event.step_failure_data.error
    while error is not None and error.cause is not None:
        error = error.cause
    return "unknown" if error is None else error.message.strip().splitlines()[0]
