"""Whether two sets of tables hold the same numbers, as far as machines can agree."""

import json
from collections.abc import Iterator, Mapping

import numpy as np
import polars as pl

SAME = 1e-9
"""Largest difference, as a share of a number or, near zero, of the column's typical size."""

JSON = ("causes",)
"""Columns whose text holds numbers."""


def jittered(frame: pl.DataFrame, seed: int) -> pl.DataFrame:
    """Every float moved in its last bits, as by the arithmetic of another processor."""
    rng = np.random.default_rng(seed)
    noise = 1.0 + 4e-16 * rng.standard_normal((frame.height, frame.width))
    return frame.with_columns(
        pl.Series(name, frame[name] * noise[:, i])
        for i, name in enumerate(frame.columns)
        if frame[name].dtype.is_float()
    )


def unequal(tables: Mapping[str, pl.DataFrame], others: Mapping[str, pl.DataFrame]) -> list[str]:
    """Every column that is not the same: numbers to `SAME`, everything else exactly."""
    assert tables.keys() == others.keys()
    return [
        found for name, table in tables.items() for found in _of_table(name, table, others[name])
    ]


def _of_table(name: str, table: pl.DataFrame, other: pl.DataFrame) -> Iterator[str]:
    if table.schema != other.schema or table.height != other.height:
        yield f"{name}: {table.schema} {table.height} against {other.schema} {other.height}"
        return
    for column in table.columns:
        mine, theirs = table[column], other[column]
        if column in JSON:
            mine, words = _numbers(mine)
            theirs, other_words = _numbers(theirs)
            if words != other_words:
                yield f"{name}.{column}: other words"
                continue
        if not mine.dtype.is_float():
            if not mine.equals(theirs, null_equal=True):
                yield f"{name}.{column}: {(mine != theirs).sum()} rows"
        elif (worst := _largest_difference(mine, theirs)) > SAME:
            yield f"{name}.{column}: {worst:.1e}"


def _numbers(texts: pl.Series) -> tuple[pl.Series, list[str]]:
    """The factors in JSON texts, and the texts without them."""
    found = [json.loads(text) for text in texts]
    factors = [cause.pop("factor") for causes in found for cause in causes]
    return pl.Series(factors, dtype=pl.Float64), [json.dumps(causes) for causes in found]


def _largest_difference(mine: pl.Series, theirs: pl.Series) -> float:
    """Largest relative difference; infinite where a number stands against none."""
    if not mine.is_null().equals(theirs.is_null()):
        return np.inf
    a, b = (side.drop_nulls().to_numpy() for side in (mine, theirs))
    finite = np.isfinite(a) & np.isfinite(b)
    if not np.array_equal(a[~finite], b[~finite], equal_nan=True):
        return np.inf
    a, b = a[finite], b[finite]
    sizes = np.abs(a[a != 0.0])
    typical = float(np.median(sizes)) if sizes.size else 1.0
    return float((np.abs(a - b) / np.maximum(np.abs(a), typical)).max(initial=0.0))
