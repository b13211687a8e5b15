"""The windows given by hand: `vensters_<jaar>.csv`, one row per run that a person cut.

Rows are read, and compared with the tows of that year, here. How long a run is, is only known when
its samples are read; `outside_run` is asked then.
"""

from collections import Counter
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Final

import polars as pl

from herijk.pipeline.channels import MOST_RUNS
from herijk.pipeline.errors import DefectiveInputError
from herijk.tables.lake import ListedWindows
from herijk.tables.row import Row
from herijk.warehouse.archive.faults import Fault, fault_from
from herijk.warehouse.archive.lists import ListRow, Wording, read_list
from herijk.warehouse.archive.text import Column, shorten
from herijk.warehouse.archive.tows import run_number
from herijk.words import say

COLUMNS: Final = (
    Column("tow_id", "sleep_id"),
    Column("run", "run"),
    Column("start_s", "van", "time", "s"),
    Column("end_s", "tot", "time", "s"),
    Column("reason", "reden"),
)
Window = Row


@dataclass(frozen=True)
class Listed:
    """What a year's tow list says that a window is compared with.

    Attributes:
        tow_ids: every `sleep_id` in the list, also of tows that are set aside.
        runs: the runs of each tow that is not set aside.
    """

    tow_ids: Collection[str]
    runs: Mapping[str, Collection[int]]


def read_windows(
    data: bytes, path: str, listed: Listed, wording: Wording
) -> tuple[list[Window], list[Fault]]:
    """Return the windows of one list for tows that are not set aside, and the faulty rows.

    Two windows for one run cost both, as nobody can know which is right.

    Raises:
        DefectiveInputError: the list as a whole cannot be read.
    """
    windows: list[Window] = []
    faults: list[Fault] = []
    for row in read_list(data, COLUMNS, "bad_window_row", path, wording, ListedWindows):
        try:
            window = _read_window(row) | {"list_path": path, "list_line": row.line}
            if _is_wanted(window, row, listed):
                windows.append(window)
        except DefectiveInputError as error:
            faults.append(fault_from(error, path))
    given = Counter((w["tow_id"], w["run"]) for w in windows)
    twice = [w for w in windows if given[w["tow_id"], w["run"]] > 1]
    return [w for w in windows if w not in twice], faults + [_given_twice(w) for w in twice]


def outside_run(windows: pl.DataFrame, seconds: pl.DataFrame) -> list[Fault]:
    """Return a fault for each window that ends after its run.

    Args:
        windows: rows of `ListedWindows`.
        seconds: `tow_id`, `run` and the run's length in whole `seconds`.
    """
    beyond = windows.join(seconds, on=["tow_id", "run"], maintain_order="left").filter(
        pl.col("end_s") > pl.col("seconds")
    )
    return [
        _fault(
            window,
            "window_outside_run",
            say(
                "the window of run {run} of tow {tow} ends at {end} s, but the run lasts "
                "{seconds} s.",
                **_values(window),
                end=window["end_s"],
                seconds=window["seconds"],
            ),
        )
        for window in beyond.iter_rows(named=True)
    ]


def _read_window(row: ListRow) -> Window:
    row.check_whole()
    window: Window = {
        "tow_id": row.text("tow_id"),
        "run": run_number(row.text("run"), row, "run", range(1, MOST_RUNS + 1)),
        "start_s": row.integer("start_s"),
        "end_s": row.integer("end_s"),
        "reason": row.text("reason"),
    }
    if window["start_s"] >= window["end_s"]:
        raise row.fault(
            say(
                "'van' is {start} s and 'tot' {end} s; a window ends after it begins.",
                start=window["start_s"],
                end=window["end_s"],
            )
        )
    return window


def _is_wanted(window: Window, row: ListRow, listed: Listed) -> bool:
    """Whether the window's tow can be used; a tow that is set aside needs no window."""
    tow_id = window["tow_id"]
    if tow_id not in listed.tow_ids:
        message = say("sleep_id {tow} is not in the tow list of that year.", tow=shorten(tow_id))
        raise row.fault(message, "window_unknown_tow")
    if tow_id not in listed.runs:
        return False
    if window["run"] not in listed.runs[tow_id]:
        message = say("tow {tow} has no run {run}.", tow=tow_id, run=row.text("run"))
        raise row.fault(message, "window_unknown_run")
    return True


def _given_twice(window: Window) -> Fault:
    message = "run {run} of tow {tow} has more than one window; none of them counts."
    return _fault(window, "window_given_twice", say(message, **_values(window)))


def _values(window: Row) -> Row:
    return {"run": window["run"], "tow": window["tow_id"]}


def _fault(window: Row, reason_code: str, message: str) -> Fault:
    line = window["list_line"]
    said = say("Line {line}: {what}", line=line, what=message)
    return Fault(window["list_path"], None, line, reason_code, said)
