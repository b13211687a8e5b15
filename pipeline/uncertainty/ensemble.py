"""Many equally likely registers, so that any later question has an answer with its uncertainty.

Is boat X really heavier than Y, does the winner change: whoever asks counts the members in which
it holds. What tows share is drawn once per member and used for all of them, which intervals of
single lines cannot show. The components are in `propagation`; members are kept in the lake.
"""

from functools import lru_cache
from typing import TYPE_CHECKING, Final

import numpy as np
import polars as pl

from pipeline.arrays import FloatArray
from pipeline.uncertainty.propagation import log_key

if TYPE_CHECKING:
    from pipeline.season_log import SeasonFactors

MEMBERS: Final = 200
SEED: Final = 2009
FEW_ROWS: Final = 8192
"""Errors added up at a time: those of all tows would take as much memory as the tables."""
REMEMBERED: Final = 1 << 14
"""Keys whose errors are kept for the next method, which has the same keys: 26 MB."""


def tow_ensemble(
    method: str,
    curves: pl.DataFrame,
    ruled: pl.DataFrame,
    budget: pl.DataFrame,
    estimated: "SeasonFactors | None",
    members: int = MEMBERS,
) -> pl.DataFrame:
    """Rows of the table `ensemble` of a method: members of every tow with a curve.

    They lie around the number that the register uses, as wide as its interval; what tows share
    stays what they share as measured.

    Args:
        method: its name.
        curves, budget: its tables `curves` and `uncertainty_budget`.
        ruled: its curves with the estimate that the register uses.
        estimated: its season factors, as `ln_errors` takes them.
        members: how many.
    """
    width = (pl.col("cw_hi_kg_m") / pl.col("cw_lo_kg_m")).log()
    used = ruled.select("tow_id", used="cw_kg_m", stated=width)
    measured = curves.drop_nulls("cw_kg_m").select("tow_id", measured=width)
    tows = measured.join(used, on="tow_id", maintain_order="left").with_columns(
        wider=(pl.col("stated") / pl.col("measured")).fill_null(1.0)
    )
    errors = ln_errors(tows["tow_id"], budget, estimated, members)
    cw = tows["used"].to_numpy()[:, None] * np.exp(errors * tows["wider"].to_numpy()[:, None])
    return pl.DataFrame(
        {
            "method": pl.repeat(method, cw.size, eager=True),
            "tow_id": tows["tow_id"].gather(np.repeat(np.arange(tows.height), members)),
            "member": np.tile(np.arange(1, members + 1, dtype=np.int16), tows.height),
            "cw_kg_m": cw.ravel(),
        }
    )


def ln_errors(
    tow_ids: pl.Series,
    budget: pl.DataFrame,
    estimated: "SeasonFactors | None",
    members: int = MEMBERS,
) -> FloatArray:
    """Realisations of the error of ln Cw of tows, shape (tows, members).

    Errors are normal. Every error has a random stream of its own, named by its key: a tow keeps its
    members when others come or go.

    Args:
        tow_ids: of those tows, each once.
        budget: rows of `propagation.budget`, at least of those tows.
        estimated: the season factors, whose errors are drawn with their correlation; None where the
            method estimates none.
        members: number of realisations.
    """
    place = pl.DataFrame({"tow_id": tow_ids}).with_row_index("place")
    rows = budget.join(place, on="tow_id", maintain_order="left")
    keys, errors = _errors(rows, estimated, members)
    index = rows.select("key").join(keys, on="key", maintain_order="left")["index"]
    of_rows = rows["place"].to_numpy(), index.to_numpy(), rows["effect_ratio"].to_numpy()
    ln_error = np.zeros((tow_ids.len(), members))
    for first in range(0, rows.height, FEW_ROWS):
        few_row, few_index, effect = (of_all[first : first + FEW_ROWS] for of_all in of_rows)
        np.add.at(ln_error, few_row, effect[:, None] * errors[few_index])
    return ln_error


def _errors(
    budget: pl.DataFrame, estimated: "SeasonFactors | None", members: int
) -> tuple[pl.DataFrame, FloatArray]:
    """Standard normal errors of every key, shape (keys, members), season factors correlated."""
    keys = budget.select("key").unique().sort("key").with_row_index("index")
    errors = np.zeros((keys.height, members))
    for own, key in zip(errors, keys["key"], strict=True):
        own[:] = _independent(key, members)
    if estimated is None:
        return keys, errors
    determined = estimated.factors.drop_nulls("factor").select(
        log_key(pl.col("season"), pl.col("part")).alias("key")
    )
    sd = np.sqrt(np.diag(estimated.covariance))
    root = np.linalg.cholesky(estimated.covariance / np.outer(sd, sd))
    independent = [_independent(key, members) for key in determined["key"]]
    if independent:
        joint = root @ np.stack(independent)
        used = determined.with_row_index("row").join(keys, on="key", maintain_order="left")
        errors[used["index"].to_numpy()] = joint[used["row"].to_numpy()]
    return keys, errors


@lru_cache(maxsize=REMEMBERED)
def _independent(key: str, members: int) -> FloatArray:
    """Standard normal errors of a key, from a stream of its own; not to be written to."""
    stream = np.random.default_rng(np.array([SEED, *key.encode()], dtype=np.uint32))
    return stream.standard_normal(members)
