"""The Dagster code location: everything that `dg` and `herijk serve` load."""

import dagster as dg

from assets import archive, tables
from assets.resources import Progress, Quiet, Setup
from assets.site import site

INDEX, READ, COLLECT, APPLY, STUDY, FINISH = (
    "index_archive",
    "read_season",
    "collect_archive",
    "apply_method",
    "study_methods",
    "finish",
)
"""The jobs of a rebuild, in order: `READ` runs per season and `APPLY` per method."""


jobs = [
    dg.define_asset_job(INDEX, dg.AssetSelection.assets(archive.archive_index)),
    dg.define_asset_job(READ, dg.AssetSelection.assets(archive.samples, archive.blocks)),
    dg.define_asset_job(COLLECT, dg.AssetSelection.assets(tables.archive_tables)),
    dg.define_asset_job(APPLY, dg.AssetSelection.assets(tables.method_tables)),
    dg.define_asset_job(STUDY, dg.AssetSelection.assets(tables.study_tables)),
    dg.define_asset_job(
        FINISH,
        dg.AssetSelection.assets(
            tables.register_tables,
            tables.consistency_tables,
            tables.summary_tables,
            tables.warehouse_database,
            site,
        ),
    ),
]


def build_defs(setup: Setup, progress: Progress) -> dg.Definitions:
    """The definitions for given folders and someone who is told the progress."""
    return dg.Definitions(
        assets=[
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
        ],
        jobs=jobs,
        resources={"setup": setup, "progress": dg.ResourceDefinition.hardcoded_resource(progress)},
    )


defs = build_defs(
    Setup(archive=dg.EnvVar("HERIJK_ARCHIVE"), data=dg.EnvVar("HERIJK_DATA")), Quiet()
)
