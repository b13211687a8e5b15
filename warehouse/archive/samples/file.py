"""Reading one samples file, or only what its start says."""

from collections.abc import Sequence
from pathlib import Path

import polars as pl
import pyarrow as pa  # type: ignore[import-untyped]
import pyarrow.parquet as pq  # type: ignore[import-untyped]

from warehouse.archive.files.contents import not_whole
from warehouse.archive.files.names import kind_of
from warehouse.archive.profile.season import SeasonProfile
from warehouse.archive.samples.binary_files import BINARY, next_line, read_binary
from warehouse.archive.samples.columns import check_nothing_misspelt
from warehouse.archive.samples.frame import (
    LineOf,
    check_runs,
    to_schema,
    with_checked_times,
    with_runs,
)
from warehouse.archive.samples.labview import read_tdms
from warehouse.archive.samples.text_files import HEAD_BYTES, body_of, read_text
from warehouse.archive.spelling.columns import find_columns


def read_samples(
    path: Path,
    profile: SeasonProfile,
    sample_rate_hz: int | None = None,
    run: int | None = None,
) -> tuple[pl.DataFrame, LineOf]:
    """Reads one samples file.

    Args:
        path: text, also LabVIEW's, packed or not; a sheet; `.parquet`; `.tdms`.
        profile: names and units of the columns in that season.
        sample_rate_hz: rate the time column must agree with; not checked when None.
        run: the run that the file is, where it is one of several.

    Returns:
        A frame with the columns of `SAMPLE_SCHEMA`, one row per sample in the order of the file,
        and the line of each row. What was not measured is null throughout: a GPS that is absent or
        empty, and what the profile declares absent. Wind angles are brought to [0, 360); one
        outside -180..360 cannot be an angle and is left as it is, for `judge_samples` to find.

    Raises:
        DefectiveInputError: the first fault that costs the whole file, with its line.
    """
    line_of: LineOf = next_line
    if kind_of(path) in BINARY:
        raw = read_binary(path, profile)
    else:
        body = body_of(path, profile)
        raw, line_of = read_text(body), body.line_of
    samples = to_schema(with_runs(raw, run), line_of, profile.wind_zero_deg)
    check_runs(samples["run"], line_of)
    if "time" in raw.columns:
        samples = with_checked_times(samples, raw["time"], sample_rate_hz, line_of)
    return samples, line_of


def check_header(path: Path, profile: SeasonProfile) -> None:
    """Reads the columns of a samples file, not its samples.

    Raises:
        DefectiveInputError: as `read_samples`, for a fault of the header.
    """
    names = _header_of(path, profile)
    check_nothing_misspelt(names, find_columns(names, profile.columns), profile)


def _header_of(path: Path, profile: SeasonProfile) -> Sequence[str]:
    kind = kind_of(path)
    if kind == ".parquet":
        try:
            with pq.ParquetFile(path) as file:
                return list(file.schema_arrow.names)
        except (OSError, pa.ArrowException) as error:
            raise not_whole(path, "Parquet", error) from error
    if kind == ".tdms":
        return read_tdms(path, most_rows=0).columns
    return body_of(path, profile, HEAD_BYTES).header
