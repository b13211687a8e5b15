"""Intake: what the archive holds today, and which of it the lake still has to read.

The lists of the archive are indexed when any file of it, or the code that reads them, changed;
samples only where a season's fingerprint says that something changed. Reading one season's files
is `warehouse.intake.lake`.
"""

import os
import time
from collections.abc import Collection, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from stat import S_ISDIR, S_ISLNK
from typing import Final

import polars as pl

from pipeline.blocks.run_blocks import BLOCK_SCHEMA, RunBlocks, stack_blocks
from pipeline.errors import MissingKnowledgeError
from pipeline.recompute.facts import with_boat_types, with_hand_windows
from pipeline.tables.frames import frame_of
from pipeline.tables.lake import AboutArchive, SeasonIndex
from warehouse.archive import (
    Failure,
    FileHashes,
    index_archive,
    read_published_registers,
    read_races,
)
from warehouse.archive.faults import fault_frame
from warehouse.archive.files import RACY_SECONDS
from warehouse.archive.profile import read_profiles
from warehouse.intake import lake
from warehouse.store.code import READING, code_hash
from warehouse.store.store import Store, fingerprint
from warehouse.store.unforeseen import note

LISTED: Final = ("boats", "tows", "runs", "windows")
INDEXED: Final = (
    *(f"listed_{name}" for name in (*LISTED, "files", "races")),
    *("printed_registers", "list_faults", "about_archive"),
)
"""What is kept of the archive's lists."""
UNREADABLE: Final = "unreadable_file"
"""A file that could not be read may be readable the next time, though nothing changed."""
READ: Final = ("season_tows", "season_runs", "season_index")
"""What is kept of a season, as the archive was when it was read."""
SEASON_TABLES: Final = (*READ, "blocks")
"""What is made when a season is read."""


def index(store: Store, root: Path) -> None:
    """Reads the lists of the archive and keeps them as the tables of `INDEXED`.

    Nothing is read where all of the archive lies there as it did when they were made.

    Raises:
        HerijkError: the folder is missing or holds nothing that looks like an archive.
    """
    seen = _seen(root)
    if seen and all(store.made_from(table) == seen for table in INDEXED):
        return
    hashes = FileHashes.load(store.file_hashes)
    listed = index_archive(root, hashes.hash_file)
    hashes.save(store.file_hashes)
    races, race_faults = read_races(root)
    printed, register_faults = read_published_registers(root)
    all_faults = (*listed.faults, *race_faults, *register_faults)
    for fault in all_faults:
        if isinstance(fault, Failure):
            note(store.root, (fault.tow_id or fault.path).replace(" ", "-"), fault.trace)
    about = {"simulated": listed.profiles.simulated, "root": str(root.resolve())}
    about |= listed.profiles.publication.model_dump()
    tables = {
        **{f"listed_{name}": getattr(listed, name) for name in LISTED},
        "listed_files": listed.files,
        "listed_races": races,
        "printed_registers": printed,
        "list_faults": fault_frame(all_faults),
        "about_archive": frame_of(AboutArchive, [about]),
    }
    may_heal = any(fault.reason_code == UNREADABLE for fault in all_faults)
    for name in INDEXED:
        store.write(name, tables[name], made_from="" if may_heal else seen)


def _seen(root: Path) -> str:
    """Fingerprint of the archive as it lies there, and of the code that reads its lists.

    Empty, so that the lists are read, where a file can have changed unseen: one behind a link, or
    one changed just now (`files.RACY_SECONDS`).
    """
    stats = dict(_stats(root))
    newest_ns = max((max(s.st_mtime_ns, s.st_ctime_ns) for s in stats.values()), default=0)
    is_racy = time.time_ns() - newest_ns < RACY_SECONDS * 1e9
    if is_racy or any(S_ISLNK(stat.st_mode) for stat in stats.values()):
        return ""
    files = {
        path: (stat.st_mode, stat.st_size, stat.st_mtime_ns, stat.st_ctime_ns)
        for path, stat in stats.items()
    }
    return fingerprint(str(root.resolve()), files, code_hash(*READING))


def _stats(root: Path) -> Iterator[tuple[str, os.stat_result]]:
    """What the system knows of each file and folder of an archive, by path within it."""
    for folder, folders, files in os.walk(root):
        for path in (Path(folder, name) for name in (*folders, *files)):
            with suppress(FileNotFoundError):
                yield path.relative_to(root).as_posix(), path.lstat()


Listing = dict[str, list[int]]
"""Size in bytes and time of the last change in ns of every file, by path within the archive."""


def listing(root: Path) -> Listing:
    """The files of an archive as they lie there now; none is opened, and no link is followed.

    Raises:
        MissingKnowledgeError: there is no such folder, or nothing in it: a disk not mounted.
    """
    files = {
        path: [stat.st_size, stat.st_mtime_ns]
        for path, stat in _stats(root)
        if not S_ISDIR(stat.st_mode) and not path.startswith(".") and "/." not in path
    }
    if not files:
        raise MissingKnowledgeError("there is no file at {}: is its disk there?", root)
    return files


def listed_seasons(store: Store) -> list[int]:
    """Seasons of which the archive lists tows, sorted."""
    seasons: list[int] = store.read("listed_tows")["season"].unique().sort().to_list()
    return seasons


def stale_seasons(store: Store, root: Path, wanted: Collection[int] | None = None) -> list[int]:
    """Listed seasons whose samples or blocks are not those of the archive of today."""
    profiles = read_profiles(root)

    def is_stale(season: int) -> bool:
        made_from = lake.season_fingerprint(*_listed(store, season), profiles.for_season(season))
        return any(store.made_from(table, str(season)) != made_from for table in SEASON_TABLES)

    asked = (s for s in listed_seasons(store) if wanted is None or s in wanted)
    return [season for season in asked if is_stale(season)]


def damaged_seasons(store: Store) -> list[int]:
    """Seasons that were read, and of which a table is not there any more."""
    there = {
        season: {store.made_from(table, str(season)) is not None for table in SEASON_TABLES}
        for season in listed_seasons(store)
    }
    return [season for season, is_there in there.items() if is_there == {True, False}]


def forget_unlisted_seasons(store: Store) -> None:
    """Removes the tables of seasons that the archive no longer lists."""
    listed = set(listed_seasons(store))
    for season in [int(s) for s in store.partitions("blocks") if int(s) not in listed]:
        lake.keep_only(store, season, SeasonIndex.create_empty())
        for table in SEASON_TABLES:
            store.remove(table, str(season))


def bring_in(store: Store, root: Path) -> None:
    """Brings all that changed in an archive into the lake, in this process; raises as `index`."""
    index(store, root)
    forget_unlisted_seasons(store)
    for season in stale_seasons(store, root):
        read_season(store, root, season)


def read_season(store: Store, root: Path, season: int) -> None:
    """Brings one season's samples and blocks into the lake, and keeps `SEASON_TABLES` of it.

    They are the list by which it was read, the index (where each listed tow's samples and blocks
    lie, or its fault), and the blocks of its sound tows together.
    """
    tows, runs = _listed(store, season)
    profile = read_profiles(root).for_season(season)
    season_index = lake.read_season(store, root, tows, runs, profile)
    blocks = lake.season_blocks(store, season, season_index)
    made_from = lake.season_fingerprint(tows, runs, profile)
    for name, frame in zip(SEASON_TABLES, (tows, runs, season_index, blocks), strict=True):
        store.write(name, frame, made_from, str(season))


def all_blocks(store: Store, columns: Sequence[str] | None = None) -> pl.DataFrame:
    """Blocks of all seasons, or some of their columns; those without a sound tow have none."""
    frames = [store.read("blocks", season, columns) for season in store.partitions("blocks")]
    return pl.concat([f for f in frames if f.height] or [pl.DataFrame(schema=BLOCK_SCHEMA)])


def typed_tows(store: Store) -> pl.DataFrame:
    """All sound tows with the type of their boat."""
    return with_boat_types(store.read("tows"), store.read("boats"))


def runs_with_windows(store: Store) -> pl.DataFrame:
    """The runs of all sound tows, with the windows that were given by hand."""
    return with_hand_windows(store.read("tow_runs"), store.read("hand_windows"))


def run_blocks(store: Store) -> RunBlocks:
    """The runs of all sound tows as arrays, with the windows that were given by hand."""
    return stack_blocks(all_blocks(store), runs_with_windows(store))


def _listed(store: Store, season: int) -> tuple[pl.DataFrame, pl.DataFrame]:
    tows = store.read("listed_tows").filter(pl.col("season") == season).sort("tow_id")
    runs = store.read("listed_runs").join(tows.select("tow_id"), on="tow_id", how="semi")
    return tows, runs.sort("tow_id", "run")
