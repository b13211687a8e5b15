"""A rebuild does what changed and nothing else, and loses no tow without saying so."""

import shutil
from collections.abc import Callable
from pathlib import Path
from unittest import mock

import polars as pl
import pytest
from polars.testing import assert_frame_equal

import warehouse.intake.reading
from assets.report import Done
from pipeline.errors import BrokenPromiseError, MissingKnowledgeError
from tests.conftest import METHODS, SMALL, STUDIES, Workbench
from tests.tables import digest_table

pytestmark = pytest.mark.more

TOWS_2009 = "sleeplijsten/sleeplijst_2009.csv"
ONE = METHODS[:1]
"""Enough where a test is not about methods."""


def list_samples_files(bench: Workbench, season: int) -> list[Path]:
    return sorted((bench.archive / f"meetdata_{season}").iterdir())


def spoil(file: Path) -> bytes:
    """Puts a run that does not exist on line 5 of a samples file; gives the old content."""
    kept = file.read_bytes()
    lines = kept.split(b"\n")
    lines[4] = b"77" + lines[4]
    file.write_bytes(b"\n".join(lines))
    return kept


def tow_of(bench: Workbench, file: Path) -> str:
    path = file.relative_to(bench.archive).as_posix()
    return bench.store.read("listed_tows").filter(samples_path=path)["tow_id"].item()


def assert_same_tables(one: dict[str, pl.DataFrame], other: dict[str, pl.DataFrame]) -> None:
    assert one.keys() == other.keys()
    for name, frame in one.items():
        assert_frame_equal(frame, other[name], check_exact=True)


SUMMED_UP = ("season_ladder", "vote_lines", "vote_races", "changes_by_cause", "contents")
"""Tables about studies and comparisons of types, besides their own."""


def without_studies(tables: dict[str, pl.DataFrame]) -> dict[str, pl.DataFrame]:
    """The tables that a rebuild makes also where it is not whole."""
    left_out = {*SUMMED_UP, *STUDIES}
    return {n: t.drop("causes", strict=False) for n, t in tables.items() if n not in left_out}


def when_read(
    monkeypatch: pytest.MonkeyPatch, change: Callable[[list[str]], object] = len
) -> list[str]:
    """Tows whose archive files are opened from now on; before each a change is made."""
    read: list[str] = []
    original = warehouse.intake.reading.read_tow_samples

    def noted(root, tow, profile):
        read.append(tow["tow_id"])
        change(read)
        return original(root, tow, profile)

    monkeypatch.setattr(warehouse.intake.reading, "read_tow_samples", noted)
    return read


@pytest.fixture
def files_read(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Tows whose archive files were opened."""
    return when_read(monkeypatch)


def mended_while_read(bench: Workbench, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """A spoilt file becomes sound when it is first read; gives the tows that are read."""
    file = list_samples_files(bench, 2009)[3]
    kept = spoil(file)
    return when_read(monkeypatch, lambda read: len(read) > 1 or file.write_bytes(kept))


def test_a_second_rebuild_does_nothing(bench, files_read):
    before, database = bench.lake_files(), bench.store.database.stat()
    assert bench.rebuild().done == Done(seasons=[], methods=[], database=False)
    assert files_read == []
    assert bench.lake_files() == before
    after = bench.store.database.stat()
    assert (after.st_ino, after.st_mtime_ns) == (database.st_ino, database.st_mtime_ns)


def test_a_spoiled_file_leaves_alone_and_a_mended_one_comes_back_by_itself(
    bench, built, files_read
):
    file = list_samples_files(bench, 2009)[3]
    tow, before = tow_of(bench, file), bench.lake_files()
    kept = spoil(file)
    assert bench.rebuild().done == Done(seasons=[2009], methods=list(METHODS), database=True)
    assert files_read == [tow]
    set_aside = bench.table("quarantine").select("path", "tow_id", "line", "reason_code").rows()
    path = file.relative_to(bench.archive).as_posix()
    assert set_aside == [(path, tow, 5, "unknown_run")]
    for name in ("tows", "run_points", "curves"):
        others = built.table(name).filter(pl.col("tow_id") != tow)
        assert_frame_equal(bench.table(name), others, check_exact=True)
    after = bench.lake_files()
    assert len(before.keys() - after.keys()) == 2  # its samples and its blocks
    assert after.items() <= before.items()  # the others were not written again

    assert bench.rebuild().done == Done()  # a known fault is not read again either
    assert files_read == [tow]

    file.write_bytes(kept)
    assert bench.rebuild().done.seasons == [2009]
    assert files_read == [tow, tow]
    assert_same_tables(without_studies(bench.tables()), without_studies(built.tables()))
    assert bench.lake_files().keys() == before.keys()


def test_a_removed_season_leaves(bench, files_read):
    (bench.archive / TOWS_2009).unlink()
    shutil.rmtree(bench.archive / "meetdata_2009")
    assert bench.rebuild(ONE).done.seasons == []
    assert bench.table("tows")["season"].unique().to_list() == [2014]
    assert bench.table("curves")["season"].unique().to_list() == [2014]
    assert not [name for name in bench.lake_files() if "season=2009" in name]
    assert files_read == []


def test_a_remark_in_a_list_makes_nothing_again(bench, files_read):
    path = bench.archive / TOWS_2009
    header, row, *rest = path.read_text("cp1252").split("\n")
    fields = row.split(";")
    fields[header.split(";").index("opmerking")] = "roer los"
    path.write_text("\n".join([header, ";".join(fields), *rest]), "cp1252")
    assert bench.rebuild().done == Done()
    assert files_read == []


def test_a_changed_list_row_changes_its_tow_without_reading_samples(bench, built, files_read):
    path = bench.archive / TOWS_2009
    weight = built.table("tows").filter(season=2009)["weight_kg"][0]
    tow = built.table("tows").filter(season=2009)["tow_id"][0]
    lines = path.read_text("cp1252").split("\n")
    changed = [
        line.replace(f";{weight:.0f};", f";{weight + 7:.0f};", 1) if line.startswith(tow) else line
        for line in lines
    ]
    path.write_text("\n".join(changed), "cp1252")
    bench.rebuild(ONE)
    assert bench.table("tows").filter(tow_id=tow)["weight_kg"].item() == weight + 7
    assert files_read == []


def test_made_elsewhere_season_by_season_the_tables_are_the_same(
    bench, built, files_read, tmp_path
):
    elsewhere = Workbench(bench.archive, tmp_path / "other data")
    assert elsewhere.rebuild(ONE, range(2014, 2017)).done.seasons == [2014]
    assert elsewhere.table("tows")["season"].unique().to_list() == [2014]
    assert len(files_read) == SMALL.tows_per_season
    assert elsewhere.rebuild().done.seasons == [2009]
    assert len(files_read) == 2 * SMALL.tows_per_season
    found = without_studies(elsewhere.tables())
    for name, frame in without_studies(built.tables()).items():
        assert digest_table(found[name]) == digest_table(frame), name


def test_lost_lake_files_are_made_again_when_their_season_is_read(bench, built):
    """Of one tow the samples are lost, of the next the blocks."""
    before = bench.lake_files().keys()
    for first, kind in enumerate(("samples", "blocks")):
        for file in sorted((bench.data / "lake" / kind / "season=2009").iterdir())[first::2]:
            file.unlink()
    assert bench.rebuild().done.seasons == [2009]
    assert bench.lake_files().keys() == before
    assert_same_tables(bench.tables(), built.tables())


def test_the_old_database_stays_when_a_step_fails(bench, built, monkeypatch):
    spoil(list_samples_files(bench, 2009)[3])
    for place, error in (
        (
            "warehouse.derive.recomputing.recompute",
            BrokenPromiseError("a promise was broken"),
        ),
        ("warehouse.derive.database._add_table", OSError("disk full")),
    ):
        with monkeypatch.context() as patched:
            patched.setattr(place, mock.Mock(side_effect=error))
            with pytest.raises(type(error), match=str(error)):
                bench.rebuild(ONE)
        assert_same_tables(bench.tables(), built.tables())
        assert not list(bench.data.glob(".herijk-*"))
    assert bench.rebuild(ONE).done.database  # what failed is done now
    assert bench.table("quarantine").height == 1


def test_an_archive_of_which_no_tow_can_be_used_says_so_and_changes_nothing(bench, built):
    for season in SMALL.seasons:
        for file in list_samples_files(bench, season):
            file.write_bytes(b"")
    with pytest.raises(MissingKnowledgeError, match=r"no tow can be used: 40 .* set aside"):
        bench.rebuild()
    assert_same_tables(bench.tables(), built.tables())


def test_seasons_that_the_archive_does_not_have_are_refused(bench):
    with pytest.raises(MissingKnowledgeError, match="it has tows of 2009, 2014"):
        bench.rebuild(seasons=range(2030, 2031))
