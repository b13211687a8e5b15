"""Every tow next to the others of its type: what the charts of the 2015 presentation plot.

All tows of all seasons, each marked: the newest of its boat and crew, towed too slowly, outside its
type. Also what hull speed says: `v0 / hull speed`, `B / hull speed`, and which of the three cases
of Cw-kromme (R. Pot 2015) a tow is. Outliers themselves are in `outliers`.
"""

from typing import Final

import numpy as np
import polars as pl

from pipeline.consistency.eras import median_interval
from pipeline.consistency.observed import (
    ALL_TYPES,
    TOW,
    UNKNOWN_TYPE,
    Observed,
    a_unit_variance,
    counts_at,
    curve_anywhere,
    ln_cw_variance,
    newest,
)
from pipeline.consistency.outliers import tow_outliers
from pipeline.consistency.tow_speed import is_slow, speed_case
from pipeline.hull import hull_speed_m_s
from pipeline.quantiles import NORMAL
from pipeline.tables.consistency import HullSpeed
from pipeline.tables.frames import frame_of

ROWED_RATIO: Final = (0.60, 0.70)
"""Presentation 2015: "We roeien op ca. 60-70% van de rompsnelheid"."""


def compared_tows(observed: Observed) -> pl.DataFrame:
    """All tows with what is compared: A, B and Cw at the standard speed, and hull speed.

    Returns:
        Rows of the table `compared_tows`; `cw_standard_kg_m` is empty where the standard speed is
        not below B, and what outliers say where the type has too few boats.
    """
    last = newest(observed).table.select("method", "tow_id", newest=pl.lit(value=True))
    outliers = tow_outliers(observed).select(
        "method",
        "tow_id",
        "deviation_sd",
        "outside",
        "candidates",
    )
    return (
        beside_their_type(observed)
        .join(last, on=["method", "tow_id"], how="left", maintain_order="left")
        .join(outliers, on=["method", "tow_id"], how="left", maintain_order="left")
        .with_columns(pl.col("newest").fill_null(value=False))
        .sort("method", "tow_id")
    )


_FROM_CURVES: Final = (
    *("declared_speed_m_s", "weight_kg", "displacement_kg", "waterline_length_m"),
    *("a_kg_m", "b_m_s", "b_lo_m_s", "b_hi_m_s", "power_w"),
)


def beside_their_type(tows: Observed) -> pl.DataFrame:
    """The columns of `compared_tows` that follow from a tow and the standard speed of its type."""
    speed = tows.column("standard_speed_m_s")
    cw = curve_anywhere(tows, speed)
    half = NORMAL * np.sqrt(ln_cw_variance(tows, speed))
    a = tows.column("a_kg_m")
    a_variance = np.maximum(a_unit_variance(tows, tows.column("q")), 0.0)
    a_half = NORMAL * np.sqrt(a_variance) * tows.column("run_sd_ratio")
    hull = hull_speed_m_s(tows.column("waterline_length_m"))
    b = tows.table["b_m_s"].to_numpy().astype(np.float64)
    ratio = tows.column("declared_speed_m_s") / hull
    numbers = {
        "a_lo_kg_m": a * np.exp(-a_half),
        "a_hi_kg_m": a * np.exp(a_half),
        "hull_speed_m_s": hull,
        "tow_hull_ratio": ratio,
        "b_hull_ratio": b / hull,
        "standard_speed_m_s": speed,
        "cw_standard_kg_m": cw,
        "cw_standard_lo_kg_m": cw * np.exp(-half),
        "cw_standard_hi_kg_m": cw * np.exp(half),
    }
    return tows.table.select(
        *TOW,
        "season",
        *(pl.col(name).cast(pl.Float64) for name in _FROM_CURVES),
    ).with_columns(
        *(pl.Series(name, values, pl.Float64).fill_nan(None) for name, values in numbers.items()),
        pl.Series("speed_case", speed_case(ratio), pl.String),
        pl.Series("beyond_curve", ~counts_at(tows, speed)),
        pl.Series("slow", is_slow(tows.table)),
    )


def hull_speed_statistics(compared: pl.DataFrame) -> pl.DataFrame:
    """Is B hull speed, and at what part of hull speed are boats towed?

    Of a boat with several tows the median counts, so that it counts once. The interval of the
    median rests on order statistics.

    Args:
        compared: rows of `compared_tows`.

    Returns:
        Rows of the table `hull_speed`, per method, and boat type or all.
    """
    every = compared.with_columns(boat_type=pl.lit(ALL_TYPES))
    typed = compared.filter(pl.col("boat_type") != UNKNOWN_TYPE)
    groups = pl.concat([every, typed]).group_by("method", "boat_type", maintain_order=True)
    rows = [{"method": m, "boat_type": t} | _hull_row(group) for (m, t), group in groups]
    return frame_of(HullSpeed, rows).sort("method", "boat_type")


def _hull_row(tows: pl.DataFrame) -> dict[str, object]:
    ratio = tows["tow_hull_ratio"]
    with_b = tows.drop_nulls("b_hull_ratio")
    row: dict[str, object] = {
        "n": tows.height,
        "n_boats": tows["fsn_no"].n_unique(),
        "tow_ratio": ratio.median(),
        "tow_share_60_70": ratio.is_between(*ROWED_RATIO).mean(),
        "b_share_within_5pct": (with_b["b_hull_ratio"] - 1.0).abs().le(0.05).mean(),
    }
    boats = with_b.group_by("fsn_no", maintain_order=True).agg(
        pl.col("b_hull_ratio", "b_m_s", "waterline_length_m").median()
    )
    ratios = np.sort(boats["b_hull_ratio"].to_numpy())
    interval = median_interval(ratios)
    row["b_ratio"] = float(np.median(ratios)) if len(ratios) else None
    if interval is not None:
        _, lo, hi = interval
        row |= {"b_ratio_lo": lo, "b_ratio_hi": hi, "b_is_hull_speed": lo <= 1.0 <= hi}
    return row
