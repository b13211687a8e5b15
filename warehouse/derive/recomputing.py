"""Recompute all tows under all methods, so that a fault of our own costs one tow or one method.

All tows of a method are computed together, because they share season factors. Where that raises an
error that nobody foresaw, each tow is computed alone; those that raise are left out, and the rest
is computed together again.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Final

import polars as pl

from pipeline.blocks.run_blocks import stack_blocks
from pipeline.method.definition import Method
from pipeline.recompute.facts import add_boats, add_hand_windows
from pipeline.recompute.recompute import recompute
from pipeline.recompute.run_cache import RunCache
from warehouse.archive.faults import Fault, make_fault_frame
from warehouse.derive.registers import draw_members
from warehouse.store.unforeseen import (
    UNFORESEEN,
    format_traceback,
    is_unforeseen,
    sentence,
    shorten_error,
)

METHOD_TABLES: Final = (
    "run_points", "curves", "log_factors", "season_links",
    "season_diagnosis", "tow_instruments", "best_estimate_weights", "uncertainty_budget",
    "curve_points", "tow_currents", "assessments", "ensemble",
)  # fmt: skip
"""The tables of all tows under a method."""


@dataclass(frozen=True)
class ArchiveRuns:
    """The tows of an archive that can be computed, and their runs.

    Attributes:
        boats: rows of `boats`.
        tows: rows of `tows`.
        tow_runs: rows of `tow_runs`.
        hand_windows: rows of `hand_windows`.
        blocks: the sums per second of all runs.
        crew_classes: rows of `crew_classes`.
    """

    boats: pl.DataFrame
    tows: pl.DataFrame
    tow_runs: pl.DataFrame
    hand_windows: pl.DataFrame
    blocks: pl.DataFrame
    crew_classes: pl.DataFrame

    def keep_only(self, tow_ids: Collection[str]) -> "ArchiveRuns":
        """Return the archive with these tows only."""
        is_chosen = pl.col("tow_id").is_in(list(tow_ids))
        return ArchiveRuns(
            boats=self.boats,
            tows=self.tows.filter(is_chosen),
            tow_runs=self.tow_runs.filter(is_chosen),
            hand_windows=self.hand_windows.filter(is_chosen),
            blocks=self.blocks.filter(is_chosen),
            crew_classes=self.crew_classes,
        )


@dataclass(frozen=True)
class RecomputedArchive:
    """What all methods make of an archive.

    Attributes:
        tables: `METHOD_TABLES` by name, with the rows of all methods that could be computed.
        tows, tow_runs: those that could be computed.
        set_aside: a fault for each tow on which our code failed.
        failures: text columns `what` (a tow or a method) and `trace`, the traceback.
    """

    tables: dict[str, pl.DataFrame]
    tows: pl.DataFrame
    tow_runs: pl.DataFrame
    set_aside: pl.DataFrame
    failures: pl.DataFrame


def recompute_archive(methods: Sequence[Method], archive: ArchiveRuns) -> RecomputedArchive:
    """Recompute all tows under all methods.

    Raises:
        MissingKnowledgeError: a method says nothing about a season.
        Exception: an unforeseen error that every method raises: there is nothing to go on with.
    """
    made, errors = _recompute_methods(methods, archive)
    sound = archive
    failing: dict[str, BaseException] = {}
    for method in methods:
        if method.name in errors:
            failing = find_failing_tows(method, archive) | failing
    if failing:
        sound = archive.keep_only(set(archive.tows["tow_id"]) - set(failing))
        made, errors = _recompute_methods(methods, sound)
    if not made:
        raise next(iter(errors.values()))
    failures = {f"tow {tow_id}": format_traceback(error) for tow_id, error in failing.items()}
    failures |= {f"method {name}": format_traceback(error) for name, error in errors.items()}
    paths = dict(archive.tows.select("tow_id", "samples_path").rows())
    faults = []
    for tow_id, error in failing.items():
        message = sentence(tow_id, shorten_error(error))
        fault = Fault(path=paths[tow_id], tow_id=tow_id, reason_code=UNFORESEEN, message=message)
        faults.append(fault)
    return RecomputedArchive(
        tables={name: pl.concat([one[name] for one in made]) for name in METHOD_TABLES},
        tows=sound.tows,
        tow_runs=sound.tow_runs,
        set_aside=make_fault_frame(faults),
        failures=pl.DataFrame(
            {"what": list(failures), "trace": list(failures.values())},
            schema={"what": pl.String, "trace": pl.String},
        ),
    )


def find_failing_tows(method: Method, archive: ArchiveRuns) -> dict[str, BaseException]:
    """Return the tows that raise an unforeseen error when computed alone, with the error.

    None where every tow does: then the method is at fault, not a tow.
    """
    failing: dict[str, BaseException] = {}
    for tow_id in archive.tows["tow_id"]:
        try:
            _recompute(method, archive.keep_only([tow_id]), RunCache())
        except BaseException as error:
            if not is_unforeseen(error):
                raise
            failing[tow_id] = error
    return {} if len(failing) == archive.tows.height else failing


def _recompute_methods(
    methods: Sequence[Method], archive: ArchiveRuns
) -> tuple[list[dict[str, pl.DataFrame]], dict[str, BaseException]]:
    """Return `METHOD_TABLES` of each method, and the unforeseen error of those that failed."""
    made = []
    errors: dict[str, BaseException] = {}
    cache = RunCache()
    for method in methods:
        try:
            made.append(_recompute(method, archive, cache))
        except BaseException as error:
            if not is_unforeseen(error):
                raise
            errors[method.name] = error
    return made, errors


def _recompute(method: Method, archive: ArchiveRuns, cache: RunCache) -> dict[str, pl.DataFrame]:
    """Return `METHOD_TABLES` of one method."""
    runs = stack_blocks(archive.blocks, add_hand_windows(archive.tow_runs, archive.hand_windows))
    tows = add_boats(archive.tows, archive.boats)
    made = recompute(method, tows, runs, cache, crew_classes=archive.crew_classes)
    return vars(made) | {"ensemble": draw_members(method, made)}
