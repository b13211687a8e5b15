"""One run of the job `rebuild` in this process, recorded in Dagster."""

from collections.abc import Sequence
from pathlib import Path

import dagster as dg

from assets.definitions import build_defs
from assets.instance import OF_A_COMMAND, end_lost_runs, instance_of
from assets.report import Check, check_of
from pipeline.errors import HerijkError
from warehouse.store.lock import only_writer
from warehouse.store.store import Store


def run_job(
    archive: Path, data: Path, methods: Sequence[str], seasons: Sequence[int]
) -> tuple[set[str], list[Check]]:
    """Makes all that is stale, as Dagster's page and the schedule do; raises as the first step.

    Returns:
        The tables that were made anew, and what the checks said.
    """
    job = build_defs(str(archive), str(data), list(methods)).resolve_job_def("rebuild")
    config = {
        "ops": {"samples": {"config": {"seasons": list(seasons)}}},
        "loggers": {"console": {"config": {"log_level": "CRITICAL"}}},
    }
    with only_writer(data), instance_of(Store(data)) as instance:
        end_lost_runs(instance, OF_A_COMMAND)
        try:
            done = job.execute_in_process(instance=instance, run_config=config, tags=OF_A_COMMAND)
        except HerijkError:
            raise
        except dg.DagsterError as error:
            if isinstance(error.__cause__, HerijkError):
                raise error.__cause__ from error
            raise
    made = {
        event.asset_key.to_user_string()
        for event in done.get_asset_materialization_events()
        if event.asset_key and event.materialization.metadata["new"].value
    }
    return made, [check_of(one) for one in done.get_asset_check_evaluations()]
