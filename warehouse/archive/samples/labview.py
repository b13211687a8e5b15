"""LabVIEW's recordings, its text and TDMS, as tables of the usual form.

A recording is columns with a header; each segment, group or file can be a run. Units, names of
channels and what they mean are the business of the modules that read such tables.
"""

import logging
import re
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

import numpy as np
import polars as pl

from pipeline.errors import DefectiveInputError
from pipeline.messages import say
from warehouse.archive.files.contents import not_whole, too_large
from warehouse.archive.limits import MOST_ROWS, SAMPLES_MAX_BYTES, too_many_rows
from warehouse.archive.spelling.text import find_delimiter

_END_OF_HEADER: Final = "***End_of_Header***"
_NUMBER_IN_NAME: Final = re.compile(r"([0-9]{1,2})[^0-9]*$")
_ROW: Final = re.compile(r"\s*[+-]?[0-9.,]")
_NO_CHANNEL: Final = ("", "comment")
_INDEX_COLUMN: Final = "X_Value"


def is_labview(data: bytes) -> bool:
    """Whether a text is a LabVIEW measurement file."""
    return data.startswith(b"LabVIEW Measurement")


def labview_as_table(data: bytes) -> bytes:
    """A LabVIEW measurement file as a table of text with one header.

    Header and rows stay on their lines; all else, as what is between two segments (a header of its
    own, with samples below it), is blank. All segments have the same columns.

    Raises:
        DefectiveInputError: `unreadable_file`.
    """
    lines = [line.rstrip("\r") for line in [*data.decode().split("\n"), ""]]
    ends = [i for i, line in enumerate(lines) if line.strip().startswith(_END_OF_HEADER)][1:]
    begin = ends[0] + 1 if ends else 0
    delimiter = find_delimiter(lines[begin])
    headers = [[name.strip() for name in lines[end + 1].split(delimiter)] for end in ends]
    channels = [[i for i, n in enumerate(h) if n.casefold() not in _NO_CHANNEL] for h in headers]
    if not channels or [] in channels or channels != channels[:1] * len(channels):
        said = say("This LabVIEW file has no segment header.")
        raise DefectiveInputError("unreadable_file", said)
    names, kept = headers[0], channels[0]
    cells = (line.split(delimiter) for line in lines[:begin])
    of_units = dict(enumerate(next((c for c in cells if c[0].strip() == "Y_Unit_Label"), [])))
    table = [""] * len(lines)
    table[begin] = delimiter.join(_with_unit(names[i], of_units.get(i, "").strip()) for i in kept)
    for start, end in pairwise([*ends, len(lines)]):
        for number in range(start + 2, end):
            if not _ROW.match(lines[number]):
                break
            fields = dict(enumerate(lines[number].split(delimiter)))
            table[number] = delimiter.join(fields.get(i, "") for i in kept)
    return "\n".join(table).encode()


def _with_unit(name: str, unit: str) -> str:
    if name == _INDEX_COLUMN:
        return "tijd [s]"
    return f"{name} [{unit}]" if unit and "[" not in name and "(" not in name else name


def read_tdms(path: Path, most_rows: int | None = None) -> pl.DataFrame:
    """The channels of a TDMS file as columns; each group is a run where none is named.

    Args:
        path: the file.
        most_rows: of each group, 0 to see the columns only; None for all.

    Raises:
        DefectiveInputError: `unreadable_file` or `too_large`.
    """
    import nptdms  # type: ignore[import-untyped]  # noqa: PLC0415 - seldom needed
    from nptdms.log import log_manager  # type: ignore[import-untyped]  # noqa: PLC0415

    log_manager.set_level(logging.CRITICAL)  # what is wrong with a file is told with the file
    try:
        if path.stat().st_size > SAMPLES_MAX_BYTES:
            raise too_large(path, SAMPLES_MAX_BYTES)
        with path.open("rb") as raw, nptdms.TdmsFile.open(raw) as file:
            groups = [group for group in file.groups() if group.channels()]
            frames = [
                _group(group, place, most_rows) for place, group in enumerate(groups, start=1)
            ]
    except DefectiveInputError:
        raise
    except Exception as error:  # npTDMS raises whatever a damaged file makes Python raise
        raise not_whole(path, "TDMS", error) from error
    if not frames:
        raise DefectiveInputError("unreadable_file", say("There are no samples in the file."))
    return pl.concat(frames, how="diagonal_relaxed")


def _group(group: Any, place: int, most_rows: int | None) -> pl.DataFrame:
    columns = {}
    for channel in group.channels():
        if len(channel) > MOST_ROWS:  # said by the file, and not by its size
            raise too_many_rows(len(channel))
        unit = str(
            channel.properties.get("unit_string", "")
            or channel.properties.get("NI_UnitDescription", "")
        )
        values = np.asarray(channel[:most_rows])
        columns[_with_unit(channel.name, unit)] = pl.Series(
            values if values.dtype != object else values.astype(str)
        )
    frame = pl.DataFrame(columns)
    step = next((channel.properties.get("wf_increment", 0.0) for channel in group.channels()), 0.0)
    if step > 0 and not any(name.startswith("tijd") for name in map(str.casefold, columns)):
        frame = frame.with_columns((pl.int_range(pl.len()) * step).alias("tijd [s]"))
    if any(name.casefold().strip() == "run" for name in columns):
        return frame
    number = _NUMBER_IN_NAME.search(group.name)
    run = int(number[1]) if number else place
    return frame.select(pl.lit(float(run)).alias("run"), pl.all())
