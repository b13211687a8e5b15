"""The Dagster code location loads, and nobody adds or loses an asset without noticing."""

import dagster as dg

from assets.archive import OUTSIDE
from assets.definitions import build_defs, defs
from assets.settings import Settings
from warehouse.intake.seasons import INDEXED

ASSETS = [
    "about_archive",
    "assessments",
    "best_estimate_weights",
    "blocks",
    "boats",
    "check_counts",
    "compared_tows",
    "correction_steps",
    "curve_points",
    "curves",
    "due_list",
    "editions",
    "ensemble",
    "era_shifts",
    "hand_windows",
    "hull_speed",
    "lineage",
    "list_faults",
    "listed_boats",
    "listed_files",
    "listed_races",
    "listed_runs",
    "listed_tows",
    "listed_windows",
    "log_factors",
    "methods",
    "option_curves",
    "option_effects",
    "option_summary",
    "pooled_curves",
    "predicted_cw",
    "prediction_error",
    "print_reproduction",
    "print_summary",
    "printed_registers",
    "promise",
    "quality_counts",
    "quarantine",
    "race_changes",
    "register",
    "register_changes",
    "register_history",
    "repeat_pairs",
    "reproducibility",
    "retow_choice",
    "run_points",
    "run_statistics",
    "samples",
    "season_changes",
    "season_diagnosis",
    "season_ladder",
    "season_links",
    "season_steps",
    "seasons",
    "site",
    "slow_tows",
    "speed_trend",
    "tow_instruments",
    "tow_runs",
    "tows",
    "trace_seconds",
    "type_consistency",
    "type_homogeneity",
    "type_line_points",
    "type_lines",
    "type_outliers",
    "uncertainty_budget",
    "variance_components",
    "warehouse_database",
]

CHECKS = [
    "samples: most_tows_sound",
    "warehouse_database: boats_stayed_within_their_intervals",
    "warehouse_database: counts_agree",
    "warehouse_database: editions_can_be_made_again",
    "warehouse_database: every_listed_tow_accounted_for",
    "warehouse_database: every_tow_has_a_curve_row",
    "warehouse_database: few_tows_set_aside",
    "warehouse_database: log_factors_stayed",
    "warehouse_database: steps_multiply_to_the_total",
    "warehouse_database: tables_fit_their_schemas",
]


def test_definitions_are_loadable():
    dg.Definitions.validate_loadable(defs)


def test_assets_are_those_listed():
    keys = defs.resolve_asset_graph().get_all_asset_keys()
    assert sorted(key.to_user_string() for key in keys) == sorted([*ASSETS, *OUTSIDE])


def test_checks_are_those_listed():
    keys = defs.resolve_asset_graph().asset_check_keys
    assert sorted(f"{key.asset_key.to_user_string()}: {key.name}" for key in keys) == CHECKS


def test_every_asset_says_what_it_is_and_whose():
    graph = defs.resolve_asset_graph()
    for node in map(graph.get, graph.materializable_asset_keys):
        assert node.group_name != "default", node.key
        assert node.kinds, node.key
        assert node.owners, node.key
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

    assert read("season_ladder") == {"correction_steps", "tows"}
    assert read("check_counts") == {"assessments"}
    assert read("race_changes") == {"register_changes", "register_history", "listed_races"}
    assert read("blocks") == {"samples"}
    assert read("samples") == {"tow_lists"}


def test_nothing_begins_by_itself_unless_it_is_served():
    served = build_defs("archive", "data", Settings(), is_served=True)
    for location, status in ((defs, "STOPPED"), (served, "RUNNING")):
        begins = [*location.schedules, *location.sensors]
        assert {one.default_status.value for one in begins} == {status}
