"""The steps of a build, each declared once, in the order in which they are made."""

from typing import Final

from herijk.pipeline.method.definition import Method
from herijk.tables.schemas import TABLES
from herijk.warehouse.build.archive_tables import archive_tables, unaccounted_tows
from herijk.warehouse.build.consistency import consistency_tables, line_tables
from herijk.warehouse.build.database import (
    DATABASE_TABLE,
    MEANINGS,
    is_whole,
    warehouse_database,
)
from herijk.warehouse.build.inputs import ARCHIVE_TABLES, FAILED, METHOD_TABLES, PUBLISHED
from herijk.warehouse.build.method_tables import RUNS, method_tables, tows_without_curve_row
from herijk.warehouse.build.recordings import recording_tables
from herijk.warehouse.build.registers import register_tables
from herijk.warehouse.build.step import Check, Step
from herijk.warehouse.build.studies import ladders_that_do_not_multiply, study_tables
from herijk.warehouse.build.summaries import summary_tables
from herijk.warehouse.store.code import FAULTS_IN_DUTCH

LAKE_ONLY: Final = ("ensemble",)
"""Tables that are not in the database: 200 rows per tow would make up most of it."""


def _register_rules(method: Method) -> object:
    return method.validity, method.title, method.title_en, method.interval


ARCHIVE: Final = Step(
    name="archive",
    says="collecting boats, tows and what was set aside",
    inputs=(
        *("list_faults", "listed_boats", "listed_windows"),
        *("season_tows", "season_runs", "season_index", "blocks", FAILED),
    ),
    outputs=ARCHIVE_TABLES,
    compute=archive_tables,
    words=(FAULTS_IN_DUTCH,),
    checks=(Check("every_listed_tow_accounted_for", "tows", unaccounted_tows),),
)
RECORDINGS: Final = Step(
    name="recordings",
    says="averaging what the instruments said",
    inputs=("tows", "blocks"),
    outputs=("trace_seconds", "run_statistics"),
    compute=recording_tables,
)
METHOD: Final = Step(
    name="method",
    says="applying method {} to all tows",
    inputs=RUNS,
    outputs=METHOD_TABLES,
    compute=method_tables,
    checks=(Check("every_tow_has_a_curve_row", "curves", tows_without_curve_row),),
)
STUDIES: Final = Step(
    name="studies",
    says="finding what each step changes, and how much choices matter",
    inputs=(*RUNS, "tow_instruments", "curves"),
    outputs=("correction_steps", "option_effects", "option_curves"),
    compute=study_tables,
    checks=(
        Check("steps_multiply_to_the_total", "correction_steps", ladders_that_do_not_multiply),
    ),
)
LINES: Final = Step(
    name="lines",
    says="drawing lines through boats of the same type",
    inputs=("curves", "run_points", "tows", "boats"),
    outputs=("type_lines", "type_line_points", "type_consistency"),
    compute=line_tables,
)
CONSISTENCY: Final = Step(
    name="consistency",
    says="comparing boats of the same type",
    inputs=("curves", "run_points", "tows", "boats", "listed_races"),
    outputs=(
        "compared_tows",
        "hull_speed",
        "type_outliers",
        "type_homogeneity",
        "pooled_curves",
        "speed_trend",
        "slow_tows",
        "repeat_pairs",
        "era_shifts",
        "reproducibility",
        "variance_components",
        "predicted_cw",
        "prediction_error",
    ),
    compute=consistency_tables,
)
REGISTERS: Final = Step(
    name="register",
    says="making registers",
    inputs=(
        *("curves", "tows", "boats", "listed_boats", "listed_races", "decisions"),
        *PUBLISHED,
    ),
    outputs=(
        *("register", "register_history", "due_list", "editions", "register_changes"),
        *("lineage", "methods"),
    ),
    compute=register_tables,
    of_method=_register_rules,
)
SUMMARIES: Final = Step(
    name="summaries",
    says="summing up",
    inputs=(
        *("tows", "curves", "run_points", "assessments", "listed_races"),
        *("register_history", "register_changes", "correction_steps", "option_effects"),
        *("repeat_pairs", "printed_registers"),
    ),
    outputs=(
        "race_changes",
        "season_changes",
        "season_ladder",
        "option_summary",
        "quality_counts",
        "check_counts",
        "promise",
        "print_reproduction",
        "print_summary",
    ),
    compute=summary_tables,
)
DATABASE: Final = Step(
    name="database",
    says="making the database",
    inputs=(*(name for name in TABLES if name not in LAKE_ONLY), "about_archive"),
    outputs=(DATABASE_TABLE,),
    compute=warehouse_database,
    also=MEANINGS,
    is_whole=is_whole,
)

STEPS: Final = (
    *(ARCHIVE, RECORDINGS, METHOD, STUDIES, LINES),
    *(CONSISTENCY, REGISTERS, SUMMARIES, DATABASE),
)
"""Every step comes after those whose tables it reads."""
