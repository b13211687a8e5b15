"""A simulated archive: as its description says, every spelling used, truth only beside it."""

import json

import numpy as np
import pytest
from polars.testing import assert_frame_equal

from herijk.simulate import WorldSettings, simulate_tow, simulate_world
from herijk.simulate.archive_writer import (
    SPELLINGS,
    find_spelling,
    truth_path,
    write_simulated_archive,
)
from herijk.simulate.papers import print_register
from herijk.simulate.practice import practices, print_curve
from pipeline.errors import HerijkError, MissingKnowledgeError
from tests.warehouse.archive.conftest import Archive
from tests.worlds import run_rows, tow_rows
from warehouse.archive import read_published_registers

SETTINGS = WorldSettings(tows_per_season=2, rate_hz=20)
RUNS = ("tow_id", "run", "direction", "target_speed_ratio", "selected")


@pytest.fixture(scope="module")
def world():
    return simulate_world(SETTINGS)


@pytest.fixture(scope="module")
def archive(world, tmp_path_factory):
    directory = tmp_path_factory.mktemp("worlds") / "archive"
    write_simulated_archive(directory, world)
    return directory


def files(directory):
    return {
        path.relative_to(directory).as_posix(): path.read_bytes()
        for path in directory.rglob("*")
        if path.is_file()
    }


def test_layout_is_the_described_one(archive, world):
    names = {name for name in files(archive) if not name.startswith("meetdata_")}
    assert names == {
        "archief.toml",
        "sloepregister/sloependata.csv",
        *(f"sloepregister/sloepregister_{season}.csv" for season in (2014, 2018)),
        "wedstrijden/spiegelrace_2018.csv",
        *(f"sleeplijsten/sleeplijst_{season}.csv" for season in SETTINGS.seasons),
    }
    samples = {tow.samples_name for tow in world.tows}
    assert {f.name.split(".")[0] for f in archive.glob("meetdata_*/*")} == samples


def test_every_allowed_spelling_occurs():
    def used(attribute):
        return {getattr(spelling, attribute) for spelling in SPELLINGS}

    assert used("extension") == {".csv", ".csv.gz", ".csv.zst", ".parquet"}
    assert used("separator") == {";", "\t", ","}
    assert used("encoding") == {"utf-8", "utf-8-sig", "cp1252"}
    assert used("line_end") == {"\n", "\r\n"}
    assert used("speed_unit") == {"m/s", "km/h", "kn"}
    assert used("force_unit") == {"N", "kgf"}
    for choice in ("decimal_comma", "signed_vane", "iso_dates", "time_column", "own_names"):
        assert used(choice) == {True, False}
    # A comma cannot both separate and mark decimals.
    assert not any(s.separator == "," and s.decimal_comma for s in SPELLINGS)
    assert len({find_spelling(season) for season in SETTINGS.seasons}) == len(SPELLINGS)


def test_truth_lies_beside_the_archive_and_never_in_it(archive, world):
    truth = json.loads(truth_path(archive).read_text(encoding="utf-8"))
    assert truth_path(archive).parent == archive.parent
    assert list(truth) == [tow.tow_id for tow in world.tows]
    for tow in world.tows:
        record = truth[tow.tow_id]
        assert record["simulated"] is True
        cw = record["cw_declared_kg_m_at_tow_temperature"]
        assert cw == pytest.approx(tow.truth.cw_at_tow_temperature_kg_m, abs=1e-4)
        curve = record["curve"]
        assert curve["speed_m_s"][8] == tow.declared_speed_m_s
        assert curve["cw_kg_m_at_tow_temperature"][8] == cw
        assert curve["cw_kg_m_at_15C"][8] == record["cw_declared_kg_m_at_15C"]
        assert [run["run"] for run in record["runs"]] == [1, 2, 3, 4, 5, 6]
    for name, data in files(archive).items():
        assert "truth" not in name
        assert b"log_factor" not in data
        assert b"cw_declared" not in data


def test_same_world_same_bytes_with_any_number_of_workers(archive, tmp_path):
    write_simulated_archive(tmp_path / "again", simulate_world(SETTINGS), workers=1)
    assert files(tmp_path / "again") == files(archive)
    assert truth_path(tmp_path / "again").read_bytes() == truth_path(archive).read_bytes()


def test_progress_is_told_once_a_tow(world, tmp_path):
    told = []
    write_simulated_archive(tmp_path / "a", world, on_tow=lambda done, n: told.append((done, n)))
    assert told == [(done, 20) for done in range(1, 21)]


def test_a_folder_with_something_in_it_is_refused(world, tmp_path):
    (tmp_path / "mine.txt").write_text("keep")
    with pytest.raises(HerijkError, match="not an empty folder"):
        write_simulated_archive(tmp_path, world)
    assert files(tmp_path) == {"mine.txt": b"keep"}


def test_an_existing_truth_file_is_not_overwritten(world, tmp_path):
    truth_path(tmp_path / "a").write_text("keep")
    with pytest.raises(HerijkError, match="nothing was written"):
        write_simulated_archive(tmp_path / "a", world)
    assert files(tmp_path) == {"a-truth.json": b"keep"}


def test_an_empty_folder_is_used_and_an_interrupted_writer_leaves_nothing(world, tmp_path):
    (tmp_path / "a").mkdir()

    def stop(done, total):
        raise MissingKnowledgeError("stopped")

    with pytest.raises(MissingKnowledgeError):
        write_simulated_archive(tmp_path / "a", world, on_tow=stop)
    assert files(tmp_path) == {}
    write_simulated_archive(tmp_path / "a", world)
    assert (tmp_path / "a" / "archief.toml").exists()
    assert {p.name for p in tmp_path.iterdir()} == {"a", "a-truth.json"}


def test_what_was_simulated_is_what_is_read_whatever_the_spelling(archive, world):
    """Lists, samples and printed registers; archives are read by code of their own."""
    scan = Archive(archive).scan()
    assert scan.faults == []
    assert scan.index.profiles.simulated
    expected = tow_rows(world)
    found = scan.index.tows.select(expected.columns)
    near = {"abs_tol": 5.1e-3, "rel_tol": 0.0, "check_dtypes": False}
    assert_frame_equal(found, expected, check_row_order=False, **near)
    assert_frame_equal(scan.index.runs.select(RUNS), run_rows(expected).select(RUNS))
    curves = {}
    for tow in world.tows:
        samples, runs = simulate_tow(world, tow)
        # Three decimals in the unit of the file.
        assert_frame_equal(scan.good[tow.tow_id], samples, abs_tol=5.1e-3, rel_tol=1e-6)
        by = practices(tow.season)
        curves[tow.tow_id] = {p: print_curve(samples, runs, tow, p) for p in by}
    read, faults = read_published_registers(archive)
    assert faults == []
    for season in read["season"].unique():
        lines = print_register(world, season, curves)
        printed = read.filter(season=season)
        assert printed["fsn_no"].to_list() == [line.boat.fsn_no for line in lines]
        for column in ("cw_kg_m", "b_m_s", "declared_speed_m_s"):
            given = [getattr(line, column) for line in lines]
            valid = printed["has_valid_curve"].to_numpy()
            assert printed[column].to_numpy()[valid] == pytest.approx(
                np.array(given)[valid], abs=0.006
            )
