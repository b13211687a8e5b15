"""The Dagster code location loads: every table an asset, every edge a table that is read."""

import dagster as dg
import pytest

from assets.definitions import ASSETS, build_defs, require_assets
from pipeline.tables.schemas import TABLES
from warehouse.intake.seasons import INDEXED

BARE = {
    *("samples", "blocks", "read_tows", "read_runs", "set_aside", "failed_tows", "unforeseen"),
    *("applied_methods", "decisions", "published_register", "published_register_history"),
    *(
        "published_register_changes",
        "published_lineage",
        "differences_that_matter",
        "objection_terms",
        "tolerances",
    ),
    *("warehouse_database", "site", "check_results", "report"),
}
"""Tables between assets, which no reader has: their columns are not declared."""

defs = build_defs("archive", "data", [])


def test_definitions_are_loadable():
    dg.Definitions.validate_loadable(defs)


def test_every_table_is_made_by_an_asset():
    keys = defs.resolve_asset_graph().materializable_asset_keys
    made = {key.to_user_string() for key in keys}
    assert set(TABLES) - made == set()
    assert {"samples", "blocks", "warehouse_database", "site"} <= made


def test_a_table_that_no_asset_makes_is_named():
    with pytest.raises(LookupError, match=r"no asset makes the table runs_per_season, .*assets/"):
        require_assets(ASSETS, [*TABLES, "runs_per_season"])


def test_every_asset_says_what_it_is_and_a_table_its_columns():
    graph = defs.resolve_asset_graph()
    nodes = [graph.get(key) for key in graph.materializable_asset_keys]
    for node in nodes:
        assert node.group_name != "default", node.key
        assert node.code_version, node.key
        assert node.description, node.key
    bare = {n.key.to_user_string() for n in nodes if "dagster/column_schema" not in n.metadata}
    assert bare == {*INDEXED, *BARE}


def test_an_edge_is_a_table_that_is_read():
    graph = defs.resolve_asset_graph()

    def read(table):
        return {key.to_user_string() for key in graph.get(dg.AssetKey(table)).parent_keys}

    assert read("era_shifts") == {"repeat_pairs", "boats"}
    assert read("type_consistency") == {
        *("curves", "run_points", "tows", "boats", "repeat_pairs", "listed_races"),
        *("differences_that_matter", "crew_classes"),
    }
    assert read("race_changes") == {
        *("register_changes", "register_history", "listed_races", "crew_classes")
    }
    assert read("blocks") == {"samples"}
    assert read("samples") == {"listed_tows", "listed_runs", "season_profiles"}


def test_nothing_begins_by_itself_unless_it_is_served():
    served = build_defs("archive", "data", [], is_served=True)
    for location, status in ((defs, "STOPPED"), (served, "RUNNING")):
        begins = [*location.schedules, *location.sensors]
        assert [one.default_status.value for one in begins] == 4 * [status]
