"""The steps of a build as assets: what `warehouse.build.graph` declares, as Dagster sees it."""

from collections.abc import Iterator
from typing import Any

import dagster as dg

from herijk.assets.events import Result
from herijk.assets.partitions import methods
from herijk.assets.resources import Setup
from herijk.assets.shown import preview
from herijk.tables.declare import dy
from herijk.tables.lake import SEASON_TABLES
from herijk.tables.schemas import TABLES
from herijk.warehouse.build.graph import STEPS
from herijk.warehouse.build.inputs import BLOCKS, DECISIONS, FAILED, PUBLISHED
from herijk.warehouse.build.step import Made, Step, Summary
from herijk.warehouse.intake.seasons import INDEXED

KINDS = {"warehouse_database": "duckdb"}
"""What an asset is stored as, where that is not Parquet."""

OWNERS = {
    "archive": "team:archive",
    "method": "team:method",
    "studies": "team:method",
    "lines": "team:method",
    "consistency": "team:method",
}
"""Who answers for the tables of a step, where it is not who publishes the register."""
PUBLISHER = "team:register"


def step_asset(step: Step) -> dg.AssetsDefinition:
    """The assets of a step: one per table, any of which can be made alone."""

    @dg.multi_asset(
        name=step.compute.__name__,
        description=step.compute.__doc__,
        specs=[_spec(step, table) for table in step.outputs],
        partitions_def=methods if step.per_method else None,
        check_specs=[dg.AssetCheckSpec(check.name, asset=check.table) for check in step.checks],
        can_subset=True,
    )
    def asset(context: dg.AssetExecutionContext, setup: Setup):  # type: ignore[no-untyped-def]
        chosen = setup.chosen_methods
        if step.per_method:
            chosen = [setup.known_methods.get(context.partition_key)]
        asked = {key.to_user_string() for key in context.selected_asset_keys}
        made = step.make(setup.store, chosen, wanted=asked)
        checks = {key.name for key in context.selected_asset_check_keys}
        for result in results_of(made):
            if isinstance(result, dg.MaterializeResult) or result.check_name in checks:
                yield result

    return asset


def _spec(step: Step, table: str) -> dg.AssetSpec:
    """A table with its meaning, its columns and what it is made from."""
    schema = TABLES.get(table)
    return dg.AssetSpec(
        table,
        deps={dep.asset_key: dep for name in step.inputs for dep in _deps(name)}.values(),
        description=(schema or step.compute).__doc__,
        metadata=None if schema is None else {"dagster/column_schema": _columns(schema)},
        group_name=step.name,
        kinds={KINDS.get(table, "parquet"), "polars"},
        owners=[OWNERS.get(step.name, PUBLISHER)],
        tags={} if schema is None else {"herijk/subject": schema.__module__.rpartition(".")[2]},
        code_version=step.code,
    )


def _deps(name: str) -> Iterator[dg.AssetDep]:
    """The asset behind an input of a step; decisions and editions are no assets."""
    if name in INDEXED:
        yield dg.AssetDep("archive_index")
    elif name in SEASON_TABLES or name == BLOCKS:
        asset = BLOCKS if name == BLOCKS else "samples"
        yield dg.AssetDep(asset, partition_mapping=dg.AllPartitionMapping())
    elif name not in (DECISIONS, FAILED, *PUBLISHED):
        yield dg.AssetDep(name)


def _columns(schema: type[dy.Schema]) -> dg.TableSchema:
    return dg.TableSchema(
        columns=[
            dg.TableColumn(
                name,
                str(column.dtype),
                column.description,
                dg.TableColumnConstraints(nullable=column.nullable),
            )
            for name, column in schema.columns().items()
        ]
    )


def _metadata(table: str, summary: Summary) -> dict[str, Any]:
    metadata: dict[str, Any] = {"dagster/row_count": summary.rows}
    if summary.statuses:
        metadata["statuses"] = dg.MetadataValue.json(summary.statuses)
    return metadata | preview(table, summary.first)


def results_of(made: Made) -> Iterator[Result]:
    """What a step made, and what does not hold of it."""
    for table, summary in made.tables.items():
        yield dg.MaterializeResult(asset_key=table, metadata=_metadata(table, summary))
    for check, faults in made.faults.items():
        yield dg.AssetCheckResult(
            check_name=check.name,
            asset_key=check.table,
            passed=not faults,
            metadata={"lost": dg.MetadataValue.json(list(faults))},
        )


STEP_ASSETS = {step.name: step_asset(step) for step in STEPS}
