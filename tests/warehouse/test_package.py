"""The tables as files: a data package that other programs open, read and believe."""

import json
from pathlib import Path

import duckdb
import polars as pl
import pytest

from herijk.tables.schemas import ABOUT, TABLES
from herijk.warehouse.build.inputs import LAKE_ONLY
from herijk.warehouse.store.files import file_sha256
from herijk.warehouse.store.package import Origin, Rights, package_is_whole, write_package
from tests.conftest import Workbench

NAMES = sorted({*TABLES, *ABOUT} - {*LAKE_ONLY})
RIGHTS = Rights("The federation", "https://example.org/licence")
MEASURED = Origin("1", False, RIGHTS, (("a", "0" * 64),))


@pytest.fixture(scope="module")
def folder(built: Workbench) -> Path:
    return built.data / "tables"


def _read(path: Path) -> dict:
    return json.loads(path.read_text(encoding="utf-8"))


def test_the_folder_is_a_data_package(folder: Path):
    """By the standard's own program; its reader of Parquet gives NaN for an empty field."""
    import frictionless  # noqa: PLC0415 - takes seconds to import

    package = frictionless.Package(str(folder / "datapackage.json"))
    misread = frictionless.Checklist(skip_errors=["type-error", "constraint-error"])
    for name in ("boats", "curves", "register"):
        report = package.get_resource(name).validate(misread)
        assert report.valid, report.flatten(["type", "message"])
    assert [resource.name for resource in package.resources] == NAMES
    for resource in package.resources:
        assert resource.hash == f"sha256:{file_sha256(folder / resource.path)}"
    assert package.licenses == [{"name": "CC0-1.0"}]
    assert "Simulated" in package.description
    assert [source["title"].split()[0] for source in package.sources] == [
        "samples", "method", "method",
    ]  # fmt: skip


def test_other_programs_read_what_the_database_holds(built: Workbench, folder: Path):
    """Declared keys single out rows, and DuckDB, pandas and Polars read the same."""
    import pandas as pd  # noqa: PLC0415 - takes seconds to import

    for resource in _read(folder / "datapackage.json")["resources"]:
        path = folder / resource["path"]
        frame = pl.read_parquet(path)
        assert frame.equals(built.table(resource["name"])), path
        key = resource["schema"]["primaryKey"]
        assert not key or not frame.select(key).is_duplicated().any(), path
        assert [f["name"] for f in resource["schema"]["fields"]] == frame.columns
        assert resource["rowcount"] == frame.height
    path = folder / "curves.parquet"
    assert pd.read_parquet(path)["cw_kg_m"].tolist() == pl.read_parquet(path)["cw_kg_m"].to_list()
    assert duckdb.read_parquet(str(path)).fetchall() == pl.read_parquet(path).rows()


def test_catalogues_find_the_same_files(folder: Path):
    catalogue, package = _read(folder / "dcat.jsonld"), _read(folder / "datapackage.json")
    found = {
        (d["dcat:downloadURL"]["@id"], f"sha256:{d['spdx:checksum']['spdx:checksumValue']}")
        for d in catalogue["dcat:distribution"]
    }
    assert found == {(r["path"], r["hash"]) for r in package["resources"]}
    assert catalogue["dct:license"] == {"@id": "https://spdx.org/licenses/CC0-1.0"}


def test_only_changed_tables_are_written_again(tmp_path):
    frames = {name: schema.create_empty() for name, schema in ABOUT.items()}
    write_package(tmp_path, frames, ABOUT, MEASURED)
    before = {f.name: f.stat().st_ino for f in (tmp_path / "tables").iterdir()}
    frames["about"] = pl.DataFrame({"key": ["simulated"], "value": ["false"]})
    write_package(tmp_path, frames, ABOUT, MEASURED)
    after = {f.name: f.stat().st_ino for f in (tmp_path / "tables").iterdir()}
    assert {name for name in before if before[name] == after[name]} == {"contents.parquet"}
    assert [f.name for f in tmp_path.iterdir()] == ["tables"]
    package = _read(tmp_path / "tables" / "datapackage.json")
    assert package["licenses"] == [{"path": "https://example.org/licence"}]
    assert package["contributors"] == [{"title": "The federation", "roles": ["publisher"]}]


def test_a_damaged_file_is_noticed_and_made_again(tmp_path):
    frames = {name: schema.create_empty() for name, schema in ABOUT.items()}
    write_package(tmp_path, frames, ABOUT, MEASURED)
    assert package_is_whole(tmp_path)
    (tmp_path / "tables" / "contents.parquet").write_bytes(b"PAR1")
    assert not package_is_whole(tmp_path)
    write_package(tmp_path, frames, ABOUT, MEASURED)
    assert package_is_whole(tmp_path)


def test_without_a_declared_licence_none_is_given(tmp_path):
    frames = {name: schema.create_empty() for name, schema in ABOUT.items()}
    write_package(tmp_path, frames, ABOUT, Origin("1", False, Rights(), ()))
    package = _read(tmp_path / "tables" / "datapackage.json")
    assert "licenses" not in package
    assert "declares no licence" in package["description"]
    assert "dct:license" not in _read(tmp_path / "tables" / "dcat.jsonld")
