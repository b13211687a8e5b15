"""All assets and checks, and the one run in which a rebuild makes them."""

from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Final

import dagster as dg

from assets import archive, checks, instance
from assets.report import Done
from assets.resources import Setup
from assets.tables import STEP_ASSETS
from warehouse.derive import database

ASSETS: Final = [archive.archive_index, archive.samples_and_blocks, *STEP_ASSETS]

QUIET_LOG: Final = {"loggers": {"console": {"config": {"log_level": "CRITICAL"}}}}
"""Nothing on the terminal: what Dagster says is in its records."""


def assets_of(setup: Setup) -> dg.Definitions:
    """Assets and checks, made one after the other in one process: it holds the lock."""
    return dg.Definitions(
        assets=ASSETS,
        asset_checks=[checks.of_the_whole],
        resources={"setup": setup},
        executor=dg.in_process_executor,
    )


def run_assets(
    archive_root: Path,
    data: Path,
    methods: Sequence[str],
    wanted: Collection[int] | None,
    done: Done,
) -> Sequence[dg.AssetCheckEvaluation]:
    """Makes, or confirms, all assets in one run, of the seasons that are wanted; raises as they do.

    Seasons can be asked for as a range only: those between confirm that they are fresh. What was
    made anew is noted as `done`.

    Returns:
        What the checks said.
    """
    setup = Setup(
        archive=str(archive_root),
        data=str(data),
        methods=list(methods),
        seasons=sorted(wanted or ()),
    )
    job = assets_of(setup).resolve_implicit_global_asset_job_def()
    with instance.instance_of(setup.store) as records:
        instance.end_lost_runs(records, instance.OF_A_COMMAND)
        seasons = [s for s in archive.know_seasons(records, setup.store) if setup.wanted([s])]
        ends = {"start": seasons[0], "end": seasons[-1]} if seasons else {}
        ranges = {f"dagster/asset_partition_range_{end}": season for end, season in ends.items()}
        # A partitioned asset cannot run without a partition: with no season there are no samples.
        made = [asset for asset in ASSETS if seasons or asset is not archive.samples_and_blocks]
        result = job.execute_in_process(
            instance=records,
            run_config=QUIET_LOG,
            tags=instance.OF_A_COMMAND | ranges,
            asset_selection=[key for asset in made for key in asset.keys],
        )
    for event in result.get_asset_materialization_events():
        _note(done, event.materialization, setup.methods)
    return result.get_asset_check_evaluations()


def _note(done: Done, made: dg.AssetMaterialization, methods: Sequence[str]) -> None:
    """Notes what was made anew."""
    if "new" not in made.metadata or not (new := made.metadata["new"].value):
        return
    match made.asset_key.to_user_string():
        case "samples":
            done.seasons = sorted({*done.seasons, int(str(made.partition))})
        case "curves" if isinstance(new, list):
            done.methods = [name for name in methods if name in (*done.methods, *new)]
        case database.DATABASE_TABLE:
            done.database = True
