"""Reading the samples of a tow into the one frame the project works with.

Form only: fields, numbers, units, run numbers, time. Whether the values can be true is the
business of `plausibility`. There are two ways to read text: a fast one that polars does whole, and
a careful one that knows lines; the fast one is trusted only where it gives the same.
"""

import re
import unicodedata
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np
import polars as pl
import pyarrow as pa  # type: ignore[import-untyped]
import pyarrow.parquet as pq  # type: ignore[import-untyped]
from numpy.typing import NDArray

from herijk.pipeline.channels import FEWEST_RUNS, MOST_RUNS, SAMPLE_SCHEMA, SECOND_FILE_OFFSET
from herijk.pipeline.errors import DefectiveInputError
from herijk.tables.row import Row
from herijk.warehouse.archive.faults import DefectiveFileError, at_line
from herijk.warehouse.archive.files import (
    PARTS,
    as_one_run,
    kind_of,
    not_whole,
    path_inside,
    read_bytes,
    read_start,
    too_large,
)
from herijk.warehouse.archive.limits import MOST_ROWS, SAMPLES_MAX_BYTES, too_many_rows
from herijk.warehouse.archive.profile import SeasonProfile
from herijk.warehouse.archive.recordings import is_labview, labview_as_table, read_tdms
from herijk.warehouse.archive.sheets import find_header
from herijk.warehouse.archive.text import (
    NUMBER_PATTERN,
    FoundColumn,
    decode,
    find_columns,
    find_delimiter,
    fold,
    nearest_column,
    score_of,
    shorten,
    split_header,
    split_line,
    unknown_headers,
    with_units,
)
from herijk.warehouse.archive.units import Scale, find_scale
from herijk.words import say

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
_FOR_A_RATE: Final = 500
"""Samples from which the rate is seen."""
PAUSE_S: Final = 10.0
"""After so long without a sample a new run begins, where nothing else says so."""
_BINARY: Final = (".parquet", ".tdms")
_BLANKS: Final = " \t"
_BLANKS_OUTSIDE: Final = re.compile(rb"^[ \t]+|[ \t]+(?=\r?$)", re.MULTILINE)
_BLANKS_WITHIN: Final = re.compile(rb"[ \t]+")
_CLOCK: Final = (
    r"^(?:.*[ T])?(?<h>[0-9]{1,2}):(?<m>[0-9]{2})(?::(?<s>[0-9]{2}(?:[.,][0-9]+)?))"
    r"(?:Z|[+-][0-9:]{2,6})?$"
)
_RUN_NAMED: Final = r"(?i)^(?:run|vaart|lauf|passage)[ \t._:-]*([0-9]{1,2})$"
"""A run with its number behind the word: `run 1`."""
_HEAD_BYTES: Final = 65_536
"""The header is looked for in so much of a file."""
_QUOTED_DECIMAL_COMMA: Final = r'"([ \t]*[+-]?[0-9]*),([0-9][0-9eE+ \t-]*)"'


@dataclass(frozen=True)
class _Body:
    """The text below the header, and what the header says of it.

    Attributes:
        header_line: line in the file of the header.
        first_line: that of the first row.
        places: lines of the rows where they do not follow each other, else empty.
        clock: the time is written as a time of day.
    """

    data: bytes
    delimiter: str
    header: Sequence[str]
    columns: Mapping[str, FoundColumn]
    header_line: int
    first_line: int
    places: Sequence[int] = ()
    clock: bool = False

    @property
    def width(self) -> int:
        """Number of columns."""
        return len(self.header)

    def line(self, row: int) -> int:
        """Line in the file of a row, counted from 0; of the header where it is negative."""
        if row < 0:
            return self.header_line
        return self.places[row] if row < len(self.places) else self.first_line + row


def read_samples(
    path: Path,
    profile: SeasonProfile,
    max_bytes: int = SAMPLES_MAX_BYTES,
    sample_rate_hz: int | None = None,
    run: int | None = None,
) -> pl.DataFrame:
    """Read one samples file.

    Args:
        path: text, also LabVIEW's, packed or not; `.parquet`; `.tdms`.
        profile: names and units of the columns in that season.
        max_bytes: limit of the file, unpacked.
        sample_rate_hz: rate the time column must agree with; not checked when None.
        run: the run that the file is, where it is one of several.

    Returns:
        A frame with the columns of `SAMPLE_SCHEMA`, one row per sample in the order of the file.
        What was not measured is null throughout: a GPS that is absent or empty, and what the
        profile declares absent. Wind angles are brought to [0, 360); one outside -180..360 cannot
        be an angle and is left as it is, for `judge_samples` to find.

    Raises:
        DefectiveInputError: the first fault that costs the whole file, with its line.
    """
    if kind_of(path) in _BINARY:
        raw, line_of = _read_binary(path, profile, max_bytes), _next_line
    else:
        body = _split_header(read_bytes(path, max_bytes), profile)
        raw, line_of = _read_text(body), body.line
    samples = _to_schema(_with_runs(raw, run), line_of, profile.wind_zero_deg)
    _check_runs(samples["run"], line_of)
    if "time" in raw.columns:
        time_s = raw["time"].to_numpy()
        turned = _turned_back(samples["run"], time_s)
        _check_time(samples["run"], time_s, sample_rate_hz, line_of, turned)
        samples = _without(samples, turned)
    return samples


LineOf = Callable[[int], int]
"""The line in a file of a row of samples, counted from 0; of the header where it is negative."""


def _next_line(row: int) -> int:
    """The line of a row where nothing but the header stands above the first."""
    return max(row + 2, 1)


def place_in_file(
    root: Path, tow: Row, profile: SeasonProfile, runs: pl.Series, path: str, row: int
) -> tuple[str, int]:
    """Return the file of a row of a tow's samples, and the line in it.

    Args:
        root: the archive.
        tow: a row of `ArchiveIndex.tows`.
        profile: the profile of its season.
        runs: the run of each sample, as `read_tow_samples` returns them.
        path: the file, or the files that are a run each.
        row: counted over these files from 0; negative for the header.
    """
    in_second = runs > SECOND_FILE_OFFSET
    own = runs.filter(in_second if path == tow["second_path"] else ~in_second).to_numpy()
    files = path.split(PARTS)
    file = files[0]
    if len(files) > 1:
        starts = run_starts(own)
        begun = int(np.searchsorted(starts, max(row, 0), "right")) - 1
        file, row = files[begun], row - int(starts[begun])
    full = path_inside(root, file)
    if kind_of(full) in _BINARY:
        return file, _next_line(row)
    return file, _split_header(read_bytes(full, SAMPLES_MAX_BYTES), profile).line(row)


def check_header(path: Path, profile: SeasonProfile) -> None:
    """Read the columns of a samples file, not its samples.

    Raises:
        DefectiveInputError: as `read_samples`, for a fault of the header.
    """
    names = _header_of(path, profile)
    _check_nothing_misspelt(names, find_columns(names, profile.columns), profile)


def _header_of(path: Path, profile: SeasonProfile) -> Sequence[str]:
    kind = kind_of(path)
    if kind == ".parquet":
        try:
            with pq.ParquetFile(path) as file:
                return list(file.schema_arrow.names)
        except (OSError, pa.ArrowException) as error:
            raise not_whole(path, "Parquet", error) from error
    if kind == ".tdms":
        return read_tdms(path, SAMPLES_MAX_BYTES, most_rows=0).columns
    return _split_header(read_start(path, _HEAD_BYTES), profile).header


def rate_in_times(path: Path, profile: SeasonProfile) -> float | None:
    """Return the samples per second at the start of a file; None where it has no times to say."""
    try:
        if kind_of(path) in _BINARY:
            frame = _read_binary(path, profile, SAMPLES_MAX_BYTES, _FOR_A_RATE)
        else:
            body = _split_header(read_start(path, _HEAD_BYTES), profile)
            if "time" not in body.columns:
                return None
            frame = _read_text(replace(body, data=body.data[: body.data.rfind(b"\n") + 1]))
    except DefectiveInputError:
        return None
    if "time" not in frame.columns or frame.height < 2:
        return None
    step = float(np.nanmedian(np.diff(frame["time"].to_numpy()[:_FOR_A_RATE])))
    return 1.0 / step if step > 0 else None


def columns_of_runs(path: Path, profile: SeasonProfile) -> tuple[tuple[str, str], ...]:
    """Return `run` or `time` with a column nobody knows as which it tells the runs of a file."""
    header = _header_of(path, profile)
    unknown = unknown_headers(header, find_columns(header, profile.columns))
    pairs = [(key, name) for key in ("run", "time") for name in unknown]
    return tuple(pair for pair in pairs if _tells_runs(path, profile, *pair))


def _tells_runs(path: Path, profile: SeasonProfile, key: str, name: str) -> bool:
    columns = tuple(
        replace(column, header=name) if column.key == key else column for column in profile.columns
    )
    try:
        runs = read_samples(path, replace(profile, columns=columns))["run"]
    except DefectiveInputError:
        return False
    return runs.n_unique() >= FEWEST_RUNS


def read_tow_samples(root: Path, tow: Row, profile: SeasonProfile) -> pl.DataFrame:
    """Read the samples of a tow, both files combined.

    Args:
        root: the archive.
        tow: a row of `ArchiveIndex.tows`.
        profile: the profile of its season.

    Returns:
        As `read_samples`; runs of the second file are numbered 21 and on and come last.

    Raises:
        DefectiveFileError: the first fault, with the file it is in.
    """
    parts = _read_parts(root, tow, tow["samples_path"], profile)
    if tow["second_path"] is not None:
        offset = pl.col("run") + pl.lit(SECOND_FILE_OFFSET, pl.Int8)
        second = _read_parts(root, tow, tow["second_path"], profile)
        parts += [part.with_columns(offset) for part in second]
    return pl.concat(parts)


def _read_parts(root: Path, tow: Row, paths: str, profile: SeasonProfile) -> list[pl.DataFrame]:
    """Read a file, or the files that are a run each."""
    several = paths.split(PARTS)
    if len(several) == 1:
        return [_read_part(root, tow, paths, profile, None)]
    runs = runs_of_parts([Path(path).name for path in several])
    parts = zip(several, runs, strict=True)
    return [_read_part(root, tow, path, profile, run) for path, run in parts]


def runs_of_parts(names: Sequence[str]) -> list[int]:
    """Return the run that each file of a tow is: by the number in its name, else by their order."""
    named = [one for name in names if (one := as_one_run(name)) is not None]
    numbers = [run for _, run in named]
    if len({tow for tow, _ in named}) == 1 and len(set(numbers)) == len(names):
        return numbers
    return list(range(1, len(names) + 1))


def _read_part(
    root: Path, tow: Row, path: str, profile: SeasonProfile, run: int | None
) -> pl.DataFrame:
    try:
        full = path_inside(root, path)
        return read_samples(full, profile, sample_rate_hz=tow["sample_rate_hz"], run=run)
    except DefectiveInputError as error:
        raise DefectiveFileError(error.reason_code, error.message, error.line, path) from error


def _with_runs(raw: pl.DataFrame, run: int | None) -> pl.DataFrame:
    """Return the samples with a run: that of the file, or a new one where the time restarts."""
    if run is not None:
        return raw.with_columns(pl.lit(float(run)).alias("run"))
    if "run" in raw.columns:
        return raw
    step = pl.col("time").diff()
    begins = ((step < 0) | (step >= PAUSE_S)).fill_null(value=False)
    if "time" not in raw.columns or not raw.select(begins.any()).item():
        said = say(
            "Nothing says which run a row is of: there is no column 'run', the time does not start "
            "again, and the file is not one of several that end in a number.",
            keys=("run",),
        )
        raise DefectiveInputError("missing_column", said, line=1)
    return raw.with_columns((begins.cum_sum() + 1).cast(pl.Float64).alias("run"))


# Text


def _read_text(body: _Body) -> pl.DataFrame:
    """Return the wanted columns as Float64, in SI units; an absent or empty gps is left out."""
    fast = _read_fast(body)
    columns = _read_carefully(body) if fast is None else fast
    return _to_si(columns, body.columns)


def _split_header(data: bytes, profile: SeasonProfile) -> _Body:
    """Find the header, below titles if there are any, and what it says of the columns."""
    if not data.isascii() or b"\x00" in data or not data[:100].strip():
        data = unicodedata.normalize("NFC", decode(data)).encode()
    places: list[int] = []
    if is_labview(data[:200].decode(errors="replace")):
        table, places = labview_as_table(data.decode())
        data = table.encode()
    lines = data[:_HEAD_BYTES].decode(errors="ignore").split("\n")
    place = find_header(lines, profile.columns)
    header_line, below = lines[place].rstrip("\r"), place + 1
    if profile.header is not None and not score_of(
        split_line(header_line, find_delimiter(header_line)), profile.columns
    ):
        header_line, below = profile.header, place
    delimiter = find_delimiter(lines[place])
    header = split_line(header_line, find_delimiter(header_line))
    if units := with_units(header, _cells_of_line(lines, below, delimiter)):
        header, below = units, below + 1
    line = places[0] if places else place + 1
    columns = find_columns(header, profile.columns, line)
    _check_nothing_misspelt(header, columns, profile)
    data = data[_start_of_line(data, below) :]
    if not data.strip(b"\r\n"):
        said = say("There are no samples below the header.")
        raise DefectiveInputError("unreadable_file", said)
    if delimiter == " ":
        data, delimiter = _BLANKS_WITHIN.sub(b"\t", _BLANKS_OUTSIDE.sub(b"", data)), "\t"
    first_line, rows = below + 1, places[1:]
    says_runs = rows or {"run", "time"} & columns.keys()
    if not says_runs and (parted := _parted_by_blank_lines(data, delimiter)):
        data, rows = parted[0], [first_line + row for row in parted[1]]
        header = [*header, "run"]
        columns = {**columns, "run": FoundColumn(len(header) - 1, "run", Scale())}
    clock = _is_clock(data, delimiter, columns.get("time"))
    return _Body(data, delimiter, header, columns, line, first_line, rows, clock)


def _parted_by_blank_lines(data: bytes, delimiter: str) -> tuple[bytes, list[int]] | None:
    """Return the rows with the number of their run behind them, and the place of each.

    A run is what stands between blank lines; None where there are none between rows. In a file
    without a column of runs or times nothing else can be meant by them.
    """
    nothing = delimiter.encode() + b" \t\r"
    lines = data.split(b"\n")
    full = np.array([bool(line.strip(nothing)) for line in lines])
    places = np.flatnonzero(full)
    begins = np.diff(places, prepend=places[:1]) > 1
    if not begins.any():
        return None
    runs = 1 + np.cumsum(begins)
    rows = (
        lines[place].rstrip(b"\r") + delimiter.encode() + str(run).encode()
        for place, run in zip(places.tolist(), runs.tolist(), strict=True)
    )
    return b"\n".join(rows) + b"\n", places.tolist()


def _cells_of_line(lines: Sequence[str], number: int, delimiter: str) -> list[str]:
    """Return the cells of a line that may be no row of samples; none where there is no line."""
    if number >= len(lines) or any(map(str.isdigit, lines[number])):
        return []
    return lines[number].split(None if delimiter == " " else delimiter)


def _start_of_line(data: bytes, number: int) -> int:
    """Place of the first byte of a line, counted from 0."""
    start = 0
    for _ in range(number):
        start = data.find(b"\n", start) + 1 or len(data)
    return start


def _is_clock(data: bytes, delimiter: str, time: FoundColumn | None) -> bool:
    if time is None:
        return False
    cells = data.partition(b"\n")[0].split(delimiter.encode())
    return time.index < len(cells) and b":" in cells[time.index]


def _check_nothing_misspelt(
    header: Sequence[str], columns: Mapping[str, FoundColumn], profile: SeasonProfile
) -> None:
    """Raise where there is no GPS, but a column that can be one: left out, it changes numbers."""
    gps = [column for column in profile.columns if column.key == "gps"]
    if "gps" in columns or not gps:
        return
    for cell in unknown_headers(header, columns):
        name, unit = split_header(cell)
        is_speed = unit is not None and find_scale("speed", unit) is not None
        if name not in map(fold, profile.ignore) and (is_speed or nearest_column(cell, gps)):
            said = say(
                "Column '{name}' is not known, and there is no 'gps'. Name it under columns of the "
                "season's profile in archief.toml, or put it there under ignore.",
                name=shorten(cell),
            )
            raise DefectiveInputError("unknown_column", said, line=1)


def _read_fast(body: _Body) -> pl.DataFrame | None:
    """Return the columns, or None where the careful way has to judge.

    That is also where a carriage return stands within a line: Polars takes it for a blank. And
    where there are commas and points: Polars takes either for the decimal mark.
    """
    mixed = b"," in body.data and b"." in body.data
    if _has_stray_return(body.data) or (mixed and body.delimiter != ","):
        return None
    quoted = b'"' in body.data
    wanted = {column.index: key for key, column in body.columns.items()}
    number = pl.String() if quoted else pl.Float64()
    schema = {
        wanted.get(index, f"ignored {index}"): number
        if index in wanted and not (body.clock and wanted[index] == "time")
        else pl.String()
        for index in range(body.width)
    }
    try:
        frame = pl.read_csv(
            body.data,
            has_header=False,
            separator=body.delimiter,
            quote_char='"' if quoted else None,
            decimal_comma=body.delimiter != ",",
            schema=schema,
        ).select(wanted.values())
        if body.clock:
            frame = frame.with_columns(_seconds_of_clock(frame["time"]))
        if quoted:
            text = pl.selectors.string()
            frame = frame.with_columns(text.str.replace(",", ".", literal=True).cast(pl.Float64()))
    except pl.exceptions.PolarsError:
        return None
    return frame if all(map(_all_finite, frame.iter_columns())) else None


def _seconds_of_clock(cells: pl.Series) -> pl.Series:
    """Return times of day, with or without a date before them, as seconds."""
    parts = cells.str.strip_chars().str.extract_groups(_CLOCK).struct
    hours, minutes, seconds = (
        parts.field(name).str.replace(",", ".", literal=True).cast(pl.Float64())
        for name in ("h", "m", "s")
    )
    return (hours * 3600 + minutes * 60 + seconds).alias("time")


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
    text = body.data.rstrip(b"\r\n").decode()
    lines = pl.Series("line", text.split("\n")).str.strip_suffix("\r")
    if body.delimiter == ",":
        lines = lines.str.replace_all(_QUOTED_DECIMAL_COMMA, '"$1.$2"')
    fields = lines.str.split(body.delimiter)
    whole = fields.list.len() == body.width
    columns: dict[str, pl.Series] = {}
    for key, column in body.columns.items():
        cells = fields.list.get(column.index, null_on_oob=True)
        cells = cells.str.strip_chars(_BLANKS).str.replace(r'^"([^"]*)"$', "$1")
        cells = cells.str.strip_chars(_BLANKS)
        if key == "gps" and (cells == "").all():
            continue
        if key == "run":
            cells = cells.str.replace(_RUN_NAMED, "$1")
        if key == "time" and body.clock:
            cells = _seconds_of_clock(cells).cast(pl.String()).fill_null(cells)
        columns[key] = _to_numbers(cells, whole)
    return pl.DataFrame(columns)


_THOUSAND: Final = {
    ",": r"^[+-]?[0-9]{1,3},[0-9]{3}$",
    ".": r"^[+-]?[0-9]{1,3}\.[0-9]{3}$",
}


def _to_numbers(cells: pl.Series, whole: pl.Series) -> pl.Series:
    """Return text as numbers, NaN where it is none or the row is not whole.

    In a column of decimal commas 1.012 can be a thousand and twelve: it is no number either. Nor is
    1,012 among points.
    """
    spelled = cells.str.contains(NUMBER_PATTERN)
    commas, points = (cells.str.contains(mark, literal=True).sum() for mark in ",.")
    for mark, rarer in ((",", commas <= points), (".", points <= commas)):
        if commas and points and rarer:
            spelled &= ~cells.str.contains(_THOUSAND[mark])
    numbers = cells.str.replace(",", ".", literal=True).cast(pl.Float64(), strict=False)
    good = (spelled & whole & numbers.is_finite()).fill_null(value=False)
    return pl.select(pl.when(good).then(numbers).otherwise(float("nan"))).to_series()


# Tables of other programs


def _read_parquet(path: Path, profile: SeasonProfile, max_bytes: int) -> pl.DataFrame:
    """Return the columns of a Parquet file that the profile names."""
    try:
        with pq.ParquetFile(path) as file:
            names = file.schema_arrow.names
            columns = find_columns(names, profile.columns)
            _check_nothing_misspelt(names, columns, profile)
            _check_parquet_size(path, file, len(columns), max_bytes)
            wanted = [names[column.index] for column in columns.values()]
            schema = pa.schema([file.schema_arrow.field(name) for name in wanted])
            table = pa.Table.from_batches(_batches(file, wanted), schema)
        return pl.DataFrame(pl.from_arrow(table))
    except FileNotFoundError as error:
        said = say("'{name}' is not there any more.", name=path.name)
        raise DefectiveInputError("samples_missing", said) from error
    except (OSError, ValueError, pa.ArrowException, pl.exceptions.PolarsError) as error:
        raise not_whole(path, "Parquet", error) from error


def _batches(file: pq.ParquetFile, names: list[str]) -> Iterator[pa.RecordBatch]:
    """The rows in pieces, as a footer may promise fewer than there are."""
    rows = 0
    for batch in file.iter_batches(columns=names):
        rows += batch.num_rows
        if rows > MOST_ROWS:
            raise too_many_rows(rows)
        yield batch


def _check_parquet_size(path: Path, file: pq.ParquetFile, width: int, max_bytes: int) -> None:
    metadata = file.metadata
    groups = (metadata.row_group(index) for index in range(metadata.num_row_groups))
    unpacked = sum(group.total_byte_size for group in groups)
    if max(unpacked, metadata.num_rows * width * 8, path.stat().st_size) > max_bytes:
        raise too_large(path, max_bytes)


def _read_binary(
    path: Path, profile: SeasonProfile, max_bytes: int, most_rows: int | None = None
) -> pl.DataFrame:
    """Return the wanted columns of a Parquet or TDMS file as Float64, as `_read_text` does."""
    if kind_of(path) == ".tdms":
        frame = read_tdms(path, max_bytes, most_rows)
    else:
        frame = _read_parquet(path, profile, max_bytes)
    if frame.is_empty():
        raise DefectiveInputError("unreadable_file", say("There are no samples in the file."))
    columns = find_columns(frame.columns, profile.columns)
    _check_nothing_misspelt(frame.columns, columns, profile)
    numbers: dict[str, pl.Series] = {}
    for key, column in columns.items():
        cells = frame.to_series(column.index)
        if key == "gps" and cells.null_count() == len(cells):
            continue
        if key == "time" and not cells.dtype.is_numeric():
            cells = _as_seconds(cells)
        numbers[key] = _only_numbers(cells, column)
    return _to_si(pl.DataFrame(numbers), columns)


def _as_seconds(cells: pl.Series) -> pl.Series:
    """Return points in time, or times of day as text, as seconds."""
    if cells.dtype.is_temporal():
        first = cells[0]
        return pl.select((pl.lit(cells) - first).dt.total_microseconds() / 1e6).to_series()
    return _seconds_of_clock(cells) if cells.dtype == pl.String() else cells


def _only_numbers(cells: pl.Series, column: FoundColumn) -> pl.Series:
    if not cells.dtype.is_numeric():
        said = say(
            "Column '{column}' holds {kind}, not numbers.", column=column.header, kind=cells.dtype
        )
        raise DefectiveInputError("bad_number", said)
    return cells.cast(pl.Float64()).fill_null(float("nan"))


# To the schema


def _to_si(frame: pl.DataFrame, columns: Mapping[str, FoundColumn]) -> pl.DataFrame:
    scaled = (
        (pl.col(key) + scale.shift) * scale.numerator / scale.denominator
        for key in frame.columns
        if (scale := columns[key].scale) != Scale()
    )
    return frame.with_columns(scaled)


def _to_schema(raw: pl.DataFrame, line_of: LineOf, wind_zero_deg: float) -> pl.DataFrame:
    """Return the frame of `SAMPLE_SCHEMA` from Float64 columns in SI units."""
    if raw["run"].is_nan().any():
        raw = _with_known_runs(raw)
    _check_run_numbers(raw["run"], line_of)
    absent = (key for key in OUTPUT_NAMES if key not in raw.columns)
    raw = raw.with_columns(pl.lit(None, pl.Float64).alias(key) for key in absent)
    angle = pl.col("wind_angle")
    turned = (angle - wind_zero_deg) % 360
    wrapped = pl.when(angle.is_between(-180, 360)).then(turned).otherwise(angle)
    samples = raw.with_columns(wrapped).select(
        pl.col(key).cast(SAMPLE_SCHEMA[name]).alias(name) for key, name in OUTPUT_NAMES.items()
    )
    # 359.99999999 rounds to 360 in 32 bits; the promise is [0, 360).
    below = pl.when(pl.col("wind_angle_deg") == 360).then(0.0).otherwise(pl.col("wind_angle_deg"))
    samples = samples.with_columns(below.cast(pl.Float32()).alias("wind_angle_deg"))
    # A number such as 1e39 is finite in 64 bits and not in 32.
    floats = pl.selectors.float()
    finite = pl.when(floats.is_infinite()).then(float("nan")).otherwise(floats)
    return samples.with_columns(finite.name.keep())


def _with_known_runs(raw: pl.DataFrame) -> pl.DataFrame:
    """Return the samples with every row in a run: one whose run cannot be read holds no numbers."""
    unread = raw["run"].is_nan()
    run = raw["run"].fill_nan(None).forward_fill().backward_fill()
    if run.null_count():
        raise DefectiveInputError("unreadable_file", say("No row has a number in column 'run'."))
    others = pl.exclude("run", "time")
    return raw.with_columns(run, pl.when(unread).then(float("nan")).otherwise(others).name.keep())


def _check_run_numbers(run: pl.Series, line_of: LineOf) -> None:
    known = run.is_in([float(number) for number in range(1, MOST_RUNS + 1)])
    if not known.all():
        row = int((~known).arg_max() or 0)
        what = say(
            "run {run:g} does not exist; runs are numbered 1 to {last}.",
            run=run[row],
            last=MOST_RUNS,
        )
        raise _at(line_of(row), "unknown_run", what)


def _at(line: int, reason_code: str, what: str) -> DefectiveInputError:
    return DefectiveInputError(reason_code, at_line(line, what), line)


def _check_runs(run: pl.Series, line_of: LineOf) -> None:
    """Every run must be one piece."""
    starts = run_starts(run.to_numpy())
    numbers = run.to_numpy()[starts]
    for position, number in enumerate(numbers):
        if number in numbers[:position]:
            what = say("run {run} begins again; its rows must stand together.", run=int(number))
            raise _at(line_of(int(starts[position])), "split_run", what)


def run_starts(run: NDArray[np.int8]) -> NDArray[np.intp]:
    """Return the row at which each run begins."""
    return np.flatnonzero(np.concatenate(([True], run[1:] != run[:-1])))


def _turned_back(run: pl.Series, time_s: NDArray[np.float64]) -> NDArray[np.int8]:
    """Runs within which the clock jumps back, where it does not in most."""
    number = run.to_numpy()
    back = (np.diff(time_s) <= 0) & (number[1:] == number[:-1])
    turned = np.unique(number[1:][back])
    return turned if 2 * len(turned) < run.n_unique() else turned[:0]


def _without(samples: pl.DataFrame, runs: NDArray[np.int8]) -> pl.DataFrame:
    """The samples without the numbers of some runs.

    Nothing says whether the clock was wrong there, or rows are there twice.
    """
    if not len(runs):
        return samples
    lost, channel = pl.col("run").is_in(runs.tolist()), pl.selectors.float()
    nothing = pl.when(channel.is_not_null()).then(float("nan"))
    return samples.with_columns(pl.when(lost).then(nothing).otherwise(channel).name.keep())


def _check_time(
    run: pl.Series,
    time_s: NDArray[np.float64],
    rate_hz: int | None,
    line_of: LineOf,
    turned: NDArray[np.int8],
) -> None:
    """Every run's time must rise at the rate, but of those that turn back (`turned`)."""
    starts = run_starts(run.to_numpy())
    ends = np.append(starts[1:], len(run))
    step = np.diff(time_s)
    step[starts[1:] - 1] = np.inf
    step[np.isin(run.to_numpy()[1:], turned)] = np.inf
    if (step <= 0).any():
        what = say("the time does not increase within the run.")
        raise _at(line_of(int(np.argmax(step <= 0)) + 1), "bad_time", what)
    if rate_hz is None:
        return
    for start, end in zip(starts, ends, strict=True):
        samples = int(end - start)
        if samples < 2 or run[int(start)] in turned:
            continue
        # The usual step: a gap costs its seconds, which `plausibility` counts.
        observed = 1.0 / float(np.nanmedian(step[start : end - 1]))
        if abs(observed / rate_hz - 1) > TIME_TOLERANCE:
            said = say(
                "Run {run}: by its times it has {observed:g} samples per second, by the list or "
                "the profile {rate}; they may differ by {most:.0%}.",
                run=run[int(start)],
                observed=observed,
                rate=rate_hz,
                most=TIME_TOLERANCE,
            )
            raise DefectiveInputError("bad_time", said, line=line_of(int(start)))
