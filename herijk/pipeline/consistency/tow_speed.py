"""Does the bend of a curve follow the speed of the tow? If the hyperbola is true, it does not.

And what a slow tow does to race power: its curve is used at speeds at which it was never towed.
"""

from typing import Any, Final

import numpy as np
import polars as pl

from herijk.pipeline import curve
from herijk.pipeline.arrays import BoolArray, FloatArray
from herijk.pipeline.consistency import mixed
from herijk.pipeline.consistency.homogeneity import height_given_bend, shared_bend
from herijk.pipeline.consistency.observed import LINE, UNKNOWN_TYPE, Observed, newest, q_at
from herijk.pipeline.consistency.reml import Problem

SLOW_POWER_W: Final = {"H": 60.0, "D": 34.0}
"""Power a rower below which a tow is too slow. Men: "minder dan 60-70 Watt" (Cw-kromme, R. Pot
2015). Women tow at 40-55 W instead of 70-90 W: the same share of their range (inferred)."""

ALL_TYPES: Final = "all"
FEWEST_BOATS: Final = 4
FEWEST_OTHERS: Final = 2
ENDS: Final = ("", "_lo", "_hi")


def is_slow(table: pl.DataFrame) -> BoolArray:
    """Whether a tow was made with too little power, shape (rows,)."""
    limit = pl.col("crew_class").replace_strict(SLOW_POWER_W, return_dtype=pl.Float64)
    slow = table.select((pl.col("power_w") < limit).fill_null(value=False)).to_series()
    return slow.to_numpy()


def speed_trend(observed: Observed) -> pl.DataFrame:
    """Trend of the bend q at a type's standard speed with the speed of the tow.

    Per type and over all types, each about its own level. The trend is per unit of ln v0; 0.1 of
    it is what 10 % of tow speed does to q.

    Returns:
        Rows of the table `speed_trend`.
    """
    boats = newest(observed)
    rows = []
    for (method,), fleet in boats.groups("method"):
        parts = [
            part for (boat_type,), part in fleet.groups("boat_type") if boat_type != UNKNOWN_TYPE
        ]
        named = [(str(part.table["boat_type"][0]), [part]) for part in parts]
        rows += [
            {"method": method, "boat_type": name} | _trend(some)
            for name, some in [*named, (ALL_TYPES, parts)]
        ]
    numbers = ("slope", "slope_lo", "slope_hi")
    schema = (
        {"method": pl.String(), "boat_type": pl.String()}
        | {"n": pl.Int32(), "n_boats": pl.Int32()}
        | dict.fromkeys(numbers, pl.Float64())
        | {"reason": pl.String()}
    )
    return pl.DataFrame(rows, schema=schema)


def _trend(parts: list[Observed]) -> dict[str, Any]:
    columns: list[tuple[FloatArray, ...]] = []
    boat: list[str] = []
    for number, part in enumerate(parts):
        speed = float(np.median(part.column("declared_speed_m_s")))
        q, unit = q_at(part, speed)
        known = np.isfinite(q)
        x = np.log(part.column("declared_speed_m_s") / speed)
        variance = unit * part.column("run_sd_ratio") ** 2
        place = np.full(len(q), float(number))
        columns.append(tuple(v[known] for v in (q, x, variance, place)))
        boat += part.table["fsn_no"].filter(pl.Series(known)).to_list()
    if not columns:
        return {"n": 0, "n_boats": 0, "reason": "few_boats"}
    q, x, variance, place = (np.concatenate(c) for c in zip(*columns, strict=True))
    n_boats = len(set(boat))
    counts = {"n": len(q), "n_boats": n_boats}
    levels = np.unique(place)
    if n_boats < max(FEWEST_BOATS, len(levels) + 2):
        return counts | {"reason": "few_boats"}
    types = (place[:, None] == levels).astype(np.float64)
    centred = x - types @ np.linalg.lstsq(types, x)[0]
    if np.abs(centred).max() < 1e-9:
        return counts | {"reason": "equal_values"}
    problem = Problem.of(q, np.column_stack([types, centred]), variance, boat)
    slope, lo, hi = (float(e[-1]) for e in mixed.fit(problem, (mixed.BOAT,)).coefficients())
    return counts | {"slope": slope, "slope_lo": lo, "slope_hi": hi, "reason": ""}


def slow_tows(observed: Observed) -> pl.DataFrame:
    """Tows made with too little power, and what their own bend does to race power.

    The tow's own curve is compared with the curve of the same runs that has the bend of the type's
    other boats: 10 and 20 % above its declared speed, and at the speed that its crew will really
    row, the median declared speed of the type's other crews of that class (inferred). The interval
    is that of the tow's own bend alone.

    Returns:
        Rows of the table `slow_tows`; the ratios are empty where the type has no other boats.
    """
    parts = [
        _slow_of_type(group, boat_type)
        for (_, boat_type), group in newest(observed).groups("method", "boat_type")
    ]
    schema = {
        "method": pl.String(),
        "tow_id": pl.String(),
        "fsn_no": pl.String(),
        "rowers": pl.Int32(),
        "crew_class": pl.String(),
        "boat_type": pl.String(),
        "declared_speed_m_s": pl.Float64(),
        "power_w": pl.Float64(),
        "rowed_speed_m_s": pl.Float64(),
    }
    ratios = (f"power_ratio_{at}{end}" for at in ("110", "120", "rowed") for end in ENDS)
    empty = pl.DataFrame(schema=schema | dict.fromkeys(ratios, pl.Float64()))
    return pl.concat([empty, *parts]).sort("method", "tow_id")


def _slow_of_type(boats: Observed, boat_type: str) -> pl.DataFrame:
    slow = is_slow(boats.table)
    chosen, others = (boats.take(np.flatnonzero(where)) for where in (slow, ~slow))
    known = boat_type != UNKNOWN_TYPE and others.table["fsn_no"].n_unique() >= FEWEST_OTHERS
    declared = chosen.column("declared_speed_m_s")
    rowed = _rowed_speed(chosen, others) if known else np.full(len(declared), np.nan)
    columns = {"rowed_speed_m_s": rowed}
    for at, speed in (("110", 1.1 * declared), ("120", 1.2 * declared), ("rowed", rowed)):
        ends = np.full((3, len(declared)), np.nan)
        if known and len(declared):
            ends = _power_ratio(chosen, shared_bend(others), speed)
        columns |= {f"power_ratio_{at}{end}": ends[i] for i, end in enumerate(ENDS)}
    return chosen.table.select(
        "method", "tow_id", *LINE, "boat_type", "declared_speed_m_s", "power_w"
    ).with_columns(pl.Series(k, v, pl.Float64).fill_nan(None) for k, v in columns.items())


def _rowed_speed(slow: Observed, others: Observed) -> FloatArray:
    """Median declared speed of the others of the same crew class, NaN without any."""
    median = others.table.group_by("crew_class").agg(pl.col("declared_speed_m_s").median())
    by_class = dict(median.iter_rows())
    return np.array([by_class.get(c, np.nan) for c in slow.table["crew_class"]], dtype=np.float64)


def _power_ratio(tows: Observed, s_s2_m2: float, speed_m_s: FloatArray) -> FloatArray:
    """Power by the own curve / by the shared bend with its interval, shape (3, rows)."""
    s = np.full(len(speed_m_s), s_s2_m2)
    shared = curve.cw(height_given_bend(tows.points, s), s, speed_m_s)
    own_s, q = tows.column("s_s2_m2"), tows.column("q")
    own = curve.cw(tows.column("c0_kg_m") / (1.0 + q), own_s, speed_m_s)
    known = np.isfinite(shared) & np.isfinite(own)
    ratio = np.where(known, own, np.nan) / np.where(known, shared, 1.0)
    x = (speed_m_s / tows.column("declared_speed_m_s")) ** 2 - 1.0
    slope = x / np.maximum(1.0 - q * x, 0.05)
    sd = np.abs(slope) * np.sqrt(tows.column("q_unit_variance")) * tows.column("run_sd_ratio")
    return np.stack([ratio, ratio * np.exp(-1.96 * sd), ratio * np.exp(1.96 * sd)])
