"""Are equal boats equal? Straight lines within a type, and repeat tows of unaltered boats.

Here the statistics of the auditors' question of 2015: does B (or A, or Cw) follow weight or tow
speed among boats of one type, and how far do two tows of one boat agree. Which differences matter
to a race stands in `pipeline.changes`.
"""

import itertools
from typing import Final

import numpy as np
import polars as pl
from scipy import stats

QUANTITIES: Final = ("b_m_s", "a_kg_m", "cw_kg_m")
EXPLAINING: Final = ("weight_kg", "declared_speed_m_s")
LEVEL: Final = 0.95
FEWEST_FOR_LINE: Final = 3
ERAS: Final = (("2009-2011", 2009, 2011), ("2012-2013", 2012, 2013), ("2014-", 2014, 9999))
"""Eras of the instruments (Sleepproef, R. Pot 2017): worn logs, Doppler logs, dGPS."""


def type_consistency(curves: pl.DataFrame, tows: pl.DataFrame, boats: pl.DataFrame) -> pl.DataFrame:
    """Straight line of each quantity on each explaining variable, per method and boat type.

    Args:
        curves, tows, boats: the warehouse's tables.

    Returns:
        Rows of the table `type_consistency`; where there are too few tows for a line, `n` alone.
    """
    known = (
        curves.filter(pl.col("status") != "rejected")
        .join(tows.select("tow_id", "weight_kg"), on="tow_id")
        .join(boats.select("fsn_no", "boat_type"), on="fsn_no")
        .drop_nulls("boat_type")
        .sort("method", "boat_type", "tow_id")
    )
    rows = [
        {"method": method, "boat_type": boat_type, "quantity": quantity, "explaining": explaining}
        | _line(group.select(explaining, quantity).drop_nulls().to_numpy())
        for (method, boat_type), group in known.group_by(
            ["method", "boat_type"], maintain_order=True
        )
        for quantity, explaining in itertools.product(QUANTITIES, EXPLAINING)
    ]
    numbers = ("slope", "slope_lo", "slope_hi", "r2", "residual_sd_ratio")
    text = ("method", "boat_type", "quantity", "explaining")
    schema = (
        dict.fromkeys(text, pl.String()) | {"n": pl.Int32()} | dict.fromkeys(numbers, pl.Float64())
    )
    return pl.DataFrame(rows, schema=schema)


def _line(points: np.ndarray) -> dict[str, float | int | None]:
    """Least-squares line with a t-interval for its slope; points of shape (n, 2): x, y."""
    n = len(points)
    x, y = points[:, 0], points[:, 1]
    if n < FEWEST_FOR_LINE or np.ptp(x) == 0.0:
        return {"n": n}
    fit = stats.linregress(x, y)
    half = stats.t.ppf(0.5 + LEVEL / 2, n - 2) * fit.stderr
    residual = y - fit.intercept - fit.slope * x
    return {
        "n": n,
        "slope": fit.slope,
        "slope_lo": fit.slope - half,
        "slope_hi": fit.slope + half,
        "r2": fit.rvalue**2,
        "residual_sd_ratio": np.sqrt((residual**2).sum() / (n - 2)) / abs(y.mean()),
    }


def repeat_pairs(curves: pl.DataFrame, tows: pl.DataFrame) -> pl.DataFrame:
    """Consecutive tows of one boat and crew without an alteration between them.

    The two are compared at the older tow's declared speed, where the older curve was measured.

    Returns:
        One row a pair: `method, fsn_no, rowers, crew_class, tow_id, tow_id_before, season,
        season_before, ln_ratio` (ln of new / old Cw).
    """
    line = ["method", "fsn_no", "rowers", "crew_class"]
    dated = (
        curves.filter(pl.col("status") != "rejected")
        .join(tows.select("tow_id", "tow_date", "altered"), on="tow_id")
        .sort(*line, "tow_date", "tow_id")
    )
    before = {
        name: pl.col(name).shift(1).over(line).alias(f"{name}_before")
        for name in ("tow_id", "season", "cw_kg_m", "declared_speed_m_s")
    }
    at_old_speed = pl.col("a_kg_m") / (
        1 - (pl.col("declared_speed_m_s_before") / pl.col("b_m_s").fill_null(float("inf"))) ** 2
    )
    return (
        dated.with_columns(before.values())
        .filter(pl.col("tow_id_before").is_not_null() & ~pl.col("altered") & (at_old_speed > 0))
        .with_columns((at_old_speed / pl.col("cw_kg_m_before")).log().alias("ln_ratio"))
        .select(*line, "tow_id", "tow_id_before", "season", "season_before", "ln_ratio")
    )


def reproducibility(pairs: pl.DataFrame) -> pl.DataFrame:
    """Standard deviation of one tow from repeat pairs, per method and era of the older tow.

    A pair differs by sqrt(2) times the deviation of one tow, so s^2 = sum(d^2) / (2 n), with a
    chi-squared interval on n degrees of freedom (ISO 5725-2, with the season as the laboratory).

    Args:
        pairs: rows of `repeat_pairs`.

    Returns:
        Rows of the table `reproducibility`.
    """
    scopes = [("all", 0, 9999), *ERAS]
    rows = [
        {"method": method, "scope": scope} | _spread(group.filter(_starts_in(first, last)))
        for (method,), group in pairs.sort("method", "tow_id").group_by(
            ["method"], maintain_order=True
        )
        for scope, first, last in scopes
    ]
    numbers = ("sd_ratio", "lo", "hi", "share_within_1pct", "share_within_2pct")
    schema = {"method": pl.String(), "scope": pl.String(), "n_pairs": pl.Int32()}
    return pl.DataFrame(rows, schema=schema | dict.fromkeys(numbers, pl.Float64()))


def _starts_in(first: int, last: int) -> pl.Expr:
    return pl.col("season_before").is_between(first, last)


def _spread(pairs: pl.DataFrame) -> dict[str, float | int | None]:
    difference = pairs["ln_ratio"].to_numpy()
    n = len(difference)
    if n == 0:
        return {"n_pairs": 0}
    total = float((difference**2).sum())
    low, high = stats.chi2.ppf(0.5 + LEVEL / 2, n), stats.chi2.ppf(0.5 - LEVEL / 2, n)
    return {
        "n_pairs": n,
        "sd_ratio": np.sqrt(total / (2 * n)),
        "lo": np.sqrt(total / (2 * low)),
        "hi": np.sqrt(total / (2 * high)),
        "share_within_1pct": float((np.abs(difference) < 0.01).mean()),
        "share_within_2pct": float((np.abs(difference) < 0.02).mean()),
    }
