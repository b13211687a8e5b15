"""Reading the samples of a tow into the one frame the project works with.

Form only: fields, numbers, units, run numbers, time. Whether the values can be true is the
business of `plausibility`. There are two ways to read text: a fast one that polars does whole, and
a careful one that knows lines; the fast one is trusted only where it gives the same.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import polars as pl
import pyarrow as pa  # type: ignore[import-untyped]
import pyarrow.parquet as pq  # type: ignore[import-untyped]
from numpy.typing import NDArray

from herijk.pipeline.channels import RUNS_PER_FILE, SAMPLE_SCHEMA, SECOND_FILE_OFFSET
from herijk.pipeline.errors import DefectiveInputError
from herijk.warehouse.archive.faults import DefectiveFileError
from herijk.warehouse.archive.files import SAMPLES_MAX_BYTES, path_inside, read_bytes, too_large
from herijk.warehouse.archive.profile import SeasonProfile
from herijk.warehouse.archive.text import (
    NUMBER_PATTERN,
    FoundColumn,
    decode,
    find_columns,
    find_delimiter,
    split_line,
)

OUTPUT_NAMES: Final = {
    "run": "run",
    "log1": "log1_m_s",
    "log2": "log2_m_s",
    "gps": "gps_m_s",
    "force": "force_n",
    "wind_speed": "wind_speed_m_s",
    "wind_angle": "wind_angle_deg",
}
TIME_TOLERANCE: Final = 0.01
_BLANKS: Final = " \t"
_ROW: Final = re.compile(rb"[^\r\n]")
_QUOTED_DECIMAL_COMMA: Final = r'"([ \t]*[+-]?[0-9]*),([0-9][0-9eE+ \t-]*)"'


@dataclass(frozen=True)
class _Body:
    """The text below the header, which ends at `start`; not copied, as it may be large."""

    data: bytes
    start: int
    delimiter: str
    width: int
    columns: Mapping[str, FoundColumn]


def read_samples(
    path: Path,
    profile: SeasonProfile,
    max_bytes: int = SAMPLES_MAX_BYTES,
    sample_rate_hz: int | None = None,
) -> pl.DataFrame:
    """Read one samples file.

    Args:
        path: a `.csv`, `.csv.gz`, `.csv.zst` or `.parquet` file.
        profile: names and units of the columns in that season.
        max_bytes: limit of the file, unpacked.
        sample_rate_hz: rate the time column must agree with; not checked when None.

    Returns:
        A frame with the columns of `SAMPLE_SCHEMA`, one row a sample in the order of the file;
        row `i` stands on line `i + 2`. `gps_m_s` is null throughout when the column is absent or
        empty. Wind angles are brought to [0, 360); one outside -180..360 cannot be an angle and
        is left as it is, for `judge_samples` to find.

    Raises:
        DefectiveInputError: the first fault that costs the whole file, with its line.
    """
    if path.suffix.casefold() == ".parquet":
        raw = _read_parquet(path, profile, max_bytes)
    else:
        raw = _read_text(read_bytes(path, max_bytes), profile)
    samples = _to_schema(raw)
    _check_runs(samples["run"])
    if "time" in raw.columns:
        _check_time(samples["run"], raw["time"].to_numpy(), sample_rate_hz)
    return samples


def read_tow_samples(root: Path, tow: Mapping[str, Any], profile: SeasonProfile) -> pl.DataFrame:
    """Read the samples of a tow, both files combined.

    Args:
        root: the archive.
        tow: a row of `ArchiveIndex.tows`.
        profile: the profile of its season.

    Returns:
        As `read_samples`; runs of the second file are numbered 11-16 and come last.

    Raises:
        DefectiveFileError: the first fault, with the file it is in.
    """
    parts = [_read_part(root, tow, tow["samples_path"], profile)]
    if tow["second_path"] is not None:
        second = _read_part(root, tow, tow["second_path"], profile)
        parts.append(second.with_columns(pl.col("run") + pl.lit(SECOND_FILE_OFFSET, pl.Int8)))
    return pl.concat(parts)


def _read_part(
    root: Path, tow: Mapping[str, Any], path: str, profile: SeasonProfile
) -> pl.DataFrame:
    try:
        return read_samples(path_inside(root, path), profile, sample_rate_hz=tow["sample_rate_hz"])
    except DefectiveInputError as error:
        raise DefectiveFileError(error.reason_code, error.message, error.line, path) from error


# Text


def _read_text(data: bytes, profile: SeasonProfile) -> pl.DataFrame:
    """Return the wanted columns as Float64, in SI units; an absent or empty gps is left out."""
    body = _split_header(data, profile)
    fast = _read_fast(body)
    columns = _read_carefully(body) if fast is None else fast
    return _to_si(columns, body.columns)


def _split_header(data: bytes, profile: SeasonProfile) -> _Body:
    if not data.isascii() or b"\x00" in data or not data[:100].strip():
        data = decode(data).encode()
    start = data.find(b"\n") + 1 or len(data)
    header_line = decode(data[:start]).rstrip("\r\n")
    delimiter = find_delimiter(header_line)
    header = split_line(header_line, delimiter)
    columns = find_columns(header, profile.columns)
    if not _ROW.search(data, start):
        raise DefectiveInputError("unreadable_file", "There are no samples below the header.")
    return _Body(data, start, delimiter, len(header), columns)


def _read_fast(body: _Body) -> pl.DataFrame | None:
    """Return the columns, or None where the careful way has to judge.

    That is also where a carriage return stands within a line: Polars takes it for a blank.
    """
    if _has_stray_return(body.data):
        return None
    quoted = body.data.find(b'"', body.start) >= 0
    wanted = {found.index: key for key, found in body.columns.items()}
    number = pl.String() if quoted else pl.Float64()
    schema = {
        wanted.get(index, f"ignored {index}"): number if index in wanted else pl.String()
        for index in range(body.width)
    }
    try:
        frame = pl.read_csv(
            body.data,
            has_header=False,
            skip_lines=1,
            separator=body.delimiter,
            quote_char='"' if quoted else None,
            decimal_comma=body.delimiter != ",",
            schema=schema,
        ).select(wanted.values())
        if quoted:
            frame = frame.select(pl.all().str.replace(",", ".", literal=True).cast(pl.Float64()))
    except pl.exceptions.PolarsError:
        return None
    return frame if all(map(_all_finite, frame.iter_columns())) else None


def _has_stray_return(data: bytes) -> bool:
    """Whether a carriage return stands anywhere but before a line feed."""
    if b"\r" not in data:
        return False
    letters = np.frombuffer(data, np.uint8)
    stray = (letters[:-1] == ord("\r")) & (letters[1:] != ord("\n"))
    return data.endswith(b"\r") or bool(stray.any())


def _all_finite(numbers: pl.Series) -> bool:
    """Whether every cell holds a number; NumPy is quicker at it than Polars."""
    return numbers.null_count() == 0 and bool(np.isfinite(numbers.to_numpy()).all())


def _read_carefully(body: _Body) -> pl.DataFrame:
    """Return the same columns, NaN where a cell is no number or its row has not all its fields."""
    text = body.data[body.start :].rstrip(b"\r\n").decode()
    lines = pl.Series("line", text.split("\n")).str.strip_suffix("\r")
    if body.delimiter == ",":
        lines = lines.str.replace_all(_QUOTED_DECIMAL_COMMA, '"$1.$2"')
    fields = lines.str.split(body.delimiter)
    whole = fields.list.len() == body.width
    columns: dict[str, pl.Series] = {}
    for key, found in body.columns.items():
        cells = fields.list.get(found.index, null_on_oob=True)
        cells = cells.str.strip_chars(_BLANKS).str.replace(r'^"([^"]*)"$', "$1")
        cells = cells.str.strip_chars(_BLANKS)
        if key == "gps" and (cells == "").all():
            continue
        columns[key] = _to_numbers(cells, whole)
    return pl.DataFrame(columns)


def _to_numbers(cells: pl.Series, whole: pl.Series) -> pl.Series:
    """Return text as numbers, NaN where it is none or the row is not whole."""
    spelled = cells.str.contains(NUMBER_PATTERN)
    numbers = cells.str.replace(",", ".", literal=True).cast(pl.Float64(), strict=False)
    good = (spelled & whole & numbers.is_finite()).fill_null(value=False)
    return pl.select(pl.when(good).then(numbers).otherwise(float("nan"))).to_series()


# Parquet


def _read_parquet(path: Path, profile: SeasonProfile, max_bytes: int) -> pl.DataFrame:
    """Return the wanted columns of a Parquet file, as `_read_text` does."""
    try:
        with pq.ParquetFile(path) as file:
            columns = find_columns(file.schema_arrow.names, profile.columns)
            _check_parquet_size(path, file, len(columns), max_bytes)
            table = file.read(columns=[file.schema_arrow.names[f.index] for f in columns.values()])
        frame = pl.DataFrame(pl.from_arrow(table))
    except FileNotFoundError as error:
        raise DefectiveInputError(
            "samples_missing", f"'{path.name}' is not there any more."
        ) from error
    except (OSError, ValueError, pa.ArrowException, pl.exceptions.PolarsError) as error:
        raise DefectiveInputError(
            "unreadable_file", f"'{path.name}' is not a whole Parquet file: {error}."
        ) from error
    if frame.is_empty():
        raise DefectiveInputError("unreadable_file", "There are no samples in the file.")
    named = frame.rename(dict(zip(frame.columns, columns, strict=True)))
    return _to_si(_parquet_numbers(named, columns), columns)


def _check_parquet_size(path: Path, file: pq.ParquetFile, width: int, max_bytes: int) -> None:
    metadata = file.metadata
    groups = (metadata.row_group(index) for index in range(metadata.num_row_groups))
    unpacked = sum(group.total_byte_size for group in groups)
    if max(unpacked, metadata.num_rows * width * 8, path.stat().st_size) > max_bytes:
        raise too_large(path, max_bytes)


def _parquet_numbers(frame: pl.DataFrame, columns: Mapping[str, FoundColumn]) -> pl.DataFrame:
    numbers: dict[str, pl.Series] = {}
    for key, found in columns.items():
        cells = frame[key]
        if key == "gps" and cells.null_count() == len(cells):
            continue
        if not cells.dtype.is_numeric():
            raise DefectiveInputError(
                "bad_number", f"Column '{found.header}' holds {cells.dtype}, not numbers."
            )
        numbers[key] = cells.cast(pl.Float64()).fill_null(float("nan"))
    return pl.DataFrame(numbers)


# To the schema


def _to_si(frame: pl.DataFrame, columns: Mapping[str, FoundColumn]) -> pl.DataFrame:
    scaled = (
        pl.col(key) * columns[key].scale[0] / columns[key].scale[1]
        for key in frame.columns
        if columns[key].scale != (1, 1)
    )
    return frame.with_columns(scaled)


def _to_schema(raw: pl.DataFrame) -> pl.DataFrame:
    """Return the frame of `SAMPLE_SCHEMA` from Float64 columns in SI units, NaN for no number."""
    if raw["run"].is_nan().any():
        raw = _with_known_runs(raw)
    _check_run_numbers(raw["run"])
    angle = pl.col("wind_angle")
    wrapped = pl.when(angle.is_between(-180, 360)).then(angle % 360).otherwise(angle)
    samples = raw.with_columns(wrapped).select(
        pl.col(key).cast(SAMPLE_SCHEMA[name]).alias(name)
        if key in raw.columns
        else pl.lit(None, SAMPLE_SCHEMA[name]).alias(name)
        for key, name in OUTPUT_NAMES.items()
    )
    # 359.99999999 rounds to 360 in 32 bits; the promise is [0, 360).
    turned = pl.when(pl.col("wind_angle_deg") == 360).then(0.0).otherwise(pl.col("wind_angle_deg"))
    samples = samples.with_columns(turned.cast(pl.Float32()).alias("wind_angle_deg"))
    # A number such as 1e39 is finite in 64 bits and not in 32.
    floats = pl.selectors.float()
    return samples.with_columns(
        pl.when(floats.is_infinite()).then(float("nan")).otherwise(floats).name.keep()
    )


def _with_known_runs(raw: pl.DataFrame) -> pl.DataFrame:
    """Return the samples with a row whose run cannot be read in the run around it, as no numbers."""
    unread = raw["run"].is_nan()
    run = raw["run"].fill_nan(None).forward_fill().backward_fill()
    if run.null_count():
        raise DefectiveInputError("unreadable_file", "No row says which run it belongs to.")
    others = pl.exclude("run", "time")
    return raw.with_columns(run, pl.when(unread).then(float("nan")).otherwise(others).name.keep())


def _check_run_numbers(run: pl.Series) -> None:
    known = run.is_in([float(number) for number in range(1, RUNS_PER_FILE + 1)])
    if not known.all():
        row = int((~known).arg_max() or 0)
        raise DefectiveInputError(
            "unknown_run",
            f"Line {row + 2}: run {run[row]:g} does not exist; runs are numbered 1 to "
            f"{RUNS_PER_FILE}.",
            line=row + 2,
        )


def _check_runs(run: pl.Series) -> None:
    """Every run must be one piece."""
    starts = run_starts(run.to_numpy())
    numbers = run.to_numpy()[starts]
    for position, number in enumerate(numbers):
        if number in numbers[:position]:
            line = int(starts[position]) + 2
            raise DefectiveInputError(
                "split_run",
                f"Line {line}: run {number} begins again; its rows must stand together.",
                line=line,
            )


def run_starts(run: NDArray[np.int8]) -> NDArray[np.intp]:
    """Return the row at which each run begins."""
    return np.flatnonzero(np.concatenate(([True], run[1:] != run[:-1])))


def _check_time(run: pl.Series, time_s: NDArray[np.float64], rate_hz: int | None) -> None:
    starts = run_starts(run.to_numpy())
    ends = np.append(starts[1:], len(run))
    step = np.diff(time_s)
    step[starts[1:] - 1] = np.inf
    if (step <= 0).any():
        line = int(np.argmax(step <= 0)) + 3
        raise DefectiveInputError(
            "bad_time", f"Line {line}: the time does not increase within the run.", line=line
        )
    if rate_hz is None:
        return
    for start, end in zip(starts, ends, strict=True):
        samples = int(end - start)
        if samples < 2:
            continue
        # The usual step: a gap costs its seconds, which `plausibility` counts.
        observed = 1.0 / float(np.nanmedian(step[start : end - 1]))
        if abs(observed / rate_hz - 1) > TIME_TOLERANCE:
            raise DefectiveInputError(
                "bad_time",
                f"Run {run[int(start)]}: by its times it has {observed:.4g} samples a second, by "
                f"the list or the profile {rate_hz}; they may differ by "
                f"{TIME_TOLERANCE:.0%}.",
                line=int(start) + 2,
            )
