"""What the archive holds: its lists, the samples of every tow, and their sums per second."""

import datetime as dt
import logging
from functools import partial
from typing import Final

import dagster as dg
import polars as pl
from pydantic import Field

from assets.lake import Folders, incremental, make_outs
from assets.workers import map_in_parallel
from pipeline.blocks.run_blocks import PLACE
from pipeline.errors import MissingKnowledgeError
from pipeline.studies.summaries import SUMS, second_means
from pipeline.tables.lake import SeasonIndex
from pipeline.tables.schemas import conform
from warehouse.derive.archive_tables import archive_tables, read_earlier
from warehouse.intake import lake, seasons
from warehouse.store.code import COMPUTING, hash_code

TOWS_PER_TASK: Final = 10
"""Number of tows that a helper reads before it reports: a helper takes a second to be asked."""

READS_WITH: Final = (*COMPUTING, "warehouse.intake")
"""Packages with which samples and blocks are brought into the lake. Files are read again for fewer:
see `warehouse.store.code.READING`."""

PROGRESS: Final = "herijk.progress"
"""Logger of how many tows are read: attributes `done` and `total` of its records."""


@dg.multi_asset(outs=make_outs(*seasons.INDEXED), can_subset=True)
@incremental()
def archive_lists(folders: Folders) -> dict[str, pl.DataFrame]:
    """Boats, tows, races and files of the archive, and what is wrong in the lists."""
    return seasons.index(folders.store, folders.archive_root)


class SeasonsToRead(dg.Config):
    """Which seasons to read."""

    seasons: list[int] = Field(
        default_factory=list,
        description="Seasons whose files are read where they changed; those of other seasons stay "
        "as they are. Empty: all seasons.",
    )


@dg.asset(code_version=hash_code(*READS_WITH))
@incremental(code=READS_WITH, is_whole=lake.has_all_files)
def samples(
    config: SeasonsToRead,
    folders: Folders,
    listed_tows: pl.DataFrame,
    listed_runs: pl.DataFrame,
    season_profiles: pl.DataFrame,  # noqa: ARG001 - the reader reads the profiles itself
) -> pl.DataFrame:
    """Where the samples and blocks of each tow lie, or why they cannot be used.

    Files are read in tasks of some tows of a season, side by side. A tow whose file, row of the
    list and profile are those of the last rebuild is not read again.
    """
    store, root = folders.store, folders.archive_root
    listed = listed_tows["season"].unique().sort().to_list()
    wanted = [season for season in listed if not config.seasons or season in config.seasons]
    if listed and not wanted:
        raise MissingKnowledgeError(
            "the archive lists no tow in the seasons asked for; it has tows of {}",
            ", ".join(map(str, listed)),
        )
    nothing = SeasonIndex.create_empty().select(pl.lit(None, pl.Int32).alias("season"), pl.all())
    before = nothing if store.read_fingerprint("samples") is None else store.read("samples")
    frames, tasks, seasons_read = [], [], []
    for season in wanted:
        tows = listed_tows.filter(season=season).sort("tow_id")
        known = seasons.find_known_samples(store, root, listed_runs, tows, before)
        if known is not None:
            frames.append(known)
            continue
        seasons_read.append(season)
        tasks += [tows.slice(start, TOWS_PER_TASK) for start in range(0, len(tows), TOWS_PER_TASK)]
    read = partial(seasons.read_tows, store, root, listed_runs)
    if len(tasks) == 1:  # starting a helper would take longer
        frames.append(read(tasks[0]))
    elif tasks:
        frames += map_in_parallel(read, tasks, folders.settings.dask, partial(log_progress, tasks))
    of_others = before.filter(~pl.col("season").is_in(wanted))
    frames.append(of_others.join(listed_tows, on="tow_id", how="semi"))
    index = pl.concat([nothing, *frames]).sort("season", "tow_id")
    lake.keep_only(store, index)
    context = dg.AssetExecutionContext.get()
    context.add_asset_metadata({"seasons_read": seasons_read}, asset_key="samples")
    return index


def log_progress(tasks: list[pl.DataFrame], n_done: int) -> None:
    """Log how many tows are read, about, when a number of tasks is done."""
    total = sum(task.height for task in tasks)
    numbers = {"done": min(n_done * TOWS_PER_TASK, total), "total": total}
    logging.getLogger(PROGRESS).info("tows", extra=numbers)


@dg.asset(code_version=hash_code(*READS_WITH))
@incremental(code=READS_WITH)
def blocks(folders: Folders, samples: pl.DataFrame) -> pl.DataFrame:
    """Return the sums over each second of each run of every tow that can be used."""
    return lake.read_all_blocks(folders.store, samples)


@dg.multi_asset(
    outs=make_outs("boats", "seasons", "read_tows", "read_runs", "hand_windows", "set_aside"),
    can_subset=True,
)
@incremental()
def archive(
    folders: Folders,
    list_faults: pl.DataFrame,
    crew_classes: pl.DataFrame,
    listed_boats: pl.DataFrame,
    listed_windows: pl.DataFrame,
    listed_tows: pl.DataFrame,
    listed_runs: pl.DataFrame,
    samples: pl.DataFrame,
    blocks: pl.DataFrame,
) -> dict[str, pl.DataFrame]:
    """Boats, tows that can be read with their runs and windows, and all that was set aside."""
    read = samples.select("tow_id")
    tables = archive_tables(
        list_faults=list_faults,
        crew_classes=crew_classes,
        listed_boats=listed_boats,
        listed_windows=listed_windows,
        season_tows=listed_tows.join(read, on="tow_id", how="semi").sort("season", "tow_id"),
        season_runs=listed_runs.join(read, on="tow_id", how="semi").sort("tow_id", "run"),
        index=samples.drop("season"),
        blocks=blocks,
        quarantine_before=read_earlier(folders.store, "quarantine"),
        has_earlier_tows=not read_earlier(folders.store, "tows").is_empty(),
        today=dt.date.today(),
    )
    return {
        "boats": tables["boats"],
        "seasons": tables["seasons"],
        "read_tows": conform("tows", tables["tows"]),
        "read_runs": conform("tow_runs", tables["tow_runs"]),
        "hand_windows": tables["hand_windows"],
        "set_aside": conform("quarantine", tables["quarantine"]),
    }


@dg.asset
@incremental(may_fail=True)
def trace_seconds(tows: pl.DataFrame, blocks: pl.DataFrame) -> pl.DataFrame:
    """Return the traces of all runs of sound tows."""
    columns = list(dict.fromkeys(("tow_id", *PLACE, *SUMS)))
    of_sound_tows = blocks.select(columns).join(
        tows, on="tow_id", how="semi", maintain_order="left"
    )
    return second_means(of_sound_tows)
