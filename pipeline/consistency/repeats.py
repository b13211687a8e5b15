"""How far two tows of one unaltered boat agree: pairs, reproducibility, and whether eras differ.

ISO 5725 with the season as the laboratory: s_r within a tow, s_R between tows. A worn log makes all
tows of an era too high; so does nothing else that hits every boat, but for age, and how boats age
is seen in the last era, where instruments are alike.
"""

from collections.abc import Sequence
from math import exp, hypot
from typing import Final

import numpy as np
import polars as pl
import polars.selectors as cs
import scipy
from polars.dataframe.group_by import GroupBy

from pipeline.arrays import FloatArray
from pipeline.consistency.boat_model import Interval
from pipeline.consistency.observed import ALL_TYPES
from pipeline.curve import s_of_height
from pipeline.history import ERAS, Era
from pipeline.quantiles import LEVEL
from pipeline.tables.consistency import EraShifts, RepeatPairs
from pipeline.tables.declare import dy
from pipeline.tables.frames import make_frame
from pipeline.tables.keys import LINE, UNKNOWN_TYPE
from pipeline.tables.row import Row

ALL_PAIRS: Final = "all"


def repeat_pairs(curves: pl.DataFrame, tows: pl.DataFrame) -> pl.DataFrame:
    """Pair consecutive tows of one boat and crew without an alteration between them.

    The two are compared at the older tow's declared speed, where the older curve was measured, each
    with its log and load cell as the other boats show them. A boat that took part in its
    own correction would agree with itself too well. E_n is their difference in units of both 95 %
    intervals (ISO 13528): above 1 they disagree.

    Returns:
        Rows of the table `repeat_pairs`.
    """
    line = ("method",) + LINE
    dated = (
        curves.filter((pl.col("status") != "rejected") & pl.col("cw_kg_m").is_not_null())
        .join(tows.select("tow_id", "tow_date", "altered"), on="tow_id", maintain_order="left")
        .with_columns(
            (0.5 * (pl.col("cw_hi_kg_m") / pl.col("cw_lo_kg_m")).log()).alias("half"),
            (pl.col("cw_others_kg_m") / pl.col("cw_kg_m")).log().fill_null(0.0).alias("by_others"),
        )
        .sort(line + ("tow_date", "tow_id"))
    )
    facts = pl.col("tow_id", "season", "cw_kg_m", "declared_speed_m_s", "half", "by_others")
    pairs = dated.with_columns(facts.shift(1).over(line).name.suffix("_before")).filter(
        pl.col("tow_id_before").is_not_null() & ~pl.col("altered")
    )
    width = (pl.col("half") ** 2 + pl.col("half_before") ** 2).sqrt()
    return (
        pairs.with_columns(pl.Series("at_old_speed", _cw_at_old_speed(pairs)))
        .filter(pl.col("at_old_speed") > 0)
        .with_columns(
            ln_ratio=(pl.col("at_old_speed") / pl.col("cw_kg_m_before")).log()
            + pl.col("by_others")
            - pl.col("by_others_before")
        )
        .with_columns(
            e_n=pl.when(width.is_finite() & (width > 0)).then(pl.col("ln_ratio") / width),
            cw_ratio=pl.col("ln_ratio").exp(),
        )
        .select(RepeatPairs.column_names())
    )


def _cw_at_old_speed(pairs: pl.DataFrame) -> FloatArray:
    """Return the new curve at the old declared speed, 0 where that is not below B."""
    a = pairs["a_kg_m"].to_numpy().astype(np.float64)
    cw = pairs["cw_kg_m"].to_numpy().astype(np.float64)
    v = pairs["declared_speed_m_s"].to_numpy().astype(np.float64)
    old = pairs["declared_speed_m_s_before"].to_numpy().astype(np.float64)
    left = 1.0 - s_of_height(a, cw, v) * old**2
    return np.where(left > 0, a / np.where(left > 0, left, 1.0), 0.0)


def reproducibility(repeat_pairs: pl.DataFrame, observed: pl.DataFrame) -> pl.DataFrame:
    """Return the standard deviation of one tow by repeat pairs, per method and era.

    A pair differs by sqrt(2) times the deviation of one tow, so s^2 = sum(d^2) / (2 n), with a
    chi-squared interval: s_R of ISO 5725-2 with the season as the laboratory. Two pairs that share
    a tow are correlated by -1/2; with m of these there are n / (1 + m / 2 n) degrees of freedom
    (Satterthwaite 1946). Beside it s_r: what the scatter of a tow's own runs does to its Cw.

    Args:
        repeat_pairs: rows of that table.
        observed: rows of `observe`, for the scatter within a tow.

    Returns:
        Rows of the table `reproducibility`, one per method and scope, also where it has no pairs.
    """
    bounds = [(ALL_PAIRS, -9999, 9999)]
    bounds += [(era.name, era.first, era.last) for era in ERAS]
    scopes = pl.DataFrame(bounds, ["scope", "first", "last"], orient="row")
    key, difference, n = ["method", "scope"], pl.col("ln_ratio"), pl.len()

    def select_scopes(rows: pl.DataFrame, season: str) -> GroupBy:
        there = pl.col(season).is_between("first", "last")
        return rows.join(scopes, how="cross").filter(there).group_by(key, maintain_order=True)

    pairs = select_scopes(repeat_pairs, "season_before").agg(
        n_pairs=n,
        sd_ratio=((difference**2).sum() / (2 * n)).sqrt(),
        chained=pl.col("tow_id_before").is_in(pl.col("tow_id").implode()).sum(),
        share_within_1pct=(difference.abs() < 0.01).mean(),
        share_within_2pct=(difference.abs() < 0.02).mean(),
    )
    run_variance = pl.col("run_rss_ratio2").sum() / pl.col("run_dof").sum()
    tows = select_scopes(observed, "season").agg(
        n_tows=n, within_sd_ratio=(run_variance * pl.col("c0_unit_variance").mean()).sqrt()
    )
    found = observed.select("method").unique(maintain_order=True).join(scopes, how="cross")
    for part in (pairs, tows):
        found = found.join(part, on=key, how="left", maintain_order="left")
    n_pairs = found["n_pairs"].cast(pl.Float64).to_numpy()
    chained = found["chained"].cast(pl.Float64).to_numpy()
    dof = n_pairs / (1.0 + chained / (2.0 * n_pairs))
    lowest = pl.Series(np.sqrt(dof / scipy.special.chdtri(dof, 0.5 - LEVEL / 2)))
    highest = pl.Series(np.sqrt(dof / scipy.special.chdtri(dof, 0.5 + LEVEL / 2)))
    return found.select(
        pl.col(key),
        pl.col("n_pairs", "n_tows").fill_null(0).cast(pl.Int32),
        "sd_ratio",
        (pl.col("sd_ratio") * lowest).alias("lo"),
        (pl.col("sd_ratio") * highest).alias("hi"),
        cs.starts_with("share_within"),
        "within_sd_ratio",
    )


def era_shifts(repeat_pairs: pl.DataFrame, boats: pl.DataFrame) -> dy.DataFrame[EraShifts]:
    """Estimate the shift of Cw from the tows of an era to later tows of the same boat and crew.

    Per method, era but the last, and boat type; also over all types. The shift is a median with
    an interval from order statistics. Ageing is the median change per year of all pairs within the
    last era; where these are too few, none is taken out. Its uncertainty is in the interval.

    Args:
        repeat_pairs: the table of that name.
        boats: `fsn_no` and `boat_type`, null without a type.

    Returns:
        Rows of the table `era_shifts`; where nothing is claimed, `reason` says why.
    """
    typed = repeat_pairs.join(
        boats.select("fsn_no", pl.col("boat_type").fill_null(UNKNOWN_TYPE)),
        on="fsn_no",
        how="left",
        maintain_order="left",
    )
    types = sorted(typed["boat_type"].drop_nulls().unique())
    rows = []
    for method in repeat_pairs["method"].unique().sort():
        own = typed.filter(pl.col("method") == method)
        within = own.filter((pl.col("season_before") >= ERAS[-1].first) & (_years() > 0))
        yearly = within.select(pl.col("ln_ratio") / _years()).to_series().to_numpy()
        groups = {ALL_TYPES: own} | {t: own.filter(pl.col("boat_type") == t) for t in types}
        for boat_type, group in groups.items():
            for era in ERAS[:-1]:
                key: Row = {"method": method, "boat_type": boat_type, "era": era.name}
                rows.append(key | _shift(group, era, yearly))
    return make_frame(EraShifts, rows)


def _years() -> pl.Expr:
    return pl.col("season") - pl.col("season_before")


def _shift(pairs: pl.DataFrame, era: Era, yearly: FloatArray) -> Row:
    """Return the shift from an era to later ones, less ageing by its changes of ln Cw per year."""
    across = pairs.filter(
        pl.col("season_before").is_between(era.first, era.last) & (pl.col("season") > era.last)
    )
    ageing = estimate_median(yearly)
    per_year, slowest, fastest = ageing or (0.0, 0.0, 0.0)
    facts: Row = {"n": across.height}
    if ageing is not None:
        facts["ageing_per_year"] = per_year
    years = across.select(_years()).to_series().to_numpy()
    interval = estimate_median(across["ln_ratio"].to_numpy() - per_year * years)
    if interval is None:
        return facts | {"reason": "few_pairs"}
    median, lo, hi = interval
    aged = 0.5 * (fastest - slowest) * float(years.mean())
    lo, hi = median - hypot(median - lo, aged), median + hypot(hi - median, aged)
    return facts | {
        "shift_ratio": exp(median),
        "lo": exp(lo),
        "hi": exp(hi),
        "apart": lo > 0.0 or hi < 0.0,
        "reason": "",
    }


def estimate_median(values: FloatArray | Sequence[float]) -> Interval | None:
    """Return the median with its 95 % interval from order statistics, None of under six values.

    Free of any distribution (David & Nagaraja 2003, Order Statistics, 7.1), so that a few tows
    pulled askew or unreported alterations do not decide.
    """
    ordered, n = np.sort(values), len(values)
    k = int(np.count_nonzero(scipy.special.bdtr(np.arange(n), n, 0.5) <= 0.025))
    if k == 0:
        return None
    return Interval(float(np.median(ordered)), float(ordered[k - 1]), float(ordered[n - k]))
