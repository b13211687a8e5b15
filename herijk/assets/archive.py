"""From archive files to blocks: the heavy part, partitioned by season."""

import datetime as dt
from typing import Final

import dagster as dg
import polars as pl

from herijk.assets.partitions import seasons
from herijk.assets.resources import Setup
from herijk.assets.shown import columns_of
from herijk.pipeline.blocks.run_blocks import BLOCK_SCHEMA
from herijk.pipeline.channels import SAMPLE_SCHEMA
from herijk.warehouse.intake import seasons as intake
from herijk.warehouse.store.code import ADDERS, FAULTS_IN_DUTCH, READERS, code_hash
from herijk.warehouse.store.store import Store

LOOKED_AT: Final = dg.FreshnessPolicy.time_window(
    warn_window=dt.timedelta(hours=26), fail_window=dt.timedelta(hours=50)
)
"""Every rebuild looks through the archive, also when it finds no change."""

OWNERS: Final = ["team:archive"]
SUBJECT: Final = {"herijk/subject": "archive"}


@dg.asset(
    code_version=code_hash(intake.__name__, FAULTS_IN_DUTCH),
    freshness_policy=LOOKED_AT,
    group_name="archive",
    kinds={"parquet"},
    owners=OWNERS,
    tags=SUBJECT,
)
def archive_index(setup: Setup) -> dg.MaterializeResult:
    """Boats, tow lists and files of the archive, with what is wrong in the lists."""
    intake.index(setup.store, setup.archive_root)
    return index_result(setup.store)


def index_result(store: Store) -> dg.MaterializeResult:
    """What is shown of the lists of the archive."""
    return dg.MaterializeResult(
        asset_key="archive_index",
        metadata={
            "dagster/row_count": store.read("listed_tows").height,
            "boats": store.read("listed_boats").height,
            "files": store.read("listed_files").height,
            "faults": store.read("list_faults").height,
            "simulated": store.read("about_archive")["simulated"][0],
        },
    )


@dg.asset(
    deps=[archive_index],
    partitions_def=seasons,
    code_version=code_hash(*READERS, FAULTS_IN_DUTCH),
    check_specs=[dg.AssetCheckSpec("most_tows_sound", asset="samples")],
    group_name="archive",
    kinds={"parquet"},
    metadata=columns_of(SAMPLE_SCHEMA),
    owners=OWNERS,
    tags=SUBJECT,
)
def samples(context: dg.AssetExecutionContext, setup: Setup) -> dg.MaterializeResult:
    """The samples of one season's tows, in Parquet; faulty tows are set aside."""
    season = int(context.partition_key)
    return samples_result(intake.read_season(setup.store, setup.archive_root, season))


def samples_result(season_index: pl.DataFrame) -> dg.MaterializeResult:
    """What is shown of a season that was read."""
    faulty = season_index.filter(pl.col("reason_code").is_not_null())
    reasons = faulty["reason_code"].value_counts(sort=True).rows()
    return dg.MaterializeResult(
        asset_key="samples",
        metadata={
            "dagster/row_count": int(season_index["samples"].sum()),
            "tows": season_index.height - faulty.height,
            "set_aside": dg.MetadataValue.json(dict(reasons)),
        },
        check_results=[
            dg.AssetCheckResult(
                asset_key="samples",
                check_name="most_tows_sound",
                passed=2 * faulty.height <= season_index.height,
                severity=dg.AssetCheckSeverity.WARN,
                metadata={"set_aside": faulty.height, "listed": season_index.height},
            )
        ],
    )


@dg.asset(
    deps=[samples],
    partitions_def=seasons,
    code_version=code_hash(*ADDERS),
    group_name="archive",
    kinds={"parquet"},
    metadata=columns_of(BLOCK_SCHEMA),
    owners=OWNERS,
    tags=SUBJECT,
)
def blocks(context: dg.AssetExecutionContext, setup: Setup) -> dg.MaterializeResult:
    """Sums over each second of each run of one season."""
    season_blocks = intake.collect_blocks(setup.store, int(context.partition_key))
    return blocks_result(season_blocks.height)


def blocks_result(rows: int) -> dg.MaterializeResult:
    """What is shown of a season's blocks."""
    return dg.MaterializeResult(asset_key="blocks", metadata={"dagster/row_count": rows})
