"""A simulated archive: as its description says, every spelling used, truth only beside it."""

import csv
import io
import json
import tomllib

import numpy as np
import polars as pl
import pytest

from herijk.simulate import WorldSettings, simulate_tow, simulate_world
from herijk.simulate.archive_writer import (
    SPELLINGS,
    spelling_of,
    truth_path,
    write_simulated_archive,
)
from herijk.simulate.papers import printed_register
from herijk.simulate.practice import practices, printed_curve
from pipeline.errors import HerijkError, MissingKnowledgeError

SETTINGS = WorldSettings(tows_per_season=2, rate_hz=20)

LIST_COLUMNS = (
    *("sleep_id", "datum", "fsn_nr", "meetfile", "meetfile2", "roeiers", "klasse"),
    *("roeisnelheid [m/s]", "lengte [m]", "breedte [m]", "hoogte [m]", "gewicht [kg]"),
    *("gewicht na [kg]", "bemanning [kg]", "watertemperatuur [C]", "correctie [%]"),
    *("gebruik runs", "verbouwd", "meetfrequentie [Hz]", "opmerking"),
)


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


def list_rows(archive, season):
    spelling = spelling_of(season)
    data = (archive / f"sleeplijsten/sleeplijst_{season}.csv").read_bytes()
    text = io.StringIO(data.decode(spelling.encoding), newline="")
    return list(csv.DictReader(text, delimiter=spelling.separator))


def sample_file(archive, tow):
    (path,) = (archive / f"meetdata_{tow.season}").glob(f"{tow.samples_name}.*")
    return path


def test_layout_is_the_described_one(archive, world):
    names = set(files(archive))
    assert "archief.toml" in names
    assert "sloepregister/sloependata.csv" in names
    assert {"sloepregister/sloepregister_2014.csv", "sloepregister/sloepregister_2018.csv"} <= names
    assert "wedstrijden/spiegelrace_2018.csv" in names
    samples = {sample_file(archive, tow).relative_to(archive).as_posix() for tow in world.tows}
    lists = {f"sleeplijsten/sleeplijst_{season}.csv" for season in SETTINGS.seasons}
    assert samples | lists <= names
    assert len(names) == len(samples) + len(lists) + 5


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
    assert len({spelling_of(season) for season in SETTINGS.seasons}) == len(SPELLINGS)


@pytest.mark.parametrize("season", SETTINGS.seasons)
def test_list_holds_what_the_federation_would_know(archive, world, season):
    rows = list_rows(archive, season)
    tows = [tow for tow in world.tows if tow.season == season]
    spelling = spelling_of(season)
    assert len(rows) == len(tows)
    for row, tow in zip(rows, tows, strict=True):
        assert tuple(row) == LIST_COLUMNS
        assert row["sleep_id"] == tow.tow_id
        assert row["meetfile"] == tow.samples_name
        assert row["datum"] in {tow.day.isoformat(), tow.day.strftime("%d-%m-%Y")}
        assert row["gebruik runs"] == "1,2,3,4,5,6"
        assert row["meetfrequentie [Hz]"] == "20"
        assert row["watertemperatuur [C]"] == spelling.number(tow.water_temperature_c, 1)
        assert row["verbouwd"] == ("ja" if tow.altered_reported else "nee")


def test_archive_says_that_it_is_simulated_and_names_its_own_columns(archive):
    profile = tomllib.loads((archive / "archief.toml").read_text(encoding="utf-8"))
    assert profile["simulated"] is True
    own = [season for season in SETTINGS.seasons if spelling_of(season).own_names]
    assert [table["seasons"] for table in profile["profile"]] == [f"{s}:{s}" for s in own]
    assert profile["profile"][0]["columns"] == {"log1": "snelheid A", "force": "trek"}
    assert profile["profile"][0]["units"] == {"force": "kgf"}


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


def test_printed_register_spells_the_curves_of_that_year(archive, world):
    spelling = spelling_of(2014)
    text = (archive / "sloepregister/sloepregister_2014.csv").read_text(spelling.encoding)
    rows = list(csv.DictReader(io.StringIO(text), delimiter=spelling.separator))
    curves = {}
    for tow in world.tows:
        samples, runs = simulate_tow(world, tow)
        by = practices(tow.season)
        curves[tow.tow_id] = {p: printed_curve(samples, runs, tow, p) for p in by}
    lines = printed_register(world, 2014, curves)
    assert [row["fsn_nr"] for row in rows] == [line.boat.fsn_no for line in lines]
    assert [row["A"] for row in rows] == [spelling.number(line.a_kg_m, 2) for line in lines]
    assert [row["Cw"] for row in rows] == [spelling.number(line.cw_kg_m, 2) for line in lines]


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


@pytest.mark.parametrize("season", SETTINGS.seasons)
def test_samples_read_back_as_simulated(archive, world, season):
    tow = next(tow for tow in world.tows if tow.season == season)
    path, spelling = sample_file(archive, tow), spelling_of(season)
    assert path.name == f"{tow.samples_name}{spelling.extension}"
    if spelling.extension == ".parquet":
        table = pl.read_parquet(path)
    else:
        table = pl.read_csv(
            path, separator=spelling.separator, decimal_comma=spelling.decimal_comma
        )
    frame, _ = simulate_tow(world, tow)
    assert table["run"].to_list() == frame["run"].to_list()
    speed = {"m/s": 1.0, "km/h": 1 / 3.6, "kn": 1852 / 3600}[spelling.speed_unit]
    force = {"N": 1.0, "kgf": 9.80665}[spelling.force_unit]
    own = spelling.own_names
    expected = {
        f"{'snelheid A' if own else 'log1'} [{spelling.speed_unit}]": ("log1_m_s", speed),
        f"log2 [{spelling.speed_unit}]": ("log2_m_s", speed),
        "trek" if own else f"kracht [{spelling.force_unit}]": ("force_n", force),
        f"wind [{spelling.speed_unit}]": ("wind_speed_m_s", speed),
    }
    if season >= 2011:
        expected[f"gps [{spelling.speed_unit}]"] = ("gps_m_s", speed)
    extra = {"tijd [s]"} if spelling.time_column else set()
    assert set(table.columns) == {"run", "wind [gra]", *expected, *extra}
    for header, (name, factor) in expected.items():
        # Three decimals in the unit of the file.
        np.testing.assert_allclose(table[header] * factor, frame[name], atol=0.51e-3 * factor)
    angle = table["wind [gra]"].to_numpy()
    assert (angle.min() < 0) == spelling.signed_vane or angle.max() <= 180
    np.testing.assert_allclose(np.mod(angle, 360.0), frame["wind_angle_deg"], atol=1e-3)
    if spelling.time_column:
        np.testing.assert_allclose(table["tijd [s]"].to_numpy()[:1001:500], [0, 25, 0])
