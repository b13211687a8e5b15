"""What a tow shows of itself, before any method: resistance, bend, wind and speed.

Means over whole runs, simple enough to compare tows; the numbers of the register come from the
steps of a method. Which numbers are compared is decided in `pipeline.assessment.plausibility`.
"""

from typing import Final

import numpy as np
import polars as pl

from pipeline.arrays import BoolArray, FloatArray
from pipeline.blocks.batch import Batch
from pipeline.blocks.run_blocks import WindowSums
from pipeline.channels import BACK, OUT
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

LEAST_RESULTANT: Final = float(np.cos(np.radians(3.3)))
"""Length of the mean direction of angles of which half are 0 and half 6.28 degrees."""


class Seen:
    """What the selected runs of each tow show, arrays of shape (tows,); NaN where nothing is shown.

    Attributes:
        batch: the tows.
        has_gps: whether any tow of its season has GPS.
        level: ln Cw at the declared speed less what power, class, weight and length predict;
            the log as the season's GPS corrects it, where there is one.
        bend: dlnCw/dlnv less the usual; `bend_sd`, its random part.
        force_n: mean tow force.
        air_share: part of it that is the air's, were the force right; more than 1 in a wrong unit.
        wind_ahead, wind_abeam: apparent wind / boat speed, mean of out and back: the true wind
            cancels, and 1 and 0 are left.
        speed: ln(speed / intended speed), median of the runs.
        in_radians: all wind angles lie where radians do.
        wind_stands_still: the anemometer shows no wind through a whole run, and some in another.
    """

    def __init__(self, batch: Batch) -> None:
        self.batch = batch
        whole = WindowSums(batch.blocks, batch.blocks.n > 0)
        mean = {
            name: whole.mean(name)
            for name in ("force", "log1_v", "log1_cw", "wind_x", "wind_y", "wind_v")
        } | {"air": _air_kg_m(batch, whole)}
        good = batch.selected & (mean["log1_v"] > 0) & (mean["log1_cw"] > 0)
        speed = np.log(np.where(good, mean["log1_v"], 1.0) / batch.of_run("declared_speed_m_s"))
        # A force or wind in another unit may leave less than nothing of the water's part.
        water = np.maximum(mean["log1_cw"] - mean["air"], LEAST_WATER * mean["log1_cw"])
        ln_cw = np.log(np.where(good, water, 1.0))
        level, bend, bend_sd = _line(batch, speed, ln_cw, good)
        ln_gps = _season_gps(batch, mean["log1_v"], good)
        windy = good.copy()
        if "wind_measured" in batch.tows.columns:
            windy &= batch.tows["wind_measured"].to_numpy()[batch.tow]
        speed_m_s = np.where(good, mean["log1_v"], 1.0)
        self.has_gps = np.isfinite(ln_gps)
        by_gps = (2.0 + USUAL_BEND) * np.nan_to_num(ln_gps)
        self.level = level - by_gps - _expected_level(batch)
        self.bend, self.bend_sd = bend - USUAL_BEND, bend_sd
        self.force_n = batch.mean(mean["force"], good)
        self.air_share = batch.mean(mean["air"] / np.where(good, mean["log1_cw"], 1.0), good)
        self.wind_ahead = _both_ways(batch, mean["wind_x"] / speed_m_s, windy) - 1.0
        self.wind_abeam = _both_ways(batch, mean["wind_y"] / speed_m_s, windy)
        self.speed = _median(batch, speed - np.log(batch.target_speed_ratio), good)
        too_far_ahead = self.wind_ahead > TOO_MUCH_AHEAD
        self.in_radians = _angles_in_radians(batch, windy) & too_far_ahead
        still, blows = mean["wind_v"] < NO_WIND_M_S, mean["wind_v"] >= NO_WIND_M_S
        self.wind_stands_still = batch.any(windy & still) & batch.any(windy & blows)


def _season_gps(batch: Batch, log_m_s: FloatArray, runs: BoolArray) -> FloatArray:
    """Median ln(GPS / log 1) of the tows of each tow's season; NaN without, shape (tows,).

    Plain GPS says little of one tow and enough of a season.
    """
    fixes = batch.blocks["gps_n"].sum(axis=1)
    gps = batch.blocks["gps"].sum(axis=1) / np.maximum(fixes, 1.0)
    there = runs & (fixes > 0) & (gps > 0)
    ratio = _both_ways(
        batch, np.log(np.where(there, gps, 1.0) / np.where(there, log_m_s, 1.0)), there
    )
    tows = batch.tows.select("season", ratio=pl.Series(ratio).fill_nan(None))
    return tows.select(pl.col("ratio").median().over("season"))["ratio"].to_numpy()


def _air_kg_m(batch: Batch, whole: WindowSums) -> FloatArray:
    """Most of the air's part of Cw, shape (runs,)."""
    front = front_area_m2(batch.of_run("beam_m"), batch.of_run("bow_height_m"))
    felt = sum(whole.mean(f"log1_head_{way}") for way in ("ahead", "behind"))
    return np.asarray(0.5 * AIR_DENSITY_KG_M3 * DRAG * front * felt)


def _line(
    batch: Batch, x: FloatArray, y: FloatArray, runs: BoolArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Least squares line through each tow's runs: value at x = 0, slope, sd of the slope."""
    middle_x, middle_y = batch.mean(x, runs), batch.mean(y, runs)
    dx = np.where(runs, x - middle_x[batch.tow], 0.0)
    wide = np.bincount(batch.tow, dx**2, batch.size)
    known = wide > 1e-6
    slope = np.bincount(batch.tow, dx * y, batch.size) / np.where(known, wide, 1.0)
    slope = np.where(known, slope, np.nan)
    level = middle_y - np.where(known, slope, USUAL_BEND) * middle_x
    level = np.where(batch.any(runs), level, np.nan)
    return level, slope, RUN_SCATTER / np.sqrt(np.where(known, wide, 1.0))


def _expected_level(batch: Batch) -> FloatArray:
    """The ln Cw that size alone predicts, at the level that the archive's median power gives."""
    size = _ln_size(batch)
    power = np.array([POWER_W[c] for c in batch.tows["crew_class"]])
    by_power = np.log(power * batch.of_tow("rowers") / batch.of_tow("declared_speed_m_s") ** 3)
    return np.asarray(size + np.median(by_power - size)) if batch.size else size


def _ln_size(batch: Batch) -> FloatArray:
    """Half ln(displacement x waterline length), which wetted surface follows."""
    displacement = batch.of_tow("weight_kg") + batch.of_tow("crew_weight_kg")
    ln = 0.5 * np.log(displacement * batch.of_tow("waterline_length_m"))
    known = np.isfinite(ln)
    return np.where(known, ln, np.median(ln[known]) if known.any() else 0.0)


def _both_ways(batch: Batch, values: FloatArray, runs: BoolArray) -> FloatArray:
    """Mean of out and back, each direction weighing the same; NaN without both."""
    ways = [runs & (batch.direction == way) for way in (OUT, BACK)]
    middle = 0.5 * sum(batch.mean(values, way) for way in ways)
    return np.where(batch.any(ways[0]) & batch.any(ways[1]), middle, np.nan)


def _median(batch: Batch, values: FloatArray, runs: BoolArray) -> FloatArray:
    """Median of each tow's marked runs; NaN without any."""
    rows = np.where(batch.by_tow(runs) > 0, batch.by_tow(values), np.nan)
    none = ~batch.any(runs)
    rows[none] = 0.0
    return np.where(none, np.nan, np.nanmedian(rows, axis=1))


def _angles_in_radians(batch: Batch, windy: BoolArray) -> BoolArray:
    """Whether every second of a tow has a mean wind angle that lies where radians do.

    In still air, and where it blows along the course, degrees do so too.
    """
    n: FloatArray = np.maximum(batch.blocks.n, 1.0)
    cos, sin = batch.blocks["wind_cos"] / n, batch.blocks["wind_sin"] / n
    angle = np.degrees(np.arctan2(sin, cos))
    there = (angle >= -0.5 * RADIANS) & (angle <= RADIANS) & (np.hypot(sin, cos) > LEAST_RESULTANT)
    outside = windy & ((batch.blocks.n > 0) & ~there).any(axis=1)
    return batch.any(windy) & ~batch.any(outside)
