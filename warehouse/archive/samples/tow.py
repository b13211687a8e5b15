"""Reading the samples of a tow: one file or sheet, two, or one for every run."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
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
from warehouse.archive.samples.file import read_samples
from warehouse.archive.samples.text_files import sheets_with_samples

Place = Callable[[int], tuple[str, int]]
"""The file of a row of a tow's samples, counted from 0, and the line in it; of the (first) header
where the row is negative."""


def read_tow_samples(root: Path, tow: Row, profile: SeasonProfile) -> tuple[pl.DataFrame, Place]:
    """Reads the samples of a tow, all of its files combined.

    Args:
        root: the archive.
        tow: a row of `ArchiveIndex.tows`.
        profile: the profile of its season.

    Returns:
        The frame, as `read_samples`: runs of the second file are numbered 21 and on and come last.
        And where its rows stand.

    Raises:
        DefectiveFileError: the first fault, with the file it is in.
    """
    files, frames, lines = [], [], []
    for name, offset in (("samples_path", 0), ("second_path", SECOND_FILE_OFFSET)):
        paths = [] if tow[name] is None else _files(root, tow[name], profile)
        for path, run in zip(paths, runs_of_parts(paths), strict=True):
            with _named(path):
                full = path_inside(root, path)
                samples, line_of = read_samples(full, profile, tow["sample_rate_hz"], run)
            files.append(path)
            frames.append(samples.with_columns(pl.col("run") + pl.lit(offset, pl.Int8)))
            lines.append(line_of)
    ends = np.cumsum([frame.height for frame in frames])

    def place(row: int) -> tuple[str, int]:
        part = int(np.searchsorted(ends, row, "right"))
        return files[part], lines[part](row - int(ends[part - 1] if part else 0))

    return pl.concat(frames), place


def _files(root: Path, paths: str, profile: SeasonProfile) -> list[str]:
    """The files or sheets that samples are in: of a workbook each sheet with samples is a run."""
    files = paths.split(PARTS)
    if len(files) > 1 or split_sheet(paths)[1] or kind_of(Path(paths)) not in SPREADSHEETS:
        return files
    with _named(paths):
        sheets = sheets_with_samples(path_inside(root, paths), profile)
    return [f"{paths}#{sheet}" for sheet in sheets] or files


def runs_of_parts(paths: Sequence[str]) -> Sequence[int | None]:
    """The run that each of several files is: by the number in its name, else by their order."""
    if len(paths) == 1:
        return [None]
    named = [one for path in paths if (one := as_one_run(Path(path).name)) is not None]
    numbers = [run for _, run in named]
    if len({tow for tow, _ in named}) == 1 and len(set(numbers)) == len(paths):
        return numbers
    return range(1, len(paths) + 1)


@contextmanager
def _named(path: str) -> Iterator[None]:
    """Gives a fault the path that it is found in."""
    try:
        yield
    except DefectiveInputError as error:
        raise DefectiveFileError(error.reason_code, error.message, error.line, path) from error
