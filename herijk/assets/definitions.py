"""The Dagster code location: everything that `dg` and `herijk serve` load."""

import os
from pathlib import Path

import dagster as dg

from herijk.assets import automation
from herijk.assets.jobs import job_defs
from herijk.assets.notify import notifier_of
from herijk.assets.progress import Quiet
from herijk.assets.resources import Setup
from herijk.assets.settings import Settings, read_settings


def build_defs(archive: str, data: str, settings: Settings, site: str = "") -> dg.Definitions:
    """The jobs of a rebuild, and what starts them when nobody asks.

    Args:
        archive, data: folders.
        settings: of the data folder.
        site: address at which the site is served, for links to it.
    """
    setup = Setup(
        archive=archive,
        data=data,
        methods=list(settings.applied),
        set_aside_share=settings.set_aside_share,
        factor_jump=settings.factor_jump,
    )
    return dg.Definitions.merge(
        job_defs(setup, Quiet(), site),
        dg.Definitions(
            jobs=[automation.rebuild_job],
            schedules=automation.schedules(settings),
            sensors=[automation.archive_sensor(Path(archive))],
            resources={
                "notifier": dg.ResourceDefinition.hardcoded_resource(notifier_of(data, settings))
            },
        ),
    )


defs = build_defs(
    os.environ.get("HERIJK_ARCHIVE", "archive"),
    os.environ.get("HERIJK_DATA", "data"),
    read_settings(Path(os.environ.get("HERIJK_DATA", "data"))),
    os.environ.get("HERIJK_SITE", ""),
)
