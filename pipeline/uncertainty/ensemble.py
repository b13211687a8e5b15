"""Many equally likely registers, so that any later question has an answer with its uncertainty.

Is boat X really heavier than Y, does the winner change: whoever asks counts the members in which
it holds. What tows share is drawn once per member and used for all of them, which intervals of
single lines cannot show. Belongs here: the draws, and the counting. Does not: the components
(`propagation`) and where members are kept (the lake).
"""

from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Final

import numpy as np
import polars as pl

from pipeline.arrays import FloatArray
from pipeline.errors import MissingKnowledgeError
from pipeline.uncertainty.propagation import log_key

if TYPE_CHECKING:
    from pipeline.season_log import SeasonFactors

MEMBERS: Final = 200
SEED: Final = 2009
FEW_ROWS: Final = 8192
"""Errors added up at a time: those of all tows would take as much memory as the tables."""
REMEMBERED: Final = 1 << 14
"""Keys whose errors are kept for the next method, which has the same keys: 26 MB."""


def register_ensemble(
    lines: pl.DataFrame,
    budget: pl.DataFrame,
    estimated: "SeasonFactors | None",
    members: int = MEMBERS,
) -> FloatArray:
    """Realisations of the Cw of every line of a register.

    Errors are normal on the logarithm. Every error has a random stream of its own, named by its
    key: a line keeps its members when others come or go.

    Args:
        lines: one row per line with `tow_id` (may occur more than once) and `cw_kg_m`.
        budget: rows of `propagation.budget`, at least of those tows.
        estimated: the season factors, whose errors are drawn with their correlation; None where the
            method estimates none.
        members: number of realisations.

    Returns:
        Cw [kg/m], shape (members, lines).
    """
    budget = budget.filter(pl.col("tow_id").is_in(lines["tow_id"].unique().implode()))
    keys, errors = _errors(budget, estimated, members)
    tows = budget["tow_id"].unique().sort()
    place = pl.DataFrame({"tow_id": tows}).with_row_index("place")
    row = budget.select("tow_id").join(place, on="tow_id", maintain_order="left")["place"]
    index = budget.select("key").join(keys, on="key", maintain_order="left")["index"]
    of_rows = row.to_numpy(), index.to_numpy(), budget["effect_ratio"].to_numpy()
    ln_error = np.zeros((tows.len(), members))
    for first in range(0, budget.height, FEW_ROWS):
        few_row, few_index, effect = (of_all[first : first + FEW_ROWS] for of_all in of_rows)
        np.add.at(ln_error, few_row, effect[:, None] * errors[few_index])
    mine = lines.select("tow_id").join(place, on="tow_id", how="left", maintain_order="left")
    cw = lines["cw_kg_m"].to_numpy()
    return np.asarray(cw[None, :] * np.exp(ln_error[mine["place"].to_numpy()].T))


def tow_ensemble(
    method: str,
    curves: pl.DataFrame,
    ruled: pl.DataFrame,
    budget: pl.DataFrame,
    estimated: "SeasonFactors | None",
) -> pl.DataFrame:
    """Rows of the table `ensemble` of a method: members of every tow with a curve.

    They lie around the number that the register uses, as wide as its interval; what tows share
    stays what they share as measured.

    Args:
        method: its name.
        curves, budget: its tables `curves` and `uncertainty_budget`.
        ruled: its curves with the estimate that the register uses.
        estimated: its season factors, as `register_ensemble` takes them.
    """
    width = (pl.col("cw_hi_kg_m") / pl.col("cw_lo_kg_m")).log()
    tows = (
        curves.drop_nulls("cw_kg_m")
        .select("tow_id", "cw_kg_m", measured=width)
        .join(
            ruled.select("tow_id", used="cw_kg_m", stated=width), on="tow_id", maintain_order="left"
        )
        .with_columns((pl.col("stated") / pl.col("measured")).fill_null(1.0))
    )
    measured, used, wider = (tows[name].to_numpy() for name in ("cw_kg_m", "used", "stated"))
    drawn = register_ensemble(tows, budget, estimated)
    cw = used * (drawn / measured) ** wider
    members = as_frame(tows.select("tow_id", "cw_kg_m"), cw)
    return members.with_columns(pl.lit(method).alias("method"))


def as_frame(lines: pl.DataFrame, cw_kg_m: FloatArray) -> pl.DataFrame:
    """Members as rows, those of a line together: `member` (1 is the first), the columns of `lines`.

    Args:
        lines: as given to `register_ensemble`, with the columns that name a line.
        cw_kg_m: shape (members, lines); it replaces that of `lines`.
    """
    members = len(cw_kg_m)
    line = np.repeat(np.arange(lines.height), members)
    return lines[line].select(
        pl.Series("member", np.tile(np.arange(1, members + 1, dtype=np.int16), lines.height)),
        pl.exclude("cw_kg_m"),
        pl.Series("cw_kg_m", cw_kg_m.T.ravel()),
    )


def share_first(members: pl.DataFrame, results: pl.DataFrame) -> pl.DataFrame:
    """Share of the members in which each crew of a race has the highest power per rower.

    Power is proportional to Cw, and the error of Cw at the declared speed is taken for that at the
    speed rowed: sound within the range in which a curve is valid. A penalty does not follow Cw.

    Args:
        members: rows of the table `ensemble` of one method.
        results: one row per crew: `tow_id` of its boat's curve, `cw_kg_m` of that curve at the
            declared speed, `power_w` by it and the `penalty_w` that was taken off.

    Returns:
        The rows of `results` with `share`, highest power first.

    Raises:
        MissingKnowledgeError: a tow has no members.
    """
    drawn = _members_of(members, results["tow_id"].to_list())
    penalty = results["penalty_w"].fill_null(0.0).to_numpy()
    per_cw = (results["power_w"].to_numpy() + penalty) / results["cw_kg_m"].to_numpy()
    first = (per_cw[:, None] * drawn - penalty[:, None]).argmax(axis=0)
    share = np.bincount(first, minlength=results.height) / drawn.shape[1]
    return results.with_columns(pl.Series("share", share)).sort("power_w", descending=True)


def _members_of(members: pl.DataFrame, tow_ids: Sequence[str]) -> FloatArray:
    """Cw of the members of each tow, shape (tows, members)."""
    per_tow = (
        members.filter(pl.col("tow_id").is_in(tow_ids))
        .group_by("tow_id", maintain_order=True)
        .agg(pl.col("cw_kg_m").sort_by("member"))
    )
    known = dict(per_tow.rows())
    for tow_id in tow_ids:
        if tow_id not in known:
            raise MissingKnowledgeError(
                "tow {} has no members in the ensemble: there is no curve for it; look "
                "for its status in the table curves",
                tow_id,
            )
    return np.array([known[tow_id] for tow_id in tow_ids])


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
