"""The steps of a build as assets: what `warehouse.derive.graph` declares, as Dagster sees it."""

import logging
from collections.abc import Iterator, Sequence
from functools import partial
from typing import Final

import dagster as dg

from assets.resources import Setup
from assets.site import SITE
from assets.workers import in_parallel, make_step
from pipeline.messages import say
from pipeline.tables.declare import dy
from pipeline.tables.schemas import TABLES
from warehouse.derive.graph import STEPS, catch_up
from warehouse.derive.inputs import Scope, state_of_table
from warehouse.derive.mending import mending
from warehouse.derive.step import Step
from warehouse.intake.seasons import SEASON_TABLES
from warehouse.store.code import code_hash
from warehouse.store.store import fingerprint

TITLES: Final = {
    "archive": say("boats, tows and what is set aside"),
    "recordings": say("the recordings of each run"),
    "method": say("curves under each method"),
    "studies": say("what each step of a method changes"),
    "lines": say("lines through the boats of a type"),
    "consistency": say("whether equal boats are equal"),
    "register": say("registers"),
    "summaries": say("summaries"),
    "database": say("the database"),
}
"""What a terminal says that a step makes, by its group."""


def step_asset(step: Step) -> dg.AssetsDefinition:
    """The assets of a step: one per table."""
    title = say("making the site")
    if step in STEPS:
        title = say("step {} of {}: {}", STEPS.index(step) + 1, len(STEPS), TITLES[step.group])

    @dg.multi_asset(
        name=step.name,
        description=step.compute.__doc__,
        specs=[_spec(step, table) for table in step.outputs],
    )
    def asset(setup: Setup) -> Iterator[dg.MaterializeResult]:
        yield from make(step, title, setup)

    return asset


def make(step: Step, title: str, setup: Setup) -> Iterator[dg.MaterializeResult]:
    """Makes the tables of a step, or confirms them where what they are made of is unchanged."""
    store, methods = setup.store, setup.chosen_methods
    new: list[str] = []

    def work() -> None:
        stale = step.stale(store, methods)
        if stale:
            logging.getLogger("herijk").info(title)
        side_by_side = setup.map(partial(make_step, step.name), stale)
        for scope, _ in side_by_side if step.per_method else in_parallel(step.make, stale):
            new.append(scope.at_hand.name)

    mending(store, work, again=partial(catch_up, store, setup.archive_root, methods, step))
    scope = Scope(store, methods)
    for table in step.outputs:
        partitions: Sequence[str | None] = scope.partitions(table) or [None]
        yield dg.MaterializeResult(
            asset_key=table,
            data_version=dg.DataVersion(fingerprint(state_of_table(scope, table))),
            metadata={
                "dagster/row_count": sum(store.count_rows(table, p) for p in partitions),
                "new": list(dict.fromkeys(new)),
            },
        )


def _spec(step: Step, table: str) -> dg.AssetSpec:
    """A table with its meaning, its columns and what it is made from."""
    schema = TABLES.get(table)
    return dg.AssetSpec(
        table,
        deps=[_dep(asset) for asset in _assets_read(step)],
        description=(schema or step.compute).__doc__,
        metadata=None if schema is None else {"dagster/column_schema": _columns(schema)},
        group_name=step.group,
        code_version=code_hash(*step.code),
    )


def _assets_read(step: Step) -> list[str]:
    """Methods, decisions and editions are no assets: the fingerprints know them."""
    return list(dict.fromkeys("samples" if t in SEASON_TABLES else t for t in step.reads))


def _dep(asset: str) -> dg.AssetDep:
    every = dg.AllPartitionMapping() if asset in ("samples", "blocks") else None
    return dg.AssetDep(asset, partition_mapping=every)


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


STEP_ASSETS = [step_asset(step) for step in (*STEPS, SITE)]
