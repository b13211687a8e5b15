"""The tables about the archive: boats, tows with their runs, and everything that is set aside."""

import dataclasses
import datetime as dt
from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

import polars as pl

from herijk.pipeline.errors import MissingKnowledgeError
from herijk.tables.frames import frame_of
from herijk.tables.lake import Faults
from herijk.warehouse.archive.windows import outside_run

if TYPE_CHECKING:
    from herijk.warehouse.build.inputs import Inputs

_LISTED_AT: Final = ["list_path", "list_line"]


class NothingSoundError(MissingKnowledgeError):
    """No tow of the archive can be used.

    Attributes:
        tables: what is known all the same, of which the quarantine says why.
    """

    def __init__(self, message: str, tables: Mapping[str, pl.DataFrame]) -> None:
        super().__init__(message)
        self.tables = tables


def archive_tables(inputs: "Inputs") -> dict[str, pl.DataFrame]:
    """Boats, sound tows with their runs and windows, and everything that was set aside.

    Raises:
        NothingSoundError: no tow is sound.
    """
    index = inputs["season_index"]
    sound = index.filter(pl.col("reason_code").is_null()).select("tow_id")
    present = _present_runs(inputs["blocks"])
    runs = inputs["season_runs"].join(present, on=["tow_id", "run"], how="semi")
    windows = inputs["listed_windows"].join(runs, on=["tow_id", "run"], how="semi")
    beyond = frame_of(Faults, map(dataclasses.asdict, outside_run(windows, present)))
    unsound = index.drop_nulls("reason_code").select(Faults.column_names())
    set_aside = pl.concat([inputs["list_faults"], beyond, unsound])
    found = {
        "boats": inputs["listed_boats"].unique("fsn_no", keep="last", maintain_order=True),
        "seasons": _seasons(inputs["season_tows"], sound),
        "tows": inputs["season_tows"].join(sound, on="tow_id", how="semi"),
        "tow_runs": runs,
        "hand_windows": windows.join(
            beyond, left_on=_LISTED_AT, right_on=["path", "line"], how="anti"
        ),
        "quarantine": _dated(set_aside, inputs.earlier("quarantine"), inputs.today),
    }
    if found["tows"].is_empty():
        raise NothingSoundError(_why_nothing(found["quarantine"]), found)
    return found


def _present_runs(blocks: pl.DataFrame) -> pl.DataFrame:
    """The runs that the samples of sound tows hold, with their length in whole `seconds`."""
    return blocks.group_by("tow_id", "run").agg((pl.col("second").max() + 1).alias("seconds"))


def _seasons(listed: pl.DataFrame, sound: pl.DataFrame) -> pl.DataFrame:
    """How many tows each season lists, and how many of them can be used."""
    is_sound = pl.col("tow_id").is_in(sound["tow_id"].implode())
    return listed.group_by("season").agg(pl.len().alias("listed"), is_sound.sum().alias("tows"))


def _why_nothing(set_aside: pl.DataFrame) -> str:
    """Why no tow can be used, by cause, and what to do."""
    if set_aside.is_empty():
        return (
            "no tow can be used: the tow lists hold none in the seasons that were read; "
            "fill sleeplijsten/sleeplijst_<jaar>.csv, or widen --seasons"
        )
    causes = set_aside["reason_code"].value_counts(sort=True).sort("count", descending=True).rows()
    counted = ", ".join(f"{number} x {reason}" for reason, number in causes)
    first = set_aside.row(0, named=True)
    return (
        f"no tow can be used: {set_aside.height} rows or files are set aside ({counted}). "
        f"All stand in the table quarantine. See them by cause with: herijk check ARCHIVE. "
        f"The first: {first['path']}: {first['message']}"
    )


def _dated(faults: pl.DataFrame, earlier: pl.DataFrame, today: dt.date) -> pl.DataFrame:
    """Faults with the day on which each was first seen, today for those that are new."""
    key = ["path", "tow_id", "line", "reason_code"]
    first = earlier.group_by(key).agg(pl.col("first_seen").min())
    return faults.join(first, on=key, how="left", nulls_equal=True).with_columns(
        pl.col("first_seen").fill_null(today)
    )


def unaccounted_tows(inputs: "Inputs", made: Mapping[str, pl.DataFrame]) -> list[str]:
    """Listed tows of the seasons read that are neither accepted nor set aside: there are none."""
    known = pl.concat([made[name].select("tow_id") for name in ("tows", "quarantine")])
    lost = inputs["season_tows"].join(known, on="tow_id", how="anti")
    return list(lost["tow_id"])
