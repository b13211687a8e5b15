"""Assessment: what a person should look at in a tow. A flag never changes a number.

Here the facts of every tow are gathered from the finished curves and run points of all tows of a
method at once, since a tow is also compared with earlier ones and with like boats; one function
applies the rules of `pipeline.assessment.checks` to them. The checks are those of the federation's
first assessment (Sleepproef, R. Pot 2017, "Eerste beoordeling" and "Opmetingen en keuring"). Which
of them reject a tow, the method says.
"""

from collections.abc import Collection, Sequence
from functools import reduce
from typing import Final

import numpy as np
import polars as pl

from pipeline.assessment.checks import CHECK, CHECKS, CODES, WAYS_LIMIT, Check
from pipeline.choice import SAME_SHARE
from pipeline.quantiles import MAD_TO_SD
from pipeline.season_log.diagnosis import CANNOT_BE_TOLD, FAULT
from pipeline.season_log.observation_model import FLEET
from pipeline.tables.keys import LINE, SIZES

LIKE: Final = ("boat_type", "rowers", "crew_class")
MIN_LIKE_BOATS: Final = 4
"""Fewest boats of a type among which one can stand out (inferred)."""

MIN_CHANGES: Final = 4
"""Fewest changes for which what they share is taken to be the season's (inferred)."""

POLISH_ROUNDS: Final = 60
"""Half a step is made in each, as neighbouring seasons move each other; 1e-4 is left at most."""

MIN_TOWS_WITH_GPS: Final = 6
"""Fewest tows with GPS that show whether the log of their season is in proportion to speed."""

MIN_SLOPE_SD: Final = 3.5
"""Standard errors from which chance does not explain that it is not. With the limit of its check
none of 990 sound seasons of 90 simulated archives is marked, and all 36 with logs of v^1.03."""

MIN_LN_SPEED_SQUARES: Final = 0.004
"""Least sum of squares of ln speed, about the mean of a direction, over the runs of a tow."""

MIN_WAYS_SD: Final = 3.0
"""Robust standard deviations, over all tows of a method, from which chance does not explain that
out and back differ."""

FREEBOARDS: Final = ("freeboard_lowest_m", "freeboard_bow_m", "freeboard_stern_m")
LISTED: Final = {"waterline_length_m": "listed_length_m", "beam_m": "listed_beam_m"}


def assess(
    curves: pl.DataFrame, run_points: pl.DataFrame, tows: pl.DataFrame, diagnosis: pl.DataFrame
) -> pl.DataFrame:
    """Return every check of every tow with what was observed and what it is compared with.

    Args:
        curves, run_points: the tables of one method, curves without `status` and `flags`.
        tows: `Tows.frame`, with what is expected of the water.
        diagnosis: rows of `season_diagnosis` of that method.

    Returns:
        Rows of the table `assessments`. A check that could not be made (nothing to compare with,
        weight not known, season after its last) has no row.
    """
    boats = _add_boats(curves, tows)
    runs = _summarize_runs(curves, run_points)
    facts = [
        _compare_with_papers(tows),
        curves.drop(set(curves.columns) & set(tows.columns) - {"tow_id"}),
        runs,
        _doubt_seasons(curves, tows, diagnosis),
        _estimate_log_slopes(curves, run_points),
        _compare_with_previous(boats, curves, diagnosis),
        _compare_with_best_estimate(curves),
        _compare_with_season_and_type(boats),
        _compare_with_type(boats, curves, diagnosis),
    ]
    return apply_checks(
        reduce(_join_by_tow, facts, tows).with_columns(by_half_a_step=HALF_STEP_RATIO),
        _widen_limit_of_ways(runs),
    )


def _widen_limit_of_ways(runs: pl.DataFrame) -> tuple[Check, ...]:
    """Return the checks, with a limit of `out_and_back_differ` that chance hardly exceeds.

    Gusts that outlast a run make out and back differ in all tows of an archive; a tow stands out
    from `MIN_WAYS_SD` robust standard deviations of all of them on.
    """
    difference = (pl.col("out_over_back") - 1.0).abs().median().fill_null(0.0)
    spread = MAD_TO_SD * float(runs.select(difference).item())
    limit = max(WAYS_LIMIT, MIN_WAYS_SD * spread)
    return tuple(
        c._replace(lowest=-limit, highest=limit) if c.code == "out_and_back_differ" else c
        for c in CHECKS
    )


def _join_by_tow(tows: pl.DataFrame, facts: pl.DataFrame) -> pl.DataFrame:
    return tows.join(facts, on="tow_id", how="left", maintain_order="left")


def apply_checks(tows: pl.DataFrame, checks: Sequence[Check] = CHECKS) -> pl.DataFrame:
    """Apply rules to the facts of tows.

    Args:
        tows: a row per tow with all that the rules measure; those that have no `method`, without
            a row in its curves, are left out.
        checks: the rules.

    Returns:
        Rows of the table `assessments`; the limit is the one that is exceeded or nearest.
    """
    x, lowest, highest = pl.col("observed"), pl.col("lowest"), pl.col("highest")
    # Of two limits equally near, but for rounding, the highest.
    nearer = (highest - x) - (x - lowest) > SAME_SHARE * (highest - lowest)
    nearer_lowest = highest.is_null() | nearer
    index = ("method", "tow_id", "season", "crew_class")
    return (
        tows.select(*index, *(_measure(check) for check in checks))
        .filter(pl.col("method").is_not_null())
        .unpivot(index=index, variable_name="check", value_name="observed")
        .filter(x.is_finite())
        .join(_list_limits(checks), on=["check", "crew_class"], maintain_order="left")
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


def _measure(check: Check) -> pl.Expr:
    return pl.sql_expr(check.measured).cast(pl.Float64).alias(check.code)


def _list_limits(checks: Sequence[Check]) -> pl.DataFrame:
    rows = [
        (c.code, crew_class, *c.limits(crew_class), c.unit, c.severity, c.last_season)
        for c in checks
        for crew_class in ("H", "D")
    ]
    names = ("check", "crew_class", "lowest", "highest", "unit", "severity", "last_season")
    schema = dict.fromkeys(names, pl.String()) | dict.fromkeys(names[2:4], pl.Float64())
    return pl.DataFrame(rows, schema=schema | {"last_season": pl.Int32()}, orient="row")


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


# The facts

HALF_STEP_RATIO: Final = pl.max_horizontal(
    pl.when(pl.col("calibration_factor").is_not_null()).then(
        pl.col("gps_step_m_s") / pl.col("declared_speed_m_s")
    ),
    pl.col("force_step_n") / 2 / (pl.col("cw_kg_m") * pl.col("declared_speed_m_s") ** 2),
)
"""Change of Cw if readings were truncated to their step and not rounded: half a step, of which that
of speed counts twice. That of a GPS counts only where it calibrates the tow."""


def _compare_with_papers(tows: pl.DataFrame) -> pl.DataFrame:
    """Compare measurements with the boat list, and with those of the boat's previous tow.

    Null for a boat that was ever altered, and after a reported alteration, which explain it.
    """

    def before(column: str) -> pl.Expr:
        return pl.col(column).shift(1).over("fsn_no", order_by=["tow_date", "tow_id"])

    same, altered = ~pl.col("altered"), pl.col("altered").any().over("fsn_no")
    off = [(pl.col(own) / pl.col(listed) - 1).abs() for own, listed in LISTED.items()]
    moved = pl.max_horizontal((pl.col(c) - before(c)).abs() for c in FREEBOARDS)
    return tows.select(
        "tow_id",
        pl.when(~altered).then(pl.max_horizontal(off)).alias("off_boat_list"),
        pl.when(same).then(moved).alias("freeboard_change_m"),
        *(pl.when(same).then(pl.col(c) / before(c) - 1).alias(f"{c}_change") for c in SIZES),
    )


def _summarize_runs(curves: pl.DataFrame, run_points: pl.DataFrame) -> pl.DataFrame:
    """Return how the runs that count lie about the curve and the intended speeds."""
    speed, way = pl.col("speed_m_s"), pl.col("direction")
    declared, target = pl.col("declared_speed_m_s"), pl.col("target_speed_ratio")
    on_curve = pl.col("cw_kg_m") / pl.col("fitted_cw_kg_m")
    least, most = ((speed / declared).min(), (speed / declared).max())
    return (
        measure_runs(curves, run_points)
        .with_columns(
            lowest_target=target.min().over("tow_id"), highest_target=target.max().over("tow_id")
        )
        .filter("used")
        .group_by("tow_id", maintain_order=True)
        .agg(
            pl.col(PER_RUN.values()).max(),
            unbalanced=way.cast(pl.Int32).sum().abs(),
            out_over_back=on_curve.filter(way > 0).mean() / on_curve.filter(way < 0).mean(),
            shortfall=pl.max_horizontal(
                least - pl.col("lowest_target").first(), pl.col("highest_target").first() - most
            ),
            beyond=pl.max_horizontal(least - 1, 1 - most),
        )
    )


MIN_USUAL_SCATTER: Final = 0.05
"""Least standard deviation of samples over Cw that counts as usual: half of the 10 % under which
nothing is too much (Sleepproef, R. Pot 2017, "Eerste beoordeling")."""

PER_RUN: Final = {
    "off_target_speed": "off_target",
    "log2_differs": "log2_off_m_s",
    "large_scatter_in_run": "scatter",
    "samples_scatter": "samples_scatter",
}
"""Checks of single runs, with the column of `measure_runs` that each looks at: a tow is marked for
the largest value among the runs that count."""


def measure_runs(curves: pl.DataFrame, run_points: pl.DataFrame) -> pl.DataFrame:
    """Return run points with what `PER_RUN` judges, null for runs that do not count.

    Args:
        curves, run_points: the tables of one method, with all tows of a season.

    Returns:
        The rows with `season` and `declared_speed_m_s` and

        - `off_target`: distance of speed / intended speed from the median of the tow, as a ratio,
        - `log2_off_m_s`: distance of log 2 from log 1, m/s,
        - `scatter`: standard deviation of the means of F / v^2 per second over their mean,
        - `samples_scatter`: the same of the samples, over the median of all runs of the season;
          both only where the method cuts runs.
    """
    used, is_cut = pl.col("used"), pl.col("ends_ratio").is_not_null()
    on_target = pl.col("speed_m_s") / (pl.col("target_speed_ratio") * pl.col("declared_speed_m_s"))
    level = on_target.filter(used).median().over("tow_id")
    log1_m_s = pl.col("speed_m_s") / pl.col("speed_factor")
    gross = pl.col("gross_cw_kg_m")
    of_samples = pl.when(used & is_cut & (gross > 0)).then(pl.col("cw_sd") / gross)
    usual = of_samples.median().over("season").clip(lower_bound=MIN_USUAL_SCATTER)
    of_runs = {
        "off_target": (on_target / level - 1).abs(),
        "log2_off_m_s": ((pl.col("log2_ratio") - 1) * log1_m_s).abs(),
        "scatter": pl.when(is_cut & (gross > 0)).then(pl.col("cw_seconds_sd_kg_m") / gross),
        "samples_scatter": of_samples / usual,
    }
    return run_points.join(
        curves.select("tow_id", "season", "declared_speed_m_s"), on="tow_id", maintain_order="left"
    ).with_columns(**{name: pl.when(used).then(value) for name, value in of_runs.items()})


def _add_boats(curves: pl.DataFrame, tows: pl.DataFrame) -> pl.DataFrame:
    """Return tows with a curve, with the boat of the day, sorted by date.

    Where the method knows the boat by all of its tows, A and Cw are moved to its best estimate: a
    tow that is off does not make the boat another. `size` is sqrt(displacement x waterline length):
    wetted surface follows it (docs of `pipeline.steps.resistance`), and friction, most of Cw,
    follows wetted surface. `s_s2_m2` is 1/B^2, also of a flat or falling curve, from A and Cw at
    the declared speed.
    """
    of_tow = ("tow_date", "altered", "waterline_length_m", "weight_kg", "crew_weight_kg")
    displacement = pl.col("weight_kg") + pl.col("crew_weight_kg")
    best_ratio = (pl.col("cw_best_kg_m") / pl.col("cw_kg_m")).fill_null(1.0)
    return (
        curves.filter(pl.col("a_kg_m").is_not_null())
        .join(tows.select("tow_id", "boat_type", *of_tow), on="tow_id", maintain_order="left")
        .with_columns(
            pl.col("a_kg_m", "cw_kg_m") * best_ratio,
            is_best=pl.col("cw_best_kg_m").is_not_null(),
            size=(displacement * pl.col("waterline_length_m")).sqrt(),
            s_s2_m2=(1 - pl.col("a_kg_m") / pl.col("cw_kg_m")) / pl.col("declared_speed_m_s") ** 2,
        )
        .sort("tow_date", "tow_id")
    )


def _cw_at(speed: pl.Expr) -> pl.Expr:
    """Return Cw of each curve at a speed; null from B on."""
    below_b = 1 - pl.col("s_s2_m2") * speed**2
    return pl.when(below_b > 0).then(pl.col("a_kg_m") / below_b)


def _doubt_seasons(
    curves: pl.DataFrame, tows: pl.DataFrame, diagnosis: pl.DataFrame
) -> pl.DataFrame:
    """Return whether an instrument of the tow's season is in doubt, where it was diagnosed.

    It is where a fault is likelier than not. A fault of 10 to 50 % is listed in the diagnosis and
    widens no tow's number; marking all of its season would mostly mark sound tows. Beside that,
    whether this boat alone shows a fault, so that the boat may have been altered instead.

    An estimated log factor rests on the seasons with dGPS: where all of these are in doubt, so is
    its season. All boats do not change at once: where they seem to, another load cell may have come
    on board, and nobody can say which of the two was right: all seasons are in doubt. Log factors
    do not rest on that.
    """
    seasons = diagnosis.group_by("season", maintain_order=True).agg(
        season_in_doubt=(pl.col("alarm") & (pl.col("verdict") != CANNOT_BE_TOLD)).any()
    )
    doubted = seasons.filter("season_in_doubt")["season"]
    anchors = {*_calibrated_seasons(curves)} & {*seasons["season"]}
    if anchors and anchors <= {*doubted}:
        estimated = diagnosis.filter(verdict="estimated")["season"]
        rests = pl.col("season").is_in(estimated.implode())
        seasons = seasons.with_columns(pl.col("season_in_doubt") | rests)
    steps = diagnosis.filter(instrument=FLEET, verdict=FAULT)
    seasons = seasons.with_columns(pl.col("season_in_doubt") | pl.lit(not steps.is_empty()))
    shown_by = diagnosis.drop_nulls("shown_by").select(
        "season", fsn_no=pl.col("shown_by").str.split(", ")
    )
    alone = tows.join(shown_by.explode("fsn_no"), on=["season", "fsn_no"], how="semi")["tow_id"]
    return tows.join(seasons, on="season", maintain_order="left").select(
        "tow_id",
        season_doubted="season_in_doubt",
        alone_shows_fault=pl.col("tow_id").is_in(alone.implode()),
    )


def _estimate_log_slopes(curves: pl.DataFrame, run_points: pl.DataFrame) -> pl.DataFrame:
    """Return how the log's factor changes with speed, by the GPS of all tows of its season.

    The slope of ln(GPS / log) by ln speed among runs one way, in which the current is the same; its
    mean over the season, 0 where chance explains it.
    """
    ways, slope = ["tow_id", "direction"], pl.col("slope")
    x, y = (pl.col(name).log() for name in ("speed_m_s", "gps_ratio"))
    of_tows = (
        run_points.filter("used", pl.col("gps_ratio") > 0)
        .select("tow_id", x=x - x.mean().over(ways), y=y - y.mean().over(ways))
        .group_by("tow_id", maintain_order=True)
        .agg(product=(pl.col("x") * pl.col("y")).sum(), spread=(pl.col("x") ** 2).sum())
        .filter(pl.col("spread") > MIN_LN_SPEED_SQUARES)
        .with_columns(slope=pl.col("product") / pl.col("spread"))
    )
    seasons = curves.select("tow_id", "season")
    by_chance = MIN_SLOPE_SD * slope.std() / pl.len().sqrt()
    found = (
        of_tows.join(seasons, on="tow_id", maintain_order="left")
        .group_by("season", maintain_order=True)
        .agg(pl.len(), log_slope=slope.mean() * (slope.mean().abs() > by_chance))
        .filter(pl.col("len") >= MIN_TOWS_WITH_GPS)
    )
    return seasons.join(found, on="season", maintain_order="left").select("tow_id", "log_slope")


def _compare_with_best_estimate(curves: pl.DataFrame) -> pl.DataFrame:
    """Return Cw as measured over the best estimate, less 1, of boats with more than one tow.

    The best estimate takes the boat's other tows into account, and that it may have been altered:
    what is left is the tow's own (pulled askew, a zero, a file of another boat).
    """
    of_line = curves.filter(pl.col("cw_kg_m").is_not_null() & (pl.len().over(LINE) > 1))
    return of_line.select("tow_id", over_best=pl.col("cw_kg_m") / pl.col("cw_best_kg_m") - 1)


def _compare_with_previous(
    boats: pl.DataFrame, curves: pl.DataFrame, diagnosis: pl.DataFrame
) -> pl.DataFrame:
    """Return Cw over that of the previous tow of boat and crew, at its declared speed, less 1.

    As `boat_change` by best estimates, where the method has them, else as `curve_change`. Less what
    weight and length explain; null where there is none before, or an alteration was reported.
    Between seasons whose logs are not on one scale, what all boats changed together is no
    change of this one.
    """

    def before(column: str) -> pl.Expr:
        return pl.col(column).shift(1).over(LINE)

    change = _cw_at(before("declared_speed_m_s")) / before("cw_kg_m")
    by_size = (pl.col("size") / before("size")).fill_null(1.0)
    changed = boats.select(
        "tow_id",
        "season",
        "is_best",
        before=before("season"),
        ln=pl.when(~pl.col("altered")).then((change / by_size).log()),
    )
    level = _estimate_season_levels(
        changed.drop_nulls("ln"), _list_seasons_to_scale(curves, diagnosis)
    )
    level_now = pl.col("season").replace_strict(level, default=0.0, return_dtype=pl.Float64)
    level_before = pl.col("before").replace_strict(level, default=0.0, return_dtype=pl.Float64)
    ratio = (pl.col("ln") - level_now + level_before).exp() - 1
    return changed.select(
        "tow_id",
        curve_change=pl.when(~pl.col("is_best")).then(ratio),
        boat_change=pl.when("is_best").then(ratio),
    )


def _estimate_season_levels(changes: pl.DataFrame, to_scale: Collection[int]) -> dict[int, float]:
    """Return the level of ln Cw of every season that is not to scale and has enough changes.

    A log that nothing calibrates gives every tow of its season the same error: between two such
    seasons each boat seems to change. By medians, so that a tow that is off moves it little (median
    polish; Tukey 1977, Exploratory Data Analysis, ch. 11).

    Args:
        changes: `season`, `before` (the season of the boat's previous tow), and `ln`, the logarithm
            of its change.
        to_scale: seasons whose level is 0.
    """
    between = changes.filter(pl.col("season") != pl.col("before"))
    ends = (("season", "before", 1.0), ("before", "season", -1.0))
    rows = pl.concat(
        between.select(here=pl.col(here), there=pl.col(there), ln=sign * pl.col("ln"))
        for here, there, sign in ends
    )
    seasons, place = np.unique(rows[["here", "there"]].to_numpy(), return_inverse=True)
    here, there = place.reshape(-1, 2).T
    free = np.bincount(here, minlength=len(seasons)) >= MIN_CHANGES
    free &= ~np.isin(seasons, list(to_scale))
    level, ln = np.zeros(len(seasons)), rows["ln"].to_numpy()
    for _ in range(POLISH_ROUNDS):
        apart = ln + level[there] - level[here]
        level += [0.5 * np.median(apart[here == s]) if free[s] else 0.0 for s in range(len(level))]
    return dict(zip(seasons[free].tolist(), level[free].tolist(), strict=True))


def _calibrated_seasons(curves: pl.DataFrame) -> pl.Series:
    return curves.drop_nulls("calibration_factor")["season"]


def _list_seasons_to_scale(curves: pl.DataFrame, diagnosis: pl.DataFrame) -> set[int]:
    """Return the seasons whose logs are on the scale of GPS: calibrated, or estimated."""
    return {*_calibrated_seasons(curves), *diagnosis.filter(verdict="estimated")["season"]}


def _compare_with_type(
    boats: pl.DataFrame, curves: pl.DataFrame, diagnosis: pl.DataFrame
) -> pl.DataFrame:
    """Return Cw over that of like boats, less 1, of tows without an earlier tow to compare with.

    These are tows of a boat and crew that was not towed before, or was altered since. Each of the
    other boats of the type with that crew counts with its last tow, at the declared speed of the
    tow that is compared, with Cw over size; the median of these is what is expected. Only seasons
    whose logs are to scale take part: other logs can make a type seem 20 % off.
    """
    to_scale = boats.filter(
        pl.col("season").is_in(_list_seasons_to_scale(curves, diagnosis))
    ).drop_nulls(["boat_type", "size"])
    is_first = pl.int_range(pl.len()).over(LINE) == 0
    firsts = boats.filter(is_first | pl.col("altered"))["tow_id"]
    others = to_scale.unique(["fsn_no", *LIKE], keep="last", maintain_order=True).select(
        *LIKE, "a_kg_m", "s_s2_m2", other_fsn_no="fsn_no", other_size="size"
    )
    return (
        to_scale.filter(pl.col("tow_id").is_in(firsts.implode()))
        .select("tow_id", *LIKE, "fsn_no", "size", "cw_kg_m", speed="declared_speed_m_s")
        .join(others, on=LIKE, maintain_order="left")
        .filter(pl.col("fsn_no") != pl.col("other_fsn_no"))
        .with_columns(other_cw=_cw_at(pl.col("speed")) * pl.col("size") / pl.col("other_size"))
        .drop_nulls("other_cw")
        .group_by("tow_id", maintain_order=True)
        .agg(over_type=pl.col("cw_kg_m").first() / pl.col("other_cw").median() - 1)
    )


def _compare_with_season_and_type(boats: pl.DataFrame) -> pl.DataFrame:
    """Return the excess of each tow over boats of its type with the same crew.

    Only for a method that knows no boat by all of its tows. Cw at the type's common speed, over its
    size, against the type's median; less the season's median, which holds the error of its log.
    Medians, so that a tow pulled askew does not move what it is compared with. An excess that the
    boat also shows in all of its later tows, when it was steered straight, is its own and does not
    count.
    """
    common_speed = pl.col("declared_speed_m_s").median().over(LIKE)
    ln, straight = pl.col("ln_excess"), pl.col("season") > CHECK["pulled_askew"].last_season
    later = ln.filter(straight).min().over("fsn_no")
    return (
        boats.filter(~pl.col("is_best"))
        .drop_nulls(["boat_type", "size"])
        .filter(pl.col("fsn_no").n_unique().over(LIKE) >= MIN_LIKE_BOATS)
        .with_columns(ln_excess=(_cw_at(common_speed) / pl.col("size")).log())
        .with_columns(ln - ln.median().over(LIKE))
        .with_columns(ln - ln.median().over("season"))
        .select("tow_id", over_like_boats=(ln - later.fill_null(0.0).clip(0.0)).exp() - 1)
    )
