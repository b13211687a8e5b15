"""The Dagster code location: everything that `dg` and `herijk serve` load."""

import os
from pathlib import Path
from typing import Final

import dagster as dg

from herijk.assets import archive, automation, checks
from herijk.assets.notify import notifier_of
from herijk.assets.resources import Setup, fixed
from herijk.assets.settings import Settings, read_settings
from herijk.assets.shown import with_site
from herijk.assets.site import site
from herijk.assets.tables import STEP_ASSETS

ASSETS: Final = [
    archive.archive_index,
    archive.samples,
    archive.blocks,
    *STEP_ASSETS.values(),
    site,
]


def build_defs(archive: str, data: str, settings: Settings, address: str = "") -> dg.Definitions:
    """Assets and checks, the job of a rebuild, and what starts it when nobody asks.

    Args:
        archive, data: folders.
        settings: of the data folder.
        address: where the site is served, if it is: assets link to their pages.
    """
    setup = Setup.of(Path(archive), Path(data), settings.methods, settings)
    notifier = notifier_of(data, settings)
    return dg.Definitions(
        assets=with_site(ASSETS, address) if address else ASSETS,
        asset_checks=checks.ALL,
        jobs=[automation.rebuild_job],
        schedules=automation.schedules(settings),
        sensors=[automation.archive_sensor(Path(archive))],
        resources={
            "setup": fixed(setup),
            "notifier": dg.ResourceDefinition.hardcoded_resource(notifier),
        },
    )


defs = build_defs(
    os.environ.get("HERIJK_ARCHIVE", "archive"),
    os.environ.get("HERIJK_DATA", "data"),
    read_settings(Path(os.environ.get("HERIJK_DATA", "data"))),
    os.environ.get("HERIJK_SITE", ""),
)
