"""Reading samples from Parquet and TDMS."""

from pathlib import Path
from typing import Final

import polars as pl
import pyarrow as pa  # type: ignore[import-untyped]
import pyarrow.parquet as pq  # type: ignore[import-untyped]

from pipeline.errors import DefectiveInputError
from pipeline.messages import say
from warehouse.archive.files.contents import not_whole, too_large
from warehouse.archive.files.names import kind_of
from warehouse.archive.limits import MOST_ROWS, SAMPLES_MAX_BYTES, too_many_rows
from warehouse.archive.profile.season import SeasonProfile
from warehouse.archive.samples.columns import check_nothing_misspelt, seconds_of_clock, to_si
from warehouse.archive.samples.labview import read_tdms
from warehouse.archive.spelling.columns import FoundColumn, find_columns

BINARY: Final = (".parquet", ".tdms")


def next_line(row: int) -> int:
    """The line of a row where nothing but the header is above the first."""
    return max(row + 2, 1)


def read_binary(path: Path, profile: SeasonProfile) -> pl.DataFrame:
    """The wanted columns of a Parquet or TDMS file as Float64, as `read_text` does."""
    frame = read_tdms(path) if kind_of(path) == ".tdms" else _read_parquet(path, profile)
    if frame.is_empty():
        raise DefectiveInputError("unreadable_file", say("There are no samples in the file."))
    columns = find_columns(frame.columns, profile.columns)
    check_nothing_misspelt(frame.columns, columns, profile)
    numbers: dict[str, pl.Series] = {}
    for key, column in columns.items():
        cells = frame.to_series(column.index)
        if key == "gps" and cells.null_count() == len(cells):
            continue
        if key == "time" and not cells.dtype.is_numeric():
            cells = _as_seconds(cells)
        numbers[key] = _only_numbers(cells, column)
    return to_si(pl.DataFrame(numbers), columns)


def _read_parquet(path: Path, profile: SeasonProfile) -> pl.DataFrame:
    """The columns of a Parquet file that the profile names."""
    try:
        with pq.ParquetFile(path) as file:
            names = file.schema_arrow.names
            columns = find_columns(names, profile.columns)
            check_nothing_misspelt(names, columns, profile)
            _check_parquet_size(path, file, len(columns))
            wanted = [names[column.index] for column in columns.values()]
            return pl.DataFrame(pl.from_arrow(file.read(columns=wanted)))
    except FileNotFoundError as error:
        said = say("'{name}' is not there any more.", name=path.name)
        raise DefectiveInputError("samples_missing", said) from error
    except (OSError, ValueError, pa.ArrowException, pl.exceptions.PolarsError) as error:
        raise not_whole(path, "Parquet", error) from error


def _check_parquet_size(path: Path, file: pq.ParquetFile, width: int) -> None:
    metadata = file.metadata
    if metadata.num_rows > MOST_ROWS:
        raise too_many_rows(metadata.num_rows)
    groups = (metadata.row_group(index) for index in range(metadata.num_row_groups))
    unpacked = sum(group.total_byte_size for group in groups)
    if max(unpacked, metadata.num_rows * width * 8, path.stat().st_size) > SAMPLES_MAX_BYTES:
        raise too_large(path, SAMPLES_MAX_BYTES)


def _as_seconds(cells: pl.Series) -> pl.Series:
    """Points in time, or times of day as text, as seconds."""
    if cells.dtype.is_temporal():
        first = cells[0]
        return pl.select((pl.lit(cells) - first).dt.total_microseconds() / 1e6).to_series()
    return seconds_of_clock(cells) if cells.dtype == pl.String() else cells


def _only_numbers(cells: pl.Series, column: FoundColumn) -> pl.Series:
    if not cells.dtype.is_numeric():
        said = say(
            "Column '{column}' holds {kind}, not numbers.", column=column.header, kind=cells.dtype
        )
        raise DefectiveInputError("bad_number", said)
    return cells.cast(pl.Float64()).fill_null(float("nan"))
