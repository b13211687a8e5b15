"""A tow on the quay: what `herijk assess` says of it.

What was found and how bad it is, is judged in `pipeline.assessment.first_assessment`. This module
prepares the values that the sentences fill in.
"""

from collections.abc import Sequence
from itertools import chain
from typing import Final

from dashboards.queries.results import Data
from pipeline.assessment.first_assessment import CHANGED
from pipeline.channels import SECOND_FILE_OFFSET
from pipeline.tables.first_assessment import RULES
from pipeline.tables.row import Row
from warehouse.queries.assess import Assessment

COUNTED: Final = ("no_curve", "few_runs", "runs_set_aside", "unbalanced_runs", "parts_set_aside")
"""Findings that observe a number of runs."""

AS_TIMES: Final = ("samples_scatter", "shallow_water")
"""Findings whose sentence says how many times."""

AS_RATIO: Final = ("unusual_calibration", "log_not_linear")
"""Findings that observe a ratio with three decimals; other ratios are written in per cent."""

SIGNED: Final = (
    "out_and_back_differ",
    "run_off_curve",
    "runs_disagree",
    "load_cell_off",
    "boat_changed",
    "unlike_other_tows",
    "curve_change_unexplained",
    "differs_from_last",
    "change_explained",
    "unlike_its_type",
    "pulled_askew",
    "heavier_after",
    "weight_changed",
    "length_changed",
    "beam_changed",
    "bow_height_changed",
)
"""Findings whose per cent has a sign."""

SIZES_IN_METRES: Final = ("length_changed", "beam_changed", "bow_height_changed")

CURVES_COMPARED: Final = (*CHANGED, "differs_from_last", "change_explained")
"""Findings that compare the curve with that of the last tow."""

INSTRUMENT_FINDINGS: Final = (
    "log2_differs",
    "unusual_calibration",
    "load_cell_off",
    "coarse_readings",
)
"""Findings about an instrument that may read otherwise all season."""


def describe_tow(tow: Assessment, *, log_known: bool) -> Data:
    """Return the data of the document about a tow on the quay.

    Args:
        tow: a tow that was assessed.
        log_known: whether intervals of the method hold the error of the log.
    """
    found = [row for row in tow.first_assessment if row["finding"]]
    ways = []
    for way in tow.ways_to_use:
        used, replaced = map(name_run, way["runs"]), map(name_run, way["instead_of"])
        ways.append(way | {"used": list(used), "replaced": list(replaced)})
    return vars(tow) | {
        "log_known": log_known,
        "findings": [_describe_finding(row, found) for row in _gather_runs_not_planned(found)],
        "rules": [_sum_up_rule(tow, rule) for rule in RULES],
        "redo_runs": None if tow.redo is None else list(map(name_run, tow.redo)),
        "ways": ways,
    }


def _describe_finding(row: Row, found: Sequence[Row]) -> Row:
    """Return a finding with what its sentence fills in.

    Returns:
        The row with `code` of its sentence, `runs_named`, `selection` for the list, the numbers
        `observed`, `limit`, `others_median`, `before`, `now` and `explained`, each None or a value,
        its decimals and its sign, and `explains`: "" or which sentence about size belongs to it.
    """
    finding = row["finding"]
    code = finding
    if finding == "out_and_back_differ" and row["runs"]:
        code = "out_and_back_differ_by_runs"
    if finding == "log2_differs" and row["verdict"] == "good":
        code = "log2_as_usual"
    compares_curves = any(one["finding"] in CURVES_COMPARED for one in found)
    explains = ""
    if row["explained_ratio"] is not None:
        if finding in CURVES_COMPARED:
            explains = "with_sizes"
        elif not compares_curves:
            explains = "alone"
    size_decimals = 2 if finding in SIZES_IN_METRES else 0
    return row | {
        "code": code,
        "runs_named": list(map(name_run, row["runs"])),
        "selection": ",".join(map(name_run, row["runs"])),
        "observed": _scale(row, row["observed"]),
        "limit": _scale(row, row["limit"]),
        "others_median": _scale(row, row["others_median"]),
        "before": _pack(row["old_value"], size_decimals),
        "now": _pack(row["new_value"], size_decimals),
        "explained": _pack(_to_percent(row["explained_ratio"]), 1, "+"),
        "explains": explains,
        "names_others": finding in INSTRUMENT_FINDINGS and bool(row["others"]),
    }


def _pack(value: float | None, decimals: int, sign: str = "") -> tuple[float, int, str] | None:
    return None if value is None else (value, decimals, sign)


def _to_percent(ratio: float | None) -> float | None:
    return None if ratio is None else 100 * ratio


def _scale(row: Row, value: float | None) -> tuple[float, int, str] | None:
    """Return a number as its sentence has it: ratios of sizes and speeds in per cent."""
    finding, unit = row["finding"], row["unit"]
    if finding in COUNTED:
        return _pack(value, 0)
    if finding in AS_TIMES:
        return _pack(value, 1)
    if finding in AS_RATIO:
        return _pack(value, 3)
    if unit == "1":
        return _pack(_to_percent(value), 1, "+" if finding in SIGNED else "")
    return _pack(value, {"m/s": 3, "m": 2}.get(unit, 1))


def _gather_runs_not_planned(found: Sequence[Row]) -> list[Row]:
    """Return findings with one for all runs that the plan does not know."""
    extra = [row for row in found if row["finding"] == "run_not_planned"]
    if not extra:
        return list(found)
    runs = list(chain.from_iterable(row["runs"] for row in extra))
    gathered = extra[0] | {"runs": runs}
    return [gathered if row is extra[0] else row for row in found if row not in extra[1:]]


def _sum_up_rule(tow: Assessment, rule: str) -> Row:
    """Return a rule of the first assessment with its worst verdict and the runs that it names."""
    own = [row for row in tow.first_assessment if row["rule"] == rule]
    again = [row["runs"] for row in own if row["verdict"] == "tow_again"]
    runs = sorted(set(chain.from_iterable(again))) if all(again) else []
    return {"rule": rule, "verdict": own[0]["verdict"], "runs": ", ".join(map(name_run, runs))}


def name_run(run: int) -> str:
    """Return the number of a run as lists have it: b1 is run 1 of the second file."""
    return str(run) if run <= SECOND_FILE_OFFSET else f"b{run - SECOND_FILE_OFFSET}"
