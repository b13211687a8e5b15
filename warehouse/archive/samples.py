"""Reading the samples of a tow: from its files to one frame of `SAMPLE_SCHEMA`.

    file -> columns by their header, as numbers in SI units -> runs, angles, absent channels

Form only: whether they can be true is the business of `plausibility`.
"""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
import polars as pl
import pyarrow as pa  # type: ignore[import-untyped]
import pyarrow.parquet as pq  # type: ignore[import-untyped]
from numpy.typing import NDArray

from pipeline.channels import MOST_RUNS, SAMPLE_SCHEMA, SECOND_FILE_OFFSET
from pipeline.errors import DefectiveInputError
from pipeline.messages import say
from pipeline.tables.row import Row
from warehouse.archive.columns import (
    UNITS,
    FoundColumn,
    decode,
    find_columns,
    find_header,
    fold,
    shorten,
    split_header,
    split_line,
    unknown_headers,
)
from warehouse.archive.faults import DefectiveFileError, at_line
from warehouse.archive.files import MAX_BYTES, path_inside, read_bytes
from warehouse.archive.profile import SeasonProfile

OUTPUT_NAMES: Final = {
    "run": "run",
    "log1": "log1_m_s",
    "log2": "log2_m_s",
    "gps": "gps_m_s",
    "force": "force_n",
    "wind_speed": "wind_speed_m_s",
    "wind_angle": "wind_angle_deg",
}
HEAD_BYTES: Final = 65_536
"""The header is looked for in so much of a file."""
TIME_TOLERANCE: Final = 0.01
ENOUGH_FOR_STEPS: Final = 10_000
"""Samples that are enough to see in which steps a channel is written."""
FEWEST_FOR_STEPS: Final = 3
"""Values that differ."""
_NUMBER: Final = r"^[+-]?([0-9]+([M][0-9]*)?|[M][0-9]+)([eE][+-]?[0-9]+)?$"
"""A number with the decimal mark M."""

Place = Callable[[int], tuple[str, int]]
"""The file of a row of a tow's samples and the line in it; of the header where it is negative."""


class Header(NamedTuple):
    """What the header of a samples file says.

    Attributes:
        line: its line in the file; the rows are below it.
        columns: the columns that are wanted.
    """

    line: int
    delimiter: str
    names: Sequence[str]
    columns: dict[str, FoundColumn]


def read_tow_samples(root: Path, tow: Row, profile: SeasonProfile) -> tuple[pl.DataFrame, Place]:
    """Reads the samples of a tow, those of a second file behind those of the first.

    Args:
        root: the archive.
        tow: a row of `ArchiveIndex.tows`.
        profile: the profile of its season.

    Returns:
        The frame, as `read_samples`; runs of the second file are numbered 21 and on. And where its
        rows stand.

    Raises:
        DefectiveFileError: the first fault, with the file it is in.
    """
    paths = [tow["samples_path"], *filter(None, [tow["second_path"]])]
    frames, headers = [], []
    for number, path in enumerate(paths):
        try:
            full = path_inside(root, path)
            samples, header_line = read_samples(full, profile, tow["sample_rate_hz"])
        except DefectiveInputError as error:
            told = error.reason_code, error.message, error.line, path
            raise DefectiveFileError(*told) from error
        offset = pl.lit(SECOND_FILE_OFFSET * number, pl.Int8)
        frames.append(samples.with_columns(pl.col("run") + offset))
        headers.append(header_line)

    def place(row: int) -> tuple[str, int]:
        first = frames[0].height
        if row < 0:
            return paths[0], headers[0]
        part, row = (1, row - first) if row >= first else (0, row)
        return paths[part], headers[part] + 1 + row

    return pl.concat(frames), place


def read_samples(
    path: Path, profile: SeasonProfile, sample_rate_hz: int | None = None
) -> tuple[pl.DataFrame, int]:
    """Reads one samples file.

    Args:
        path: text, packed or not, or Parquet.
        profile: names and units of the columns in that season.
        sample_rate_hz: rate the time column must agree with; not checked when None.

    Returns:
        A frame with the columns of `SAMPLE_SCHEMA`, one row per sample in the order of the file,
        and the line of the header. What was not measured is null throughout: a GPS that is absent
        or empty, and what the profile declares absent. Wind angles are brought to [0, 360); one
        outside -180..360 cannot be an angle and is left as it is, for `judge_samples` to find.

    Raises:
        DefectiveInputError: the first fault that costs the whole file, with its line.
    """
    read = _read_parquet if path.suffix.lower() == ".parquet" else _read_text
    header, raw = read(path, profile)
    if raw.is_empty():
        said = say("There are no samples below the header.")
        raise DefectiveInputError("unreadable_file", said)
    raw = raw.with_columns(header.columns[key].to_si(pl.col(key)) for key in raw.columns)
    raw = _with_every_run(raw)
    _check_runs(raw["run"], header.line)
    if "time" in raw.columns and sample_rate_hz:
        _check_times(raw, sample_rate_hz, header.line)
    return _to_schema(raw, profile.wind_zero_deg), header.line


def check_header(path: Path, profile: SeasonProfile) -> None:
    """Reads the columns of a samples file, not its samples.

    Raises:
        DefectiveInputError: as `read_samples`, for a fault of the header.
    """
    if path.suffix.lower() == ".parquet":
        _parquet_header(path, profile)
    else:
        start = read_bytes(path, HEAD_BYTES, start_only=True)
        _header(decode(start[: start.rfind(b"\n")] or start), profile)


def _known(names: Sequence[str], profile: SeasonProfile, line: int = 1) -> dict[str, FoundColumn]:
    """The columns in a header.

    Raises where there is no GPS, but a column that may be one: left out, it changes numbers.
    """
    found = find_columns(names, profile.columns, line)
    can_be_gps = "gps" not in found and any(column.key == "gps" for column in profile.columns)
    for header in unknown_headers(names, found) if can_be_gps else []:
        name, unit = split_header(header)
        if (unit or "").casefold() in UNITS["speed"] and name not in map(fold, profile.ignore):
            text = say(
                "Column '{name}' is not known, and there is no 'gps'. Name it under columns of the "
                "season's profile in archief.toml, or put it there under ignore."
            )
            raise DefectiveInputError("unknown_column", say(text, name=shorten(header)), line)
    return found


# Text


def _header(text: str, profile: SeasonProfile) -> Header:
    """The header in the first lines of a text, below titles if there are any."""
    lines = text.replace("\r", "").split("\n")
    place, delimiter = find_header(lines, profile.columns)
    names = split_line(lines[place], delimiter)
    return Header(place + 1, delimiter, names, _known(names, profile, place + 1))


def _read_text(path: Path, profile: SeasonProfile) -> tuple[Header, pl.DataFrame]:
    """Reads a table of text: the quick way where every cell is a number, else cell by cell."""
    data = read_bytes(path)
    if not data.isascii() or b"\x00" in data or not data[:100].strip():
        data = decode(data).encode()
    header = _header(data[:HEAD_BYTES].decode(errors="ignore"), profile)
    body = b"".join(data.split(b"\n", header.line)[header.line :]).rstrip(b"\r\n")
    frame = _read_fast(body, header) if body else None
    return header, _read_cells(body, header) if frame is None else frame


def _read_fast(body: bytes, header: Header) -> pl.DataFrame | None:
    """The columns; None where a cell is not a number, or a row has not all its fields."""
    is_comma = header.delimiter != "," and b"," in body
    is_odd = b'"' in body or (b"\r" in body and body.count(b"\r") != body.count(b"\r\n"))
    if is_odd or (is_comma and b"." in body):
        return None
    wanted = {column.index: key for key, column in header.columns.items()}
    schema = {
        wanted.get(index, f"ignored {index}"): pl.Float64() if index in wanted else pl.String()
        for index in range(len(header.names))
    }
    try:
        frame = pl.read_csv(
            body,
            has_header=False,
            separator=header.delimiter,
            quote_char=None,
            decimal_comma=is_comma,
            schema=schema,
        ).select(wanted.values())
    except pl.exceptions.PolarsError:
        return None
    is_whole = all(
        column.null_count() == 0 and np.isfinite(column.to_numpy()).all()
        for column in frame.iter_columns()
    )
    return frame if is_whole else None


def _read_cells(body: bytes, header: Header) -> pl.DataFrame:
    """The same columns, NaN where a cell is not a number or its row has not all its fields.

    A column has one decimal mark: among commas 1.012 can be a thousand and twelve.
    """
    lines = pl.Series(body.decode().split("\n") if body else [], dtype=pl.String)
    fields = lines.str.strip_suffix("\r").str.split(header.delimiter)
    is_whole = fields.list.len() == len(header.names)
    found: dict[str, pl.Series] = {}
    for key, column in header.columns.items():
        cells = fields.list.get(column.index, null_on_oob=True).str.strip_chars(" \t")
        cells = cells.str.replace(r'^"([^"]*)"$', "$1").str.strip_chars(" \t")
        if key == "gps" and (cells == "").all():
            continue
        commas, points = (cells.str.contains(mark, literal=True).sum() for mark in ",.")
        pattern = _NUMBER.replace("M", "," if commas >= points else ".")
        numbers = cells.str.replace(",", ".", literal=True).cast(pl.Float64(), strict=False)
        is_good = cells.str.contains(pattern) & is_whole & numbers.is_finite()
        found[key] = pl.select(pl.when(is_good).then(numbers).otherwise(float("nan"))).to_series()
    return pl.DataFrame(found)


# Parquet


def _read_parquet(path: Path, profile: SeasonProfile) -> tuple[Header, pl.DataFrame]:
    header, rows = _parquet_header(path, profile)
    if max(rows * len(header.columns) * 8, path.stat().st_size) > MAX_BYTES:
        text = say(
            "'{name}' holds more than {limit:.0f} MB, unpacked; a samples file is about 12 MB."
        )
        said = say(text, name=path.name, limit=MAX_BYTES / 1e6)
        raise DefectiveInputError("too_large", said)
    names = {header.names[column.index]: key for key, column in header.columns.items()}
    try:
        frame = pl.DataFrame(pl.from_arrow(pq.read_table(path, columns=[*names])))
    except (OSError, ValueError, pa.ArrowException, pl.exceptions.PolarsError) as error:
        raise _not_whole(path, error) from error
    numbers = {}
    for name, key in names.items():
        cells = frame[name]
        if cells.null_count() == len(cells) and key == "gps":
            continue
        if not cells.dtype.is_numeric():
            text = say("Column '{column}' holds {kind}, not numbers.")
            raise DefectiveInputError("bad_number", say(text, column=name, kind=cells.dtype))
        numbers[key] = cells.cast(pl.Float64()).fill_null(float("nan"))
    return header, pl.DataFrame(numbers)


def _parquet_header(path: Path, profile: SeasonProfile) -> tuple[Header, int]:
    """The header of a Parquet file, and how many rows it has."""
    try:
        with pq.ParquetFile(path) as file:
            names, rows = list(file.schema_arrow.names), file.metadata.num_rows
    except (OSError, ValueError, pa.ArrowException) as error:
        raise _not_whole(path, error) from error
    return Header(1, "", names, _known(names, profile)), rows


def _not_whole(path: Path, error: Exception) -> DefectiveInputError:
    text = say("'{name}' is not a whole {kind} file: {error}.")
    said = say(text, name=path.name, kind="Parquet", error=error)
    return DefectiveInputError("unreadable_file", said)


# Runs, times and the schema


def _with_every_run(raw: pl.DataFrame) -> pl.DataFrame:
    """The samples with every row in a run: one whose run cannot be read holds no numbers."""
    unread = raw["run"].is_nan()
    if not unread.any():
        return raw
    run = raw["run"].fill_nan(None).forward_fill().backward_fill()
    if run.null_count():
        raise DefectiveInputError("unreadable_file", say("No row has a number in column 'run'."))
    others = pl.exclude("run", "time")
    return raw.with_columns(run, pl.when(unread).then(float("nan")).otherwise(others).name.keep())


def _check_runs(run: pl.Series, header_line: int) -> None:
    """Every run must have a number that exists, and be one piece."""
    is_known = run.is_in([float(number) for number in range(1, MOST_RUNS + 1)])
    if not is_known.all():
        row = int((~is_known).arg_max() or 0)
        text = say("run {run:g} does not exist; runs are numbered 1 to {last}.")
        raise _at(header_line, row, "unknown_run", say(text, run=run[row], last=MOST_RUNS))
    starts = run_starts(run.to_numpy())
    again = starts[(~run.gather(starts).is_first_distinct()).to_numpy()]
    if len(again):
        row = int(again[0])
        text = say("run {run:g} begins again; its rows must be together.")
        raise _at(header_line, row, "split_run", say(text, run=run[row]))


def _at(header_line: int, row: int, code: str, what: str) -> DefectiveInputError:
    line = header_line + 1 + row
    return DefectiveInputError(code, at_line(line, what), line)


def run_starts(run: NDArray[np.generic]) -> NDArray[np.intp]:
    """The row at which each run begins."""
    return np.flatnonzero(np.concatenate(([True], run[1:] != run[:-1])))


def _check_times(raw: pl.DataFrame, rate_hz: int, header_line: int) -> None:
    """In every run the time must rise, at the rate that the list or the profile says.

    Raises:
        DefectiveInputError: `bad_time`.
    """
    step_s = pl.col("time").diff().fill_nan(None)
    runs = raw.with_row_index("row").group_by("run", maintain_order=True)
    found = runs.agg(pl.col("row").first(), turns=(step_s <= 0).any(), hz=1 / step_s.median())
    for run, row, turns, hz in found.rows():
        if turns or (hz and abs(hz / rate_hz - 1) > TIME_TOLERANCE):
            text = say(
                "run {run:g} has {observed:g} samples per second by its times, or its times jump "
                "back; by the list or the profile it is {rate}."
            )
            what = say(text, run=run, observed=hz, rate=rate_hz)
            raise _at(header_line, row, "bad_time", what)


def _to_schema(raw: pl.DataFrame, wind_zero_deg: float) -> pl.DataFrame:
    """The frame of `SAMPLE_SCHEMA` from Float64 columns in SI units."""
    absent = (key for key in OUTPUT_NAMES if key not in raw.columns)
    raw = raw.with_columns(pl.lit(None, pl.Float64).alias(key) for key in absent)
    angle = pl.col("wind_angle")
    turned = ((angle - wind_zero_deg) % 360).cast(pl.Float32)
    turned = pl.when(turned == 360).then(0.0).otherwise(turned)  # 359.99999999 in 32 bits
    wrapped = pl.when(angle.is_between(-180, 360)).then(turned).otherwise(angle)
    samples = raw.with_columns(wrapped.alias("wind_angle")).select(
        pl.col(key).cast(SAMPLE_SCHEMA[name]).alias(name) for key, name in OUTPUT_NAMES.items()
    )
    floats = pl.selectors.float()  # a number such as 1e39 is finite in 64 bits and not in 32
    finite = pl.when(floats.is_infinite()).then(float("nan")).otherwise(floats)
    return samples.with_columns(finite.name.keep())


def steps_of(samples: pl.DataFrame) -> dict[str, float | None]:
    """In which steps readings are written: the least difference between two of GPS and of force.

    Coarse steps do no harm where readings are rounded, as the unrest of a run is larger. Nothing in
    the samples tells whether they were rounded or cut off, which makes all half a step too small.

    Returns:
        `gps_step_m_s` and `force_step_n`; None where a channel has too few values to tell.
    """
    names = {"gps_step_m_s": "gps_m_s", "force_step_n": "force_n"}
    return {step: _least_step(samples[name]) for step, name in names.items()}


def _least_step(channel: pl.Series) -> float | None:
    values = channel.drop_nulls().to_numpy()[:: max(len(channel) // ENOUGH_FOR_STEPS, 1)]
    distinct = np.unique(values[np.isfinite(values)].astype(np.float64))
    return float(np.diff(distinct).min()) if len(distinct) >= FEWEST_FOR_STEPS else None
