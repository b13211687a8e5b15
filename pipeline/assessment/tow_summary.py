"""What the selected runs of each tow show of force, wind and speed, whatever the method.

Means over whole runs, a middle drag coefficient, and the log as the season's GPS corrects it: good
enough to see a wrong unit, a bad zero or a turned vane. The numbers of the register come from the
steps of a method. What is compared is decided in `pipeline.assessment.plausibility`.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
import polars as pl

from pipeline.arrays import BoolArray, FloatArray
from pipeline.blocks.run_blocks import WindowSums
from pipeline.blocks.tows import Tows
from pipeline.crews import STANDARD_CREWS, get_usual_power
from pipeline.hull import AIR_DENSITY_KG_M3, front_area_m2

MIDDLE_DRAG: Final = 0.6
"""Middle of the drag coefficients in use: good enough to take off most of the air."""

RUN_SD: Final = 0.02
"""Standard deviation of ln Cw of one run about its curve (inferred)."""

USUAL_BEND: Final = 0.75
"""Usual d ln Cw / d ln v; B lies at 1.06 to 1.5 times the hull speed."""

MIN_WATER_SHARE: Final = 0.2
"""Smallest part of the resistance that is the water's."""

MAX_RADIANS: Final = 2.0 * np.pi
"""Angles in radians lie between -3.14 and 6.28: degrees of a vane that hardly moves."""

MIN_EXCESS_AHEAD: Final = 0.1
"""Angles in radians read as degrees put all wind ahead: more than the boat's own speed is left."""

MIN_WIND_M_S: Final = 0.1
"""Mean wind of a run under which the anemometer stands still."""

MIN_OWN_SPEED: Final = 1.0
"""Least mean of the apparent wind out and back / boat speed by which a true wind is divided. An
anemometer that shows less is wrong, and its wind would pass for a gale."""

MIN_RESULTANT: Final = float(np.cos(np.radians(3.3)))
"""Length of the mean direction of angles of which half are 0 and half 6.28 degrees."""

MIN_LN_SPEED_SQUARES: Final = 1e-6
"""Sum of squares of ln speed about its mean below which runs show no slope."""


@dataclass(frozen=True)
class TowSummary:
    """What the selected runs of each tow show; arrays of shape (tows,), NaN where nothing is shown.

    Attributes:
        tows: the tows.
        has_gps: whether any tow of its season has GPS.
        level: ln Cw at the declared speed less what power, class, weight and length predict;
            the log as the season's GPS corrects it, where there is one.
        bend: d ln Cw / d ln v less the usual; `bend_sd`, its random part.
        force_n: mean tow force.
        air_share: part of it that is the air's, were the force right; more than 1 in a wrong unit.
        wind_ahead, wind_abeam: apparent wind / boat speed, mean of out and back, less 1 and 0: the
            true wind cancels.
        true_wind: true wind / boat speed: the difference of the apparent wind out and back, in
            which the boat's own speed cancels, over their sum, in which the true wind cancels. So
            a unit that makes winds too large does not raise it. Where the sum is under the boat's
            speed, as that of a wind over ground, the difference is taken over the boat's speed.
        speed: ln(speed / intended speed), median of the runs.
        is_in_radians: all wind angles lie where radians do.
        wind_stands_still: the anemometer shows no wind through a whole run, and some in another.
    """

    tows: Tows
    has_gps: BoolArray
    level: FloatArray
    bend: FloatArray
    bend_sd: FloatArray
    force_n: FloatArray
    air_share: FloatArray
    wind_ahead: FloatArray
    wind_abeam: FloatArray
    true_wind: FloatArray
    speed: FloatArray
    is_in_radians: BoolArray
    wind_stands_still: BoolArray


def summarize_tows(tows: Tows, crew_classes: pl.DataFrame = STANDARD_CREWS) -> TowSummary:
    """Return what the selected runs of each tow show."""
    whole = WindowSums(tows.blocks, tows.blocks.n > 0)
    log_m_s = whole.mean("log1_v")
    gross = whole.mean("log1_cw")
    air = _estimate_air_kg_m(tows, whole)
    is_used = tows.selected & (log_m_s > 0) & (gross > 0)
    safe_gross = np.where(is_used, gross, 1.0)
    speed_m_s = np.where(is_used, log_m_s, 1.0)
    ln_speed = np.log(speed_m_s / tows.get_of_runs("declared_speed_m_s"))
    # A force or wind in another unit may leave less than nothing of the water's part.
    water = np.where(is_used, np.maximum(gross - air, MIN_WATER_SHARE * gross), 1.0)
    level, bend, bend_sd = _fit_lines(tows, ln_speed, np.log(water), is_used)
    ln_gps = _find_season_gps(tows, log_m_s, is_used)
    by_gps = (2.0 + USUAL_BEND) * np.nan_to_num(ln_gps)

    is_windy = is_used & tows.has_channel("wind")[tows.tow]
    ahead = whole.mean("wind_x") / speed_m_s
    abeam = whole.mean("wind_y") / speed_m_s
    wind_ahead = tows.mean_of_ways(ahead, is_windy) - 1.0
    wind_abeam = tows.mean_of_ways(abeam, is_windy)
    true_ahead = tows.mean_of_ways(tows.direction * ahead, is_windy)
    true_abeam = tows.mean_of_ways(tows.direction * abeam, is_windy)
    own_speed = np.hypot(1.0 + wind_ahead, wind_abeam)
    is_still = whole.mean("wind_v") < MIN_WIND_M_S
    return TowSummary(
        tows=tows,
        has_gps=np.isfinite(ln_gps),
        level=level - by_gps - _expect_level(tows, crew_classes),
        bend=bend - USUAL_BEND,
        bend_sd=bend_sd,
        force_n=tows.mean(whole.mean("force"), is_used),
        air_share=tows.mean(air / safe_gross, is_used),
        wind_ahead=wind_ahead,
        wind_abeam=wind_abeam,
        true_wind=np.hypot(true_ahead, true_abeam) / np.maximum(own_speed, MIN_OWN_SPEED),
        speed=_take_median(tows, ln_speed - np.log(tows.target_speed_ratio), is_used),
        is_in_radians=_has_angles_in_radians(tows, is_windy) & (wind_ahead > MIN_EXCESS_AHEAD),
        wind_stands_still=tows.any(is_windy & is_still) & tows.any(is_windy & ~is_still),
    )


def _find_season_gps(tows: Tows, log_m_s: FloatArray, is_used: BoolArray) -> FloatArray:
    """Return the median ln(GPS / log 1) of the tows of each tow's season; NaN without, (tows,).

    Plain GPS says little of one tow and enough of a season.
    """
    fixes = tows.blocks["gps_n"].sum(axis=1)
    gps_m_s = tows.blocks["gps"].sum(axis=1) / np.maximum(fixes, 1.0)
    has_gps = is_used & (fixes > 0) & (gps_m_s > 0)
    safe_gps = np.where(has_gps, gps_m_s, 1.0)
    safe_log = np.where(has_gps, log_m_s, 1.0)
    ratio = tows.mean_of_ways(np.log(safe_gps / safe_log), has_gps)
    ratios = tows.frame.select("season", ratio=pl.Series(ratio).fill_nan(None))
    return ratios.select(pl.col("ratio").median().over("season"))["ratio"].to_numpy()


def _estimate_air_kg_m(tows: Tows, whole: WindowSums) -> FloatArray:
    """Return most of the air's part of Cw, (runs,)."""
    front = front_area_m2(tows.get_of_runs("beam_m"), tows.get_of_runs("bow_height_m"))
    felt = whole.mean("log1_head_ahead") + whole.mean("log1_head_behind")
    return np.asarray(0.5 * AIR_DENSITY_KG_M3 * MIDDLE_DRAG * front * felt)


def _fit_lines(
    tows: Tows, x: FloatArray, y: FloatArray, is_used: BoolArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the least squares line through each tow's runs: value at x = 0, slope, slope's sd."""
    mean_x = tows.mean(x, is_used)
    dx = np.where(is_used, x - mean_x[tows.tow], 0.0)
    squares = np.bincount(tows.tow, dx**2, tows.size)
    has_slope = squares > MIN_LN_SPEED_SQUARES
    safe_squares = np.where(has_slope, squares, 1.0)
    slope = np.bincount(tows.tow, dx * y, tows.size) / safe_squares
    slope = np.where(has_slope, slope, np.nan)
    level = tows.mean(y, is_used) - np.where(has_slope, slope, USUAL_BEND) * mean_x
    return np.where(tows.any(is_used), level, np.nan), slope, RUN_SD / np.sqrt(safe_squares)


def _expect_level(tows: Tows, crew_classes: pl.DataFrame) -> FloatArray:
    """Return ln Cw that size alone predicts, at the level that the archive's median power gives."""
    # Wetted surface follows half of ln(displacement x waterline length).
    displacement = tows.get_of_tows("weight_kg") + tows.get_of_tows("crew_weight_kg")
    ln_size = 0.5 * np.log(displacement * tows.get_of_tows("waterline_length_m"))
    is_known = np.isfinite(ln_size)
    usual_ln_size = np.median(ln_size[is_known]) if is_known.any() else 0.0
    ln_size = np.where(is_known, ln_size, usual_ln_size)
    usual_power_w = get_usual_power(crew_classes)
    power = np.array([usual_power_w[crew_class] for crew_class in tows.frame["crew_class"]])
    by_power = np.log(
        power * tows.get_of_tows("rowers") / tows.get_of_tows("declared_speed_m_s") ** 3
    )
    return np.asarray(ln_size + np.median(by_power - ln_size)) if tows.size else ln_size


def _take_median(tows: Tows, values: FloatArray, is_used: BoolArray) -> FloatArray:
    """Return the median over each tow's used runs; NaN without any, (tows,)."""
    rows = np.where(tows.group_by_tow(is_used) > 0, tows.group_by_tow(values), np.nan)
    has_none = ~tows.any(is_used)
    rows[has_none] = 0.0
    return np.where(has_none, np.nan, np.nanmedian(rows, axis=1))


def _has_angles_in_radians(tows: Tows, is_windy: BoolArray) -> BoolArray:
    """Return whether the mean wind angle of every second of a tow lies where radians do, (tows,).

    In still air, and where it blows along the course, degrees do so too.
    """
    n: FloatArray = np.maximum(tows.blocks.n, 1.0)
    cos, sin = tows.blocks["wind_cos"] / n, tows.blocks["wind_sin"] / n
    angle = np.degrees(np.arctan2(sin, cos))
    is_steady = np.hypot(sin, cos) > MIN_RESULTANT
    is_small = (angle >= -0.5 * MAX_RADIANS) & (angle <= MAX_RADIANS) & is_steady
    has_other = is_windy & ((tows.blocks.n > 0) & ~is_small).any(axis=1)
    return tows.any(is_windy) & ~tows.any(has_other)
