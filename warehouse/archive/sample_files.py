"""Reading one samples file: text, Parquet or TDMS, to columns of numbers.

    file -> columns by their header -> numbers in the units of the file, times in seconds

What the rows are (runs, a recording), and the schema, is the business of `samples`.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from itertools import chain
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
import polars as pl
import pyarrow as pa  # type: ignore[import-untyped]
import pyarrow.parquet as pq  # type: ignore[import-untyped]

from pipeline.channels import MOST_RUNS
from pipeline.errors import DefectiveInputError
from pipeline.messages import say
from warehouse.archive.columns import (
    CLOCK,
    UNITS,
    DefectiveHeaderError,
    FoundColumn,
    decode,
    find_columns,
    find_header,
    find_unit,
    fold,
    fold_names,
    quote_names,
    shorten,
    split_header,
    split_line,
)
from warehouse.archive.faults import say_at_line
from warehouse.archive.files import MAX_BYTES, read_bytes
from warehouse.archive.profile import SeasonProfile

HEAD_BYTES: Final = 65_536
"""The header is looked for in so much of a file."""
MIN_READABLE_TIMES: Final = 0.5
"""Part of the times that must be readable; with fewer the unit is another one."""
MIN_SLOW_GAPS: Final = 10
MIN_SLOW_EMPTY: Final = 0.3
"""A column with so many gaps, and this part of its cells empty, is sampled at a slower rate."""
_NUMBER: Final = r"^[+-]?([0-9]+([M][0-9]*)?|[M][0-9]+)([eE][+-]?[0-9]+)?$"
"""A number with the decimal mark M."""
_CLOCK: Final = (
    r"^(?:[0-9]{1,4}[-/.][0-9]{1,2}[-/.][0-9]{1,4}[T ])?"
    r"([0-9]{1,2}):([0-5]?[0-9]):([0-5]?[0-9](?:[.,][0-9]*)?)"
    r"\s*(?:([AaPp])\.?[Mm]\.?|Z|[+-][0-9]{2}:?[0-9]{2})?$"
)
"""A time of day on a clock of 24 hours or with AM and PM; a date before it is not read."""
_LABVIEW_TEXT: Final = b"LabVIEW Measurement"


class Header(NamedTuple):
    """What the header of a samples file says.

    Attributes:
        line: its line in the file.
        delimiter: between its fields.
        names: its cells.
        columns: the columns that are wanted.
    """

    line: int
    delimiter: str
    names: Sequence[str]
    columns: dict[str, FoundColumn]


@dataclass(frozen=True)
class SampleTable:
    """The numbers of a samples file.

    Attributes:
        frame: Float64 columns by key, in the units of the file but the time, which is in seconds;
            NaN where a cell is not a number; `run` where the file tells it.
        columns: where the columns are, and their scales.
        header_line: the header's line, from 1.
        first_line: the line of the first row.
    """

    frame: pl.DataFrame
    columns: dict[str, FoundColumn]
    header_line: int = 1
    first_line: int = 2


def read_table(path: Path, profile: SeasonProfile) -> SampleTable:
    """Read the columns of a samples file.

    Raises:
        DefectiveInputError: the first fault that costs the whole file, with its line.
    """
    suffix = path.suffix.lower()
    if suffix == ".lvm":
        raise _labview_error(path.name)
    if suffix == ".parquet":
        table = _read_parquet(path, profile)
    elif suffix == ".tdms":
        table = _read_tdms(path, profile)
    else:
        table = _read_text(path, profile)
    if table.frame.is_empty():
        said = say("There are no samples below the header.")
        raise DefectiveInputError("unreadable_file", said)
    return table


def check_header(path: Path, profile: SeasonProfile) -> None:
    """Read the columns of a samples file, not its samples.

    Raises:
        DefectiveInputError: as `read_table`, for a fault of the header.
    """
    suffix = path.suffix.lower()
    if suffix == ".lvm":
        raise _labview_error(path.name)
    if suffix == ".parquet":
        _read_parquet_header(path, profile)
    elif suffix == ".tdms":
        _read_tdms(path, profile, header_only=True)
    else:
        start = read_bytes(path, HEAD_BYTES, start_only=True)
        _check_not_labview(start, path.name)
        _find_header(decode(start[: start.rfind(b"\n")] or start), profile)


def _labview_error(name: str) -> DefectiveInputError:
    text = say(
        "'{name}' is LabVIEW text (.lvm), which is not read. Convert it to a table, as "
        "docs/archive.md shows under 'LabVIEW text', or save it as .tdms."
    )
    return DefectiveInputError("labview_text", say(text, name=name))


def _check_not_labview(data: bytes, name: str) -> None:
    if data[:200].lstrip(b"\xef\xbb\xbf \t\r\n").startswith(_LABVIEW_TEXT):
        raise _labview_error(name)


def _find_known(
    names: Sequence[str], profile: SeasonProfile, line: int = 1
) -> dict[str, FoundColumn]:
    """Return the columns in a header.

    Raises where there is no GPS, but a column that may be one: left out, it changes numbers.
    """
    possible = _find_possible_gps(names, profile)
    ask_gps = [profile.ask("columns.gps")] if possible else []
    try:
        found = find_columns(names, profile.columns, line, profile.ask, ask_gps)
    except DefectiveHeaderError as error:
        raise _add_other_answers(error, profile) from error
    if possible and "gps" not in found:
        text = say(
            "There is no column 'gps', and {names} can be it. Name the one that is, or say that "
            'there is none: absent = ["gps"]. What is neither goes under ignore of the season.'
        )
        said = say(text, names=quote_names(possible))
        raise DefectiveHeaderError("unknown_column", said, line, ask_gps)
    return found


def _add_other_answers(error: DefectiveHeaderError, profile: SeasonProfile) -> DefectiveHeaderError:
    """Return the error about a header with the answers that are not the name of a column."""
    said, ask = error.message, list(error.ask)
    asked = "\n".join(ask)
    if ".run = " in asked:
        text = say(
            '{header} Where no column says which run a row is: runs = "file" if each run has its '
            'file, or runs = "windows" if begin and end of each run are in the list vensters.'
        )
        said = say(text, header=said)
        ask.append(profile.ask("runs"))
    if "columns.log2 = " in asked or "columns.wind_speed = " in asked:
        said = say("{header} What was not on board goes under absent.", header=said)
        ask.append(profile.ask("absent", '["?"]'))
    return DefectiveHeaderError(error.reason_code, said, error.line, ask)


def _find_possible_gps(names: Sequence[str], profile: SeasonProfile) -> list[str]:
    """Return the headers that are no known column and have the unit of a speed, or none.

    There are none where a GPS is found, or not looked for.
    """
    gps_header = profile.find_header("gps")
    if gps_header is None:
        return []
    known = fold_names(profile.columns)
    possible = []
    for header in names:
        name, unit = split_header(header)
        if name == fold(gps_header):
            return []
        is_known = name in known or name in map(fold, profile.ignore)
        is_speed = unit is None or find_unit("speed", unit) is not None
        if name and not is_known and is_speed:
            possible.append(header.strip())
    return possible


# Text


def _find_header(text: str, profile: SeasonProfile) -> Header:
    """Return the header in the first lines of a text, below titles if there are any."""
    lines = text.replace("\r", "").split("\n")
    place, delimiter = find_header(lines, profile.columns)
    names = split_line(lines[place], delimiter)
    return Header(place + 1, delimiter, names, _find_known(names, profile, place + 1))


def _read_text(path: Path, profile: SeasonProfile) -> SampleTable:
    """Read a table of text: the quick way where every cell is a number, else cell by cell."""
    data = read_bytes(path)
    _check_not_labview(data, path.name)
    if not data.isascii() or b"\x00" in data or not data[:100].strip():
        data = decode(data).encode()
    header = _find_header(data[:HEAD_BYTES].decode(errors="ignore"), profile)
    above = header.line + profile.skip_below_header
    body = _cut_body(data, above)
    hold = frozenset(profile.hold)
    frame = _read_fast(body, header, hold) if body else None
    if frame is None:
        frame = _read_cells(body, header, above + 1)
        _check_first_rows(frame, body, header, profile, above + 1)
    _check_slow_channels(frame, header, hold, profile, above + 1)
    frame = _hold_slow_channels(frame, profile.hold)
    frame = _convert_times(frame, header, profile, above + 1)
    return SampleTable(frame, header.columns, header.line, above + 1)


def _cut_body(data: bytes, above: int) -> bytes:
    """Return the text below so many lines, without blank lines at the end."""
    start = 0
    for _ in range(above):
        start = data.find(b"\n", start) + 1
        if not start:
            return b""
    end = len(data)
    while end > start and data[end - 1] in b"\r\n":
        end -= 1
    return data[start:end]


def _read_fast(body: bytes, header: Header, hold: frozenset[str]) -> pl.DataFrame | None:
    """Return the columns; None where a cell is not a number, or a row has not all its fields."""
    is_comma = header.delimiter != "," and b"," in body
    is_odd = b'"' in body or (b"\r" in body and body.count(b"\r") != body.count(b"\r\n"))
    if is_odd or (is_comma and b"." in body):
        return None
    wanted = {column.index: key for key, column in header.columns.items()}
    as_text = {key for key, column in header.columns.items() if column.scale == CLOCK}
    schema: dict[str, pl.DataType] = {}
    for index in range(len(header.names)):
        key = wanted.get(index, f"ignored {index}")
        is_number = index in wanted and key not in as_text
        schema[key] = pl.Float64() if is_number else pl.String()
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
    for key, column in zip(frame.columns, frame.iter_columns(), strict=True):
        if key in as_text:
            continue
        has_gap = column.null_count() > 0 and key not in hold
        if has_gap or not np.isfinite(float(column.sum())):  # not a number, or infinite, in any row
            return None
    return frame


def _read_cells(body: bytes, header: Header, first_line: int) -> pl.DataFrame:
    """Return the same columns, NaN where a cell is not a number, null where it is empty.

    A row that has not all its fields is NaN throughout. A column has one decimal mark: among commas
    1.012 can be a thousand and twelve.

    Raises:
        DefectiveInputError: no row has all its fields, or no cell of column `run` is a number.
    """
    fields = _split_rows(body, header.delimiter)
    is_whole = fields.list.len() == len(header.names)
    if len(fields) and not is_whole.any():
        text = say(
            "the row has {fields} fields where the header has {width}. Where commas stand both "
            "between fields and before decimals, export the file again with ';' between fields."
        )
        said = say(text, fields=len(fields[0]), width=len(header.names))
        raise DefectiveInputError("broken_row", say_at_line(first_line, said), first_line)
    found: dict[str, pl.Series] = {}
    for key, column in header.columns.items():
        cells = fields.list.get(column.index, null_on_oob=True).str.strip_chars(" \t")
        cells = cells.str.replace(r'^"([^"]*)"$', "$1").str.strip_chars(" \t")
        if key == "gps" and (cells == "").all():
            continue
        if column.scale == CLOCK:
            found[key] = pl.select(pl.when(is_whole).then(cells)).to_series()
            continue
        commas = cells.str.contains(",", literal=True).sum()
        points = cells.str.contains(".", literal=True).sum()
        pattern = _NUMBER.replace("M", "," if commas >= points else ".")
        numbers = cells.str.replace(",", ".", literal=True).cast(pl.Float64(), strict=False)
        is_good = cells.str.contains(pattern) & is_whole & numbers.is_finite()
        is_empty = is_whole & (cells == "")
        if key == "run" and not is_good.any():
            text = say(
                "column '{column}' holds '{cell}', and a number from 1 to {last} is expected: "
                "replace it in the whole file."
            )
            said = say(text, column=column.header, cell=shorten(cells[0] or ""), last=MOST_RUNS)
            raise DefectiveInputError("unknown_run", say_at_line(first_line, said), first_line)
        number = pl.when(is_good).then(numbers).when(~is_empty).then(float("nan"))
        found[key] = pl.select(number).to_series()
    return pl.DataFrame(found)


def _split_rows(body: bytes, delimiter: str) -> pl.Series:
    """Return the fields of each row; one whose quotation mark is not closed has one field."""
    lines = pl.Series(body.decode().split("\n") if body else [], dtype=pl.String)
    lines = lines.str.strip_suffix("\r")
    if b'"' not in body:
        return lines.str.split(delimiter)
    rows = []
    for line in lines:
        try:
            rows.append(split_line(line, delimiter))
        except DefectiveInputError:
            rows.append([line])
    return pl.Series(rows, dtype=pl.List(pl.String))


def _check_first_rows(
    frame: pl.DataFrame, body: bytes, header: Header, profile: SeasonProfile, first_line: int
) -> None:
    """Raise where the lines right below the header are text, such as units."""
    numbers = frame.select(pl.exclude("time")).fill_null(float("nan"))
    is_text = numbers.select(pl.all_horizontal(pl.all().is_nan())).to_series()
    leading = int(is_text.arg_min() or 0) if not is_text.all() else 0
    lines = body.split(b"\n", leading)[:leading]
    delimiter = header.delimiter.encode()
    if not lines or any(line.count(delimiter) + 1 != len(header.names) for line in lines):
        return
    text = say(
        "the lines below the header are no samples, up to line {last}. Say how many these are: "
        "skip_below_header under [[profile]] in archief.toml."
    )
    said = say_at_line(first_line, say(text, last=first_line + leading - 1))
    ask = (profile.ask("skip_below_header"),)
    raise DefectiveHeaderError("broken_row", said, first_line, ask)


def _check_slow_channels(
    frame: pl.DataFrame,
    header: Header,
    hold: frozenset[str],
    profile: SeasonProfile,
    first_line: int,
) -> None:
    """Raise where a column has regular gaps, and nobody declared that it is sampled slower."""
    for key, column in header.columns.items():
        if key in hold or key not in frame.columns or not frame[key].null_count():
            continue
        is_empty = frame[key].is_null()
        gaps = int((is_empty & ~is_empty.shift(1, fill_value=False)).sum())
        if gaps < MIN_SLOW_GAPS or is_empty.mean() < MIN_SLOW_EMPTY:  # type: ignore[operator]
            continue
        text = say(
            "column '{column}' is empty in {percent:.0f} % of the rows. If it is sampled at a "
            'slower rate, say so: hold = ["{key}"] under [[profile]] in archief.toml. If it cannot '
            "be used, name it under absent."
        )
        said = say(text, column=column.header, percent=100 * is_empty.mean(), key=key)  # type: ignore[operator]
        line = first_line + int(is_empty.arg_max() or 0)
        raise DefectiveHeaderError(
            "slow_channel", say_at_line(line, said), line, (profile.ask("hold", '["?"]'),)
        )


def _hold_slow_channels(frame: pl.DataFrame, hold: Sequence[str]) -> pl.DataFrame:
    """Return the table with slower channels held; every other empty cell becomes NaN.

    A value is held for twice the usual distance of two: a longer gap is a receiver that failed.
    """
    held = []
    for key in hold:
        if key not in frame.columns or key == "run":
            continue
        rows = np.flatnonzero(frame[key].is_not_null().to_numpy())
        usual = int(np.median(np.diff(rows))) if len(rows) > 1 else 1
        value = pl.col(key).forward_fill(max(2 * usual - 1, 0))
        held.append(value.over("run") if "run" in frame.columns else value)
    if held:
        frame = frame.with_columns(held)
    if not any(column.null_count() for column in frame.iter_columns()):
        return frame
    return frame.with_columns(pl.selectors.float().fill_null(float("nan")))


def _convert_times(
    frame: pl.DataFrame, header: Header, profile: SeasonProfile, first_line: int
) -> pl.DataFrame:
    """Return the table with its times in seconds; a row whose time cannot be read holds nothing.

    Raises:
        DefectiveHeaderError: `bad_time`, most times cannot be read: the unit is another one.
    """
    if "time" not in frame.columns:
        return frame
    column = header.columns["time"]
    if column.scale == CLOCK:
        parts = pl.col("time").str.strip_chars().str.extract_groups(_CLOCK).struct
        hours = parts.field("1").cast(pl.Float64)
        half = parts.field("4").str.to_lowercase()
        is_afternoon = half == "p"
        hours = pl.when(half.is_null()).then(hours).otherwise(hours % 12 + 12 * is_afternoon)
        seconds = parts.field("3").str.replace(",", ".").cast(pl.Float64, strict=False)
        value = hours * 3600 + parts.field("2").cast(pl.Float64) * 60 + seconds
    else:
        value = column.to_si(pl.col("time"))
    times = frame.select(value.fill_null(float("nan"))).to_series()
    is_unread = times.is_nan()
    if not is_unread.any():
        return frame.with_columns(times.alias("time"))
    if is_unread.mean() > 1 - MIN_READABLE_TIMES:  # type: ignore[operator]
        line = first_line + int(is_unread.arg_max() or 0)
        text = say(
            "the time in column '{column}' cannot be read as [{unit}]. Say how it is written: "
            "units.time under [[profile]] in archief.toml, one of {known}. If it is none of these, "
            'say that times do not count: absent = ["time"].'
        )
        known = ", ".join(UNITS["time"])
        said = say(text, column=column.header, unit=column.unit, known=known)
        ask = (profile.ask("units.time"), profile.ask("absent", '["?"]'))
        raise DefectiveHeaderError("bad_time", say_at_line(line, said), line, ask)
    others = pl.exclude("run", "time")
    return frame.with_columns(
        times.alias("time"), pl.when(is_unread).then(float("nan")).otherwise(others).name.keep()
    )


# Parquet


def _read_parquet(path: Path, profile: SeasonProfile) -> SampleTable:
    header, rows = _read_parquet_header(path, profile)
    if max(rows * len(header.columns) * 8, path.stat().st_size) > MAX_BYTES:
        raise _too_large_error(path)
    names = {header.names[column.index]: key for key, column in header.columns.items()}
    try:
        frame = pl.DataFrame(pl.from_arrow(pq.read_table(path, columns=list(names))))
    except (OSError, ValueError, pa.ArrowException, pl.exceptions.PolarsError) as error:
        raise _damaged_error(path, "Parquet", error) from error
    numbers = {}
    for name, key in names.items():
        cells = frame[name]
        if cells.null_count() == len(cells) and key == "gps":
            continue
        if header.columns[key].scale == CLOCK:
            numbers[key] = cells.cast(pl.String())
            continue
        if not cells.dtype.is_numeric():
            text = say("Column '{column}' holds {kind}, not numbers.")
            raise DefectiveInputError("bad_number", say(text, column=name, kind=cells.dtype))
        numbers[key] = cells.cast(pl.Float64())
    frame = pl.DataFrame(numbers)
    _check_slow_channels(frame, header, frozenset(profile.hold), profile, 2)
    frame = _convert_times(_hold_slow_channels(frame, profile.hold), header, profile, 2)
    return SampleTable(frame, header.columns)


def _read_parquet_header(path: Path, profile: SeasonProfile) -> tuple[Header, int]:
    """Return the header of a Parquet file, and how many rows it has."""
    try:
        with pq.ParquetFile(path) as file:
            names, rows = list(file.schema_arrow.names), file.metadata.num_rows
    except (OSError, ValueError, pa.ArrowException) as error:
        raise _damaged_error(path, "Parquet", error) from error
    return Header(1, "", names, _find_known(names, profile)), rows


def _damaged_error(path: Path, kind: str, error: Exception) -> DefectiveInputError:
    text = say("'{name}' is not a whole {kind} file: {error}.")
    said = say(text, name=path.name, kind=kind, error=f"{error}"[:200])
    return DefectiveInputError("unreadable_file", said)


def _too_large_error(path: Path) -> DefectiveInputError:
    text = say("'{name}' holds more than {limit:.0f} MB, unpacked; a samples file is about 12 MB.")
    return DefectiveInputError("too_large", say(text, name=path.name, limit=MAX_BYTES / 1e6))


# TDMS


def _read_tdms(path: Path, profile: SeasonProfile, header_only: bool = False) -> SampleTable:
    """Read the runs of a recording of LabVIEW: a group each, in the order of the file.

    One group with a channel `run` is a table. A channel at a slower rate is held, where the file
    or the profile says that it is slower.
    """
    groups = _open_tdms(path, header_only)
    frames, columns = [], {}
    for run, group in _assign_groups(groups, profile):
        channels = group.channels()
        names = []
        for channel in channels:
            unit = channel.properties.get("unit_string")
            has_own_unit = not unit or "[" in channel.name
            names.append(channel.name if has_own_unit else f"{channel.name} [{unit}]")
        columns = _find_known(names, profile.leave_out_run() if run else profile)
        if header_only:
            continue
        frame = _read_group(path, group.name, channels, columns, profile)
        if run:
            frame = frame.with_columns(run=pl.lit(float(run)))
        frames.append(frame)
    if header_only:
        return SampleTable(pl.DataFrame(), columns)
    if "run" not in columns:
        columns = columns | {"run": FoundColumn(-1, "run")}
    shared = [key for key in columns if all(key in frame.columns for frame in frames)]
    return SampleTable(pl.concat(frame.select(shared) for frame in frames), columns)


def _open_tdms(path: Path, header_only: bool) -> list[Any]:
    """Return the groups of a TDMS file that have channels.

    Raises:
        DefectiveInputError: `unreadable_file` or `too_large`.
    """
    if find_spec("nptdms") is None:
        text = say("'{name}' is read with an extra: pip install 'herijk[labview]'.")
        raise DefectiveInputError("unreadable_file", say(text, name=path.name))
    if path.stat().st_size > MAX_BYTES:
        raise _too_large_error(path)
    from nptdms import TdmsFile  # type: ignore[import-untyped]  # noqa: PLC0415 - only for these

    try:
        file = TdmsFile.read_metadata(path) if header_only else TdmsFile.read(path)
        groups = [group for group in file.groups() if group.channels()]
        total = sum(map(len, chain.from_iterable(group.channels() for group in groups)))
    except Exception as error:  # a damaged file makes the library raise almost anything
        raise _damaged_error(path, "TDMS", error) from error
    if total * 8 > MAX_BYTES:
        raise _too_large_error(path)
    if not groups:
        raise _damaged_error(path, "TDMS", ValueError("there is no channel in it"))
    return groups


def _assign_groups(groups: Sequence[Any], profile: SeasonProfile) -> list[tuple[int | None, Any]]:
    """Return the groups that are runs, each with its number; None for one with a channel `run`.

    Raises:
        DefectiveHeaderError: a group that the profile names is not there, or the numbers in the
            names of the groups are in another order than the groups.
    """
    wanted = fold_names(profile.columns)
    run_header = fold(profile.find_header("run") or "")
    with_channels = []
    has_run_channel = False
    for group in groups:
        channel_names = {split_header(channel.name)[0] for channel in group.channels()}
        if len(channel_names & wanted) > 1:
            with_channels.append(group)
            has_run_channel = has_run_channel or run_header in channel_names
    names = [group.name for group in with_channels]
    if profile.groups:
        missing = [name for name in profile.groups if name not in names]
        if missing:
            text = say("There is no group '{name}'; the groups with channels are {names}.")
            said = say(text, name=missing[0], names=quote_names(names))
            raise DefectiveHeaderError(
                "missing_column", said, None, (profile.ask("groups", '["?"]'),)
            )
        by_name = dict(zip(names, with_channels, strict=True))
        return list(enumerate(map(by_name.__getitem__, profile.groups), start=1))
    if len(with_channels) == 1 and has_run_channel:
        return [(None, with_channels[0])]
    if not with_channels:
        return list(enumerate(groups[:1], start=1))  # what is missing is told of the first
    numbers = []
    for name in names:
        digits = re.findall(r"[0-9]+", name)
        numbers.append(int(digits[-1]) if digits else 0)
    if len(names) > MOST_RUNS or numbers != sorted(numbers):
        text = say("The groups are {names}, and it is not clear which run each of them is.")
        said = say(text, names=quote_names(names))
        raise DefectiveHeaderError("unknown_run", said, None, (profile.ask("groups", '["?"]'),))
    return list(enumerate(with_channels, start=1))


def _read_group(
    path: Path,
    name: str,
    channels: Sequence[Any],
    columns: dict[str, FoundColumn],
    profile: SeasonProfile,
) -> pl.DataFrame:
    """Return the channels of a group, slower ones held to the rate of the fastest."""
    found: dict[str, np.ndarray[Any, Any]] = {}
    steps: dict[str, float | None] = {}
    for key, column in columns.items():
        try:
            values = np.asarray(channels[column.index][:], dtype=np.float64)
        except (TypeError, ValueError) as error:
            raise _damaged_error(path, "TDMS", error) from error
        if key == "gps" and not len(values):
            continue
        found[key] = values
        steps[key] = channels[column.index].properties.get("wf_increment")
    rows = max(map(len, found.values()), default=0)
    fastest = next((key for key, values in found.items() if len(values) == rows), "")
    for key, values in found.items():
        if len(values) == rows:
            continue
        step, fast_step = steps[key], steps[fastest]
        is_declared = key in profile.hold
        ratio = step / fast_step if step and fast_step else None
        if ratio is None and is_declared and len(values):
            ratio = rows / len(values)
        if ratio is None or ratio <= 1 or abs(len(values) * ratio - rows) > ratio:
            text = say(
                "group '{group}': channel '{channel}' has {number} samples and '{other}' {most}. "
                'If it is sampled at a slower rate, say so: hold = ["{key}"] under [[profile]] in '
                "archief.toml."
            )
            said = say(
                text, group=name, channel=columns[key].header, number=len(values),
                other=columns[fastest].header, most=rows, key=key,
            )  # fmt: skip
            ask = (profile.ask("hold", '["?"]'),)
            raise DefectiveHeaderError("slow_channel", said, None, ask)
        place = np.minimum((np.arange(rows) / ratio).astype(np.int64), len(values) - 1)
        found[key] = values[place]
    frame = pl.DataFrame(found)
    header = Header(1, "", [], columns)
    return _convert_times(frame, header, profile, 1)
