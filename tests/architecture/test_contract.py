"""The tables that other programs rely on: none lost, every column explained.

The lists below are the promise, written down apart from the code. A line may be added; to change
one, say so in CHANGELOG.md under Data.
"""

import re

import pytest

from pipeline.channels import MOST_RUNS, SECOND_FILE_OFFSET
from pipeline.tables.schemas import TABLES

PROMISED = {
    "boats": "fsn_no ht_no name boat_type",
    "tows": "tow_id season tow_date fsn_no rowers crew_class declared_speed_m_s"
    " waterline_length_m beam_m bow_height_m weight_kg crew_weight_kg water_temperature_c altered",
    "run_points": "method tow_id run window_start_s window_end_s speed_m_s cw_kg_m cw_sd used"
    " reason",
    "curves": "method tow_id fsn_no season rowers crew_class declared_speed_m_s a_kg_m b_m_s"
    " b_capped cw_kg_m cw_lo_kg_m cw_hi_kg_m b_lo_m_s b_hi_m_s runs_used status flags",
    "log_factors": "method season factor lo hi source",
    "register": "edition method fsn_no rowers crew_class tow_id tow_date valid_until"
    " declared_speed_m_s a_kg_m b_m_s cw_kg_m cw_lo_kg_m cw_hi_kg_m status",
    "register_changes": "from_edition to_edition fsn_no rowers crew_class change cw_ratio"
    " power_ratio time_ratio causes",
    "type_lines": "method tows boat_type quantity explaining n slope slope_lo slope_hi r2"
    " residual_sd_ratio",
    "reproducibility": "method scope n_pairs sd_ratio lo hi share_within_1pct share_within_2pct",
    "quarantine": "path tow_id line reason_code message first_seen",
    "methods": "method title title_en content_hash definition",
    "lineage": "edition fsn_no rowers crew_class tow_id path sha256 method method_hash"
    " code_version",
}

UNITS = {"m_s": "m/s", "n": "N", "kg_m": "kg/m", "kg": "kg", "m": "m", "s": "s", "w": "W", "c": "C"}
"""Endings of column names and the unit each stands for, longest first."""


def columns():
    """Every column of every table, with the name of its table."""
    for table, schema in TABLES.items():
        for name, column in schema.columns().items():
            yield f"{table}.{name}", column


@pytest.mark.parametrize("table", PROMISED)
def test_promised_columns_are_there(table):
    assert set(PROMISED[table].split()) - set(TABLES[table].column_names()) == set()


@pytest.mark.parametrize("table", TABLES)
def test_every_table_is_explained(table):
    assert (TABLES[table].__doc__ or "").strip()


def test_every_column_is_explained():
    assert [name for name, column in columns() if not column.description] == []


def test_a_unit_in_a_name_is_the_declared_unit():
    wrong = []
    for name, column in columns():
        declared = (column.metadata or {}).get("unit")
        ending = re.search(r"_(m_s|kg_m|kg|m|s|n|w|c)$", name)
        if ending and declared not in (None, "1", UNITS[ending[1]]):
            wrong.append(f"{name} is in {declared}")
    assert wrong == []


def test_every_run_that_a_plan_or_a_second_file_can_have_fits_every_table():
    most = {name: t.columns()["run"].max for name, t in TABLES.items() if "run" in t.columns()}
    assert set(most.values()) == {SECOND_FILE_OFFSET + MOST_RUNS}, most
