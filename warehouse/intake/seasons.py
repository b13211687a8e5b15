"""Intake: the lists of the archive, and what of the samples the lake still has to read.

Reading one season's files is `warehouse.intake.lake`.
"""

import dataclasses
import json
import os
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Final

import polars as pl

from pipeline.blocks.run_blocks import RunBlocks, stack_blocks
from pipeline.errors import MissingKnowledgeError
from pipeline.messages import LANGUAGES
from pipeline.recompute.facts import add_boat_types, add_hand_windows
from pipeline.tables.frames import make_frame
from pipeline.tables.lake import AboutArchive
from warehouse.archive import (
    Failure,
    FileHashes,
    index_archive,
    read_published_registers,
    read_races,
)
from warehouse.archive.faults import make_fault_frame
from warehouse.archive.profile import read_profiles
from warehouse.intake import lake
from warehouse.store.store import Store, fingerprint
from warehouse.store.unforeseen import note

INDEXED: Final = (
    "listed_boats", "listed_tows", "listed_runs", "listed_windows", "listed_files", "listed_races",
    "listed_acceptances", "printed_registers", "list_faults", "about_archive", "season_profiles",
    "crew_classes",
)  # fmt: skip
"""What is kept of the archive's lists."""


def index(store: Store, root: Path) -> dict[str, pl.DataFrame]:
    """Return the tables of `INDEXED`: what the lists of the archive say today.

    Raises:
        HerijkError: the folder is missing or holds nothing that looks like an archive.
    """
    hashes = FileHashes.load(store.file_hashes)
    listed = index_archive(root, hashes.hash_file)
    hashes.save(store.file_hashes)
    races, race_faults = read_races(root)
    printed, register_faults = read_published_registers(root)
    all_faults = list(listed.faults) + race_faults + register_faults
    for fault in all_faults:
        if isinstance(fault, Failure):
            note(store.root, (fault.tow_id or fault.path).replace(" ", "-"), fault.trace)
    about = {"simulated": listed.profiles.simulated, "root": str(root.resolve())}
    about |= listed.profiles.publication.model_dump()
    names = {crew.code: crew.name for crew in listed.profiles.crew}
    about["crew_names"] = json.dumps(names) if names else None
    languages = tuple(dict.fromkeys(listed.profiles.languages))
    about["languages"] = " ".join(languages) if languages != LANGUAGES else None
    profiles = []
    for season in listed.tows["season"].unique().sort():
        profile = dataclasses.asdict(listed.profiles.find(season))
        profiles.append((season, fingerprint(profile)))
    schema = {"season": pl.Int64, "profile": pl.String}
    return {
        "listed_boats": listed.boats,
        "listed_tows": listed.tows,
        "listed_runs": listed.runs,
        "listed_windows": listed.windows,
        "listed_acceptances": listed.acceptances,
        "listed_files": listed.files,
        "listed_races": races,
        "printed_registers": printed,
        "list_faults": make_fault_frame(all_faults),
        "about_archive": make_frame(AboutArchive, [about]),
        "crew_classes": listed.profiles.crew_classes,
        "season_profiles": pl.DataFrame(profiles, schema, orient="row"),
    }


def find_known_samples(
    store: Store, root: Path, runs: pl.DataFrame, tows: pl.DataFrame, before: pl.DataFrame
) -> pl.DataFrame | None:
    """Return the rows of `samples` of a season of which no file has to be read, or None.

    Args:
        store: the data folder.
        root: the archive.
        runs: listed runs.
        tows: all listed tows of the season.
        before: rows of `samples` of the last rebuild.
    """
    profile = read_profiles(root).find(tows["season"][0])
    own = before.join(tows, on="tow_id", how="semi").sort("tow_id")
    return own if lake.is_up_to_date(store, own, tows, runs, profile) else None


def read_tows(store: Store, root: Path, runs: pl.DataFrame, tows: pl.DataFrame) -> pl.DataFrame:
    """Bring the samples and blocks of some tows of a season into the lake.

    Returns:
        Their rows of `samples`, sorted by tow.
    """
    season = tows["season"][0]
    own = runs.join(tows, on="tow_id", how="semi")
    index = lake.read_tows(store, root, tows, own, read_profiles(root).find(season))
    return index.select(pl.lit(season).cast(pl.Int32).alias("season"), pl.all())


Listing = dict[str, list[int]]
"""Size in bytes and time of the last change in ns of every file, by path within the archive."""


def listing(root: Path) -> Listing:
    """Return the files of an archive as they lie there now; none is opened.

    Raises:
        MissingKnowledgeError: there is no such folder, or nothing in it: a disk not mounted.
    """
    files = {}
    for folder, _, names in os.walk(root):
        for name in names:
            path = Path(folder, name)
            place = path.relative_to(root).as_posix()
            if place.startswith(".") or "/." in place:
                continue
            with suppress(FileNotFoundError):
                stat = path.stat()
                files[place] = [stat.st_size, stat.st_mtime_ns, stat.st_ctime_ns]
    if not files:
        raise MissingKnowledgeError("there is no file at {}: is its disk there?", root)
    return files


def read_all_blocks(store: Store, columns: Sequence[str] | None = None) -> pl.DataFrame:
    """Return the blocks of all seasons, or some of their columns."""
    return store.read("blocks", columns=columns)


def read_typed_tows(store: Store) -> pl.DataFrame:
    """Return all sound tows with the type of their boat."""
    return add_boat_types(store.read("tows"), store.read("boats"))


def read_runs_with_windows(store: Store) -> pl.DataFrame:
    """Return the runs of all sound tows, with the windows that were given by hand."""
    return add_hand_windows(store.read("tow_runs"), store.read("hand_windows"))


def run_blocks(store: Store) -> RunBlocks:
    """Return the runs of all sound tows as arrays, with the windows that were given by hand."""
    return stack_blocks(read_all_blocks(store), read_runs_with_windows(store))
