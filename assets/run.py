"""One run of the job `rebuild` in this process, recorded in Dagster."""

from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any

import dagster as dg

from assets.definitions import build_defs
from assets.instance import OF_A_COMMAND, end_lost_runs, open_instance
from assets.lake import NEW
from assets.report import Done
from pipeline.errors import HerijkError
from warehouse.store.lock import hold_write_lock
from warehouse.store.store import Store


def run_job(
    archive: Path,
    data: Path,
    methods: Sequence[str],
    seasons: Sequence[int],
    selection: Collection[str] | None = None,
) -> Done:
    """Make all that is stale, as Dagster's page and the schedule do.

    Args:
        archive: the archive folder.
        data: the data folder.
        methods: names of the methods to apply.
        seasons: seasons of which changed files are read; none for all.
        selection: names of the assets to make; None for all.

    Returns:
        What was made anew.

    Raises:
        HerijkError: as the asset raised it.
    """
    job = build_defs(str(archive), str(data), list(methods)).resolve_job_def("rebuild")
    config: dict[str, Any] = {"loggers": {"console": {"config": {"log_level": "CRITICAL"}}}}
    if seasons:
        config["ops"] = {"samples": {"config": {"seasons": list(seasons)}}}
    with hold_write_lock(data), open_instance(Store(data)) as instance:
        end_lost_runs(instance, OF_A_COMMAND)
        try:
            result = job.execute_in_process(
                instance=instance,
                run_config=config,
                tags=OF_A_COMMAND,
                asset_selection=None if selection is None else list(map(dg.AssetKey, selection)),
            )
        except dg.DagsterError as error:
            if isinstance(error.__cause__, HerijkError):
                raise error.__cause__ from error
            raise
    return list_made(result, methods)


def list_made(result: dg.ExecuteInProcessResult, methods: Sequence[str]) -> Done:
    """Return which assets a run made anew, without those that it only confirmed."""
    done = Done()
    for event in result.get_asset_materialization_events():
        made = event.materialization
        is_new = NEW in made.metadata and made.metadata[NEW].value
        name = made.asset_key.to_user_string()
        if name == "samples" and "seasons_read" in made.metadata:
            done.seasons = list(made.metadata["seasons_read"].value)  # type: ignore[arg-type]
        elif name == "curves" and is_new:
            done.methods = list(methods)
        elif name == "warehouse_database" and is_new:
            done.database = True
    return done
