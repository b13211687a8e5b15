"""The Dagster code location: what `dg`, `dagster dev` and `herijk serve` load."""

import os
from pathlib import Path

import dagster as dg

from assets import automation
from assets.location import assets_of
from assets.notify import notifier_of
from assets.resources import Setup
from assets.settings import Settings, read_settings


def build_defs(
    archive: str, data: str, settings: Settings, is_served: bool = False
) -> dg.Definitions:
    """The same, with the job of a rebuild, and what starts it when nobody asks."""
    notifier = notifier_of(data, settings)
    setup = Setup(archive=archive, data=data, methods=list(settings.methods))
    by_itself = dg.Definitions(
        jobs=[automation.rebuild_job],
        schedules=automation.schedules(settings, is_served),
        sensors=[automation.archive_sensor(Path(archive), is_served)],
        resources={"notifier": dg.ResourceDefinition.hardcoded_resource(notifier)},
    )
    return dg.Definitions.merge(assets_of(setup), by_itself)


defs = build_defs(
    os.environ.get("HERIJK_ARCHIVE", "archive"),
    os.environ.get("HERIJK_DATA", "data"),
    read_settings(Path(os.environ.get("HERIJK_DATA", "data"))),
    is_served="HERIJK_SITE" in os.environ,
)
