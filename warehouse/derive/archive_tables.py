"""The tables about the archive: boats, tows with their runs, and everything that is set aside."""

import datetime as dt
from pathlib import Path
from typing import Final

import duckdb
import polars as pl

from pipeline.blocks.run_blocks import RunBlocks, stack_blocks
from pipeline.crews import STANDARD_CREWS
from pipeline.errors import HerijkError, MissingKnowledgeError, NoTowsYetError
from pipeline.messages import say
from pipeline.recompute.facts import add_boat_types
from pipeline.tables.frames import make_frame
from pipeline.tables.lake import Faults, SeasonIndex
from pipeline.tables.schemas import TABLES, conform
from warehouse.archive.faults import OF_A_HEADER, make_fault_frame
from warehouse.archive.list_rules import find_windows_outside_run
from warehouse.derive.plausible import add_doubts, judge, list_gross_faults
from warehouse.derive.same_samples import CONTENT, find_same_samples
from warehouse.intake import lake
from warehouse.intake import seasons as intake
from warehouse.store.database import open_database
from warehouse.store.store import Store

SAMPLES_MISSING: Final = "samples_missing"
"""Reason code of a listed tow whose file of samples is not there."""


def archive_tables(
    list_faults: pl.DataFrame,
    crew_classes: pl.DataFrame,
    listed_boats: pl.DataFrame,
    listed_windows: pl.DataFrame,
    season_tows: pl.DataFrame,
    season_runs: pl.DataFrame,
    index: pl.DataFrame,
    blocks: pl.DataFrame,
    quarantine_before: pl.DataFrame,
    has_earlier_tows: bool,
    today: dt.date,
) -> dict[str, pl.DataFrame]:
    """Return boats, sound tows with their runs and windows, and everything that was set aside.

    Raises:
        NoTowsYetError: no tow is listed or has samples, and no earlier rebuild had a tow: the
            archive is new.
        MissingKnowledgeError: no tow is sound for another reason, or where an earlier rebuild had
            some. A disk that is not mounted must not empty the register.
    """
    sound = index.filter(pl.col("reason_code").is_null()).select("tow_id")
    contents = blocks.select("tow_id", "run", "second", pl.col(CONTENT))
    contents = contents.join(sound, on="tow_id", how="semi", maintain_order="left")
    present = contents.group_by("tow_id", "run", maintain_order=True).agg(
        seconds=pl.col("second").max() + 1
    )
    listed = _add_reading_steps(season_tows.join(sound, on="tow_id", how="semi"), index)
    runs_read = season_runs.join(present, on=["tow_id", "run"], how="semi")
    tows, contradicted = judge_tows(
        add_boat_types(listed, listed_boats),
        stack_blocks(blocks, runs_read),
        contents,
        crew_classes,
    )
    sound = sound.join(tows, on="tow_id", how="semi")
    runs = runs_read.join(tows, on="tow_id", how="semi")
    windows = listed_windows.join(runs, on=["tow_id", "run"], how="semi")
    beyond = make_fault_frame(find_windows_outside_run(windows, present))
    losses = index.select(pl.col("losses").explode()).unnest("losses").drop_nulls("path")
    known = [name for name in Faults.column_names() if name in index.columns]
    unsound = index.drop_nulls("reason_code").select(known)
    set_aside = pl.concat([list_faults, beyond, unsound, losses, contradicted], how="diagonal")
    tables = {
        "boats": listed_boats.unique("fsn_no", keep="last", maintain_order=True),
        "seasons": _count_tows(season_tows, sound, losses),
        "tows": tows.join(
            _sum_losses(losses).drop("lost_s"), on="tow_id", how="left", maintain_order="left"
        ).with_columns(pl.col("runs_set_aside").fill_null(0)),
        "tow_runs": _add_lost_seconds(runs, losses),
        "hand_windows": windows.join(beyond, on=["path", "line"], how="anti"),
        "quarantine": add_first_seen(set_aside, quarantine_before, today),
    }
    if tables["tows"].is_empty():
        reasons = tables["quarantine"].drop_nulls("tow_id")["reason_code"].unique().to_list()
        # Nothing is wrong but that tows are not listed, or have no samples, yet.
        waits = tables["quarantine"].is_empty() or reasons == [SAMPLES_MISSING]
        reason = _explain_no_tows(tables["quarantine"], waits)
        if has_earlier_tows or not waits:
            raise MissingKnowledgeError(reason)
        raise NoTowsYetError(reason)
    return tables


def read_archive(store: Store, root: Path, today: dt.date | None = None) -> None:
    """Make the tables about an archive in this process, without Dagster.

    Used by who looks at an archive beside a rebuild, such as a first assessment. All tows that can
    be read count as sound: whether they can be computed is not tried.

    Args:
        store: the data folder to write them in.
        root: the archive.
        today: day that is noted where a fault is seen for the first time; that of the clock if
            left out.
    """
    tables = intake.index(store, root)
    tows = tables["listed_tows"].sort("season", "tow_id")
    runs = tables["listed_runs"]
    none = make_frame(SeasonIndex, []).insert_column(0, pl.Series("season", [], pl.Int32))
    seasons = tows.partition_by("season", maintain_order=True)
    read = [intake.read_tows(store, root, runs, own) for own in seasons]
    samples = pl.concat([none] + read)
    lake.keep_only(store, samples)
    blocks = lake.read_all_blocks(store, samples)
    made = archive_tables(
        list_faults=tables["list_faults"],
        crew_classes=tables["crew_classes"],
        listed_boats=tables["listed_boats"],
        listed_windows=tables["listed_windows"],
        season_tows=tows,
        season_runs=runs.sort("tow_id", "run"),
        index=samples.drop("season"),
        blocks=blocks,
        quarantine_before=read_earlier(store, "quarantine"),
        has_earlier_tows=False,
        today=today or dt.date.today(),
    )
    tables |= {"samples": samples, "blocks": blocks}
    for name, frame in tables.items():
        store.write(name, frame)
    for name, frame in made.items():
        store.write(name, conform(name, frame))


def read_earlier(store: Store, table: str) -> pl.DataFrame:
    """Return a table as the last rebuild left it, from the database where the lake lost it.

    Empty where there was no rebuild.
    """
    if store.read_fingerprint(table) is not None:
        return store.read(table)
    try:
        with open_database(store.database) as db:
            return pl.DataFrame(db.table(table).pl())
    except (HerijkError, duckdb.Error):  # not made yet, or damaged too
        return TABLES[table].create_empty()


def _add_reading_steps(tows: pl.DataFrame, index: pl.DataFrame) -> pl.DataFrame:
    """Add in which steps the readings are written, and whether there is a wind among them."""
    read = index.select("tow_id", "wind_read", "gps_step_m_s", "force_step_n")
    has_wind = pl.col("wind_measured") & pl.col("wind_read").fill_null(True)
    return (
        tows.join(read, on="tow_id", how="left", maintain_order="left")
        .with_columns(wind_measured=has_wind)
        .drop("wind_read")
    )


def _sum_losses(losses: pl.DataFrame) -> pl.DataFrame:
    """Return per tow how many runs are set aside, and the seconds that are left out."""
    return losses.group_by("tow_id", maintain_order=True).agg(
        (pl.col("lost") == "run").sum().alias("runs_set_aside"),
        pl.col("lost_s").filter(pl.col("lost") == "seconds").sum(),
    )


def _add_lost_seconds(runs: pl.DataFrame, losses: pl.DataFrame) -> pl.DataFrame:
    """Add the longest time that was left out of a channel of each run."""
    lost = (
        losses.filter(lost="seconds")
        .group_by("tow_id", "run", maintain_order=True)
        .agg(pl.col("lost_s").max())
    )
    return runs.join(lost, on=["tow_id", "run"], how="left", maintain_order="left").with_columns(
        pl.col("lost_s").fill_null(0.0)
    )


def judge_tows(
    tows: pl.DataFrame,
    blocks: RunBlocks,
    contents: pl.DataFrame,
    crew_classes: pl.DataFrame = STANDARD_CREWS,
) -> tuple[pl.DataFrame, pl.DataFrame]:
    """Return the tows with their doubts, and the faults of those that other tows contradict.

    Args:
        tows: rows of `tows` with `boat_type`.
        blocks: their runs.
        contents: what `same_samples` takes of the same blocks.
        crew_classes: the table of that name.
    """
    twice = find_same_samples(tows, contents)
    once = tows.join(twice, on="tow_id", how="anti")
    judged = judge(once, blocks, crew_classes)
    gross = list_gross_faults(judged, once)
    kept = add_doubts(once.join(gross, on="tow_id", how="anti"), judged)
    return kept, pl.concat([twice, gross])


def _count_tows(listed: pl.DataFrame, sound: pl.DataFrame, losses: pl.DataFrame) -> pl.DataFrame:
    """Return how many tows each season lists, how many can be used, and what is lost of these."""
    is_sound = pl.col("tow_id").is_in(sound["tow_id"].implode())
    return (
        listed.join(_sum_losses(losses), on="tow_id", how="left", maintain_order="left")
        .group_by("season", maintain_order=True)
        .agg(
            pl.len().alias("listed"),
            is_sound.sum().alias("tows"),
            pl.col("runs_set_aside", "lost_s").sum(),
        )
    )


def _explain_no_tows(set_aside: pl.DataFrame, waits_for_samples: bool) -> str:
    """Return a sentence that says why no tow can be used, by cause, and what to do."""
    if set_aside.is_empty():
        return say(
            "no tow can be used: the tow lists hold none in the seasons that were read; "
            "fill sleeplijsten/sleeplijst_<jaar>.csv, or widen --seasons"
        )
    first = set_aside.row(0, named=True)
    if waits_for_samples:
        first = set_aside.row(by_predicate=pl.col("reason_code") == SAMPLES_MISSING, named=True)
        return say(
            "no tow has samples yet: put the files that the tow lists name in meetdata_<jaar>/. "
            "The first that is missing: {}: {}",
            first["path"],
            first["message"],
        )
    causes = set_aside["reason_code"].value_counts(sort=True).sort("count", descending=True).rows()
    counted = ", ".join(f"{number} x {reason}" for reason, number in causes)
    return say(
        "no tow can be used: {} rows or files are set aside ({}). See them by cause with: herijk "
        "check ARCHIVE. The first: {}: {}",
        set_aside.height,
        counted,
        first["path"],
        first["message"],
    )


def add_first_seen(faults: pl.DataFrame, earlier: pl.DataFrame, today: dt.date) -> pl.DataFrame:
    """Add to each fault its cost and the day on which it was first seen: today for new ones.

    A fault that does not say what it costs has cost a tow, a row of a list or a file.
    """
    key = ["path", "tow_id", "line", "reason_code"]
    whole = pl.col("line").is_null() | pl.col("reason_code").is_in(OF_A_HEADER)
    of_list = pl.when(whole).then(pl.lit("file")).otherwise(pl.lit("row"))
    lost = pl.when(pl.col("tow_id").is_not_null()).then(pl.lit("tow")).otherwise(of_list)
    first = earlier.group_by(key, maintain_order=True).agg(pl.col("first_seen").min())
    return faults.join(
        first, on=key, how="left", nulls_equal=True, maintain_order="left"
    ).with_columns(pl.col("lost").fill_null(lost), pl.col("first_seen").fill_null(today))
