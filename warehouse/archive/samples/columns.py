"""The columns of a samples file, whatever kind of file it is."""

from collections.abc import Mapping, Sequence
from typing import Final

import polars as pl

from pipeline.errors import DefectiveInputError
from pipeline.messages import say
from warehouse.archive.profile.season import SeasonProfile
from warehouse.archive.spelling.columns import (
    FoundColumn,
    nearest_columns,
    unknown_headers,
)
from warehouse.archive.spelling.headers import split_header
from warehouse.archive.spelling.text import fold, shorten
from warehouse.archive.spelling.units import Scale, find_scale

_CLOCK: Final = (
    r"^(?:.*[ T])?(?<h>[0-9]{1,2}):(?<m>[0-9]{2})(?::(?<s>[0-9]{2}(?:[.,][0-9]+)?))"
    r"(?:Z|[+-][0-9:]{2,6})?$"
)


def check_nothing_misspelt(
    header: Sequence[str], columns: Mapping[str, FoundColumn], profile: SeasonProfile
) -> None:
    """Raises where there is no GPS, but a column that can be one: left out, it changes numbers."""
    gps = [column for column in profile.columns if column.key == "gps"]
    if "gps" in columns or not gps:
        return
    for cell in unknown_headers(header, columns):
        name, unit = split_header(cell)
        is_speed = unit is not None and find_scale("speed", unit) is not None
        if name not in map(fold, profile.ignore) and (is_speed or nearest_columns(cell, gps)):
            said = say(
                "Column '{name}' is not known, and there is no 'gps'. Name it under columns of the "
                "season's profile in archief.toml, or put it there under ignore.",
                name=shorten(cell),
            )
            raise DefectiveInputError("unknown_column", said, line=1)


def seconds_of_clock(cells: pl.Series) -> pl.Series:
    """Times of day, with or without a date before them, as seconds."""
    parts = cells.str.strip_chars().str.extract_groups(_CLOCK).struct
    hours, minutes, seconds = (
        parts.field(name).str.replace(",", ".", literal=True).cast(pl.Float64())
        for name in ("h", "m", "s")
    )
    return (hours * 3600 + minutes * 60 + seconds).alias("time")


def to_si(frame: pl.DataFrame, columns: Mapping[str, FoundColumn]) -> pl.DataFrame:
    """Columns as they are written in SI units."""
    scaled = (
        (pl.col(key) + scale.shift) * scale.numerator / scale.denominator
        for key in frame.columns
        if (scale := columns[key].scale) != Scale()
    )
    return frame.with_columns(scaled)
