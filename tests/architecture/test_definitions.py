"""The Dagster code location loads, and nobody adds or loses an asset without noticing."""

import dagster as dg
import polars as pl

from herijk.assets.definitions import ASSETS as DEFINED
from herijk.assets.definitions import build_defs, defs
from herijk.assets.settings import Settings
from herijk.assets.shown import PAGES, preview, with_site
from tests.conftest import METHODS

ASSETS = [
    "archive_index",
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
    "correction_steps: steps_multiply_to_the_total",
    "curves: every_tow_has_a_curve_row",
    "log_factors: log_factors_stayed",
    "quarantine: few_tows_set_aside",
    "register: boats_stayed_within_their_intervals",
    "register: editions_can_be_made_again",
    "samples: most_tows_sound",
    "tows: every_listed_tow_accounted_for",
    "warehouse_database: counts_agree",
    "warehouse_database: tables_fit_their_schemas",
]


def test_definitions_are_loadable():
    dg.Definitions.validate_loadable(defs)


def test_assets_are_those_listed():
    keys = defs.resolve_asset_graph().get_all_asset_keys()
    assert sorted(key.to_user_string() for key in keys) == ASSETS


def test_checks_are_those_listed():
    keys = defs.resolve_asset_graph().asset_check_keys
    assert sorted(f"{key.asset_key.to_user_string()}: {key.name}" for key in keys) == CHECKS


def test_every_asset_says_what_it_is_and_whose():
    graph = defs.resolve_asset_graph()
    for node in map(graph.get, graph.get_all_asset_keys()):
        assert node.group_name != "default", node.key
        assert node.kinds, node.key
        assert node.owners, node.key
        assert node.code_version, node.key
        assert node.description, node.key


def test_every_asset_that_is_a_table_shows_its_columns():
    graph = defs.resolve_asset_graph()
    nodes = map(graph.get, graph.get_all_asset_keys())
    bare = {n.key.to_user_string() for n in nodes if "dagster/column_schema" not in n.metadata}
    assert bare == {"archive_index", "site", "warehouse_database"}


def test_one_table_can_be_made_alone(bench):
    before = {f.name: f.stat().st_mtime_ns for f in _tables(bench)}
    location = build_defs(str(bench.archive), str(bench.data), Settings(methods=METHODS))
    alone = dg.AssetSelection.assets("season_ladder")
    job = dg.define_asset_job("alone", alone - alone.checks())
    both = dg.Definitions.merge(location, dg.Definitions(jobs=[job]))
    assert both.resolve_job_def("alone").execute_in_process().success
    changed = {f.name for f in _tables(bench) if f.stat().st_mtime_ns != before[f.name]}
    assert changed == {"season_ladder.parquet"}
    assert not bench.rebuild().done.database  # what was made alone is what a rebuild makes


def _tables(bench):
    return (bench.data / "lake" / "tables").glob("*.parquet")


def test_assets_link_to_their_page_where_the_site_is_served():
    specs = [s for a in with_site(DEFINED, "http://127.0.0.1:3001/site") for s in a.specs]
    pages = {s.key.to_user_string(): s.metadata["page"].url for s in specs if "page" in s.metadata}
    assert pages.keys() == PAGES.keys()
    assert pages["register"] == "http://127.0.0.1:3001/site/register.html"


def test_a_table_that_people_look_for_is_seen_in_dagster():
    seen = preview("log_factors", pl.DataFrame({"season": [2009], "factor": [1.04259]}))
    assert "| 2009   | 1.0426 |" in seen["preview"].md_str
    assert preview("run_points", pl.DataFrame({"run": [1]})) == {}
