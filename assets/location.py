"""The assets and checks of an archive and a data folder."""

from collections.abc import Sequence
from typing import Final

import dagster as dg

from assets import archive, checks
from assets.resources import Setup
from assets.site import site
from assets.tables import STEP_ASSETS

ASSETS: Final[Sequence[dg.AssetsDefinition]] = [
    archive.archive_index,
    archive.samples,
    archive.blocks,
    *STEP_ASSETS,
    site,
]


def assets_of(setup: Setup) -> dg.Definitions:
    """Assets and checks, made one after the other in one process: it holds the lock."""
    return dg.Definitions(
        assets=ASSETS,
        asset_checks=[checks.of_the_whole],
        resources={"setup": setup},
        executor=dg.in_process_executor,
    )
