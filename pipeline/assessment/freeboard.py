"""Changes of weight and fore-and-aft balance since the previous tow, as freeboards show them.

Freeboards are measured afloat since 2017, to check weight and how it lies over the length
(Sleepproef, R. Pot 2017, "Opmetingen en keuring"). A boat that sinks by d displaces density times
waterplane times d more; one that trims has its centre of gravity moved. Sides are taken to be
upright near the waterline, which holds for centimetres.
"""

from typing import Final

import polars as pl

WATER_KG_M3: Final = 1000.0
WATERPLANE: Final = 0.65
"""Waterplane / (waterline length x breadth) of a sloop that is pointed at both ends (inferred)."""

BALANCE: Final = 0.045
"""Second moment of the waterplane about its middle / (waterplane x length^2): 1/12 for a box, less
for pointed ends (inferred)."""

ENDS: Final = ("freeboard_bow_m", "freeboard_stern_m")


def by_freeboard(tows: pl.DataFrame) -> pl.DataFrame:
    """Change of weight and balance since the boat's previous tow, as freeboards show it.

    Args:
        tows: `tow_id`, `fsn_no`, `tow_date`, `altered`, sizes, `weight_kg` and freeboards.

    Returns:
        Per tow `weight_by_freeboard`: the change of weight by freeboards less that on the scale, as
        a part of the weight; `balance_changed`: how far the centre of gravity moved, as a part of
        the waterline length, forward above 0. Null without two sets of freeboards, after a
        reported alteration, and the first without both weights.
    """
    length, weight = pl.col("waterline_length_m"), pl.col("weight_kg")
    waterplane = WATERPLANE * length * pl.col("beam_m")
    sunk = -_change(pl.mean_horizontal(pl.col(ENDS[0]), pl.col(ENDS[1])))
    both = pl.col(ENDS[0]).is_not_null() & pl.col(ENDS[1]).is_not_null()
    bow_down = -_change(pl.col(ENDS[0]) - pl.col(ENDS[1])) / length
    moment = WATER_KG_M3 * waterplane * BALANCE * length**2 * bow_down
    told = both & _before(both) & ~pl.col("altered")
    by_water = WATER_KG_M3 * waterplane * sunk
    return tows.sort("tow_date", "tow_id").select(
        "tow_id",
        weight_by_freeboard=pl.when(told).then((by_water - _change(weight)) / weight),
        balance_changed=pl.when(told).then(moment / (weight * length)),
    )


def _before(value: pl.Expr) -> pl.Expr:
    return value.shift(1).over("fsn_no")


def _change(value: pl.Expr) -> pl.Expr:
    return value - _before(value)
