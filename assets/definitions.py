"""The Dagster code location: what `dg`, `dagster dev` and `herijk serve` load."""

import os
from pathlib import Path

import dagster as dg

from assets import automation
from assets.resources import Setup
from assets.run import assets_of
from assets.settings import Settings, read_settings


def build_defs(
    archive: str, data: str, settings: Settings, is_served: bool = False
) -> dg.Definitions:
    """The same, with the job of a rebuild, and what starts it when nobody asks."""
    by_itself = dg.Definitions(
        jobs=[automation.rebuild_job],
        schedules=[automation.nightly(settings, is_served)],
        sensors=[
            automation.archive_changed(Path(archive), is_served),
            automation.rebuild_failed(settings, is_served),
        ],
    )
    setup = Setup(archive=archive, data=data, methods=list(settings.methods))
    return dg.Definitions.merge(assets_of(setup), by_itself)


@dg.definitions
def defs() -> dg.Definitions:
    """What the environment names."""
    data = os.environ.get("HERIJK_DATA", "data")
    archive = os.environ.get("HERIJK_ARCHIVE", "archive")
    return build_defs(archive, data, read_settings(Path(data)), "HERIJK_SITE" in os.environ)
