"""Assessment: what a person should look at in a tow. A flag never changes a number.

What the checks measure is gathered from the finished curves and run points of all tows of a method
at once (`run_measures`, `comparisons`), since a tow is also compared with earlier ones and with
like boats; one function applies the rules of `checks` to it. The checks are those of the
federation's first assessment (Sleepproef, R. Pot 2017, "Eerste beoordeling" and "Opmetingen en
keuring"). Which of them reject a tow, the method says.
"""

from collections.abc import Sequence
from typing import Final

import polars as pl

from pipeline.assessment.checks import CHECK, CHECKS, CODES, WAYS_LIMIT, Check
from pipeline.assessment.comparisons import (
    add_boats,
    compare_with_best_estimate,
    compare_with_papers,
    compare_with_previous,
    compare_with_season_and_type,
    compare_with_type,
    doubt_seasons,
    estimate_log_slopes,
)
from pipeline.assessment.currents import CANNOT_BE_TOLD, CHANGED
from pipeline.assessment.run_measures import summarize_runs
from pipeline.choice import SAME_SHARE
from pipeline.crews import STANDARD_CREWS
from pipeline.hull import BEAM_DRAUGHTS, GRAVITY_M_S2
from pipeline.quantiles import MAD_TO_SD

MIN_WAYS_SD: Final = 3.0
"""Robust standard deviations, over all tows of a method, from which chance does not explain that
out and back differ."""

HALF_STEP_RATIO: Final = pl.max_horizontal(
    pl.when(pl.col("calibration_factor").is_not_null()).then(
        pl.col("gps_step_m_s") / pl.col("declared_speed_m_s")
    ),
    pl.col("force_step_n") / 2 / (pl.col("cw_kg_m") * pl.col("declared_speed_m_s") ** 2),
)
"""Change of Cw if readings were truncated to their step and not rounded: half a step, of which that
of speed counts twice. That of a GPS counts only where it calibrates the tow."""

MAX_DEPTH_FROUDE: Final = 0.5
"""Speed over the speed of the longest wave of that depth, sqrt(g h), from which a boat feels the
bottom (inferred: speed trials of ships ask 0.60, by h >= 2.75 v^2/g, ISO 15016:2015)."""
MIN_DEPTH_DRAUGHTS: Final = 3.0
"""Least depth in draughts (inferred)."""
NEEDED_DEPTH_RATIO: Final = pl.max_horizontal(
    (pl.col("fastest_m_s") / MAX_DEPTH_FROUDE) ** 2 / GRAVITY_M_S2,
    MIN_DEPTH_DRAUGHTS * pl.col("beam_m") / BEAM_DRAUGHTS,
) / pl.col("water_depth_m")
"""Depth at which the fastest run that counts does not feel the bottom, over the depth there was."""

CLEAR_CHANGE: Final = (
    pl.when(current_verdict=CHANGED)
    .then(pl.col("current_change_m_s").abs())
    .when(pl.col("current_verdict") != CANNOT_BE_TOLD)
    .then(0.0)
)
"""Change of the current from out to back [m/s]; 0 where chance explains it."""


def assess(
    curves: pl.DataFrame,
    run_points: pl.DataFrame,
    tows: pl.DataFrame,
    diagnosis: pl.DataFrame,
    currents: pl.DataFrame,
    crew_classes: pl.DataFrame = STANDARD_CREWS,
) -> pl.DataFrame:
    """Return every check of every tow with what was observed and what it is compared with.

    Args:
        curves, run_points: the tables of one method, curves without `status` and `flags`.
        tows: `Tows.frame`, with what is expected of the water.
        diagnosis: rows of `season_diagnosis` of that method.
        currents: rows of `tow_currents` of that method.
        crew_classes: the table of that name.

    Returns:
        Rows of the table `assessments`. A check that could not be made (nothing to compare with,
        weight not known, season after its last) has no row.
    """
    boats = add_boats(curves, tows)
    runs = summarize_runs(curves, run_points)
    measures = [
        compare_with_papers(tows),
        curves.drop(set(curves.columns) & set(tows.columns) - {"tow_id"}),
        runs,
        doubt_seasons(curves, tows, diagnosis),
        estimate_log_slopes(curves, run_points),
        currents.select("tow_id", current_change_m_s=CLEAR_CHANGE),
        compare_with_previous(boats, curves, diagnosis),
        compare_with_best_estimate(curves),
        compare_with_season_and_type(boats),
        compare_with_type(boats, curves, diagnosis),
    ]
    measured = tows
    for measure in measures:
        measured = measured.join(measure, on="tow_id", how="left", maintain_order="left")
    measured = measured.with_columns(
        by_half_a_step=HALF_STEP_RATIO, needed_depth_ratio=NEEDED_DEPTH_RATIO
    )
    return apply_checks(measured, _widen_limit_of_ways(runs), crew_classes)


def _widen_limit_of_ways(runs: pl.DataFrame) -> tuple[Check, ...]:
    """Return the checks, with a limit of `out_and_back_differ` that chance hardly exceeds.

    Gusts that outlast a run make out and back differ in all tows of an archive; a tow stands out
    from `MIN_WAYS_SD` robust standard deviations of all of them on.
    """
    difference = (pl.col("out_over_back") - 1.0).abs().median().fill_null(0.0)
    spread = MAD_TO_SD * float(runs.select(difference).item())
    limit = max(WAYS_LIMIT, MIN_WAYS_SD * spread)
    widened = CHECK["out_and_back_differ"]._replace(lowest=-limit, highest=limit)
    return tuple((CHECK | {widened.code: widened}).values())


def apply_checks(
    tows: pl.DataFrame,
    checks: Sequence[Check] = CHECKS,
    crew_classes: pl.DataFrame = STANDARD_CREWS,
) -> pl.DataFrame:
    """Apply rules to what was measured of tows.

    Args:
        tows: a row per tow with all that the rules measure; those that have no `method`, without
            a row in its curves, are left out.
        checks: the rules.
        crew_classes: the limits of each class.

    Returns:
        Rows of the table `assessments`; the limit is the one that is exceeded or nearest.
    """
    x, lowest, highest = pl.col("observed"), pl.col("lowest"), pl.col("highest")
    # Of two limits equally near, but for rounding, the highest.
    nearer = (highest - x) - (x - lowest) > SAME_SHARE * (highest - lowest)
    nearer_lowest = highest.is_null() | nearer
    index = ("method", "tow_id", "season", "crew_class")
    measured = []
    for check in checks:
        number = pl.sql_expr(check.measured).cast(pl.Float64)
        measured.append(number.alias(check.code))
    return (
        tows.select([pl.col(index)] + measured)
        .filter(pl.col("method").is_not_null())
        .unpivot(index=index, variable_name="check", value_name="observed")
        .filter(x.is_finite())
        .join(_list_limits(checks, crew_classes), on=["check", "crew_class"], maintain_order="left")
        .filter(pl.col("season") <= pl.col("last_season").fill_null(pl.col("season")))
        .select(
            "method",
            "tow_id",
            "check",
            "severity",
            "observed",
            pl.when(nearer_lowest).then(lowest).otherwise(highest).alias("limit"),
            "unit",
            ((x < lowest).fill_null(False) | (x > highest).fill_null(False)).alias("flagged"),
        )
    )


def _list_limits(checks: Sequence[Check], crew_classes: pl.DataFrame) -> pl.DataFrame:
    """Return the limits of each check for each class, with what else a check declares."""
    rows = []
    for check in checks:
        for crew_class in crew_classes["crew_class"]:
            lowest, highest = check.limits(crew_class, crew_classes)
            row = {
                "check": check.code,
                "crew_class": crew_class,
                "lowest": lowest,
                "highest": highest,
                "unit": check.unit,
                "severity": check.severity,
                "last_season": check.last_season,
            }
            rows.append(row)
    schema = {
        "check": pl.String(),
        "crew_class": pl.String(),
        "lowest": pl.Float64(),
        "highest": pl.Float64(),
        "unit": pl.String(),
        "severity": pl.String(),
        "last_season": pl.Int32(),
    }
    return pl.DataFrame(rows, schema)


def add_status(
    curves: pl.DataFrame, assessments: pl.DataFrame, rejecting: Sequence[tuple[int, str]]
) -> pl.DataFrame:
    """Add `status` and `flags` to curves.

    Rejected is a tow without a curve or with a flag that rejects; flagged one that somebody must
    look at; the others are accepted. Notes are not listed, unless they reject.

    Args:
        curves: curves of one method.
        assessments: their assessments.
        rejecting: pairs of season and check that reject.
    """
    pairs = pl.DataFrame(
        list(rejecting), schema={"season": pl.Int32(), "check": pl.String()}, orient="row"
    ).with_columns(pl.lit(True).alias("rejects"))
    flagged = (
        assessments.filter("flagged")
        .join(curves.select("tow_id", "season"), on="tow_id", maintain_order="left")
        .join(pairs, on=["season", "check"], how="left", maintain_order="left")
        .with_columns(pl.col("rejects").fill_null(False) | (pl.col("severity") == "refuse"))
        .filter((pl.col("severity") == "look") | pl.col("rejects"))
        .sort(pl.col("check").replace_strict(CODES, range(len(CODES))))
        .group_by("tow_id", maintain_order=True)
        .agg(pl.col("check").alias("flags"), pl.col("rejects").any())
    )
    status = (
        pl.when("rejects")
        .then(pl.lit("rejected"))
        .when(pl.col("flags").is_not_null())
        .then(pl.lit("flagged"))
        .otherwise(pl.lit("accepted"))
    )
    return (
        curves.join(flagged, on="tow_id", how="left", maintain_order="left")
        .with_columns(status.alias("status"), pl.col("flags").fill_null([]))
        .drop("rejects")
    )
