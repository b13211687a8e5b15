"""Assessment: what a person should look at in a tow. A flag never changes a number.

Here the number of each check is computed from the finished curves and run points of all tows of a
method at once, since a tow is also compared with earlier ones and with like boats. The checks are
those of the federation's first assessment (Sleepproef, R. Pot 2017, "Eerste beoordeling" and
"Opmetingen en keuring"); their limits are data, in `pipeline.assessment.checks`. Which of
them reject a tow, the method says.
"""

from collections.abc import Sequence
from typing import Final

import polars as pl

from pipeline.assessment.checks import CHECK, CHECKS, CODES, DOUBTS, UNUSUAL
from pipeline.assessment.season_levels import season_levels
from pipeline.assessment.shared import (
    rising_with_speed,
    ways_apart,
)
from pipeline.choice import SAME_SHARE
from pipeline.season_log.diagnosis import FAULT
from pipeline.season_log.effects import FLEET
from pipeline.tables.archive import Tows
from pipeline.tables.frames import dtypes
from pipeline.tables.keys import LINE

LIKE: Final = ("boat_type", "rowers", "crew_class")
FEWEST_LIKE_BOATS: Final = 4
"""Fewest boats of a type among which one can stand out (inferred)."""

FREEBOARDS: Final = ("freeboard_lowest_m", "freeboard_bow_m", "freeboard_stern_m")
NOT_ALWAYS_KNOWN: Final = pl.DataFrame(
    schema={
        **dtypes(Tows),
        "boat_type": pl.String,
        **dict.fromkeys(("listed_length_m", "listed_beam_m"), pl.Float64),
    }
)
"""Columns that the tows of an old edition, or a single tow, may lack."""

SIZES: Final = {
    "weight_changed": "weight_kg",
    "length_changed": "waterline_length_m",
    "beam_changed": "beam_m",
    "bow_height_changed": "bow_height_m",
}


def assess(
    curves: pl.DataFrame, run_points: pl.DataFrame, tows: pl.DataFrame, diagnosis: pl.DataFrame
) -> pl.DataFrame:
    """Every check of every tow with what was observed and what it is compared with.

    Args:
        curves, run_points: the tables of one method, curves without `status` and `flags`.
        tows: rows of `tows`, with `boat_type` and what the boat list says where that is known; of a
            column that is missing nothing is known.
        diagnosis: rows of `season_diagnosis` of that method.

    Returns:
        Rows of the table `assessments`. A check that could not be made (nothing to compare with,
        weight not known, season after its last) has no row.
    """
    tows = pl.concat([tows, NOT_ALWAYS_KNOWN], how="diagonal_relaxed")
    pairs = _pairs(curves, tows, diagnosis)
    observed = [
        _of_curves(curves),
        _of_runs(curves, run_points),
        rising_with_speed(curves, run_points),
        _of_doubts(tows),
        _of_correction(run_points, tows),
        _of_sizes(tows),
        _of_steps(curves, tows),
        ways_apart(curves, run_points),
        _of_season(curves, tows, diagnosis),
        _of_previous_curve(pairs),
        _of_like_boats(curves, tows),
    ]
    long = pl.concat([_long(frame) for frame in observed])
    return _beside_limits(long, curves)


def with_status(
    curves: pl.DataFrame, assessments: pl.DataFrame, rejecting: Sequence[tuple[int, str]]
) -> pl.DataFrame:
    """The curves with `status` and `flags`.

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


def _long(frame: pl.DataFrame) -> pl.DataFrame:
    """One row per tow and check, from a column per check; what is not known is left out."""
    return (
        frame.with_columns(pl.exclude("tow_id").cast(pl.Float64))
        .unpivot(index="tow_id", variable_name="check", value_name="observed")
        .filter(pl.col("observed").is_finite())
    )


def _limits() -> pl.DataFrame:
    rows = [
        (c.code, crew_class, *c.limits(crew_class), c.unit, c.severity, c.last_season)
        for c in CHECKS
        for crew_class in ("H", "D")
    ]
    names = ("check", "crew_class", "lowest", "highest", "unit", "severity", "last_season")
    schema = dict.fromkeys(names, pl.String()) | dict.fromkeys(names[2:4], pl.Float64())
    return pl.DataFrame(rows, schema=schema | {"last_season": pl.Int32()}, orient="row")


def _beside_limits(observed: pl.DataFrame, curves: pl.DataFrame) -> pl.DataFrame:
    """Adds the limit that is exceeded or nearest, and whether it is exceeded."""
    x, lowest, highest = pl.col("observed"), pl.col("lowest"), pl.col("highest")
    # Of two limits equally near, but for rounding, the highest.
    nearer = (highest - x) - (x - lowest) > SAME_SHARE * (highest - lowest)
    nearer_lowest = highest.is_null() | nearer
    of_tow = curves.select("method", "tow_id", "season", "crew_class")
    return (
        observed.join(of_tow, on="tow_id", maintain_order="left")
        .join(_limits(), on=["check", "crew_class"], maintain_order="left")
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


# A single tow


def _of_curves(curves: pl.DataFrame) -> pl.DataFrame:
    has_curve = pl.col("a_kg_m").is_not_null()
    return curves.select(
        "tow_id",
        no_curve=has_curve,
        few_runs="runs_used",
        residual_large="residual_sd_ratio",
        unusual_calibration="calibration_factor",
        b_at_cap=pl.when(has_curve).then("b_capped"),
        b_not_determined=pl.when(has_curve).then(pl.col("b_m_s").is_null()),
        power_outside_range="power_w",
        slow_tow="power_w",
    )


def _of_runs(curves: pl.DataFrame, run_points: pl.DataFrame) -> pl.DataFrame:
    speed, cw, way = pl.col("speed_m_s"), pl.col("cw_kg_m"), pl.col("direction")
    declared = pl.col("declared_speed_m_s")
    on_curve = cw / pl.col("fitted_cw_kg_m")
    target = pl.col("target_speed_ratio")
    shortfall = pl.max_horizontal(
        (speed / declared).min() - pl.col("lowest_target").first(),
        pl.col("highest_target").first() - (speed / declared).max(),
    )
    beyond = pl.max_horizontal((speed / declared).min() - 1, 1 - (speed / declared).max())
    log1 = speed / pl.col("speed_factor")
    on_target = speed / (target * declared)
    return (
        run_points.with_columns(
            lowest_target=target.min().over("tow_id"), highest_target=target.max().over("tow_id")
        )
        .filter("used")
        .join(curves.select("tow_id", "declared_speed_m_s"), on="tow_id", maintain_order="left")
        .group_by("tow_id", maintain_order=True)
        .agg(
            unbalanced_runs=way.cast(pl.Int32).sum().abs(),
            out_and_back_differ=on_curve.filter(way > 0).mean() / on_curve.filter(way < 0).mean()
            - 1,
            log2_differs=((pl.col("log2_ratio") - 1) * log1).abs().max(),
            large_scatter_in_run=(pl.col("cw_sd") / cw.abs()).max(),
            off_target_speed=(on_target / on_target.median() - 1).abs().max(),
            ends_differ=pl.col("ends_ratio").max(),
            range_not_covered=shortfall,
            declared_speed_not_covered=beyond,
        )
    )


def _of_doubts(tows: pl.DataFrame) -> pl.DataFrame:
    """What the rest of the archive says of a tow, judged before any method."""
    return tows.select(
        "tow_id",
        *(pl.col("doubts").list.contains(code).alias(code) for code in DOUBTS),
        *(pl.col("unusual").list.contains(code).alias(code) for code in UNUSUAL),
    )


def _of_correction(run_points: pl.DataFrame, tows: pl.DataFrame) -> pl.DataFrame:
    """The tow list's speed correction, where the speeds are as the log read them; else 0."""
    as_read = (pl.col("speed_factor") - 1.0).abs().max() < SAME_SHARE
    speeds = (
        run_points.filter("used")
        .group_by("tow_id", maintain_order=True)
        .agg(as_read.alias("as_read"))
    )
    listed = pl.col("speed_correction_ratio")
    return tows.join(speeds, on="tow_id", maintain_order="left").select(
        "tow_id", correction_not_used=pl.when("as_read").then(listed).otherwise(listed * 0.0)
    )


# Against earlier tows


def _before(column: str, group: Sequence[str]) -> pl.Expr:
    return pl.col(column).shift(1).over(group)


def _of_sizes(tows: pl.DataFrame) -> pl.DataFrame:
    """Weight after, and measurements against those of the boat's previous tow with any crew."""
    same = ~pl.col("altered")
    freeboards = [(pl.col(c) - _before(c, ["fsn_no"])).abs() for c in FREEBOARDS]
    changes = {
        code: pl.when(same).then(pl.col(column) / _before(column, ["fsn_no"]) - 1)
        for code, column in SIZES.items()
    }
    return tows.sort("tow_date", "tow_id").select(
        "tow_id",
        "runs_set_aside",
        lamps_burned="lamp_ratio",
        load_cell_off=pl.col("load_cell_ratio") - 1,
        boat_list_differs=_off_boat_list(),
        water_differs="water_off_c",
        crew_weight=pl.col("crew_weight_kg") / pl.col("rowers"),
        heavier_after=pl.col("weight_after_kg") / pl.col("weight_kg") - 1,
        freeboard_changed=pl.when(same).then(pl.max_horizontal(freeboards)),
        **changes,
    )


def _of_steps(curves: pl.DataFrame, tows: pl.DataFrame) -> pl.DataFrame:
    """Change of Cw if readings were truncated to their step and not rounded: half a step.

    That of a GPS counts only where it calibrates the tow.
    """
    speed = pl.col("declared_speed_m_s")
    by_gps = pl.when(pl.col("calibration_factor").is_not_null()).then(
        pl.col("gps_step_m_s") / speed  # half a step; speed counts twice
    )
    by_force = pl.col("force_step_n") / 2 / (pl.col("cw_kg_m") * speed**2)
    steps = tows.select("tow_id", "gps_step_m_s", "force_step_n")
    return curves.join(steps, on="tow_id", maintain_order="left").select(
        "tow_id", coarse_readings=pl.max_horizontal(by_gps, by_force)
    )


def _off_boat_list() -> pl.Expr:
    """How far length or breadth is from the boat list; null for a boat that was ever altered."""
    off = [
        (pl.col(column) / pl.col(listed) - 1).abs()
        for column, listed in (
            ("waterline_length_m", "listed_length_m"),
            ("beam_m", "listed_beam_m"),
        )
    ]
    return pl.when(~pl.col("altered").any().over("fsn_no")).then(pl.max_horizontal(off))


def _with_boats(curves: pl.DataFrame, tows: pl.DataFrame) -> pl.DataFrame:
    """Tows with a curve, with the boat of the day, sorted by date.

    `size` is sqrt(displacement x waterline length): wetted surface follows it (docs of
    `pipeline.steps.resistance`), and friction, most of Cw, follows wetted surface. `s_s2_m2` is
    1/B^2, also of a flat or falling curve, from A and Cw at the declared speed.
    """
    of_tow = ("tow_date", "altered", "waterline_length_m", "weight_kg", "crew_weight_kg")
    displacement = pl.col("weight_kg") + pl.col("crew_weight_kg")
    return (
        curves.filter(pl.col("a_kg_m").is_not_null())
        .join(tows.select("tow_id", "boat_type", *of_tow), on="tow_id", maintain_order="left")
        .with_columns(
            size=(displacement * pl.col("waterline_length_m")).sqrt(),
            s_s2_m2=(1 - pl.col("a_kg_m") / pl.col("cw_kg_m")) / pl.col("declared_speed_m_s") ** 2,
        )
        .sort("tow_date", "tow_id")
    )


def _cw_at(speed: pl.Expr) -> pl.Expr:
    """Cw of each curve at a speed; null from B on."""
    below_b = 1 - pl.col("s_s2_m2") * speed**2
    return pl.when(below_b > 0).then(pl.col("a_kg_m") / below_b)


def _of_season(curves: pl.DataFrame, tows: pl.DataFrame, diagnosis: pl.DataFrame) -> pl.DataFrame:
    """Whether an instrument of the tow's season is in doubt, where the season was diagnosed.

    An estimated log factor rests on the seasons with dGPS: where all of these are in doubt, so is
    its season. All boats do not change at once: where they seem to, another load cell may have come
    on board, and nobody can say which of the two was right: all seasons are in doubt. Log factors
    do not rest on that.
    """
    seasons = diagnosis.group_by("season", maintain_order=True).agg(
        season_in_doubt=pl.col("alarm").any()
    )
    doubted = seasons.filter("season_in_doubt")["season"]
    anchors = {*_by_gps(curves)} & {*seasons["season"]}
    if anchors and anchors <= {*doubted}:
        estimated = diagnosis.filter(verdict="estimated")["season"]
        rests = pl.col("season").is_in(estimated.implode())
        seasons = seasons.with_columns(pl.col("season_in_doubt") | rests)
    steps = diagnosis.filter(instrument=FLEET, verdict=FAULT)
    seasons = seasons.with_columns(pl.col("season_in_doubt") | pl.lit(not steps.is_empty()))
    return tows.join(seasons, on="season", maintain_order="left").select(
        "tow_id", "season_in_doubt"
    )


def _pairs(curves: pl.DataFrame, tows: pl.DataFrame, diagnosis: pl.DataFrame) -> pl.DataFrame:
    """Every tow with a curve beside the previous one of boat and crew, at its declared speed.

    `ln` is what weight and length leave unexplained of ln Cw / Cw before; null where there is none
    before, or an alteration was reported. Between seasons whose logs are not on one scale, what all
    boats changed together is no change of this one.
    """
    change = _cw_at(_before("declared_speed_m_s", LINE)) / _before("cw_kg_m", LINE)
    by_size = (pl.col("size") / _before("size", LINE)).fill_null(1.0)
    changed = _with_boats(curves, tows).select(
        "tow_id",
        *LINE,
        "season",
        before=_before("season", LINE),
        change=change,
        ln=pl.when(~pl.col("altered")).then((change / by_size).log()),
    )
    level = season_levels(changed.drop_nulls("ln"), _seasons_to_scale(curves, diagnosis))
    now, then = (
        pl.col(column).replace_strict(level, default=0.0, return_dtype=pl.Float64)
        for column in ("season", "before")
    )
    return changed.with_columns(pl.col("ln") - now + then)


def _of_previous_curve(pairs: pl.DataFrame) -> pl.DataFrame:
    return pairs.select(
        "tow_id",
        curve_changed=pl.col("change") - 1,
        curve_change_unexplained=pl.col("ln").exp() - 1,
    )


def _seasons_to_scale(curves: pl.DataFrame, diagnosis: pl.DataFrame) -> set[int]:
    """Seasons whose logs GPS or the other seasons bring to one scale."""
    return {*_by_gps(curves), *diagnosis.filter(verdict="estimated")["season"]}


def _by_gps(curves: pl.DataFrame) -> pl.Series:
    return curves.drop_nulls("calibration_factor")["season"]


# Against like boats


def _of_like_boats(curves: pl.DataFrame, tows: pl.DataFrame) -> pl.DataFrame:
    """Excess of each tow over boats of its type with the same crew.

    Cw at the type's common speed, over its size, against the type's median; less the season's
    median, which holds the error of its log. Medians, so that a tow pulled askew does not move
    what it is compared with. An excess that the boat also shows in all of its later tows, when it
    was steered straight, is its own and does not count.
    """
    boats = _with_boats(curves, tows)
    common_speed = pl.col("declared_speed_m_s").median().over(LIKE)
    ln, straight = pl.col("ln_excess"), pl.col("season") > CHECK["pulled_askew"].last_season
    later = ln.filter(straight).min().over("fsn_no")
    return (
        boats.drop_nulls(["boat_type", "size"])
        .filter(pl.col("fsn_no").n_unique().over(LIKE) >= FEWEST_LIKE_BOATS)
        .with_columns(ln_excess=(_cw_at(common_speed) / pl.col("size")).log())
        .with_columns(ln - ln.median().over(LIKE))
        .with_columns(ln - ln.median().over("season"))
        .select("tow_id", pulled_askew=(ln - later.fill_null(0.0).clip(0.0)).exp() - 1)
    )
