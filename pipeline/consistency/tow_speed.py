"""Does the bend of a curve follow the speed of the tow? If the hyperbola is true, it does not.

And what a slow tow does to race power: its curve is used at speeds at which it was never towed.
"""

from typing import Any, Final

import numpy as np
import polars as pl

from pipeline import curve
from pipeline.arrays import BoolArray, FloatArray
from pipeline.consistency import mixed
from pipeline.consistency.homogeneity import height_given_bend, shared_bend
from pipeline.consistency.observed import LINE, UNKNOWN_TYPE, Observed, newest, q_at

SLOW_POWER_W: Final = {"H": 60.0, "D": 34.0}
"""Power a rower below which a tow is too slow. Men: "minder dan 60-70 Watt" (Cw-kromme, R. Pot
2015). Women tow at 40-55 W instead of 70-90 W: the same share of their range (inferred)."""

ALL_TYPES: Final = "all"
FEWEST_BOATS: Final = 4


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
    problem = mixed.Problem.of(q, np.column_stack([types, centred]), variance, boat)
    slope, lo, hi = (float(e[-1]) for e in mixed.fit(problem, (mixed.BOAT,)).coefficients())
    return counts | {"slope": slope, "slope_lo": lo, "slope_hi": hi, "reason": ""}


def slow_tows(observed: Observed) -> pl.DataFrame:
    """Tows made with too little power, and what their own bend does to race power.

    The tow's own curve is compared, 10 and 20 % above its declared speed, with the curve of the
    same runs that has the bend of the type's other boats. The interval is that of the tow's own
    bend alone.

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
    }
    ratios = (f"power_ratio_{above}{end}" for above in (110, 120) for end in ("", "_lo", "_hi"))
    empty = pl.DataFrame(schema=schema | dict.fromkeys(ratios, pl.Float64()))
    return pl.concat([empty, *parts]).sort("method", "tow_id")


def _slow_of_type(boats: Observed, boat_type: str) -> pl.DataFrame:
    slow = is_slow(boats.table)
    chosen, others = (boats.take(np.flatnonzero(where)) for where in (slow, ~slow))
    ratios = {}
    for above in (110, 120):
        ratio, half = np.full(slow.sum(), np.nan), np.full(slow.sum(), np.nan)
        if boat_type != UNKNOWN_TYPE and others.table["fsn_no"].n_unique() >= 2 and slow.any():
            ratio, half = _power_ratio(chosen, shared_bend(others), above / 100.0)
        for end, values in (
            ("", ratio),
            ("_lo", ratio * np.exp(-half)),
            ("_hi", ratio * np.exp(half)),
        ):
            ratios[f"power_ratio_{above}{end}"] = values
    return chosen.table.select(
        "method", "tow_id", *LINE, "boat_type", "declared_speed_m_s", "power_w"
    ).with_columns(pl.Series(k, v).fill_nan(None) for k, v in ratios.items())


def _power_ratio(tows: Observed, s_s2_m2: float, above: float) -> tuple[FloatArray, FloatArray]:
    """Power by the own curve / by the shared bend, and half the width of its interval in ln."""
    speed = above * tows.column("declared_speed_m_s")
    s = np.full(len(speed), s_s2_m2)
    shared = curve.cw(height_given_bend(tows.points, s), s, speed)
    own_s, q = tows.column("s_s2_m2"), tows.column("q")
    own_a = tows.column("c0_kg_m") / (1.0 + q)
    own = curve.cw(own_a, own_s, speed)
    known = np.isfinite(shared) & np.isfinite(own)
    ratio = np.where(known, own, 1.0) / np.where(known, shared, 1.0)
    x = above**2 - 1.0
    slope = x / np.maximum(1.0 - q * x, 0.05)
    half = 1.96 * slope * np.sqrt(tows.column("q_unit_variance")) * tows.column("run_sd_ratio")
    return np.where(known, ratio, np.nan), np.where(known, half, np.nan)
