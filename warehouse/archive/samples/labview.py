"""LabVIEW's recordings, its text and TDMS, as tables of the usual form.

A recording is columns with a header; each segment, group or file can be a run. Units, names of
channels and what they mean are the business of the modules that read such tables.
"""

import logging
import re
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
_NUMBER_IN_NAME: Final = re.compile(r"([0-9]{1,2})[^0-9]*$")
_INDEX_COLUMN: Final = "X_Value"


def is_labview(text: str) -> bool:
    """Whether a text is a LabVIEW measurement file."""
    return text[:200].lstrip("\ufeff").startswith("LabVIEW Measurement")


def labview_as_table(text: str) -> tuple[str, list[int]]:
    """A LabVIEW measurement file as a table of text with one header.

    Each segment (a header of its own, with samples below it) becomes a run where there is none:
    column `run` is put before the others.

    Returns:
        The table, with the separator and decimal mark of the file; and the line in the file of
        each of its rows, the header's first.

    Raises:
        DefectiveInputError: `unreadable_file`.
    """
    lines = [line.rstrip("\r") for line in text.split("\n")]
    about = _about(lines)
    separator = _SEPARATORS.get(about.get("separator", "tab").casefold(), "\t")
    starts = [i for i, line in enumerate(lines) if line.strip().startswith(_END_OF_HEADER)]
    if len(starts) < 2:
        said = say("This LabVIEW file has no segment header.")
        raise DefectiveInputError("unreadable_file", said)
    rows: list[str] = []
    places: list[int] = []
    for run, start in enumerate(starts[1:], start=1):
        header, kept = _segment_header(lines, start, separator)
        if not rows:
            rows.append(separator.join(["run", *(header[i] for i in kept)]))
            places.append(start + 2)
        end = starts[run + 1] if run + 1 < len(starts) else len(lines)
        for number in range(start + 2, end):
            fields = lines[number].split(separator)
            if not lines[number].strip() or not _is_number(fields[kept[0]] if fields else ""):
                break
            chosen = (fields[i] if i < len(fields) else "" for i in kept)
            rows.append(separator.join([str(run), *chosen]))
            places.append(number + 1)
    return "\n".join(rows), places


def _about(lines: list[str]) -> dict[str, str]:
    """What the head of the file says, by name."""
    properties = {}
    for line in lines[:40]:
        if line.strip().startswith(_END_OF_HEADER):
            break
        name, _, value = line.replace("\t", ",", 1).partition(",")
        properties[name.strip().casefold()] = value.strip(", \t")
    return properties


def _segment_header(lines: list[str], start: int, separator: str) -> tuple[list[str], list[int]]:
    """The header of a segment with units, and which columns hold a channel."""
    names = (
        [cell.strip() for cell in lines[start + 1].split(separator)]
        if start + 1 < len(lines)
        else []
    )
    units: list[str] = []
    for line in lines[max(0, start - 15) : start]:
        cells = line.split(separator)
        if cells[0].strip() == "Y_Unit_Label":
            units = [cell.strip() for cell in cells]
    kept = [i for i, name in enumerate(names) if name and name.casefold() != "comment"]
    if not kept:
        said = say("This LabVIEW file has no segment header.")
        raise DefectiveInputError("unreadable_file", said, start + 1)
    return [
        _with_unit(name, units[i] if i < len(units) else "") for i, name in enumerate(names)
    ], kept


def _with_unit(name: str, unit: str) -> str:
    if name == _INDEX_COLUMN:
        return "tijd [s]"
    return f"{name} [{unit}]" if unit and "[" not in name and "(" not in name else name


def _is_number(cell: str) -> bool:
    return bool(re.fullmatch(r"\s*[+-]?[0-9.,]+(?:[eE][+-]?[0-9]+)?\s*", cell)) or not cell.strip()


def read_tdms(path: Path, most_rows: int | None) -> pl.DataFrame:
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
