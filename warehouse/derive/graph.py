"""The steps of a build, each declared once, in the order in which they are made."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from pipeline.consistency.eras import era_shifts
from pipeline.consistency.tables import line_tables
from pipeline.method.definition import Method
from pipeline.studies.claims import print_reproduction
from pipeline.tables.views import VIEWS
from warehouse.derive import consistency, database, registers, summaries
from warehouse.derive.archive_tables import archive_tables
from warehouse.derive.inputs import (
    ARCHIVE_TABLES,
    LINE_TABLES,
    METHOD_TABLES,
    STUDY_TABLES,
    TYPE_TABLES,
)
from warehouse.derive.method_tables import method_tables
from warehouse.derive.step import Step
from warehouse.derive.studies import study_tables
from warehouse.intake import seasons as intake
from warehouse.store.code import COMPUTING
from warehouse.store.store import Store

ARCHIVE: Final = Step("archive", archive_tables, ARCHIVE_TABLES)
METHOD: Final = Step("method", method_tables, METHOD_TABLES)
STUDIES: Final = Step("studies", study_tables, STUDY_TABLES)
LINES: Final = Step("lines", line_tables, LINE_TABLES)
TYPES: Final = Step("consistency", consistency.type_tables, TYPE_TABLES)
REGISTERS: Final = Step(
    "register",
    registers.register_tables,
    ("register", "register_history", "editions", "register_changes", "lineage", "methods"),
)
DATABASE: Final = Step(
    "database",
    database.warehouse_database,
    (database.DATABASE_TABLE,),
    code=(*COMPUTING, "warehouse.store.package"),
    also=str((database.MEANINGS, VIEWS)),
    is_whole=database.is_whole,
)

STEPS: Final = (
    ARCHIVE,
    Step("recordings", summaries.recording_tables, ("trace_seconds", "run_statistics")),
    *(METHOD, STUDIES, LINES, TYPES),
    *(
        Step("consistency", compute, (compute.__name__,))
        for compute in (
            consistency.slow_tows,
            consistency.repeat_pairs,
            era_shifts,
            consistency.reproducibility,
        )
    ),
    REGISTERS,
    Step("register", registers.due_list, ("due_list",)),
    *(
        Step("summaries", compute, (compute.__name__,))
        for compute in (
            summaries.race_changes,
            summaries.season_changes,
            print_reproduction,
        )
    ),
    DATABASE,
)
"""Every step comes after those whose tables it reads."""


def catch_up(store: Store, archive: Path, methods: Sequence[Method], step: Step) -> None:
    """Makes again what a step reads and what is not there as it should be."""
    intake.index(store, archive)
    for season in intake.damaged_seasons(store):
        intake.read_season(store, archive, season)
        intake.collect_blocks(store, season)
    for before in STEPS[: STEPS.index(step)]:
        for scope in before.stale(store, methods):
            before.make(scope)
