"""The assets and checks of an archive and a data folder."""

from collections.abc import Sequence
from typing import Final

import dagster as dg

from assets import archive, checks
from assets.progress import Progress
from assets.resources import Setup, progress_in_log
from assets.site import site
from assets.tables import STEP_ASSETS

ASSETS: Final[Sequence[dg.AssetsDefinition | dg.AssetSpec]] = [
    *archive.OUTSIDE_SPECS,
    archive.archive_index,
    archive.samples,
    archive.blocks,
    *STEP_ASSETS,
    site,
]


def assets_of(
    setup: Setup, progress: Progress | dg.ResourceDefinition = progress_in_log
) -> dg.Definitions:
    """Assets and checks, made one after the other in one process: it holds the lock.

    Args:
        setup: the folders and the methods.
        progress: is told how far it is.
    """
    return dg.Definitions(
        assets=ASSETS,
        asset_checks=[checks.of_the_whole],
        resources={"setup": setup, "progress": progress},
        executor=dg.in_process_executor,
    )
