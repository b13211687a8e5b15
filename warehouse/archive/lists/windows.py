"""The windows given by hand, one row per run that a person cut.

Rows are read, and compared with the tows of that year, here. How long a run is, is only known when
its samples are read; `outside_run` is asked then.
"""

from collections.abc import Iterable

import polars as pl

from pipeline.messages import say
from warehouse.archive.faults import Fault, at_line
from warehouse.archive.files.finding import ArchiveFile
from warehouse.archive.files.list_kinds import WINDOWS
from warehouse.archive.profile.definition import Profiles
from warehouse.archive.sheets.reading import read_sound
from warehouse.archive.sheets.rows import cell, keep, to_table


def read_windows(
    files: Iterable[ArchiveFile], profiles: Profiles, listed: pl.DataFrame, runs: pl.DataFrame
) -> tuple[pl.DataFrame, list[Fault]]:
    """The windows for tows that are not set aside (`ListedWindows`), and the faulty rows.

    Two windows for one run cost both, as nobody can know which is right.

    Args:
        files: those of the archive.
        profiles: how the lists are worded.
        listed: `season` and `tow_id` of every listed tow.
        runs: `tow_id` and `run` of those that are not set aside.
    """
    rows, faults = read_sound(files, WINDOWS, profiles)
    rows = in_order(rows, faults, WINDOWS.reason_code)
    known = listed.unique().with_columns(is_listed=True)
    rows = rows.join(known, on=["season", "tow_id"], how="left", maintain_order="left")
    text = say("sleep_id {tow} is not in the tow list of that year.")
    is_unknown = pl.col("is_listed").is_null()
    tow = pl.col("tow_id")
    rows = keep(rows, faults, is_unknown, "window_unknown_tow", text, tow=tow)
    rows = rows.filter(tow.is_in(runs["tow_id"].implode()))
    planned = runs.select("tow_id", "run", is_planned=True)
    rows = rows.join(planned, on=["tow_id", "run"], how="left", maintain_order="left")
    text, has_none = say("tow {tow} has no run {run}."), pl.col("is_planned").is_null()
    rows = keep(rows, faults, has_none, "window_unknown_run", text, tow=tow, run=cell("run"))
    text = say("run {run} of tow {tow} has more than one window; none of them counts.")
    is_twice = pl.struct("tow_id", "run").is_duplicated()
    rows = keep(rows, faults, is_twice, "window_given_twice", text, run=pl.col("run"), tow=tow)
    return to_table(WINDOWS.table, rows, faults, WINDOWS.reason_code), faults


def in_order(rows: pl.DataFrame, faults: list[Fault], code: str) -> pl.DataFrame:
    """The windows, or the times that a lamp burned, that end after they begin."""
    start, end = pl.col("start_s"), pl.col("end_s")
    text = say("'van' is {start} s and 'tot' {end} s; a window ends after it begins.")
    return keep(rows, faults, start >= end, code, text, start=start, end=end)


def outside_run(windows: pl.DataFrame, seconds: pl.DataFrame) -> list[Fault]:
    """A fault for each window that ends after its run.

    Args:
        windows: rows of `ListedWindows`.
        seconds: `tow_id`, `run` and the run's length in whole `seconds`.
    """
    listed = windows.join(seconds, on=["tow_id", "run"], maintain_order="left")
    beyond = listed.filter(pl.col("end_s") > pl.col("seconds"))
    text = say(
        "the window of run {run} of tow {tow} ends at {end} s, but the run lasts {seconds} s."
    )
    return [
        Fault(path, None, line, "window_outside_run", at_line(line, say(text, **facts)))
        for path, line, facts in beyond.select(
            "path", "line", pl.struct("run", "seconds", tow="tow_id", end="end_s")
        ).iter_rows()
    ]
