"""What a tow shows of itself, before any method: resistance, bend, wind and speed.

Means over whole runs, simple enough to compare tows; the numbers of the register come from the
steps of a method. Which numbers are compared is decided in `pipeline.assessment.plausibility`.
"""

from typing import Final

import numpy as np
import polars as pl

from pipeline.arrays import BoolArray, FloatArray
from pipeline.blocks.run_blocks import WindowSums
from pipeline.blocks.tows import Tows
from pipeline.hull import AIR_DENSITY_KG_M3, front_area_m2

POWER_W: Final = {"H": 80.0, "D": 47.5}
"""What a rower gives at the declared speed: the middle of 70-90 and of 40-55 W (Sleepproef 2017,
"Sleepsnelheid")."""

DRAG: Final = 0.6
"""Middle of the drag coefficients in use: good enough to take off most of the air."""

RUN_SCATTER: Final = 0.02
"""Standard deviation of ln Cw of one run about its curve (inferred)."""

USUAL_BEND: Final = 0.75
"""Usual dlnCw/dlnv; B lies at 1.06 to 1.5 times the hull speed."""

LEAST_WATER: Final = 0.2
"""Smallest part of the resistance that is the water's."""

RADIANS: Final = 2.0 * np.pi
"""Angles in radians lie between -3.14 and 6.28: degrees of a vane that hardly moves."""

TOO_MUCH_AHEAD: Final = 0.1
"""Angles in radians read as degrees put all wind ahead: more than the boat's own speed is left."""

NO_WIND_M_S: Final = 0.1
"""Mean wind of a run that an anemometer standing still shows."""

MIN_OWN_SPEED: Final = 1.0
"""Least mean of the apparent wind out and back / boat speed by which a true wind is divided. An
anemometer that shows less is wrong, and its wind would pass for a gale."""

LEAST_RESULTANT: Final = float(np.cos(np.radians(3.3)))
"""Length of the mean direction of angles of which half are 0 and half 6.28 degrees."""


class Seen:
    """What the selected runs of each tow show, arrays of shape (tows,); NaN where nothing is shown.

    Attributes:
        tows: the tows.
        has_gps: whether any tow of its season has GPS.
        level: ln Cw at the declared speed less what power, class, weight and length predict;
            the log as the season's GPS corrects it, where there is one.
        bend: dlnCw/dlnv less the usual; `bend_sd`, its random part.
        force_n: mean tow force.
        air_share: part of it that is the air's, were the force right; more than 1 in a wrong unit.
        wind_ahead, wind_abeam: apparent wind / boat speed, mean of out and back: the true wind
            cancels, and 1 and 0 are left.
        true_wind: true wind / boat speed: the difference of the apparent wind out and back, in
            which the boat's own speed cancels, over their sum, in which the true wind cancels. So
            a unit that makes winds too large does not raise it. Where the sum is under the boat's
            speed, as that of a wind over ground, the difference is taken over the boat's speed.
        speed: ln(speed / intended speed), median of the runs.
        in_radians: all wind angles lie where radians do.
        wind_stands_still: the anemometer shows no wind through a whole run, and some in another.
    """

    def __init__(self, tows: Tows) -> None:
        self.tows = tows
        whole = WindowSums(tows.blocks, tows.blocks.n > 0)
        mean = {
            name: whole.mean(name)
            for name in ("force", "log1_v", "log1_cw", "wind_x", "wind_y", "wind_v")
        } | {"air": _air_kg_m(tows, whole)}
        good = tows.selected & (mean["log1_v"] > 0) & (mean["log1_cw"] > 0)
        speed = np.log(np.where(good, mean["log1_v"], 1.0) / tows.get_of_runs("declared_speed_m_s"))
        # A force or wind in another unit may leave less than nothing of the water's part.
        water = np.maximum(mean["log1_cw"] - mean["air"], LEAST_WATER * mean["log1_cw"])
        ln_cw = np.log(np.where(good, water, 1.0))
        level, bend, bend_sd = _line(tows, speed, ln_cw, good)
        ln_gps = _season_gps(tows, mean["log1_v"], good)
        windy = good & tows.measured("wind")[tows.tow]
        speed_m_s = np.where(good, mean["log1_v"], 1.0)
        self.has_gps = np.isfinite(ln_gps)
        by_gps = (2.0 + USUAL_BEND) * np.nan_to_num(ln_gps)
        self.level = level - by_gps - _expected_level(tows)
        self.bend, self.bend_sd = bend - USUAL_BEND, bend_sd
        self.force_n = tows.mean(mean["force"], good)
        self.air_share = tows.mean(mean["air"] / np.where(good, mean["log1_cw"], 1.0), good)
        ahead, abeam = mean["wind_x"] / speed_m_s, mean["wind_y"] / speed_m_s
        self.wind_ahead = tows.mean_of_ways(ahead, windy) - 1.0
        self.wind_abeam = tows.mean_of_ways(abeam, windy)
        true_ahead = tows.mean_of_ways(tows.direction * ahead, windy)
        true_abeam = tows.mean_of_ways(tows.direction * abeam, windy)
        own_speed = np.hypot(1.0 + self.wind_ahead, self.wind_abeam)
        self.true_wind = np.hypot(true_ahead, true_abeam) / np.maximum(own_speed, MIN_OWN_SPEED)
        self.speed = _median(tows, speed - np.log(tows.target_speed_ratio), good)
        too_far_ahead = self.wind_ahead > TOO_MUCH_AHEAD
        self.in_radians = _angles_in_radians(tows, windy) & too_far_ahead
        still, blows = mean["wind_v"] < NO_WIND_M_S, mean["wind_v"] >= NO_WIND_M_S
        self.wind_stands_still = tows.any(windy & still) & tows.any(windy & blows)


def _season_gps(tows: Tows, log_m_s: FloatArray, runs: BoolArray) -> FloatArray:
    """Median ln(GPS / log 1) of the tows of each tow's season; NaN without, shape (tows,).

    Plain GPS says little of one tow and enough of a season.
    """
    fixes = tows.blocks["gps_n"].sum(axis=1)
    gps = tows.blocks["gps"].sum(axis=1) / np.maximum(fixes, 1.0)
    there = runs & (fixes > 0) & (gps > 0)
    ratio = tows.mean_of_ways(
        np.log(np.where(there, gps, 1.0) / np.where(there, log_m_s, 1.0)), there
    )
    ratios = tows.frame.select("season", ratio=pl.Series(ratio).fill_nan(None))
    return ratios.select(pl.col("ratio").median().over("season"))["ratio"].to_numpy()


def _air_kg_m(tows: Tows, whole: WindowSums) -> FloatArray:
    """Most of the air's part of Cw, shape (runs,)."""
    front = front_area_m2(tows.get_of_runs("beam_m"), tows.get_of_runs("bow_height_m"))
    felt = sum(whole.mean(f"log1_head_{way}") for way in ("ahead", "behind"))
    return np.asarray(0.5 * AIR_DENSITY_KG_M3 * DRAG * front * felt)


def _line(
    tows: Tows, x: FloatArray, y: FloatArray, runs: BoolArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Least squares line through each tow's runs: value at x = 0, slope, sd of the slope."""
    middle_x, middle_y = tows.mean(x, runs), tows.mean(y, runs)
    dx = np.where(runs, x - middle_x[tows.tow], 0.0)
    wide = np.bincount(tows.tow, dx**2, tows.size)
    known = wide > 1e-6
    slope = np.bincount(tows.tow, dx * y, tows.size) / np.where(known, wide, 1.0)
    slope = np.where(known, slope, np.nan)
    level = middle_y - np.where(known, slope, USUAL_BEND) * middle_x
    level = np.where(tows.any(runs), level, np.nan)
    return level, slope, RUN_SCATTER / np.sqrt(np.where(known, wide, 1.0))


def _expected_level(tows: Tows) -> FloatArray:
    """The ln Cw that size alone predicts, at the level that the archive's median power gives."""
    size = _ln_size(tows)
    power = np.array([POWER_W[c] for c in tows.frame["crew_class"]])
    by_power = np.log(
        power * tows.get_of_tows("rowers") / tows.get_of_tows("declared_speed_m_s") ** 3
    )
    return np.asarray(size + np.median(by_power - size)) if tows.size else size


def _ln_size(tows: Tows) -> FloatArray:
    """Half ln(displacement x waterline length), which wetted surface follows."""
    displacement = tows.get_of_tows("weight_kg") + tows.get_of_tows("crew_weight_kg")
    ln = 0.5 * np.log(displacement * tows.get_of_tows("waterline_length_m"))
    known = np.isfinite(ln)
    return np.where(known, ln, np.median(ln[known]) if known.any() else 0.0)


def _median(tows: Tows, values: FloatArray, runs: BoolArray) -> FloatArray:
    """Median of each tow's marked runs; NaN without any."""
    rows = np.where(tows.group_by_tow(runs) > 0, tows.group_by_tow(values), np.nan)
    none = ~tows.any(runs)
    rows[none] = 0.0
    return np.where(none, np.nan, np.nanmedian(rows, axis=1))


def _angles_in_radians(tows: Tows, windy: BoolArray) -> BoolArray:
    """Whether every second of a tow has a mean wind angle that lies where radians do.

    In still air, and where it blows along the course, degrees do so too.
    """
    n: FloatArray = np.maximum(tows.blocks.n, 1.0)
    cos, sin = tows.blocks["wind_cos"] / n, tows.blocks["wind_sin"] / n
    angle = np.degrees(np.arctan2(sin, cos))
    there = (angle >= -0.5 * RADIANS) & (angle <= RADIANS) & (np.hypot(sin, cos) > LEAST_RESULTANT)
    outside = windy & ((tows.blocks.n > 0) & ~there).any(axis=1)
    return tows.any(windy) & ~tows.any(outside)
