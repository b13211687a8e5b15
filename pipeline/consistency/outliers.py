"""Which boats and tows differ from the others of their type, and what could explain it."""

from collections.abc import Iterator
from typing import Final

import numpy as np
import polars as pl
import scipy

from pipeline.arrays import BoolArray, FloatArray
from pipeline.consistency import mixed
from pipeline.consistency.lines import (
    BEND,
    LN_CW,
    LN_DISPLACEMENT,
    explaining_variable,
    quantities,
)
from pipeline.consistency.observed import TOW, UNKNOWN_TYPE, Observed, newest
from pipeline.consistency.tow_speed import is_slow
from pipeline.history import STEERED_STRAIGHT_FROM
from pipeline.tables.consistency import TypeOutliers

FEWEST_BOATS: Final = 3
"""Fewest boats beyond the unknowns of a type that one boat is compared with."""

OUTSIDE_LEVEL: Final = 0.05
"""Chance that any boat of a type of like boats is called outside (Bonferroni)."""

UNUSUAL_SD: Final = 2.0
"""A weight, length or season counts as unusual from this many standard deviations on."""

ASKEW_EXCESS: Final = 0.03
"""Pulled askew gave 5-10 % too high, once 40 % (presentation 2015); less is not worth naming."""


def type_outliers(observed: Observed) -> pl.DataFrame:
    """The newest tow of every boat against its type, with what could explain a difference.

    By height and bend (v/B)^2 of the curve, both at the standard speed; the height after the line
    on ln displacement where that is known. Of the forms of the bend this one has the most even
    spread: where B truly spreads 10 %, 27 % of types of 24 boats had an outlier by q, 11 % have one
    by this. A boat's expectation comes from the other boats alone; the deviation is in standard
    deviations of a prediction (externally Studentised).

    Returns:
        Rows of the table `type_outliers`: one per method, tow and quantity, `outside` or not;
        none of a type where the search for its variances did not come to rest.
    """
    return _outliers(newest(observed), (mixed.BOAT,), (LN_CW, BEND))


def tow_outliers(observed: Observed) -> pl.DataFrame:
    """Every tow against the tows of the other boats of its type, by Cw at the standard speed.

    A season's own deviation is taken out, so that a tow stands out by itself and not because its
    log was worn like those of all tows that year.

    Returns:
        As `type_outliers`, for all tows.
    """
    return _outliers(observed, mixed.COMPONENTS, (LN_CW,))


def _outliers(tows: Observed, components: tuple[str, ...], names: tuple[str, ...]) -> pl.DataFrame:
    parts = [
        _deviations(boats, quantity, fit)
        for (_, boat_type), group in tows.groups("method", "boat_type")
        if boat_type != UNKNOWN_TYPE
        for quantity in names
        for boats, problem in _compared(group, components, quantity)
        if (fit := mixed.fit(problem, *components)) is not None
    ]
    return _with_season(pl.concat([TypeOutliers.create_empty(), *parts]))


def _compared(
    boats: Observed, components: tuple[str, ...], quantity: str
) -> Iterator[tuple[Observed, mixed.Problem]]:
    """The boats of a type that have a quantity, with what is fitted; nothing where too few have."""
    y, unit = quantities(boats)[quantity]
    displacement = explaining_variable(boats, LN_DISPLACEMENT)
    is_weighed = quantity == LN_CW and bool(np.isfinite(displacement).all())
    known = np.flatnonzero(np.isfinite(y))
    boats, displacement = boats.take(known), displacement[known]
    x = np.ones((len(known), 1))
    if is_weighed and len(known) and np.ptp(displacement) > 1e-9:
        x = np.column_stack([x, displacement - displacement.mean()])
    if boats.table["fsn_no"].n_unique() >= x.shape[1] + FEWEST_BOATS:
        variance = unit[known] * boats.column("run_sd_ratio") ** 2
        season = boats.table["season"].to_numpy() if mixed.OTHER in components else None
        hull = boats.table["hull"].to_numpy()
        yield boats, mixed.Problem(y[known], variance, x, hull, season)


def _deviations(boats: Observed, quantity: str, fit: mixed.Fit) -> pl.DataFrame:
    """Rows of the table `type_outliers`, without the candidate `season`."""
    y = fit.problem.y
    error, variance, scale = fit.leave_boats_out()
    deviation = error / np.sqrt(variance * scale)
    chance = 1.0 - OUTSIDE_LEVEL / (2.0 * len(y))
    limit = float(scipy.special.stdtrit(max(fit.dof - 1, 1), chance))
    return boats.table.select(
        *TOW,
        "season",
        pl.lit(quantity).alias("quantity"),
        "standard_speed_m_s",
        pl.Series("value", y),
        pl.Series("expected", y - error),
        pl.Series("deviation_sd", deviation),
        pl.Series("outside", np.abs(deviation) > limit),
        pl.Series("candidates", _candidates(boats, quantity, error)),
    )


def _candidates(boats: Observed, quantity: str, error: FloatArray) -> list[list[str]]:
    """What could explain a boat's place, as codes; the season is judged afterwards."""
    table = boats.table
    unchecked = (table["season"] < STEERED_STRAIGHT_FROM).to_numpy()
    high = (error > ASKEW_EXCESS) & (quantity == LN_CW)
    differ = table["flags"].list.contains("out_and_back_differ").to_numpy()
    checks = {
        "weight": _unusual(explaining_variable(boats, "weight_kg")),
        "length": _unusual(explaining_variable(boats, "waterline_length_m")),
        "log": table["flags"].list.contains("unusual_calibration").to_numpy(),
        "altered": table["altered"].to_numpy(),
        "slow_tow": is_slow(table),
        "askew": differ | (high & unchecked),
        "b_at_cap": table["b_capped"].to_numpy(),
        "b_not_determined": table["b_m_s"].is_null().to_numpy(),
    }
    return [[code for code, applies in checks.items() if applies[i]] for i in range(table.height)]


def _unusual(values: FloatArray) -> BoolArray:
    """Whether a value lies far from the other boats', each judged by the others."""
    known = np.isfinite(values)
    others = int(known.sum()) - 1
    if others < FEWEST_BOATS:
        return np.zeros(len(values), bool)
    # About the mean of the others: with the value itself mean and squares are known.
    from_all = values - values[known].mean()
    squares = from_all**2 * (others + 1) / others
    variance = ((from_all[known] ** 2).sum() - squares) / (others - 1)
    from_others = np.abs(from_all) * (others + 1) / others
    return np.asarray(known & (from_others > UNUSUAL_SD * np.sqrt(np.fmax(variance, 1e-18))))


def _with_season(outliers: pl.DataFrame) -> pl.DataFrame:
    """Adds the candidate `season` where the season's other boats lie on the same side."""
    group = ["method", "quantity", "season"]
    others = pl.len().over(group) - 1
    mean = (pl.col("deviation_sd").sum().over(group) - pl.col("deviation_sd")) / others
    along = mean * pl.col("deviation_sd").sign() * others.sqrt() > UNUSUAL_SD
    return outliers.with_columns(
        pl.when((others > 0) & along)
        .then(pl.col("candidates").list.concat(pl.lit(["season"])))
        .otherwise("candidates")
        .alias("candidates")
    ).sort("method", "boat_type", "tow_id", "quantity")
