"""Do seasons with other instruments stand apart? Repeat tows across eras, with ageing taken out.

A worn log makes all tows of an era too high; so does nothing else that hits every boat, but for
age. How boats age is seen in the last era, where instruments are alike.
"""

from collections.abc import Sequence
from math import exp, hypot

import numpy as np
import polars as pl
import scipy

from pipeline.arrays import FloatArray
from pipeline.consistency.observed import ALL_TYPES, UNKNOWN_TYPE
from pipeline.history import ERAS, Era
from pipeline.tables.consistency import EraShifts
from pipeline.tables.declare import dy
from pipeline.tables.frames import frame_of
from pipeline.tables.row import Row


def era_shifts(repeat_pairs: pl.DataFrame, boats: pl.DataFrame) -> dy.DataFrame[EraShifts]:
    """Shift of Cw from the tows of an era to the next tow of the same boat and crew, later.

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
        rows += [
            {"method": method, "boat_type": boat_type, "era": era.name} | _shift(group, era, yearly)
            for boat_type, group in groups.items()
            for era in ERAS[:-1]
        ]
    return frame_of(EraShifts, rows)


def _years() -> pl.Expr:
    return pl.col("season") - pl.col("season_before")


def _shift(pairs: pl.DataFrame, era: Era, yearly: FloatArray) -> Row:
    """Shift from an era to later ones, less ageing by its changes of ln Cw per year."""
    across = pairs.filter(
        pl.col("season_before").is_between(era.first, era.last) & (pl.col("season") > era.last)
    )
    ageing = median_interval(yearly)
    per_year, slowest, fastest = ageing or (0.0, 0.0, 0.0)
    facts: Row = {"n": across.height}
    if ageing is not None:
        facts["ageing_per_year"] = per_year
    years = across.select(_years()).to_series().to_numpy()
    interval = median_interval(across["ln_ratio"].to_numpy() - per_year * years)
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


def median_interval(values: FloatArray | Sequence[float]) -> tuple[float, float, float] | None:
    """Median with its 95 % interval from order statistics, None for fewer than six values.

    Free of any distribution (David & Nagaraja 2003, Order Statistics, 7.1), so that a few tows
    pulled askew or unreported alterations do not decide.
    """
    ordered, n = np.sort(values), len(values)
    k = int(np.count_nonzero(scipy.special.bdtr(np.arange(n), n, 0.5) <= 0.025))
    if k == 0:
        return None
    return float(np.median(ordered)), float(ordered[k - 1]), float(ordered[n - k])
