"""What the consistency analysis looks at: tows with their curves, boats and measuring errors.

Here tables are joined once and run points become arrays beside them; nothing is judged. Errors
come from the scatter of the runs about the curve, pooled over a type, since the six runs of one
tow say too little about it. B counts as free here even where the method caps it.
"""

from dataclasses import dataclass
from typing import Final, Self

import numpy as np
import polars as pl

from pipeline import curve
from pipeline.arrays import BoolArray, FloatArray, IntArray
from pipeline.curve import VALID_RATIO
from pipeline.quantiles import NORMAL
from pipeline.tables.keys import LINE

UNKNOWN_TYPE, ALL_TYPES = "unknown", "all"
FEWEST_POINTS: Final = 3

TOW: Final = ("method", "tow_id", *LINE, "boat_type")
"""What names a tow, and with it a boat and crew, in the tables of this package."""


@dataclass(frozen=True)
class Observed:
    """Tows and their run points, row by row.

    Attributes:
        table: one row per method and tow: columns of `curves` and `tows`, `boat_type`, and
            `displacement_kg`; `standard_speed_m_s`, the median declared speed of all tows of the
            type, one for all methods and seasons; `s_s2_m2`, `c0_kg_m`, `q` of the free fit at the
            declared speed; `c0_unit_variance` (relative), `q_unit_variance`,
            `c0_q_unit_covariance`: covariance of (ln C0, q) for a run scatter of 1;
            `run_sd_ratio`: the type's pooled scatter of a run, null where unknown; `run_dof`:
            degrees of freedom of the tow itself.
        points: run points, shape (rows, runs).
    """

    table: pl.DataFrame
    points: curve.Points

    def take(self, rows: IntArray) -> Self:
        """Some of the rows."""
        points = curve.Points(
            self.points.speed_m_s[rows], self.points.cw_kg_m[rows], self.points.used[rows]
        )
        return type(self)(self.table[rows], points)

    def column(self, name: str) -> FloatArray:
        """A column of numbers without nulls, shape (rows,)."""
        return self.table[name].to_numpy().astype(np.float64)

    def rows_by(self, *by: str) -> list[tuple[tuple[str, ...], IntArray]]:
        """Which rows are of each group, in the order of the group's names."""
        rows = self.table.select(*by, pl.int_range(pl.len()).alias("row"))
        grouped = rows.group_by(by, maintain_order=True).agg("row")
        keys, own = grouped.select(by).rows(), grouped["row"]
        groups = [(key, rows.to_numpy()) for key, rows in zip(keys, own, strict=True)]
        return sorted(groups, key=lambda item: tuple(map(str, item[0])))

    def groups(self, *by: str) -> list[tuple[tuple[str, ...], "Observed"]]:
        """The rows of each group, in the order of the group's names."""
        return [(key, self.take(rows)) for key, rows in self.rows_by(*by)]


def of_trusted(frame: pl.DataFrame, tows: pl.DataFrame) -> pl.DataFrame:
    """Rows by `tow_id` of tows that nothing is doubted about: others compare with nothing."""
    trusted = tows.filter(pl.col("doubts").list.len() == 0)
    return frame.join(trusted, on="tow_id", how="semi", maintain_order="left")


def observe(
    curves: pl.DataFrame, tows: pl.DataFrame, boats: pl.DataFrame, run_points: pl.DataFrame
) -> Observed:
    """Join the warehouse's tables; tows whose runs determine no curve are left out.

    A boat ends at an alteration: `hull` is the boat as it was between two of them.
    """
    of_tow = (
        *("hull", "boat_type", "tow_date", "altered"),
        *("weight_kg", "crew_weight_kg", "waterline_length_m", "beam_m"),
    )
    alterations = pl.col("altered").fill_null(False).cum_sum().over("fsn_no").cast(pl.String)
    tows = (
        tows.sort("tow_date", "tow_id")
        .with_columns(hull=pl.concat_str("fsn_no", alterations, separator="/"))
        .join(boats.select("fsn_no", "boat_type"), on="fsn_no", how="left", maintain_order="left")
        .with_columns(pl.col("boat_type").fill_null(UNKNOWN_TYPE))
    )
    table = (
        curves.filter((pl.col("status") != "rejected") & pl.col("cw_kg_m").is_not_null())
        .join(tows.select("tow_id", *of_tow), on="tow_id", maintain_order="left")
        .with_columns(displacement_kg=pl.col("weight_kg") + pl.col("crew_weight_kg"))
        .sort("method", "tow_date", "tow_id")
        .join(_standard_speeds(tows), on="boat_type", how="left", maintain_order="left")
    )
    points = _points(table, run_points)
    fitted = curve.fit(points)
    declared = table["declared_speed_m_s"].to_numpy()
    c0, q = curve.to_c0_q(fitted.a_kg_m, fitted.s_s2_m2, declared)
    sound = fitted.converged & np.isfinite(c0) & (fitted.n_points >= FEWEST_POINTS)
    safe = np.where(sound, c0, 1.0)
    unit = curve.Scatter(safe * safe, np.full(len(c0), np.inf))
    errors = curve.covariance(points, fitted, unit, declared)
    sound &= np.isfinite(errors.q_variance)
    numbers = table.with_columns(
        s_s2_m2=pl.Series(fitted.s_s2_m2),
        c0_kg_m=pl.Series(c0),
        q=pl.Series(q),
        c0_unit_variance=pl.Series(errors.c0_variance_kg2_m2 / safe**2),
        q_unit_variance=pl.Series(errors.q_variance),
        c0_q_unit_covariance=pl.Series(errors.c0_q_covariance_kg_m / safe),
        run_rss_ratio2=pl.Series(fitted.rss_kg2_m2 / safe**2),
        run_dof=pl.Series(fitted.n_points - 2.0),
    )
    known = Observed(numbers, points).take(np.flatnonzero(sound))
    pooled = (pl.col("run_rss_ratio2").sum() / pl.col("run_dof").sum()).sqrt()
    scatter = pooled.over("method", "boat_type").alias("run_sd_ratio")
    return Observed(known.table.with_columns(scatter), known.points)


def _standard_speeds(tows: pl.DataFrame) -> pl.DataFrame:
    """The speed at which boats of a type are compared, the same under every method."""
    median = pl.col("declared_speed_m_s").median().alias("standard_speed_m_s")
    return tows.group_by("boat_type", maintain_order=True).agg(median)


def _points(table: pl.DataFrame, run_points: pl.DataFrame) -> curve.Points:
    """Used run points in one row per row of `table`; unused places hold 1 and do not count."""
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
    arrays = [np.ones((table.height, places)) for _ in range(2)]
    mask = np.zeros((table.height, places), bool)
    at = used["row"].to_numpy(), used["place"].to_numpy()
    arrays[0][at], arrays[1][at], mask[at] = used["speed_m_s"], used["cw_kg_m"], True
    return curve.Points(arrays[0], arrays[1], mask)


def newest(observed: Observed) -> Observed:
    """The newest tow of every boat and crew: several tows of one are not several boats."""
    last = (
        observed.table.with_row_index("row")
        .group_by("method", *LINE, maintain_order=True)
        .agg(pl.col("row").sort_by("tow_date", "tow_id").last())
    )
    return observed.take(np.sort(last["row"].to_numpy()))


def curve_at(observed: Observed, speed_m_s: FloatArray | float) -> FloatArray:
    """Cw of the register's curves at a speed; NaN outside the speeds at which a curve counts."""
    return np.where(counts_at(observed, speed_m_s), curve_anywhere(observed, speed_m_s), np.nan)


def curve_anywhere(observed: Observed, speed_m_s: FloatArray | float) -> FloatArray:
    """Cw of the register's curves at a speed, also where they do not count; NaN from B on.

    The curve is read from Cw and A, which also holds where there is no B (a falling curve).
    """
    declared = observed.column("declared_speed_m_s")
    s = curve.s_of_height(observed.column("a_kg_m"), observed.column("cw_kg_m"), declared)
    cw = curve.cw(observed.column("a_kg_m"), s, speed_m_s)
    return np.where(np.isfinite(cw), cw, np.nan)


def counts_at(observed: Observed, speed_m_s: FloatArray | float) -> BoolArray:
    """Whether each curve counts at a speed, shape (rows,)."""
    ratio = speed_m_s / observed.column("declared_speed_m_s")
    low, high = VALID_RATIO
    return np.asarray((ratio >= low - 1e-9) & (ratio <= high + 1e-9))


def ln_cw_unit_variance(observed: Observed, speed_m_s: FloatArray | float) -> FloatArray:
    """Variance of ln Cw at a speed for a run scatter of 1, from the covariance of (ln C0, q)."""
    x = (speed_m_s / observed.column("declared_speed_m_s")) ** 2 - 1.0
    slope = x / np.maximum(1.0 - observed.column("q") * x, 0.1)
    return (
        observed.column("c0_unit_variance")
        + 2.0 * slope * observed.column("c0_q_unit_covariance")
        + slope * slope * observed.column("q_unit_variance")
    )


def a_unit_variance(observed: Observed, q: FloatArray) -> FloatArray:
    """Variance of ln A for a run scatter of 1, at bends q of the curves, shape (rows,)."""
    shared = 2.0 * observed.column("c0_q_unit_covariance") / (1.0 + q)
    of_bend = observed.column("q_unit_variance") / (1.0 + q) ** 2
    return observed.column("c0_unit_variance") - shared + of_bend


def ln_cw_variance(observed: Observed, speed_m_s: FloatArray | float) -> FloatArray:
    """Variance of ln Cw of each tow at a speed: by its runs or by its interval, the larger.

    The interval of `curves` also knows of the log; it is that at the declared speed.
    """
    runs = ln_cw_unit_variance(observed, speed_m_s) * observed.column("run_sd_ratio") ** 2
    half = 0.5 * np.log(observed.column("cw_hi_kg_m") / observed.column("cw_lo_kg_m"))
    return np.fmax(runs, (half / NORMAL) ** 2)


def bend_at(observed: Observed, speed_m_s: FloatArray | float) -> tuple[FloatArray, FloatArray]:
    """Bend (v/B)^2 at a common speed and its variance for a run scatter of 1."""
    r = observed.column("s_s2_m2") * speed_m_s**2
    stretch = (speed_m_s / observed.column("declared_speed_m_s")) ** 2
    stretch = stretch / (1.0 + observed.column("q")) ** 2
    return r, stretch * stretch * observed.column("q_unit_variance")


def q_at(observed: Observed, speed_m_s: FloatArray | float) -> tuple[FloatArray, FloatArray]:
    """Bend q at a common speed and its variance for a run scatter of 1; NaN where v >= B."""
    s, declared = observed.column("s_s2_m2"), observed.column("declared_speed_m_s")
    r = s * speed_m_s**2
    below = r < 1.0
    q = np.where(below, r / np.where(below, 1.0 - r, 1.0), np.nan)
    stretch = (speed_m_s / declared * (1.0 + q) / (1.0 + observed.column("q"))) ** 2
    return q, stretch * stretch * observed.column("q_unit_variance")


def observe_trusted(
    curves: pl.DataFrame, tows: pl.DataFrame, boats: pl.DataFrame, run_points: pl.DataFrame
) -> Observed:
    """What statistics look at: the tows that nothing is doubted about."""
    return observe(of_trusted(curves, tows), tows, boats, of_trusted(run_points, tows))
