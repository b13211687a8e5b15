"""The Dagster code location: what `dg`, `dagster dev` and `herijk serve` load."""

import os
from pathlib import Path

import dagster as dg

from assets import archive, automation, consistency, curves, database, register, rules
from assets.lake import Folders, Lake, declared
from assets.settings import read_settings

ROOMS = (archive, rules, curves, consistency, register, database)

ASSETS = [
    asset.map_asset_specs(declared)
    for room in ROOMS
    for asset in dg.load_assets_from_modules([room], group_name=room.__name__.partition(".")[2])
    if isinstance(asset, dg.AssetsDefinition)
]


def build_defs(
    archive: str, data: str, methods: list[str], is_served: bool = False
) -> dg.Definitions:
    """The definitions of an archive and a data folder."""
    folders = Folders(archive=archive, data=data, methods=methods)
    settings = read_settings(Path(data))
    return dg.Definitions(
        assets=ASSETS,
        asset_checks=database.CHECKS,
        resources={"folders": folders, "io_manager": Lake(folders=folders)},
        jobs=[automation.rebuild_job],
        schedules=[automation.nightly(settings, is_served)],
        sensors=[
            automation.archive_changed(Path(archive), is_served),
            automation.rebuild_succeeded(settings, Path(data), is_served),
            automation.rebuild_failed(settings, is_served),
        ],
        executor=dg.in_process_executor,
    )


@dg.definitions
def defs() -> dg.Definitions:
    """What the environment names."""
    return build_defs(
        os.environ.get("HERIJK_ARCHIVE", "archive"),
        os.environ.get("HERIJK_DATA", "data"),
        [],
        "HERIJK_SITE" in os.environ,
    )
