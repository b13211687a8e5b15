"""The Dagster code location loads: every table an asset, every edge a table that is read."""

import dagster as dg

from assets.definitions import build_defs
from assets.settings import Settings
from pipeline.tables.schemas import TABLES
from warehouse.intake.seasons import INDEXED

CHECKS = [
    "warehouse_database: boats_stayed_within_their_intervals",
    "warehouse_database: editions_can_be_made_again",
    "warehouse_database: every_listed_tow_accounted_for",
    "warehouse_database: every_tow_has_a_curve_row",
    "warehouse_database: few_tows_set_aside",
    "warehouse_database: log_factors_stayed",
    "warehouse_database: steps_multiply_to_the_total",
    "warehouse_database: tables_fit_their_schemas",
]

defs = build_defs("archive", "data", Settings())


def test_definitions_are_loadable():
    dg.Definitions.validate_loadable(defs)


def test_every_table_is_an_asset():
    keys = {key.to_user_string() for key in defs.resolve_asset_graph().get_all_asset_keys()}
    assert set(TABLES) - keys == set()
    assert {"samples", "blocks", "warehouse_database", "site"} <= keys


def test_checks_are_those_listed():
    keys = defs.resolve_asset_graph().asset_check_keys
    assert sorted(f"{key.asset_key.to_user_string()}: {key.name}" for key in keys) == CHECKS


def test_every_asset_says_what_it_is():
    graph = defs.resolve_asset_graph()
    for node in map(graph.get, graph.materializable_asset_keys):
        assert node.group_name != "default", node.key
        assert node.code_version, node.key
        assert node.description, node.key


def test_every_asset_that_is_a_table_shows_its_columns():
    graph = defs.resolve_asset_graph()
    nodes = map(graph.get, graph.materializable_asset_keys)
    bare = {n.key.to_user_string() for n in nodes if "dagster/column_schema" not in n.metadata}
    assert bare == {*INDEXED, "site", "warehouse_database"}


def test_an_edge_is_a_table_that_is_read():
    graph = defs.resolve_asset_graph()

    def read(table):
        return {key.to_user_string() for key in graph.get(dg.AssetKey(table)).parent_keys}

    assert read("era_shifts") == {"repeat_pairs", "boats"}
    assert read("type_lines") == {"curves", "run_points", "tows", "boats"}
    assert read("race_changes") == {"register_changes", "register_history", "listed_races"}
    assert read("blocks") == {"samples"}
    assert read("samples") == {"listed_tows", "listed_runs"}


def test_nothing_begins_by_itself_unless_it_is_served():
    served = build_defs("archive", "data", Settings(), is_served=True)
    for location, status in ((defs, "STOPPED"), (served, "RUNNING")):
        begins = [*location.schedules, *location.sensors]
        assert [one.default_status.value for one in begins] == 3 * [status]
