"""The assets, their checks, and the jobs that make up a rebuild."""

from typing import Final

import dagster as dg

from herijk.assets import archive, checks
from herijk.assets.progress import Progress
from herijk.assets.resources import Setup, fixed
from herijk.assets.shown import with_site
from herijk.assets.site import site
from herijk.assets.tables import STEP_ASSETS
from herijk.warehouse.build import graph

INDEX, READ, SITE, CHECK = "index_archive", "read_season", "make_site", "check"

BUILD_JOBS: Final = {
    graph.ARCHIVE: "collect_archive",
    graph.RECORDINGS: "average_recordings",
    graph.METHOD: "apply_method",
    graph.STUDIES: "study_methods",
    graph.LINES: "draw_lines",
    graph.CONSISTENCY: "compare_boats",
    graph.REGISTERS: "make_registers",
    graph.SUMMARIES: "sum_up",
    graph.DATABASE: "make_database",
}
"""The job of every step, in order."""

NAMES: Final = (INDEX, READ, *BUILD_JOBS.values(), SITE, CHECK)
"""The jobs of a rebuild, in order: `READ` runs per season, `apply_method` per method."""

ASSETS = [
    archive.archive_index,
    archive.samples,
    archive.blocks,
    *STEP_ASSETS.values(),
    site,
]

AFTERWARDS = dg.AssetSelection.checks(*checks.ALL)
"""These checks look at the whole, so they run when all is finished."""


JOBS = [
    dg.define_asset_job(INDEX, dg.AssetSelection.assets(archive.archive_index)),
    dg.define_asset_job(READ, dg.AssetSelection.assets(archive.samples, archive.blocks)),
    *(
        dg.define_asset_job(job, dg.AssetSelection.assets(STEP_ASSETS[step.name]) - AFTERWARDS)
        for step, job in BUILD_JOBS.items()
    ),
    dg.define_asset_job(SITE, dg.AssetSelection.assets(site)),
    dg.define_asset_job(CHECK, AFTERWARDS),
]


def job_defs(setup: Setup, progress: Progress, address: str = "") -> dg.Definitions:
    """The jobs of a rebuild for given folders, and someone who is told the progress.

    Assets link to their pages at the address, if the site is served at one.
    """
    return dg.Definitions(
        assets=with_site(ASSETS, address) if address else ASSETS,
        asset_checks=checks.ALL,
        jobs=JOBS,
        resources={
            "setup": fixed(setup),
            "progress": dg.ResourceDefinition.hardcoded_resource(progress),
        },
    )
