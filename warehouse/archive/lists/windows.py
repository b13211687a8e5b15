"""The windows given by hand, one row per run that a person cut.

Rows are read, and compared with the tows of that year, here. How long a run is, is only known when
its samples are read; `outside_run` is asked then.
"""

from collections.abc import Collection, Mapping
from functools import partial
from pathlib import Path

import polars as pl

from pipeline.messages import say
from pipeline.tables.row import Row
from warehouse.archive.faults import Fault, at_line
from warehouse.archive.files.list_kinds import WINDOWS
from warehouse.archive.sheets.reading import read_lists
from warehouse.archive.sheets.row import ListRow
from warehouse.archive.spelling.text import shorten
from warehouse.archive.spelling.wording import Wording

RunsOf = Mapping[tuple[int, str | None], Collection[int]]
"""The runs of every listed tow, by season and `sleep_id`; none of one that is set aside."""


def read_windows(
    root: Path, wording: Wording, runs_of: RunsOf
) -> tuple[pl.DataFrame, tuple[Fault, ...]]:
    """The windows for tows that are not set aside (`ListedWindows`), and the faulty rows.

    Two windows for one run cost both, as nobody can know which is right.
    """
    windows, faults = read_lists(root, WINDOWS, wording, partial(_window, runs_of))
    usable = {tow_id for (_, tow_id), runs in runs_of.items() if runs}
    wanted = windows.filter(pl.col("tow_id").is_in(usable))
    is_twice = pl.struct("tow_id", "run").is_duplicated()
    twice = map(_given_twice, wanted.filter(is_twice).iter_rows(named=True))
    return wanted.filter(~is_twice), (*faults, *twice)


def outside_run(windows: pl.DataFrame, seconds: pl.DataFrame) -> list[Fault]:
    """A fault for each window that ends after its run.

    Args:
        windows: rows of `ListedWindows`.
        seconds: `tow_id`, `run` and the run's length in whole `seconds`.
    """
    listed = windows.join(seconds, on=["tow_id", "run"], maintain_order="left")
    beyond = listed.filter(pl.col("end_s") > pl.col("seconds"))
    message = say(
        "the window of run {run} of tow {tow} ends at {end} s, but the run lasts {seconds} s."
    )
    return [
        _fault(
            window, "window_outside_run", message, end=window["end_s"], seconds=window["seconds"]
        )
        for window in beyond.iter_rows(named=True)
    ]


def check_order(row: ListRow, window: Row) -> None:
    """Raises where a window, or the time that a lamp burned, does not end after it begins."""
    start, end = window["start_s"], window["end_s"]
    if start >= end:
        message = say("'van' is {start} s and 'tot' {end} s; a window ends after it begins.")
        raise row.fault(say(message, start=start, end=end))


def _window(runs_of: RunsOf, row: ListRow, season: int) -> Row:
    window = row.values(WINDOWS.columns)
    check_order(row, window)
    tow_id = window["tow_id"]
    if (season, tow_id) not in runs_of:
        message = say("sleep_id {tow} is not in the tow list of that year.", tow=shorten(tow_id))
        raise row.fault(message, "window_unknown_tow")
    runs = runs_of[season, tow_id]
    if runs and window["run"] not in runs:
        message = say("tow {tow} has no run {run}.", tow=tow_id, run=row.text("run"))
        raise row.fault(message, "window_unknown_run")
    return window


def _given_twice(window: Row) -> Fault:
    message = say("run {run} of tow {tow} has more than one window; none of them counts.")
    return _fault(window, "window_given_twice", message)


def _fault(window: Row, reason_code: str, message: str, **values: object) -> Fault:
    said = say(message, run=window["run"], tow=window["tow_id"], **values)
    line = window["line"]
    return Fault(window["path"], None, line, reason_code, at_line(line, said))
