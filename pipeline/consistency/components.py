"""How the spread of Cw divides over boats, seasons, boat x season and runs.

One mixed model over all repeated and single tows, by restricted maximum likelihood. An alteration
makes a new boat. Ageing is not in the model; it counts as season and as boat x season.
"""

from typing import Final

import numpy as np
import polars as pl

from pipeline.arrays import FloatArray
from pipeline.consistency import mixed
from pipeline.consistency.observed import (
    UNKNOWN_TYPE,
    Observed,
    curve_at,
    ln_cw_unit_variance,
)
from pipeline.tables.consistency import VarianceComponents
from pipeline.tables.declare import dy
from pipeline.tables.frames import frame_of
from pipeline.tables.keys import LINE
from pipeline.tables.row import Row

FLEET, WITHIN_TYPE = "fleet", "within_type"
SCOPES: Final = (FLEET, WITHIN_TYPE)

FEWEST_REPEATS: Final = 3
NAMES: Final = {"boat": mixed.BOAT, "season": mixed.OTHER, "boat_season": mixed.CELL}


def variance_components(observed: Observed) -> dy.DataFrame[VarianceComponents]:
    """Standard deviations of ln Cw by cause, over the fleet and within types, per method.

    A boat with a crew is compared at its median declared speed; the growth of Cw with speed is
    taken out, as boats are compared at one speed. `run` is what the scatter of the runs does to the
    Cw of one tow; it is known from within the tows.

    Returns:
        Rows of the table `variance_components`: `boat`, `season`, `boat_season` and `run` for each
        method and scope; empty numbers with a `reason` where tows do not determine them.
    """
    rows = [
        {"method": method, "scope": scope} | row
        for (method,), tows in observed.groups("method")
        for scope in SCOPES
        for row in _components(tows, scope)
    ]
    return frame_of(VarianceComponents, rows)


def _components(tows: Observed, scope: str) -> list[Row]:
    tows = _identified(tows)
    y, variance = _compared(tows)
    known = np.isfinite(y)
    if scope == WITHIN_TYPE:
        known &= (tows.table["boat_type"] != UNKNOWN_TYPE).to_numpy()
    rows = np.flatnonzero(known)
    tows, y, variance = tows.take(rows), y[rows], variance[rows]
    boat, season = tows.table["boat"].to_numpy(), tows.table["season"].to_numpy()
    n_boats = len(np.unique(boat))
    counts: Row = {"n": len(y), "n_boats": n_boats}
    x = _fixed(tows, scope)
    few = len(y) - n_boats < FEWEST_REPEATS or len(np.unique(season)) < 2
    if few or n_boats < x.shape[1] + 2:
        return _nothing(counts, "too_few_repeats")
    fit = mixed.fit(mixed.Problem(y, variance, x, boat, season), *mixed.COMPONENTS)
    if fit is None:
        return _nothing(counts, "not_settled")
    return [counts | row for row in _shares(fit, float(np.sqrt(variance.mean())))]


def _nothing(counts: Row, reason: str) -> list[Row]:
    return [counts | {"component": name, "reason": reason} for name in (*NAMES, "run")]


def _shares(fit: mixed.Fit, run: float) -> list[Row]:
    sd = dict(zip(NAMES, fit.sd, strict=True)) | {"run": run}
    total = sum(s * s for s in sd.values())
    rows: list[Row] = [
        {"component": name, "sd_ratio": s, "share": s * s / total if total > 0 else None}
        for name, s in sd.items()
    ]
    intervals = fit.intervals()
    for row in rows[:-1]:
        row["lo"], row["hi"] = intervals[NAMES[row["component"]]]
    return [row | {"reason": ""} for row in rows]


def _identified(tows: Observed) -> Observed:
    """Adds `boat`: boat and crew as it was between two alterations, and its median speed."""
    line = list(LINE)
    named = tows.table.with_columns(
        pl.col("altered").cum_sum().over(line, order_by=["tow_date", "tow_id"]).alias("state")
    ).with_columns(
        pl.concat_str([*line, "state"], separator="/").alias("boat"),
        pl.col("declared_speed_m_s").median().over([*line, "state"]).alias("median_speed_m_s"),
    )
    return Observed(named, tows.points)


def _compared(tows: Observed) -> tuple[FloatArray, FloatArray]:
    speed = tows.column("median_speed_m_s")
    variance = ln_cw_unit_variance(tows, speed) * tows.column("run_sd_ratio") ** 2
    return np.log(curve_at(tows, speed)), variance


def _fixed(tows: Observed, scope: str) -> FloatArray:
    """One level for the fleet, or one per type; and a slope with the speed of comparison."""
    if tows.table.is_empty():
        return np.ones((0, 1))
    levels = np.ones((tows.table.height, 1))
    if scope == WITHIN_TYPE:
        types = np.unique(tows.table["boat_type"].to_numpy().astype(str), return_inverse=True)[1]
        levels = np.eye(int(types.max()) + 1)[types]
    speed = np.log(tows.column("median_speed_m_s"))
    within = speed - levels @ np.linalg.lstsq(levels, speed)[0]
    return np.column_stack([levels, within]) if np.abs(within).max() > 1e-9 else levels
