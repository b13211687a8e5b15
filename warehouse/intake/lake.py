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
from pipeline.tables.frames import make_frame
from pipeline.tables.lake import SeasonIndex
from pipeline.tables.row import Row
from warehouse.archive import Fault, FileHashes, SeasonProfile, make_fault
from warehouse.intake.reading import read_samples
from warehouse.store.code import ADDING, READING, hash_code
from warehouse.store.store import (
    DamagedFileError,
    Store,
    count_rows,
    fingerprint,
    read_file_metadata,
    read_parquet,
    write_parquet,
)
from warehouse.store.unforeseen import (
    UNFORESEEN,
    format_traceback,
    is_unforeseen,
    note,
    sentence,
    shorten_error,
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


def read_tows(
    store: Store,
    root: Path,
    tows: pl.DataFrame,
    runs: pl.DataFrame,
    profile: SeasonProfile,
) -> pl.DataFrame:
    """Bring the samples and blocks of tows of a season into the lake.

    Args:
        store: the data folder.
        root: the archive.
        tows: listed tows of one season.
        runs: their runs.
        profile: how that season's files are written.

    Returns:
        Their rows of `SeasonIndex`, sorted by tow.
    """
    hashes = FileHashes.load(store.file_hashes)
    runs_of = dict(runs.partition_by("tow_id", as_dict=True))

    def read(tow: Row) -> Row:
        return _bring_in_tow(store, root, tow, runs_of[tow["tow_id"],], profile, hashes)

    workers = min(2, pl.thread_pool_size())  # asked here: asking starts the threads
    with ThreadPoolExecutor(workers) as pool:
        rows = list(pool.map(read, tows.sort("tow_id").iter_rows(named=True)))
    return make_frame(SeasonIndex, rows)


def read_all_blocks(store: Store, index: pl.DataFrame) -> pl.DataFrame:
    """Return the blocks of all sound tows, sorted by season, tow, run and second.

    Args:
        store: the data folder.
        index: rows of `SeasonIndex` with `season`.

    Raises:
        DamagedFileError: samples and blocks of a tow were removed; they are read again.
    """
    sound = index.filter(pl.col("blocks_key").is_not_null()).sort("season", "tow_id")
    frames = []
    for season, blocks_key in sound.select("season", "blocks_key").iter_rows():
        path = store.blocks_path(season, blocks_key)
        if not path.exists():
            raise DamagedFileError(store.table_path("samples"))
        frames.append(read_parquet(path))
    if not frames:
        return pl.DataFrame(schema=BLOCK_SCHEMA)
    tow = np.repeat(np.arange(len(frames)), [frame.height for frame in frames])
    return pl.concat(frames).insert_column(0, sound["tow_id"].gather(tow))


def _bring_in_tow(
    store: Store,
    root: Path,
    tow: Row,
    runs: pl.DataFrame,
    profile: SeasonProfile,
    hashes: FileHashes,
) -> Row:
    """Bring the samples and blocks of a tow into the lake; return its row of `SeasonIndex`.

    A tow whose file of samples is there is not read again: the footer says what it lost. Of a tow
    that cannot be used, the row has the fault.
    """
    samples_key, blocks_key = name_files(tow, runs, profile)
    row = dict.fromkeys(SeasonIndex.column_names())
    row |= {"tow_id": tow["tow_id"], "samples_key": samples_key}
    path = store.samples_path(profile.season, samples_key)
    blocks_path = store.blocks_path(profile.season, blocks_key)
    try:
        samples = None
        stored = read_file_metadata(path, FACTS_KEY)
        facts = None if stored is None else json.loads(stored)
        if facts is None:
            samples, facts = read_samples(root, tow, runs, profile)
            _check_unchanged(root, tow, hashes)
            write_parquet(samples, path, {FACTS_KEY: json.dumps(facts)}, LAKE_FORM)
        if not blocks_path.exists():
            if samples is None:
                samples = read_parquet(path, list(SAMPLE_SCHEMA), use_threads=False)
            sums = block_sums(samples, tow["sample_rate_hz"])
            write_parquet(sums, blocks_path, form=LAKE_FORM)
    except DefectiveInputError as error:
        _check_unchanged(root, tow, hashes)
        fault = make_fault(error, tow["samples_path"], tow["tow_id"])
    except BaseException as error:
        if not is_unforeseen(error):
            raise
        note(store.root, tow["tow_id"], format_traceback(error))
        message = sentence(tow["tow_id"], shorten_error(error))
        fault = Fault(
            path=tow["samples_path"],
            tow_id=tow["tow_id"],
            reason_code=UNFORESEEN,
            message=message,
        )
    else:
        return row | facts | {"blocks_key": blocks_key, "samples": count_rows(path)}
    found = fault.to_row()
    return row | {name: found[name] for name in row.keys() & found.keys()}


class ArchiveChangedError(UnavailableError):
    """A file of the archive changed between looking through the archive and reading it."""


def _check_unchanged(root: Path, tow: Row, hashes: FileHashes) -> None:
    """Raise where a file changed: samples are named by its hash, so they must be its own.

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


def name_files(tow: Row, runs: pl.DataFrame, profile: SeasonProfile) -> tuple[str, str]:
    """Return the names (keys) of the samples and the blocks of a tow.

    Samples are named by the contents of their files, what the lists say of them, how they are read
    and the code that reads; blocks by their samples and the code that adds them up.
    """
    facts = (
        "samples_sha256", "second_sha256", "sample_rate_hz", "declared_speed_m_s",
        "samples_runs", "second_runs", "run_windows",
    )  # fmt: skip
    samples_key = fingerprint(
        [tow[name] for name in facts],
        runs.sort("run").rows(),
        dataclasses.asdict(profile),
        hash_code(*READING),
    )
    blocks_key = fingerprint(samples_key, tow["sample_rate_hz"], hash_code(*ADDING))
    return samples_key, blocks_key


def is_up_to_date(
    store: Store,
    index: pl.DataFrame,
    tows: pl.DataFrame,
    runs: pl.DataFrame,
    profile: SeasonProfile,
) -> bool:
    """Return whether rows of `samples` are those that reading tows again would give.

    Args:
        store: the data folder.
        index: rows of `samples`.
        tows: listed tows of one season.
        runs: listed runs, perhaps also of other tows.
        profile: how files of that season are written.
    """
    known = dict(index.select("tow_id", pl.struct("samples_key", "blocks_key")).iter_rows())
    runs_of = dict(runs.join(tows, on="tow_id", how="semi").partition_by("tow_id", as_dict=True))
    for tow in tows.iter_rows(named=True):
        row = known.get(tow["tow_id"])
        samples_key, blocks_key = name_files(tow, runs_of[tow["tow_id"],], profile)
        if row is None or row["samples_key"] != samples_key:
            return False
        if row["blocks_key"] not in (None, blocks_key):  # None: the tow cannot be used
            return False
    return has_files(store, index)


def has_all_files(store: Store) -> bool:
    """Return whether the samples and blocks that the table `samples` names are there."""
    return has_files(store, store.read("samples"))


def has_files(store: Store, index: pl.DataFrame) -> bool:
    """Return whether the samples and blocks of tows are there.

    Args:
        store: the data folder.
        index: rows of `samples`.
    """
    return all(path.exists() for path in list_files(store, index))


def list_files(store: Store, index: pl.DataFrame) -> set[Path]:
    """Return the paths of the samples and blocks of tows that can be used."""
    sound = index.filter(pl.col("blocks_key").is_not_null())
    paths = set()
    for season, samples_key, blocks_key in sound.select(
        "season", "samples_key", "blocks_key"
    ).iter_rows():
        paths.add(store.samples_path(season, samples_key))
        paths.add(store.blocks_path(season, blocks_key))
    return paths


def keep_only(store: Store, index: pl.DataFrame) -> None:
    """Remove samples and blocks that no row of `samples` names."""
    named = list_files(store, index)
    for kind in ("samples", "blocks"):
        for file in (store.lake / kind).glob("season=*/[!.]*.parquet"):
            if file not in named:
                file.unlink()
