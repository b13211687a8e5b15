"""From archive files to blocks: the heavy part, partitioned by season."""

import logging
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import Any, Final

import dagster as dg
import polars as pl

from assets.resources import Setup
from pipeline.blocks.run_blocks import BLOCK_SCHEMA
from pipeline.channels import SAMPLE_SCHEMA
from pipeline.messages import say
from warehouse.derive.inputs import state_of_table
from warehouse.derive.mending import mending
from warehouse.intake import seasons as intake
from warehouse.store.code import ADDING, READING, code_hash
from warehouse.store.store import Store, fingerprint

LOG: Final = logging.getLogger("herijk")

SEASONS: Final = dg.DynamicPartitionsDefinition(name="season")
"""Seasons are found in the archive, so a new campaign needs no change of code."""

VERSION_TAG: Final = "dagster/data_version"

GROUP: Final = "archive"


@dg.multi_asset(
    specs=[
        dg.AssetSpec(
            name,
            code_version=code_hash(*READING),
            description=f"{name}: of the lists of the archive",
            group_name=GROUP,
        )
        for name in intake.INDEXED
    ]
)
def archive_index(
    context: dg.AssetExecutionContext, setup: Setup
) -> Iterator[dg.MaterializeResult]:
    """Boats, tow lists and files of the archive, with what is wrong in the lists."""
    look = partial(intake.index, setup.store, setup.archive_root)
    mending(setup.store, look, again=look)
    know_seasons(context.instance, setup.store)
    for name in intake.INDEXED:
        yield dg.MaterializeResult(
            asset_key=name,
            data_version=dg.DataVersion(fingerprint(state_of_table(setup.scope, name))),
            metadata={"dagster/row_count": setup.store.read(name).height},
        )


def know_seasons(instance: dg.DagsterInstance, store: Store) -> Sequence[str]:
    """Makes the seasons of the archive those of Dagster; gives them in Dagster's order."""
    kind, listed = str(SEASONS.name), list(map(str, intake.listed_seasons(store)))
    instance.add_dynamic_partitions(kind, listed)
    for season in set(instance.get_dynamic_partitions(kind)) - {*listed}:
        instance.delete_dynamic_partition(kind, season)
    return instance.get_dynamic_partitions(kind)


def _columns(schema: Mapping[str, pl.DataType]) -> dict[str, dg.TableSchema]:
    columns = [dg.TableColumn(name, str(kind)) for name, kind in schema.items()]
    return {"dagster/column_schema": dg.TableSchema(columns)}


@dg.multi_asset(
    name="seasons_read",
    specs=[
        dg.AssetSpec(
            "samples",
            deps=["listed_tows", "listed_runs"],
            description="The samples of the tows of seasons, in Parquet; faulty ones are set aside",
            code_version=code_hash(*READING, *ADDING),
            metadata=_columns(SAMPLE_SCHEMA),
            group_name=GROUP,
        ),
        dg.AssetSpec(
            "blocks",
            deps=["samples"],
            description="Sums over each second of each run of seasons",
            code_version=code_hash(*ADDING),
            metadata=_columns(BLOCK_SCHEMA),
            group_name=GROUP,
        ),
    ],
    partitions_def=SEASONS,
)
def samples_and_blocks(
    context: dg.AssetExecutionContext, setup: Setup
) -> Iterator[dg.MaterializeResult]:
    """Samples and blocks of the seasons of which the archive or the code changed."""
    store, root = setup.store, setup.archive_root
    asked, read = setup.wanted(context.partition_keys), set()

    def work() -> None:
        stale = intake.stale_seasons(store, root, asked)
        listed = Counter(store.read("listed_tows", columns=["season"])["season"])
        tows, began = sum(listed[season] for season in stale), time.monotonic()
        LOG.info(say("reading {} tows", tows))
        for season, _ in setup.map(partial(intake.read_season, store, root), stale):
            read.add(season)
            done = sum(listed[season] for season in read)
            left_s = (time.monotonic() - began) * (tows - done) / done
            LOG.info(say("{} of {} tows were read; {:.0f} s left", done, tows, left_s))

    intake.index(store, root)
    mending(store, work, again=partial(intake.index, store, root))
    yield dg.MaterializeResult(asset_key="samples")
    for season in asked:
        index = store.read("season_index", str(season))
        aside = index["reason_code"].drop_nulls().value_counts(sort=True)
        about = {
            "dagster/row_count": int(index["samples"].sum()),
            "tows": index["reason_code"].null_count(),
            "set_aside": dict(aside.rows()),
            "new": season in read,
        }
        contents = [store.contents(name, str(season)) for name in intake.READ]
        _record(context, "samples", str(season), contents, about)
    yield dg.MaterializeResult(asset_key="blocks")
    for season in asked:
        rows = store.count_rows("blocks", str(season))
        about = {"dagster/row_count": rows, "new": season in read}
        _record(context, "blocks", str(season), store.contents("blocks", str(season)), about)


def _record(
    context: dg.AssetExecutionContext,
    asset: str,
    partition: str,
    state: object,
    metadata: Mapping[str, Any],
) -> None:
    """Records a season once more, with a version of its own: a result has one for a whole range."""
    key = dg.AssetKey(asset)
    here = dg.AssetRecordsFilter(asset_key=key, asset_partitions=[partition])
    (last,) = context.instance.fetch_materializations(here, limit=1).records
    assert last.asset_materialization is not None  # noqa: S101 - the event that Dagster just wrote
    tags = {**(last.asset_materialization.tags or {}), VERSION_TAG: fingerprint(state)}
    context.log_event(
        dg.AssetMaterialization(key, partition=partition, metadata=metadata, tags=tags)
    )
