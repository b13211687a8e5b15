"""LabVIEW's recordings, its text and TDMS, as tables of the usual form.

A recording is columns with a header; each segment, group or file can be a run. Units, names of
channels and what they mean are the business of the modules that read such tables.
"""

import logging
import re
from collections.abc import Iterable
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

import numpy as np
import polars as pl

from pipeline.errors import DefectiveInputError
from pipeline.messages import say
from warehouse.archive.files.contents import not_whole, too_large
from warehouse.archive.limits import MOST_ROWS, SAMPLES_MAX_BYTES, too_many_rows

_END_OF_HEADER: Final = "***End_of_Header***"
_SEPARATORS: Final = {"tab": "\t", "comma": ",", "semicolon": ";", "space": " "}
_SEPARATOR: Final = re.compile(r"(?im)^separator[\t,][ \t,]*(\w+)")
_NUMBER_IN_NAME: Final = re.compile(r"([0-9]{1,2})[^0-9]*$")
_NONE: Final = ("", "comment")
"""What is no channel."""
_INDEX_COLUMN: Final = "X_Value"


def is_labview(text: str) -> bool:
    """Whether a text is a LabVIEW measurement file."""
    return text[:200].lstrip("\ufeff").startswith("LabVIEW Measurement")


def labview_as_table(text: str) -> tuple[str, list[int]]:
    """A LabVIEW measurement file as a table of text with one header.

    Each segment (a header of its own, with samples below it) becomes a run where there is none:
    column `run` is put before the others. All segments have the same columns.

    Returns:
        The table, with the separator and decimal mark of the file; and the line in the file of
        each of its rows, the header's first.

    Raises:
        DefectiveInputError: `unreadable_file`.
    """
    lines = [line.rstrip("\r") for line in text.split("\n")]
    starts = [i for i, line in enumerate(lines) if line.strip().startswith(_END_OF_HEADER)]
    named = _SEPARATOR.search("\n".join(lines[: starts[0]] if starts else []))
    separator = _SEPARATORS.get(named[1].casefold(), "\t") if named else "\t"
    cells = [line.split(separator) for line in [*lines, ""]]
    headers = [[cell.strip() for cell in cells[start + 1]] for start in starts[1:]]
    columns = [[i for i, name in enumerate(x) if name.casefold() not in _NONE] for x in headers]
    if not columns or [] in columns or columns != columns[:1] * len(columns):
        said = say("This LabVIEW file has no segment header.")
        raise DefectiveInputError("unreadable_file", said)
    names, kept = headers[0], columns[0]
    of_units = next((c for c in cells[: starts[1]] if c[0].strip() == "Y_Unit_Label"), [])
    units = {place: unit.strip() for place, unit in enumerate(of_units)}
    header = [_with_unit(names[i], units.get(i, "")) for i in kept]
    counts = not _names_runs(names)
    rows, places = [separator.join(["run"] * counts + header)], [starts[1] + 2]
    for run, (start, end) in enumerate(pairwise([*starts[1:], len(lines)]), start=1):
        for number in range(start + 2, end):
            fields = dict(enumerate(cells[number]))
            if not lines[number].strip() or not _is_number(fields.get(kept[0], "")):
                break
            rows.append(separator.join([str(run)] * counts + [fields.get(i, "") for i in kept]))
            places.append(number + 1)
    return "\n".join(rows), places


def _names_runs(names: Iterable[str]) -> bool:
    """Whether a recording has a column of its own that says which run a sample is of."""
    return any(name.casefold().strip() == "run" for name in names)


def _with_unit(name: str, unit: str) -> str:
    if name == _INDEX_COLUMN:
        return "tijd [s]"
    return f"{name} [{unit}]" if unit and "[" not in name and "(" not in name else name


def _is_number(cell: str) -> bool:
    return bool(re.fullmatch(r"\s*[+-]?[0-9.,]+(?:[eE][+-]?[0-9]+)?\s*", cell)) or not cell.strip()


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
    if _names_runs(columns):
        return frame
    number = _NUMBER_IN_NAME.search(group.name)
    run = int(number[1]) if number else place
    return frame.select(pl.lit(float(run)).alias("run"), pl.all())
