"""From blocks to the tables of the warehouse: light, all seasons at once, once per method."""

import datetime as dt

import dagster as dg
import polars as pl

from herijk.assets.archive import archive_index, blocks, samples
from herijk.assets.partitions import methods
from herijk.assets.resources import Setup
from herijk.pipeline.method.definition import shipped_method
from herijk.warehouse.build import tables
from herijk.warehouse.build.summaries import (
    SUMMARY_TABLES,
    SUMMED,
    SUMMED_OF_METHODS,
    make_summaries,
)


def _results(rows: dict[str, int]) -> list[dg.MaterializeResult]:
    return [
        dg.MaterializeResult(asset_key=name, metadata={"dagster/row_count": count})
        for name, count in rows.items()
    ]


@dg.multi_asset(
    specs=[
        dg.AssetSpec(name, deps=[archive_index, samples], group_name="tables", kinds={"parquet"})
        for name in tables.ARCHIVE_TABLES
    ],
    check_specs=[dg.AssetCheckSpec("every_listed_tow_accounted_for", asset="tows")],
)
def archive_tables(setup: Setup):
    """Boats, sound tows with their runs, and what was set aside."""
    store = setup.store
    yield from _results(tables.collect_archive(store, dt.date.today()))
    lost = tables.unaccounted_tows(store)
    yield dg.AssetCheckResult(
        check_name="every_listed_tow_accounted_for",
        asset_key="tows",
        passed=not lost,
        metadata={"lost": dg.MetadataValue.json(lost)},
    )


all_blocks = dg.AssetDep(blocks, partition_mapping=dg.AllPartitionMapping())
"""Every method needs the blocks of every season."""


@dg.multi_asset(
    specs=[
        dg.AssetSpec(
            name,
            deps=["boats", "tows", "tow_runs", "hand_windows", all_blocks],
            group_name="method",
            kinds={"parquet"},
        )
        for name in (*tables.METHOD_TABLES, *tables.METHOD_FILES)
    ],
    partitions_def=methods,
    check_specs=[dg.AssetCheckSpec("every_tow_has_a_curve_row", asset="curves")],
)
def method_tables(context: dg.AssetExecutionContext, setup: Setup):
    """Run points, curves, log factors, assessments and members of all tows under one method."""
    store = setup.store
    method = shipped_method(context.partition_key)
    found = tables.apply_method(store, method, tables.run_blocks(store))
    statuses = found["curves"]["status"].value_counts().sort("status").rows()
    for name, frame in found.items():
        yield dg.MaterializeResult(
            asset_key=name,
            metadata={
                "dagster/row_count": frame.height,
                "method_hash": method.content_hash,
                "statuses": dg.MetadataValue.json(dict(statuses)),
            },
        )
    yield dg.AssetCheckResult(
        check_name="every_tow_has_a_curve_row",
        asset_key="curves",
        passed=found["curves"].height == store.read("tows").height,
    )


@dg.multi_asset(
    specs=[
        dg.AssetSpec(
            name, deps=["tows", "tow_runs", blocks], group_name="method", kinds={"parquet"}
        )
        for name in tables.STUDY_TABLES
    ],
    check_specs=[dg.AssetCheckSpec("steps_multiply_to_the_total", asset="correction_steps")],
)
def study_tables(setup: Setup):
    """What each step of a method changes, and how much choices of judgement matter."""
    store = setup.store
    rows = tables.make_studies(store, setup.chosen_methods, tables.run_blocks(store))
    yield from _results(rows)
    yield dg.AssetCheckResult(
        check_name="steps_multiply_to_the_total",
        asset_key="correction_steps",
        passed=tables.ladders_multiply(store.read("correction_steps")),
    )


@dg.multi_asset(
    specs=[
        dg.AssetSpec(
            name, deps=["curves", "tows", "boats"], group_name="register", kinds={"parquet"}
        )
        for name in tables.REGISTER_TABLES
    ],
)
def register_tables(setup: Setup):
    """Draft registers, who is due, what changes between registers, and lineage."""
    yield from _results(tables.make_registers(setup.store, setup.chosen_methods))


@dg.multi_asset(
    specs=[
        dg.AssetSpec(
            name,
            deps=["curves", "run_points", "tows", "boats"],
            group_name="consistency",
            kinds={"parquet"},
        )
        for name in tables.CONSISTENCY_TABLES
    ],
)
def consistency_tables(setup: Setup):
    """Are equal boats equal: the statistics of every boat type under every method."""
    yield from _results(tables.make_consistency(setup.store, setup.chosen_methods))


@dg.multi_asset(
    specs=[
        dg.AssetSpec(
            name,
            deps=[*SUMMED, *SUMMED_OF_METHODS, all_blocks],
            group_name="summaries",
            kinds={"parquet"},
        )
        for name in SUMMARY_TABLES
    ],
)
def summary_tables(setup: Setup):
    """What many tows have in common, and races replayed under every edition."""
    names = [method.name for method in setup.chosen_methods]
    yield from _results(make_summaries(setup.store, names))


@dg.asset(
    deps=[*tables.WHOLE_TABLES, *tables.METHOD_TABLES],
    group_name="register",
    kinds={"duckdb"},
)
def warehouse_database(setup: Setup) -> dg.MaterializeResult:
    """All tables in one DuckDB file, swapped in whole."""
    rows = tables.make_database(setup.store, setup.chosen_methods)
    frame = pl.DataFrame({"table": list(rows), "rows": list(rows.values())}).sort("table")
    return dg.MaterializeResult(
        metadata={
            "dagster/row_count": sum(rows.values()),
            "tables": dg.MetadataValue.md(_markdown(frame)),
        }
    )


def _markdown(frame: pl.DataFrame) -> str:
    with pl.Config(
        tbl_formatting="MARKDOWN",
        tbl_hide_dataframe_shape=True,
        tbl_hide_column_data_types=True,
        tbl_rows=-1,
    ):
        return str(frame)
