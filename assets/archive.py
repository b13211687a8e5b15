"""From archive files to blocks: the heavy part, partitioned by season."""

import datetime as dt
from collections.abc import Iterator, Mapping
from functools import partial
from typing import Any, Final

import dagster as dg
import polars as pl

from assets.progress import Progress
from assets.resources import Setup
from assets.workers import read_season
from pipeline.blocks.run_blocks import BLOCK_SCHEMA
from pipeline.channels import SAMPLE_SCHEMA
from warehouse.derive.inputs import OTHERS, state_of_table
from warehouse.derive.mending import mending
from warehouse.intake import seasons as intake
from warehouse.store.code import ADDING, READING, code_hash
from warehouse.store.store import Store, fingerprint

SEASONS: Final = dg.DynamicPartitionsDefinition(name="season")
"""Seasons are found in the archive, so a new campaign needs no change of code."""

OUTSIDE: Final = {
    "tow_lists": "rows of the tow lists, with the hashes of their files",
    "method_options": "the options of the methods that are applied",
    "register_rules": "titles of methods, and how long a tow counts",
    "decisions": "decisions of people about tows",
    "published": "editions that were published",
    "failed_tows": "tows on which Herijk itself failed",
}
PEOPLE_AND_US: Final = ("decisions", "published", "failed_tows")
VERSION_TAG: Final = "dagster/data_version"
"""What no asset makes: it is looked at with the lists of the archive, and noted as observed."""

OUTSIDE_SPECS: Final = [
    dg.AssetSpec(
        name,
        description=meaning,
        group_name="outside",
        partitions_def=SEASONS if name == "tow_lists" else None,
    )
    for name, meaning in OUTSIDE.items()
]

OWNERS: Final = ["team:archive"]
SUBJECT: Final = {"herijk/subject": "archive"}
LOOKED_AT: Final = dg.FreshnessPolicy.time_window(
    warn_window=dt.timedelta(hours=26), fail_window=dt.timedelta(hours=50)
)
"""Every rebuild looks through the archive, also when it finds no change."""


@dg.multi_asset(
    specs=[
        dg.AssetSpec(
            name,
            code_version=code_hash(*READING),
            description=f"{name}: of the lists of the archive",
            freshness_policy=LOOKED_AT if name == "listed_files" else None,
            group_name="archive",
            kinds={"parquet"},
            owners=OWNERS,
            tags=SUBJECT,
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
    context.instance.add_dynamic_partitions(
        str(SEASONS.name), [str(season) for season in intake.listed_seasons(setup.store)]
    )
    observe(context.instance, setup)
    for name in intake.INDEXED:
        yield dg.MaterializeResult(
            asset_key=name,
            data_version=dg.DataVersion(fingerprint(state_of_table(setup.scope, name))),
            metadata={"dagster/row_count": setup.store.read(name).height},
        )


def observe(instance: dg.DagsterInstance, setup: Setup) -> list[tuple[str, str | None]]:
    """Notes what changed of all that no asset makes; gives its names, with the season."""
    changed = []
    for name, season, version in _seen(setup):
        if version != _last_version(instance, name, season):
            # Of what it does not make, Dagster compares these two kinds of events.
            kind = dg.AssetMaterialization if season is None else dg.AssetObservation
            seen = kind(name, partition=season, tags={VERSION_TAG: version})
            instance.report_runless_asset_event(seen)
            changed.append((name, season))
    return changed


def _last_version(instance: dg.DagsterInstance, name: str, season: str | None) -> str | None:
    """The version under which something was last noted."""
    here = dg.AssetRecordsFilter(
        asset_key=dg.AssetKey(name), asset_partitions=None if season is None else [season]
    )
    fetch = instance.fetch_materializations if season is None else instance.fetch_observations
    for record in fetch(here, limit=1).records:
        event = record.asset_materialization or record.asset_observation
        return None if event is None else (event.tags or {}).get(VERSION_TAG)
    return None


def _seen(setup: Setup) -> Iterator[tuple[str, str | None, str]]:
    """Name, season and version of all that no asset makes."""
    scope = setup.scope
    for season, listed in intake.season_fingerprints(setup.store, setup.archive_root).items():
        yield "tow_lists", str(season), listed
    options = [(method.name, method.content_hash) for method in scope.methods]
    yield "method_options", None, fingerprint(options)
    for name, parameter in (("register_rules", "methods"), *((n, n) for n in PEOPLE_AND_US)):
        yield name, None, fingerprint(OTHERS[parameter].state(scope))


def _columns(schema: Mapping[str, pl.DataType]) -> dict[str, dg.TableSchema]:
    columns = [dg.TableColumn(name, str(kind)) for name, kind in schema.items()]
    return {"dagster/column_schema": dg.TableSchema(columns)}


@dg.asset(
    deps=["tow_lists"],
    code_version=code_hash(*READING, *ADDING),
    check_specs=[dg.AssetCheckSpec("most_tows_sound", asset="samples")],
    metadata=_columns(SAMPLE_SCHEMA),
    partitions_def=SEASONS,
    group_name="archive",
    kinds={"parquet"},
    owners=OWNERS,
    tags=SUBJECT,
)
def samples(
    context: dg.AssetExecutionContext, setup: Setup, progress: dg.ResourceParam[Progress]
) -> Iterator[dg.MaterializeResult]:
    """The samples of the tows of seasons, in Parquet; faulty tows are set aside."""
    store, root = setup.store, setup.archive_root
    asked, read = setup.wanted(context.partition_keys), set()

    def work() -> None:
        stale = intake.stale_seasons(store, root, asked)
        progress.expect(intake.count_listed(store, stale))
        reading = partial(read_season, store.root, root)
        if len(stale) == 1 and setup.settings.dask is None:
            intake.read_season(store, root, stale[0], progress.tow_read)
            read.update(stale)
            return
        for season, tows in setup.map(reading, stale):
            read.add(season)
            for tow_id, is_set_aside in tows:
                progress.tow_read(tow_id, is_set_aside)

    intake.index(store, root)
    mending(store, work, again=partial(intake.index, store, root))
    yield dg.MaterializeResult(check_results=[_most_tows_sound(store)])
    for season in asked:
        index = store.read("season_index", str(season))
        faulty = index.drop_nulls("reason_code")
        metadata = {
            "dagster/row_count": int(index["samples"].sum()),
            "tows": index.height - faulty.height,
            "set_aside": dict(faulty["reason_code"].value_counts(sort=True).rows()),
            "new": season in read,
        }
        contents = [store.contents(name, str(season)) for name in intake.READ]
        _record(context, season, contents, metadata)


def _most_tows_sound(store: Store) -> dg.AssetCheckResult:
    """Of all seasons, not those of this run: a check's result is that of the whole asset."""
    index = store.read_all("season_index")
    faulty = index["reason_code"].count()
    return dg.AssetCheckResult(
        passed=2 * faulty <= index.height,
        severity=dg.AssetCheckSeverity.WARN,
        metadata={"set_aside": faulty, "listed": index.height},
    )


@dg.asset(
    deps=[samples],
    code_version=code_hash(*ADDING),
    metadata=_columns(BLOCK_SCHEMA),
    partitions_def=SEASONS,
    group_name="archive",
    kinds={"parquet"},
    owners=OWNERS,
    tags=SUBJECT,
)
def blocks(context: dg.AssetExecutionContext, setup: Setup) -> Iterator[dg.MaterializeResult]:
    """Sums over each second of each run of seasons."""
    store = setup.store
    asked, collected = setup.wanted(context.partition_keys), set()
    for season in asked:
        work = partial(intake.collect_blocks, store, season)
        again = partial(intake.read_season, store, setup.archive_root, season)
        if intake.blocks_are_stale(store, season):
            mending(store, work, again)
            collected.add(season)
    yield dg.MaterializeResult()
    for season in asked:
        metadata = {
            "dagster/row_count": store.count_rows("blocks", str(season)),
            "new": season in collected,
        }
        _record(context, season, store.contents("blocks", str(season)), metadata)


def _record(
    context: dg.AssetExecutionContext, season: int, state: object, metadata: Mapping[str, Any]
) -> None:
    """Records a season once more, with a version of its own: a result has one for a whole range."""
    key, partition = context.asset_key, str(season)
    here = dg.AssetRecordsFilter(asset_key=key, asset_partitions=[partition])
    (last,) = context.instance.fetch_materializations(here, limit=1).records
    assert last.asset_materialization is not None  # noqa: S101 - the event that Dagster just wrote
    tags = {**(last.asset_materialization.tags or {}), VERSION_TAG: fingerprint(state)}
    context.log_event(
        dg.AssetMaterialization(key, partition=partition, metadata=metadata, tags=tags)
    )
