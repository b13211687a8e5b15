"""Many equally likely registers, so that any later question has an answer with its uncertainty.

Is boat X really heavier than Y, does the winner change: whoever asks counts the members in which
it holds. What tows share is drawn once per member and used for all of them, which intervals of
single lines cannot show. Belongs here: the draws. Does not: the components (`uncertainty`) and
what is asked of the members.
"""

from typing import Final

import numpy as np
import polars as pl

from pipeline.arrays import FloatArray
from pipeline.season_log import SeasonFactors
from pipeline.uncertainty import log_key

MEMBERS: Final = 200
SEED: Final = 2009


def register_ensemble(
    lines: pl.DataFrame,
    budget: pl.DataFrame,
    found: SeasonFactors,
    members: int = MEMBERS,
    seed: int = SEED,
) -> FloatArray:
    """Realisations of the Cw of every line of a register.

    Errors are normal on the logarithm. Every error has a random stream of its own, named by its
    key: a line keeps its members when others come or go.

    Args:
        lines: one row a line with `tow_id` (may occur more than once) and `cw_kg_m`.
        budget: rows of `uncertainty.budget`, at least of those tows.
        found: the season factors, whose errors are drawn with their correlation.
        members: number of realisations.
        seed: of the draws; a part of the edition.

    Returns:
        Cw [kg/m], shape (members, lines).
    """
    budget = budget.filter(pl.col("tow_id").is_in(lines["tow_id"].unique().implode()))
    keys, errors = _errors(budget, found, members, seed)
    tows = budget["tow_id"].unique().sort()
    place = pl.DataFrame({"tow_id": tows}).with_row_index("place")
    row = budget.select("tow_id").join(place, on="tow_id", maintain_order="left")["place"]
    ln_error = np.zeros((tows.len(), members))
    effect = budget["effect_ratio"].to_numpy()[:, None]
    index = budget.select("key").join(keys, on="key", maintain_order="left")["index"]
    np.add.at(ln_error, row.to_numpy(), effect * errors[index.to_numpy()])
    mine = lines.select("tow_id").join(place, on="tow_id", how="left", maintain_order="left")
    cw = lines["cw_kg_m"].to_numpy()
    return np.asarray(cw[None, :] * np.exp(ln_error[mine["place"].to_numpy()].T))


def as_frame(lines: pl.DataFrame, cw_kg_m: FloatArray) -> pl.DataFrame:
    """Members as rows: `member` (1 is the first), the columns of `lines`, its Cw replaced.

    Args:
        lines: as given to `register_ensemble`, with the columns that name a line.
        cw_kg_m: shape (members, lines).
    """
    members = len(cw_kg_m)
    names = pl.concat([lines.drop("cw_kg_m")] * members)
    member = np.repeat(np.arange(1, members + 1, dtype=np.int16), lines.height)
    return names.with_columns(
        pl.Series("member", member), pl.Series("cw_kg_m", cw_kg_m.ravel())
    ).select("member", pl.exclude("member"))


def _errors(
    budget: pl.DataFrame, found: SeasonFactors, members: int, seed: int
) -> tuple[pl.DataFrame, FloatArray]:
    """Standard normal errors of every key, shape (keys, members), season factors correlated."""
    keys = budget.select("key").unique().sort("key").with_row_index("index")
    errors = np.stack([_stream(seed, key).standard_normal(members) for key in keys["key"]])
    determined = found.factors.filter(pl.col("factor").is_not_null()).select(
        log_key(pl.col("season"), pl.col("part"), pl.col("log")).alias("key")
    )
    sd = np.sqrt(np.diag(found.covariance))
    root = np.linalg.cholesky(found.covariance / np.outer(sd, sd))
    independent = [_stream(seed, key).standard_normal(members) for key in determined["key"]]
    if independent:
        joint = root @ np.stack(independent)
        used = determined.with_row_index("row").join(keys, on="key")
        errors[used["index"].to_numpy()] = joint[used["row"].to_numpy()]
    return keys, errors


def _stream(seed: int, key: str) -> np.random.Generator:
    return np.random.default_rng([seed, *key.encode()])
