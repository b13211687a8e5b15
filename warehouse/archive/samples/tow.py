"""Reading the samples of a tow: one file or sheet, two, or one for every run."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import polars as pl

from pipeline.channels import SECOND_FILE_OFFSET
from pipeline.errors import DefectiveInputError
from pipeline.tables.row import Row
from warehouse.archive.faults import DefectiveFileError
from warehouse.archive.files.finding import path_inside
from warehouse.archive.files.names import PARTS, SPREADSHEETS, as_one_run, kind_of, split_sheet
from warehouse.archive.profile.season import SeasonProfile
from warehouse.archive.samples.binary_files import BINARY, next_line
from warehouse.archive.samples.file import read_samples
from warehouse.archive.samples.frame import run_starts
from warehouse.archive.samples.text_files import body_of, sheets_with_samples


def read_tow_samples(root: Path, tow: Row, profile: SeasonProfile) -> pl.DataFrame:
    """Reads the samples of a tow, both files combined.

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
    """Reads a file, or the files that are a run each."""
    several = _files(root, paths, profile)
    if len(several) == 1:
        return [_read_part(root, tow, several[0], profile, None)]
    runs = runs_of_parts([Path(path).name for path in several])
    parts = zip(several, runs, strict=True)
    return [_read_part(root, tow, path, profile, run) for path, run in parts]


def _files(root: Path, paths: str, profile: SeasonProfile) -> list[str]:
    """The files or sheets that samples are in: of a workbook each sheet with samples is a run."""
    files = paths.split(PARTS)
    if len(files) > 1 or split_sheet(paths)[1] or kind_of(Path(paths)) not in SPREADSHEETS:
        return files
    try:
        sheets = sheets_with_samples(path_inside(root, paths), profile)
    except DefectiveInputError as error:
        raise DefectiveFileError(error.reason_code, error.message, error.line, paths) from error
    return [f"{paths}#{sheet}" for sheet in sheets] or files


def runs_of_parts(names: Sequence[str]) -> list[int]:
    """The run that each file of a tow is: by the number in its name, else by their order."""
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


def place_in_file(
    root: Path, tow: Row, profile: SeasonProfile, runs: pl.Series, row: int
) -> tuple[str, int]:
    """The file of a row of a tow's samples, and the line in it.

    Args:
        root: the archive.
        tow: a row of `ArchiveIndex.tows`.
        profile: the profile of its season.
        runs: the run of each sample, as `read_tow_samples` returns them.
        row: counted over the samples of the tow from 0; negative for the header.
    """
    numbers = runs.to_numpy()
    begins = int((numbers <= SECOND_FILE_OFFSET).sum())
    in_second = tow["second_path"] is not None and row >= begins
    files = _files(root, tow["second_path" if in_second else "samples_path"], profile)
    own = numbers[begins:] if in_second else numbers
    row -= begins if in_second else 0
    starts = run_starts(own)
    part = int(np.searchsorted(starts, max(row, 0), "right")) - 1 if len(files) > 1 else 0
    file = files[part]
    row -= int(starts[part])
    full = path_inside(root, file)
    if kind_of(full) in BINARY:
        return file, next_line(row)
    return file, body_of(full, profile).line(row)
