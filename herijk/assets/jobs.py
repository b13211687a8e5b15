"""The assets, their checks, and the jobs that make up a rebuild."""

import dagster as dg

from herijk.assets import archive, checks, tables
from herijk.assets.resources import Progress, Setup, fixed
from herijk.assets.site import site

STEPS = INDEX, READ, COLLECT, APPLY, STUDY, COMPARE, FINISH, CHECK = (
    "index_archive",
    "read_season",
    "collect_archive",
    "apply_method",
    "study_methods",
    "compare_boats",
    "finish",
    "check",
)
"""The jobs of a rebuild, in order: `READ` runs per season and `APPLY` per method."""

ASSETS = [
    archive.archive_index,
    archive.samples,
    archive.blocks,
    tables.archive_tables,
    tables.method_tables,
    tables.study_tables,
    tables.register_tables,
    tables.consistency_tables,
    tables.summary_tables,
    tables.warehouse_database,
    site,
]

AFTERWARDS = dg.AssetSelection.checks(*checks.ALL)
"""These checks look at the whole, so they run when all is finished."""

JOBS = [
    dg.define_asset_job(INDEX, dg.AssetSelection.assets(archive.archive_index)),
    dg.define_asset_job(READ, dg.AssetSelection.assets(archive.samples, archive.blocks)),
    dg.define_asset_job(COLLECT, dg.AssetSelection.assets(tables.archive_tables) - AFTERWARDS),
    dg.define_asset_job(APPLY, dg.AssetSelection.assets(tables.method_tables) - AFTERWARDS),
    dg.define_asset_job(STUDY, dg.AssetSelection.assets(tables.study_tables)),
    dg.define_asset_job(COMPARE, dg.AssetSelection.assets(tables.consistency_tables) - AFTERWARDS),
    dg.define_asset_job(
        FINISH,
        dg.AssetSelection.assets(
            tables.register_tables,
            tables.summary_tables,
            tables.warehouse_database,
            site,
        )
        - AFTERWARDS,
    ),
    dg.define_asset_job(CHECK, AFTERWARDS),
]


def job_defs(setup: Setup, progress: Progress) -> dg.Definitions:
    """The jobs of a rebuild for given folders, and someone who is told the progress."""
    return dg.Definitions(
        assets=ASSETS,
        asset_checks=checks.ALL,
        jobs=JOBS,
        resources={
            "setup": fixed(setup),
            "progress": dg.ResourceDefinition.hardcoded_resource(progress),
        },
    )
