"""Equally likely registers, so that any later question has an answer with its uncertainty.

Is boat X really heavier than Y, does the winner change: whoever asks counts the members in which
it holds. What tows share is drawn once per member and used for all of them, which intervals of
single lines cannot show. The components are in `propagation`; members are kept in the lake.
"""

from typing import TYPE_CHECKING, Final

import numpy as np
import polars as pl

from pipeline.arrays import FloatArray
from pipeline.uncertainty.propagation import make_log_key

if TYPE_CHECKING:
    from pipeline.season_log import SeasonFactors

MEMBERS: Final = 200
SEED: Final = 2009


def draw_ensemble(
    method: str,
    curves: pl.DataFrame,
    ruled: pl.DataFrame,
    budget: pl.DataFrame,
    factors: "SeasonFactors | None",
    members: int = MEMBERS,
) -> pl.DataFrame:
    """Return the members of every tow with a curve: rows of the table `ensemble`.

    They lie around the number that the register uses, as wide as its interval; what tows share
    stays what they share as measured.

    Args:
        method: its name.
        curves, budget: its tables `curves` and `uncertainty_budget`.
        ruled: its curves with the estimate that the register uses.
        factors: its season factors, as `draw_ln_errors` takes them.
        members: how many.
    """
    ln_width = (pl.col("cw_hi_kg_m") / pl.col("cw_lo_kg_m")).log()
    measured = curves.drop_nulls("cw_kg_m").select("tow_id", measured_width=ln_width)
    used = ruled.select("tow_id", cw="cw_kg_m", used_width=ln_width)
    tows = measured.join(used, on="tow_id", maintain_order="left").with_columns(
        ratio=(pl.col("used_width") / pl.col("measured_width")).fill_null(1.0)
    )
    errors = draw_ln_errors(tows["tow_id"], budget, factors, members)
    cw = tows["cw"].to_numpy()[:, None] * np.exp(errors * tows["ratio"].to_numpy()[:, None])
    return pl.DataFrame(
        {
            "method": pl.repeat(method, cw.size, eager=True),
            "tow_id": tows["tow_id"].gather(np.repeat(np.arange(tows.height), members)),
            "member": np.tile(np.arange(1, members + 1, dtype=np.int16), tows.height),
            "cw_kg_m": cw.ravel(),
        }
    )


def draw_ln_errors(
    tow_ids: pl.Series,
    budget: pl.DataFrame,
    factors: "SeasonFactors | None",
    members: int = MEMBERS,
) -> FloatArray:
    """Draw errors of ln Cw of tows, (tows, members): the sum of effect times normal error.

    Every error has a random stream of its own, named by its key: a tow keeps its members when
    others come or go. Errors of season factors are correlated as their covariance says.

    Args:
        tow_ids: of those tows, each once.
        budget: rows of `propagation.make_budget`, at least of those tows.
        factors: the season factors; None where the method estimates none.
        members: number of draws.
    """
    error_of = {key: _draw(key, members) for key in budget["key"].unique().sort()}
    if factors is not None and factors.covariance.size:
        determined = factors.factors.drop_nulls("factor")
        keys = determined.select(key=make_log_key(pl.col("season"), pl.col("part")))["key"]
        sd = np.sqrt(np.diag(factors.covariance))
        root = np.linalg.cholesky(factors.covariance / np.outer(sd, sd))
        correlated = root @ np.stack([_draw(key, members) for key in keys])
        error_of |= dict(zip(keys, correlated, strict=True))
    place = pl.DataFrame({"tow_id": tow_ids}).with_row_index("place")
    rows = budget.join(place, on="tow_id", maintain_order="left")
    ln_error = np.zeros((tow_ids.len(), members))
    for tow, key, effect in rows.select("place", "key", "effect_ratio").iter_rows():
        ln_error[tow] += effect * error_of[key]
    return ln_error


def _draw(key: str, members: int) -> FloatArray:
    """Draw standard normal errors from the random stream of a key."""
    stream = np.random.default_rng(np.array([SEED] + list(key.encode()), dtype=np.uint32))
    return stream.standard_normal(members)
