"""What the archive holds: lists, samples, and of each tow the sums per second."""

import datetime as dt
from functools import partial
from typing import Final

import dagster as dg
import polars as pl
from pydantic import Field

from assets.lake import Folders, incremental, outs
from assets.workers import side_by_side
from pipeline.blocks.run_blocks import PLACE
from pipeline.errors import MissingKnowledgeError
from pipeline.studies.summaries import SUMS, second_means
from pipeline.tables.lake import SeasonIndex
from pipeline.tables.schemas import TABLES, conform
from warehouse.derive.archive_tables import archive_tables
from warehouse.intake import lake, seasons
from warehouse.store.store import Store


@dg.multi_asset(outs=outs(*seasons.INDEXED), can_subset=True)
@incremental()
def archive_lists(folders: Folders) -> dict[str, pl.DataFrame]:
    """Boats, tows, races and files of the archive, and what is wrong in the lists."""
    return seasons.index(folders.store, folders.archive_root)


NO_SAMPLES: Final = SeasonIndex.create_empty().select(
    pl.lit(None, pl.Int32).alias("season"), pl.all()
)
"""The columns of `samples`, without a row."""


class Seasons(dg.Config):
    """Which seasons to read; the others stay as they are."""

    seasons: list[int] = Field(default_factory=list)


@dg.asset
@incremental()
def samples(
    config: Seasons,
    folders: Folders,
    listed_tows: pl.DataFrame,
    listed_runs: pl.DataFrame,
    season_profiles: pl.DataFrame,  # noqa: ARG001 - how files are written: the reader asks itself
) -> pl.DataFrame:
    """Where the samples and blocks of each tow lie, or why they cannot be used."""
    store, root = folders.store, folders.archive_root
    by_season = {s: tows for (s,), tows in listed_tows.partition_by("season", as_dict=True).items()}
    read = sorted(s for s in by_season if not config.seasons or s in config.seasons)
    if by_season and not read:
        raise MissingKnowledgeError(
            "the archive lists no tow in the seasons asked for; it has tows of {}",
            ", ".join(map(str, sorted(by_season))),
        )
    known = store.read("samples")["samples_key"] if store.made_from("samples") else ()
    work = partial(seasons.read_season, store, root, listed_runs)
    whole = [s for s in read if seasons.is_read(root, listed_runs, by_season[s], known)]
    frames = [work(by_season[season]) for season in whole]
    left = [by_season[season] for season in read if season not in whole]
    frames += side_by_side(work, left, folders.settings.dask) if len(left) > 1 else map(work, left)
    if config.seasons and store.made_from("samples") is not None:
        before = store.read("samples").filter(~pl.col("season").is_in(read))
        frames.append(before.join(listed_tows, on="tow_id", how="semi"))
    index = pl.concat([NO_SAMPLES, *frames]).sort("season", "tow_id")
    lake.keep_only(store, index)
    return index


@dg.asset
@incremental()
def blocks(folders: Folders, samples: pl.DataFrame) -> pl.DataFrame:
    """Sums over each second of each run of every tow that can be used."""
    return lake.all_blocks(folders.store, samples)


@dg.multi_asset(
    outs=outs("boats", "seasons", "read_tows", "read_runs", "hand_windows", "set_aside"),
    can_subset=True,
)
@incremental()
def archive(
    folders: Folders,
    list_faults: pl.DataFrame,
    listed_boats: pl.DataFrame,
    listed_windows: pl.DataFrame,
    listed_tows: pl.DataFrame,
    listed_runs: pl.DataFrame,
    samples: pl.DataFrame,
    blocks: pl.DataFrame,
) -> dict[str, pl.DataFrame]:
    """Boats, tows that can be read with their runs and windows, and all that was set aside."""
    read = samples.select("tow_id")
    made = archive_tables(
        list_faults=list_faults,
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
        "boats": made["boats"],
        "seasons": made["seasons"],
        "read_tows": conform("tows", made["tows"]),
        "read_runs": conform("tow_runs", made["tow_runs"]),
        "hand_windows": made["hand_windows"],
        "set_aside": conform("quarantine", made["quarantine"]),
    }


def read_earlier(store: Store, table: str) -> pl.DataFrame:
    """Return a table as the last rebuild left it; empty where there was none."""
    if store.made_from(table) is None:
        return TABLES[table].create_empty()
    return store.read(table)


@dg.asset
@incremental(may_fail=True)
def trace_seconds(tows: pl.DataFrame, blocks: pl.DataFrame) -> pl.DataFrame:
    """The traces of all runs of sound tows."""
    of_all = blocks.select(*dict.fromkeys(("tow_id", *PLACE, *SUMS)))
    return second_means(of_all.join(tows, on="tow_id", how="semi", maintain_order="left"))
