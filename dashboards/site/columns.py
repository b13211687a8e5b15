"""What charts draw as JSON, column by column."""

from typing import Final

import polars as pl
import polars.selectors as cs

DRAWN: Final = 5
"""Significant digits of what charts draw."""


def json_of(frame: pl.DataFrame) -> str:
    """A frame as lists by column."""
    return _shown(frame).select(pl.all().implode()).write_ndjson().rstrip("\n")


def json_by(frame: pl.DataFrame, key: str) -> dict[str, str]:
    """The same of the rows of every key, in their order, without the key: made at once."""
    groups = _shown(frame).group_by(key, maintain_order=True).agg(pl.all())
    texts = groups.drop(key).write_ndjson().split("\n")
    return dict(zip(groups[key], texts, strict=False))  # a line break ends the last text


def _shown(frame: pl.DataFrame) -> pl.DataFrame:
    return frame.with_columns(cs.float().round_sig_figs(DRAWN))
