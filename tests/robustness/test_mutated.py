"""A mutated archive: every faulty tow is set aside or harmless, and every other row identical."""

import datetime as dt
import random
import shutil

import polars as pl
from polars.testing import assert_frame_equal

from pipeline.method import shipped_method
from tests.conftest import METHODS, Workbench
from tests.robustness.mutated import spoil_bytes, spoil_row, spoil_samples
from warehouse import intake, tables

LIST_2009 = "sleeplijsten/sleeplijst_2009.csv"
FAULTS_EACH = 18
"""Of the twenty tows of 2009; two stay whole, and all of 2014."""

ROUNDS = 18
SEEN = dt.date(2026, 11, 21)
KEPT = ("tows", "tow_runs", "run_points", "curves")
JUDGED = ("status", "flags", "list_line")
"""Judged against other tows, or where a row stands: no number."""


def results(bench: Workbench) -> dict[str, pl.DataFrame]:
    """Tables after the archive was read again and the methods applied, without Dagster."""
    store = bench.store
    intake.index(store, bench.archive)
    for season in intake.stale_seasons(store, bench.archive):
        intake.read_season(store, bench.archive, season, lambda tow, aside: None)
        intake.collect_blocks(store, season)
    tables.collect_archive(store, SEEN)
    blocks = tables.run_blocks(store)
    found = {name: store.read(name) for name in ("tows", "tow_runs", "quarantine")}
    for name in METHODS:
        applied = tables.apply_method(store, shipped_method(name), blocks)
        for table in ("run_points", "curves"):
            found[table] = (
                pl.concat([found[table], applied[table]]) if table in found else applied[table]
            )
    return found


def mutate(bench: Workbench, seed: int) -> dict[str, str]:
    """Puts a fault in most tows of 2009; returns what it is, by tow."""
    chosen = random.Random(seed)
    listed = bench.store.read("listed_tows").filter(season=2009).sort("tow_id")
    rows = listed.select("tow_id", "samples_path").rows()
    spoiled = {}
    list_file = bench.archive / LIST_2009
    lines = list_file.read_text("cp1252").rstrip("\n").split("\n")
    for tow_id, path in chosen.sample(rows, FAULTS_EACH):
        file, how = bench.archive / path, chosen.random()
        if how < 0.65:
            spoiled[tow_id] = spoil_samples(chosen, file)
        elif how < 0.75:
            spoiled[tow_id] = spoil_bytes(chosen, file)
        else:
            place = next(i for i, line in enumerate(lines) if line.startswith(f"{tow_id};"))
            lines[place], spoiled[tow_id] = spoil_row(chosen, lines[place])
    list_file.write_text("\n".join(lines) + "\n", "cp1252")
    return spoiled


def test_every_faulty_tow_is_set_aside_or_harmless_and_the_rest_identical(built, tmp_path):
    seen, harmless = set(), []
    clean = None
    shutil.copytree(built.data, tmp_path / "data")
    for seed in range(ROUNDS):
        shutil.copytree(built.archive, tmp_path / f"archive-{seed}")
        bench = Workbench(tmp_path / f"archive-{seed}", tmp_path / "data")
        clean = clean or results(Workbench(built.archive, tmp_path / "data"))
        spoiled = mutate(bench, seed)
        seen |= {(seed, tow, what) for tow, what in spoiled.items()}
        found = results(bench)
        aside = set(found["quarantine"]["tow_id"].drop_nulls())
        passed = spoiled.keys() - aside
        harmless += [(seed, tow, spoiled[tow]) for tow in sorted(passed)]
        others = ~pl.col("tow_id").is_in(list(spoiled.keys() - passed))
        assert not (aside - spoiled.keys())
        for name in KEPT:
            drop = [c for c in JUDGED if c in clean[name].columns]
            changing = [c for c in clean[name].columns if c.endswith("sha256")]
            assert_frame_equal(
                found[name].drop(drop + changing),
                clean[name].filter(others).drop(drop + changing),
                check_exact=True,
                check_row_order=False,
            )
        shutil.rmtree(bench.archive)
    assert len(seen) == ROUNDS * FAULTS_EACH >= 300
    assert len(harmless) < len(seen) / 10, harmless
