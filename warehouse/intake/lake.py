"""The lake: samples and blocks of every tow, written once and named by content.

An archive file that did not change is not read again. A tow's samples are named by its rows of the
list, the hashes of its files, the way to read them and the code that reads; its blocks by the
samples and the code that adds them up. A fault in the samples is remembered the same way. What the
files look like is known to `warehouse.archive`, and which sums there are to
`pipeline.blocks.run_blocks`.
"""

import dataclasses
import json
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path
from typing import Final

import numpy as np
import polars as pl

from pipeline.blocks.run_blocks import BLOCK_SCHEMA
from pipeline.blocks.sums import block_sums
from pipeline.channels import SAMPLE_SCHEMA
from pipeline.errors import DefectiveInputError, UnavailableError
from pipeline.tables.frames import frame_of
from pipeline.tables.lake import SeasonIndex
from pipeline.tables.row import Row
from warehouse.archive import (
    Fault,
    FileHashes,
    SeasonProfile,
    fault_from,
    judge_samples,
    read_tow_samples,
)
from warehouse.archive.samples.frame import steps_of
from warehouse.store.code import ADDING, READING, code_hash
from warehouse.store.store import (
    DamagedFileError,
    Store,
    count_rows,
    fingerprint,
    metadata_of,
    read_parquet,
    write_parquet,
)
from warehouse.store.unforeseen import (
    UNFORESEEN,
    in_short,
    is_unforeseen,
    note,
    sentence,
    traced,
)

LAKE_FORM: Final = {
    "compression": "lz4",
    "data_page_size": 1 << 22,
    "use_dictionary": ["tow_id"],
    "write_statistics": False,
}
"""How samples and blocks are packed: measured in docs/decisions.md."""

FACTS_KEY: Final = "herijk.facts"
"""In the footer of samples: what the index says of a tow that can be used."""

Tow = Row


def read_season(
    store: Store,
    root: Path,
    tows: pl.DataFrame,
    runs: pl.DataFrame,
    profile: SeasonProfile,
) -> pl.DataFrame:
    """Brings the samples and blocks of a season's tows into the lake.

    Args:
        store: the data folder.
        root: the archive.
        tows: listed tows of one season.
        runs: their runs.
        profile: how that season's files are written.

    Returns:
        The season's index, `SeasonIndex`, sorted by tow.
    """
    hashes = FileHashes.load(store.file_hashes)
    runs_of = dict(runs.partition_by("tow_id", as_dict=True))

    def read(tow: Tow) -> Row:
        listed_runs = runs_of[tow["tow_id"],]
        key = _samples_key(tow, listed_runs, profile)
        found = _bring_in(store, root, tow, listed_runs, profile, key, hashes)
        return found | {"tow_id": tow["tow_id"]}

    workers = min(2, pl.thread_pool_size())  # asked here: asking starts the threads
    with ThreadPoolExecutor(workers) as pool:
        rows = list(pool.map(read, tows.sort("tow_id").iter_rows(named=True)))
    return frame_of(SeasonIndex, rows)


def all_blocks(store: Store, index: pl.DataFrame) -> pl.DataFrame:
    """Blocks of all sound tows, with `tow_id`, sorted by season, tow, run and second.

    Args:
        store: the data folder.
        index: rows of `SeasonIndex` with `season`.

    Raises:
        DamagedFileError: samples and blocks of a tow were removed; they are read again.
    """
    sound = index.filter(pl.col("blocks_key").is_not_null()).sort("season", "tow_id")
    paths = [store.blocks_path(*tow) for tow in sound.select("season", "blocks_key").rows()]
    if not all(path.exists() for path in paths):
        raise DamagedFileError(store.table_path("samples"))
    frames = [read_parquet(path) for path in paths]
    if not frames:
        return pl.DataFrame(schema=BLOCK_SCHEMA)
    tow = np.repeat(np.arange(len(frames)), [frame.height for frame in frames])
    return pl.concat(frames).insert_column(0, sound["tow_id"].gather(tow))


def _bring_in(
    store: Store,
    root: Path,
    tow: Tow,
    runs: pl.DataFrame,
    profile: SeasonProfile,
    key: str,
    hashes: FileHashes,
) -> Row:
    """Index row of a tow after its samples and blocks are in the lake, or with its fault.

    The footer of its samples says what it lost: a tow whose file is there is not read again.
    """
    row = dict.fromkeys(SeasonIndex.column_names()) | {"samples_key": key}
    path = store.samples_path(profile.season, key)
    blocks_key = fingerprint(key, tow["sample_rate_hz"], code_hash(*ADDING))
    blocks_path = store.blocks_path(profile.season, blocks_key)
    try:
        samples, kept = None, metadata_of(path, FACTS_KEY)
        facts = None if kept is None else json.loads(kept)
        if facts is None:
            whole, place = read_tow_samples(root, tow, profile)
            samples, faults = judge_samples(whole, place, tow, runs)
            facts = {
                "losses": [fault.as_row() for fault in faults],
                "wind_read": samples["wind_speed_m_s"].null_count() == 0,
                **steps_of(samples),
            }
            _check_unchanged(root, tow, hashes)
            named = samples.select(pl.lit(tow["tow_id"]).alias("tow_id"), pl.all())
            write_parquet(named, path, {FACTS_KEY: json.dumps(facts)}, LAKE_FORM)
        if not blocks_path.exists():
            if samples is None:
                samples = read_parquet(path, list(SAMPLE_SCHEMA), use_threads=False)
            sums = block_sums(samples, tow["sample_rate_hz"])
            write_parquet(sums, blocks_path, form=LAKE_FORM)
    except DefectiveInputError as error:
        _check_unchanged(root, tow, hashes)
        fault = fault_from(error, tow["samples_path"], tow["tow_id"])
    except BaseException as error:
        if not is_unforeseen(error):
            raise
        note(store.root, tow["tow_id"], traced(error))
        message = sentence(tow["tow_id"], in_short(error))
        fault = Fault(tow["samples_path"], tow["tow_id"], None, UNFORESEEN, message)
    else:
        return row | facts | {"blocks_key": blocks_key, "samples": count_rows(path)}
    found = fault.as_row()
    return row | {name: found[name] for name in row.keys() & found.keys()}


class ArchiveChangedError(UnavailableError):
    """A file of the archive changed between looking through the archive and reading it."""


def _check_unchanged(root: Path, tow: Tow, hashes: FileHashes) -> None:
    """Samples are named by the hash of their file, so they must be that file's.

    A file with the size and time it had when it was hashed is not read once more.
    """
    for path, sha256 in (("samples_path", "samples_sha256"), ("second_path", "second_sha256")):
        now = None  # also where a file went away
        with suppress(FileNotFoundError):
            now = tow[path] and hashes.hash_samples(root, tow[path])
        if now != tow[sha256]:
            raise ArchiveChangedError(
                "{} changed while it was read. Try again when nobody is copying files into {}",
                tow[path],
                root,
            )


def samples_keys(tows: pl.DataFrame, runs: pl.DataFrame, profile: SeasonProfile) -> set[str]:
    """What the samples of a season's tows are called."""
    runs_of = dict(runs.join(tows, on="tow_id", how="semi").partition_by("tow_id", as_dict=True))
    rows = tows.iter_rows(named=True)
    return {_samples_key(tow, runs_of[tow["tow_id"],], profile) for tow in rows}


def _samples_key(tow: Tow, runs: pl.DataFrame, profile: SeasonProfile) -> str:
    names = ("samples_sha256", "second_sha256", "sample_rate_hz", "declared_speed_m_s")
    facts = [tow[n] for n in names], runs.sort("run").rows()
    return fingerprint(*facts, dataclasses.asdict(profile), code_hash(*READING))


def keep_only(store: Store, index: pl.DataFrame) -> None:
    """Removes samples and blocks that the index does not name (any more)."""
    kept = {
        path(season, key)
        for column, path in (("samples_key", store.samples_path), ("blocks_key", store.blocks_path))
        for season, key in index.select("season", column).drop_nulls().rows()
    }
    for kind in ("samples", "blocks"):
        for file in (store.lake / kind).glob("season=*/[!.]*.parquet"):
            if file not in kept:
                file.unlink()
