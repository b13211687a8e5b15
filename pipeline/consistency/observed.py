"""The tows that boats of a type are compared by: curves, boats and measuring errors in one frame.

Here tables are joined once and what is compared is brought to one speed per type; nothing is
judged. Errors come from the scatter of the runs about the curve, pooled over a type, since the six
runs of one tow say too little about it, and from what moves all runs of a tow alike; those of Cw
are at least what the tow's interval says. How far that is true, `pipeline.consistency.noise` asks
the repeat tows. B counts as free here even where the method caps it.
"""

from typing import Final

import numpy as np
import polars as pl

from pipeline import curve
from pipeline.arrays import BoolArray, FloatArray
from pipeline.curve import VALID_RATIO
from pipeline.hull import hull_speed_m_s
from pipeline.quantiles import NORMAL
from pipeline.tables.keys import LINE, UNKNOWN_TYPE

ALL_TYPES: Final = "all"
TOW: Final = ("method", "tow_id") + LINE + ("boat_type",)
"""What names a tow, and with it a boat and crew, in the tables of this package."""

MIN_POINTS: Final = 3
"""Run points below which the bend of a curve has no error that is known."""

LOAD_CELL_ZERO_SD_N: Final = 3.0
"""Standard deviation of the load cell's zero from tow to tow [N] (inferred)."""

LOG_EXPONENT_SD: Final = 0.015
"""Standard deviation of the power of the true speed that a log reads, about 1 (inferred)."""

MIN_BEND: Final = 0.05
"""Least bend q at which errors of A and of the bend are taken."""


def select_trusted(frame: pl.DataFrame, tows: pl.DataFrame) -> pl.DataFrame:
    """Return the rows by `tow_id` of tows that nothing is doubted about."""
    trusted = tows.filter(pl.col("doubts").list.len() == 0)
    return frame.join(trusted, on="tow_id", how="semi", maintain_order="left")


def observe(
    curves: pl.DataFrame, tows: pl.DataFrame, boats: pl.DataFrame, run_points: pl.DataFrame
) -> pl.DataFrame:
    """Join the warehouse's tables and bring each curve to the standard speed of its type.

    Args:
        curves, tows, boats, run_points: the tables of those names.

    Returns:
        One row per method and tow whose runs determine a curve: columns of `curves` and `tows`,
        `boat_type` (or `UNKNOWN_TYPE`), and

        - `newest`: whether the tow is the last of its boat and crew;
        - `displacement_kg`: boat and crew; `hull_speed_m_s`;
        - `standard_speed_m_s`: median declared speed of all tows of the type, v*, the same under
          every method;
        - `beyond_curve`: v* lies outside the speeds at which the curve counts;
        - `cw_standard_kg_m`: Cw(v*) of the register's curve, null from B on;
        - `ln_cw_variance`: of ln Cw(v*);
        - `bend`: (v*/B)^2 of a free fit to the runs, 0 or less without B; `bend_variance`;
        - `ln_a_sd`: of ln A by the runs; `ln_a_variance`: for comparing, with the log's error;
        - `ln_cw_zero_effect`, `bend_zero_effect`, `ln_a_zero_effect`: size of the effect of a zero
          error of the load cell [1/N];
        - `run_sd_ratio`, `run_dof`, `run_rss_ratio2`, `c0_unit_variance`: scatter
          of a run of the type, degrees of freedom and squares of the tow, and the variance of its
          ln Cw at the declared speed for a scatter of 1.
    """
    joined = _join_tows(curves, tows, boats)
    length = joined["waterline_length_m"].to_numpy().astype(np.float64)
    joined = joined.with_columns(hull_speed_m_s=pl.Series(hull_speed_m_s(length)))
    points = _stack_points(joined, run_points)
    free = curve.fit(points)
    declared = joined["declared_speed_m_s"].to_numpy()
    c0, q = curve.to_c0_q(free.a_kg_m, free.s_s2_m2, declared)
    is_sound = free.converged & np.isfinite(c0) & (free.n_points >= MIN_POINTS)
    safe_c0 = np.where(is_sound, c0, 1.0)
    unit_scatter = curve.Scatter(safe_c0**2, np.full(len(c0), np.inf))
    errors = curve.covariance(points, free, unit_scatter, declared)
    is_sound &= np.isfinite(errors.q_variance)
    scatter = joined.with_columns(
        s_s2_m2=pl.Series(free.s_s2_m2),
        c0_kg_m=pl.Series(c0),
        q=pl.Series(q),
        c0_unit_variance=pl.Series(errors.c0_variance_kg2_m2 / safe_c0**2),
        q_unit_variance=pl.Series(errors.q_variance),
        c0_q_unit_covariance=pl.Series(errors.c0_q_covariance_kg_m / safe_c0),
        run_rss_ratio2=pl.Series(free.rss_kg2_m2 / safe_c0**2),
        run_dof=pl.Series(free.n_points - 2.0),
    ).filter(pl.Series(is_sound))
    of_type = ("method", "boat_type")
    type_dof = pl.col("run_dof").sum()
    pooled = scatter.with_columns(
        run_sd_ratio=(pl.col("run_rss_ratio2").sum() / type_dof).sqrt().over(of_type),
        type_q=pl.col("q").median().over(of_type),
    )
    return _compare_at_standard_speed(pooled)


def observe_trusted(
    curves: pl.DataFrame, tows: pl.DataFrame, boats: pl.DataFrame, run_points: pl.DataFrame
) -> pl.DataFrame:
    """Return the rows of `observe` of tows that nothing is doubted about."""
    return observe(select_trusted(curves, tows), tows, boats, select_trusted(run_points, tows))


def _join_tows(curves: pl.DataFrame, tows: pl.DataFrame, boats: pl.DataFrame) -> pl.DataFrame:
    """Return accepted curves with their tow and boat, by method and date."""
    known = (
        tows.sort("tow_date", "tow_id")
        .join(boats.select("fsn_no", "boat_type"), on="fsn_no", how="left", maintain_order="left")
        .with_columns(pl.col("boat_type").fill_null(UNKNOWN_TYPE))
        .with_columns(standard_speed_m_s=pl.col("declared_speed_m_s").median().over("boat_type"))
        .select(
            "tow_id", "boat_type", "tow_date", "altered", "standard_speed_m_s",
            "weight_kg", "crew_weight_kg", "waterline_length_m", "beam_m",
        )
    )  # fmt: skip
    dated = pl.struct("tow_date", "tow_id")
    return (
        curves.filter((pl.col("status") != "rejected") & pl.col("cw_kg_m").is_not_null())
        .join(known, on="tow_id", maintain_order="left")
        .with_columns(
            displacement_kg=pl.col("weight_kg") + pl.col("crew_weight_kg"),
            newest=dated.rank("ordinal", descending=True).over(("method",) + LINE) == 1,
        )
        .sort("method", "tow_date", "tow_id")
    )


def _stack_points(table: pl.DataFrame, run_points: pl.DataFrame) -> curve.Points:
    """Return the used run points, one row per row of `table`."""
    used = (
        run_points.filter(pl.col("used") & (pl.col("cw_kg_m") > 0) & (pl.col("speed_m_s") > 0))
        .join(
            table.select("method", "tow_id").with_row_index("row"),
            on=["method", "tow_id"],
            maintain_order="left",
        )
        .sort("row", "run")
        .with_columns(pl.int_range(pl.len()).over("row").alias("place"))
    )
    places = 1 + (used["place"].to_numpy().max() if used.height else 0)
    shape = (table.height, places)
    speed, cw, is_used = np.ones(shape), np.ones(shape), np.zeros(shape, bool)
    at = used["row"].to_numpy(), used["place"].to_numpy()
    speed[at] = used["speed_m_s"]
    cw[at] = used["cw_kg_m"]
    is_used[at] = True
    return curve.Points(speed, cw, is_used)


def _compare_at_standard_speed(pooled: pl.DataFrame) -> pl.DataFrame:
    """Add what is compared at the standard speed, with its variances."""

    def column(name: str) -> FloatArray:
        return pooled[name].to_numpy().astype(np.float64)

    standard, declared = column("standard_speed_m_s"), column("declared_speed_m_s")
    run_variance = column("run_sd_ratio") ** 2
    c0_unit, q_unit = column("c0_unit_variance"), column("q_unit_variance")
    c0_q_unit, q = column("c0_q_unit_covariance"), column("q")
    s = curve.s_of_height(column("a_kg_m"), column("cw_kg_m"), declared)
    cw = curve.cw(column("a_kg_m"), s, standard)
    q_of_tow = _q_variance_of_tow(pooled)
    # A zero error z of the load cell adds z / F to ln Cw, takes (1 + q) z / F from q, and so adds
    # 2 z / F to ln A.
    zero_effect = 1.0 / (column("c0_kg_m") * declared**2)

    # Errors of A and of the bend are taken at the type's bend: else a small B, whose error looks
    # small, would weigh most.
    type_q = np.maximum(column("type_q"), MIN_BEND)
    bend_by_q = (standard / declared) ** 2 / (1.0 + type_q) ** 2
    ln_a_own = _ln_a_unit_variance(q, c0_unit, q_unit, c0_q_unit)
    ln_a_typical = _ln_a_unit_variance(type_q, c0_unit, q_unit, c0_q_unit)
    beside_runs = np.maximum(_interval_variance(pooled) - run_variance * c0_unit, 0.0)
    numbers = {
        "cw_standard_kg_m": np.where(np.isfinite(cw), cw, np.nan),
        "ln_cw_variance": ln_cw_variance_at(pooled, standard),
        "bend": column("s_s2_m2") * standard**2,
        "bend_variance": bend_by_q**2 * (run_variance * q_unit + q_of_tow),
        "ln_cw_zero_effect": zero_effect,
        "bend_zero_effect": bend_by_q * (1.0 + type_q) * zero_effect,
        "ln_a_zero_effect": 2.0 * zero_effect,
        "ln_a_sd": np.sqrt(np.maximum(ln_a_own, 0.0) * run_variance),
        "ln_a_variance": run_variance * ln_a_typical + beside_runs + q_of_tow / (1.0 + type_q) ** 2,
    }
    beyond_curve = pl.Series("beyond_curve", ~is_within_curve(pooled, standard))
    columns = pl.DataFrame(numbers).fill_nan(None).get_columns()
    return pooled.with_columns(beyond_curve).with_columns(columns)


def is_within_curve(observed: pl.DataFrame, speed_m_s: FloatArray) -> BoolArray:
    """Return whether each curve counts at a speed, shape (rows,)."""
    ratio = speed_m_s / observed["declared_speed_m_s"].to_numpy()
    low, high = VALID_RATIO
    return np.asarray((ratio >= low - 1e-9) & (ratio <= high + 1e-9))


def ln_cw_variance_at(observed: pl.DataFrame, speed_m_s: FloatArray) -> FloatArray:
    """Return the variance of ln Cw of each tow at a speed, shape (rows,).

    At the declared speed it is that of the runs or, if larger, that of the interval, which also
    knows of the log. Away from it the error of the bend is added.
    """

    def column(name: str) -> FloatArray:
        return observed[name].to_numpy().astype(np.float64)

    # Cw(v) / C0 = 1 / (1 - q x), so that d ln Cw = d ln C0 + x / (1 - q x) dq.
    x = (speed_m_s / column("declared_speed_m_s")) ** 2 - 1.0
    by_bend = x / np.maximum(1.0 - column("q") * x, 0.1)
    run_variance = column("run_sd_ratio") ** 2
    at_declared = np.maximum(
        run_variance * column("c0_unit_variance"), _interval_variance(observed)
    )
    of_bend = 2.0 * by_bend * column("c0_q_unit_covariance")
    of_bend += by_bend**2 * column("q_unit_variance")
    return np.maximum(
        at_declared + run_variance * of_bend + by_bend**2 * _q_variance_of_tow(observed), 0.0
    )


def _interval_variance(observed: pl.DataFrame) -> FloatArray:
    """Return the variance of ln Cw at the declared speed by its 95 % interval, 0 without one."""
    half = (0.5 * (pl.col("cw_hi_kg_m") / pl.col("cw_lo_kg_m")).log()).fill_null(0.0)
    return (observed.select(half).to_series().to_numpy() / NORMAL) ** 2


def _q_variance_of_tow(observed: pl.DataFrame) -> FloatArray:
    """Return the variance of the bend by what moves all runs of a tow alike, shape (rows,).

    A zero error z of the load cell takes (1 + q) z / F from q, as ln Cw falls with speed by
    2 z / F. A log that reads v^(1 + e) takes e from it.
    """
    force_n = observed["c0_kg_m"].to_numpy() * observed["declared_speed_m_s"].to_numpy() ** 2
    zero_ratio = LOAD_CELL_ZERO_SD_N / force_n
    q = observed["q"].to_numpy()
    return np.asarray(((1.0 + q) * zero_ratio) ** 2 + LOG_EXPONENT_SD**2, dtype=np.float64)


def _ln_a_unit_variance(
    q: FloatArray, c0_unit: FloatArray, q_unit: FloatArray, c0_q_unit: FloatArray
) -> FloatArray:
    """Return the variance of ln A = ln C0 - ln(1 + q) for a run scatter of 1."""
    return c0_unit - 2.0 * c0_q_unit / (1.0 + q) + q_unit / (1.0 + q) ** 2
