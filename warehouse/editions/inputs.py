"""What went into an edition: tows with their files, and per tow a hash of all it is made from.

A number depends on its own tow, and under some methods on all tows at once (a coefficient of the
whole archive). Which files still are what they were is `verify`'s.
"""

import csv
from collections.abc import Mapping
from pathlib import Path
from typing import Final

import polars as pl

from warehouse.store.editions import Manifest
from warehouse.store.store import Store, fingerprint

JUDGED: Final = ("doubts", "unusual")
"""What all other tows say of a tow."""

NOT_INPUT: Final = JUDGED + (
    "samples_path", "second_path", "inputs_sha256", "hand_reason", "list_path", "list_line",
)  # fmt: skip
"""What a tow is called or said to be does not change its numbers; its doubts follow from others."""

INPUTS_HASH: Final = "inputs_sha256"
MAKE_NUMBERS: Final = ("boats", "tows", "windows", "force_checks", "lamps", "profile")
"""Kinds of files, beside samples, that can change a number of an edition."""
OLDER_SOURCES: Final = "inputs.csv"
"""What editions up to version 1.0.0 were made from; since then the manifest and the tows say it."""


def add_input_hashes(tows: pl.DataFrame, runs: pl.DataFrame) -> pl.DataFrame:
    """Add the hash of all that the numbers of a tow are made from: list row, runs and files."""
    facts = sorted(set(runs.columns) - set(NOT_INPUT))
    of_tow = runs.sort("tow_id", "run").select(facts).rows_by_key("tow_id", include_key=True)
    measured = sorted(set(tows.columns) - set(NOT_INPUT))
    hashes = [
        fingerprint(row, of_tow.get(tow_id, []))
        for tow_id, row in zip(tows["tow_id"], tows.select(measured).iter_rows(), strict=True)
    ]
    return tows.with_columns(pl.Series(INPUTS_HASH, hashes, pl.String))


def read_tables_of_today(store: Store) -> dict[str, pl.DataFrame]:
    """Return `tows`, with the hash of their inputs, and `tow_runs` of the warehouse as it is."""
    from warehouse.intake import seasons as intake  # noqa: PLC0415 - all that reads archives

    runs = intake.read_runs_with_windows(store)
    return {"tows": add_input_hashes(intake.read_typed_tows(store), runs), "tow_runs": runs}


def find_same_tows(
    was: Mapping[str, pl.DataFrame], now: Mapping[str, pl.DataFrame]
) -> frozenset[str]:
    """Return the tows whose inputs are the same in two sets of `tows` and `tow_runs`.

    Compared is what both tables say: a fact that was not recorded earlier is no difference.
    """
    of_tow = [name for name in was["tows"].columns if name in now["tows"].columns]
    of_run = [name for name in was["tow_runs"].columns if name in now["tow_runs"].columns]
    before = add_input_hashes(was["tows"].select(of_tow), was["tow_runs"].select(of_run))
    after = add_input_hashes(now["tows"].select(of_tow), now["tow_runs"].select(of_run))
    return frozenset(before.join(after, on=["tow_id", INPUTS_HASH], how="semi")["tow_id"])


def list_files(store: Store) -> dict[str, str]:
    """Return the lists of the archive, by path, with the SHA-256 of each."""
    listed = store.read("listed_files").filter(pl.col("kind").is_in(MAKE_NUMBERS)).sort("path")
    return dict(listed.select("path", "sha256").rows())


def list_sources(path: Path, manifest: Manifest) -> dict[str, str]:
    """Return the lists, or the printed register, that an edition was made from, with SHA-256.

    Editions of before have them in `inputs.csv`. A row of another width was changed, which the
    hash of that file shows.
    """
    if manifest.sources:
        return manifest.sources
    older = path / OLDER_SOURCES
    if OLDER_SOURCES not in manifest.files or not older.is_file():
        return {}
    text = older.read_text(encoding="utf-8-sig", errors="replace")
    rows = [row for row in csv.reader(text.splitlines(), delimiter=";") if len(row) == 3]
    return {file: sha256 for file, kind, sha256 in rows[1:] if kind != "meetdata"}
