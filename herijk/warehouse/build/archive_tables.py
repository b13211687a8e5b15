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
    from herijk.warehouse.build.step import Inputs

_LISTED_AT: Final = ["list_path", "list_line"]


def archive_tables(inputs: "Inputs") -> dict[str, pl.DataFrame]:
    """Boats, sound tows with their runs and windows, and everything that was set aside.

    Raises:
        MissingKnowledgeError: no tow is sound.
    """
    faults = inputs["list_faults"]
    index = inputs["season_index"]
    sound = index.filter(pl.col("reason_code").is_null()).select("tow_id")
    tows = inputs["season_tows"].join(sound, on="tow_id", how="semi")
    runs = inputs["season_runs"].join(sound, on="tow_id", how="semi")
    windows = inputs["listed_windows"].join(runs, on=["tow_id", "run"], how="semi")
    beyond = _outside_run(windows, inputs)
    unsound = index.drop_nulls("reason_code").select(Faults.column_names())
    set_aside = pl.concat([faults, beyond, unsound])
    if tows.is_empty():
        raise _nothing_sound(set_aside)
    return {
        "boats": inputs["listed_boats"],
        "seasons": _seasons(inputs["season_tows"], sound),
        "tows": tows,
        "tow_runs": runs,
        "hand_windows": windows.join(
            beyond, left_on=_LISTED_AT, right_on=["path", "line"], how="anti"
        ),
        "quarantine": _dated(set_aside, inputs.earlier("quarantine"), inputs.today),
    }


def _seasons(listed: pl.DataFrame, sound: pl.DataFrame) -> pl.DataFrame:
    """How many tows each season lists, and how many of them can be used."""
    is_sound = pl.col("tow_id").is_in(sound["tow_id"].implode())
    return listed.group_by("season").agg(pl.len().alias("listed"), is_sound.sum().alias("tows"))


def _nothing_sound(faults: pl.DataFrame) -> MissingKnowledgeError:
    """The error for an archive without any tow that can be used."""
    if faults.is_empty():
        return MissingKnowledgeError(
            "no tow can be used: the tow lists hold none in the seasons that were read; "
            "fill sleeplijsten/sleeplijst_<jaar>.csv, or widen --seasons"
        )
    first = faults.row(0, named=True)
    return MissingKnowledgeError(
        f"no tow can be used: {faults.height} tows or files are set aside. Mend the first and "
        f"try again: {first['path']}: {first['message']}"
    )


def _outside_run(windows: pl.DataFrame, inputs: "Inputs") -> pl.DataFrame:
    """Faults of windows that end after their run."""
    if windows.is_empty():
        return Faults.create_empty()
    seconds = (
        inputs["blocks"]
        .group_by("tow_id", "run")
        .agg((pl.col("second").max() + 1).alias("seconds"))
    )
    faults = outside_run(windows, seconds)
    return frame_of(Faults, map(dataclasses.asdict, faults))


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
