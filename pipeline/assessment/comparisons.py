"""What the checks of a tow measure beside its own runs: other tows, like boats, papers, its season.

Each function returns a row per tow with the columns that `checks` reads.
"""

from collections.abc import Collection, Sequence
from typing import Final

import numpy as np
import polars as pl

from pipeline.assessment.checks import CHECK
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

FREEBOARDS: Final = ("freeboard_lowest_m", "freeboard_bow_m", "freeboard_stern_m")


def compare_with_papers(tows: pl.DataFrame) -> pl.DataFrame:
    """Compare measurements with the boat list, and with those of the boat's previous tow.

    Null for a boat that was ever altered, and after a reported alteration, which explain it.
    """

    def before(columns: Sequence[str]) -> pl.Expr:
        return pl.col(columns).shift(1).over("fsn_no", order_by=["tow_date", "tow_id"])

    same, altered = ~pl.col("altered"), pl.col("altered").any().over("fsn_no")
    length_off = (pl.col("waterline_length_m") / pl.col("listed_length_m") - 1).abs()
    beam_off = (pl.col("beam_m") / pl.col("listed_beam_m") - 1).abs()
    freeboard_change = pl.max_horizontal((pl.col(FREEBOARDS) - before(FREEBOARDS)).abs())
    size_change = pl.col(SIZES) / before(SIZES) - 1
    return tows.select(
        "tow_id",
        pl.when(same).then(size_change).name.suffix("_change"),
        off_boat_list=pl.when(~altered).then(pl.max_horizontal(length_off, beam_off)),
        freeboard_change_m=pl.when(same).then(freeboard_change),
    )


def add_boats(curves: pl.DataFrame, tows: pl.DataFrame) -> pl.DataFrame:
    """Return tows with a curve, with the boat of the day, sorted by date.

    Where the method knows the boat by all of its tows, A and Cw are moved to its best estimate: a
    tow that is off does not make the boat another. `size` is sqrt(displacement x waterline length):
    wetted surface follows it (docs of `pipeline.steps.resistance`), and friction, most of Cw,
    follows wetted surface. `s_s2_m2` is 1/B^2, also of a flat or falling curve, from A and Cw at
    the declared speed.
    """
    of_tow = tows.select(
        "tow_id", "boat_type", "tow_date", "altered",
        "waterline_length_m", "weight_kg", "crew_weight_kg",
    )  # fmt: skip
    displacement = pl.col("weight_kg") + pl.col("crew_weight_kg")
    best_ratio = (pl.col("cw_best_kg_m") / pl.col("cw_kg_m")).fill_null(1.0)
    return (
        curves.filter(pl.col("a_kg_m").is_not_null())
        .join(of_tow, on="tow_id", maintain_order="left")
        .with_columns(
            pl.col("a_kg_m", "cw_kg_m") * best_ratio,
            is_best=pl.col("cw_best_kg_m").is_not_null(),
            size=(displacement * pl.col("waterline_length_m")).sqrt(),
            s_s2_m2=(1 - pl.col("a_kg_m") / pl.col("cw_kg_m")) / pl.col("declared_speed_m_s") ** 2,
        )
        .sort("tow_date", "tow_id")
    )


def _compute_cw_at(speed: pl.Expr) -> pl.Expr:
    """Return Cw of each curve at a speed; null from B on."""
    below_b = 1 - pl.col("s_s2_m2") * speed**2
    return pl.when(below_b > 0).then(pl.col("a_kg_m") / below_b)


def doubt_seasons(
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
    doubted = set(seasons.filter("season_in_doubt")["season"])
    anchors = set(_list_calibrated_seasons(curves)) & set(seasons["season"])
    if anchors and anchors <= doubted:
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


def estimate_log_slopes(curves: pl.DataFrame, run_points: pl.DataFrame) -> pl.DataFrame:
    """Return how the log's factor changes with speed, by the GPS of all tows of its season.

    The slope of ln(GPS / log) by ln speed among runs one way, in which the current is the same; its
    mean over the season, 0 where chance explains it.
    """
    ways, slope = ["tow_id", "direction"], pl.col("slope")
    x, y = pl.col("speed_m_s").log(), pl.col("gps_ratio").log()
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


def compare_with_best_estimate(curves: pl.DataFrame) -> pl.DataFrame:
    """Return Cw as measured over the best estimate, less 1, of boats with more than one tow.

    The best estimate takes the boat's other tows into account, and that it may have been altered:
    what is left is the tow's own (pulled askew, a zero, a file of another boat).
    """
    of_line = curves.filter(pl.col("cw_kg_m").is_not_null() & (pl.len().over(LINE) > 1))
    return of_line.select("tow_id", over_best=pl.col("cw_kg_m") / pl.col("cw_best_kg_m") - 1)


def compare_with_previous(
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

    change = _compute_cw_at(before("declared_speed_m_s")) / before("cw_kg_m")
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
    forward = between.select(here="season", there="before", ln="ln")
    backward = between.select(here="before", there="season", ln=-pl.col("ln"))
    rows = pl.concat([forward, backward])
    seasons, place = np.unique(rows[["here", "there"]].to_numpy(), return_inverse=True)
    here, there = place.reshape(-1, 2).T
    free = np.bincount(here, minlength=len(seasons)) >= MIN_CHANGES
    free &= ~np.isin(seasons, list(to_scale))
    level, ln = np.zeros(len(seasons)), rows["ln"].to_numpy()
    for _ in range(POLISH_ROUNDS):
        apart = ln + level[there] - level[here]
        for season in np.flatnonzero(free):
            level[season] += 0.5 * np.median(apart[here == season])
    return dict(zip(seasons[free].tolist(), level[free].tolist(), strict=True))


def _list_calibrated_seasons(curves: pl.DataFrame) -> pl.Series:
    return curves.drop_nulls("calibration_factor")["season"]


def _list_seasons_to_scale(curves: pl.DataFrame, diagnosis: pl.DataFrame) -> set[int]:
    """Return the seasons whose logs are on the scale of GPS: calibrated, or estimated."""
    estimated = diagnosis.filter(verdict="estimated")["season"]
    return set(_list_calibrated_seasons(curves)) | set(estimated)


def compare_with_type(
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
    last_tows = to_scale.unique(("fsn_no",) + LIKE, keep="last", maintain_order=True)
    others = last_tows.select(
        pl.col(LIKE), "a_kg_m", "s_s2_m2", other_fsn_no="fsn_no", other_size="size"
    )
    return (
        to_scale.filter(pl.col("tow_id").is_in(firsts.implode()))
        .select("tow_id", pl.col(LIKE), "fsn_no", "size", "cw_kg_m", speed="declared_speed_m_s")
        .join(others, on=LIKE, maintain_order="left")
        .filter(pl.col("fsn_no") != pl.col("other_fsn_no"))
        .with_columns(
            other_cw=_compute_cw_at(pl.col("speed")) * pl.col("size") / pl.col("other_size")
        )
        .drop_nulls("other_cw")
        .group_by("tow_id", maintain_order=True)
        .agg(over_type=pl.col("cw_kg_m").first() / pl.col("other_cw").median() - 1)
    )


def compare_with_season_and_type(boats: pl.DataFrame) -> pl.DataFrame:
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
        .with_columns(ln_excess=(_compute_cw_at(common_speed) / pl.col("size")).log())
        .with_columns(ln - ln.median().over(LIKE))
        .with_columns(ln - ln.median().over("season"))
        .select("tow_id", over_like_boats=(ln - later.fill_null(0.0).clip(0.0)).exp() - 1)
    )
