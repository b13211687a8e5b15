"""The tables as files: a data package that other programs open, read and believe."""

import json
from pathlib import Path

import polars as pl
import pytest

from pipeline.tables.schemas import ABOUT, TABLES
from tests.conftest import Workbench
from warehouse.derive.database import LAKE_ONLY
from warehouse.store.files import file_sha256
from warehouse.store.package import package_is_whole, write_package
from warehouse.store.store import write_parquet

NAMES = sorted({*TABLES} - {*LAKE_ONLY})
MEASURED = {"simulated": "false", "code_version": "1"}
OWNED = {"publisher": "The federation", "licence": "https://example.org/licence"}


@pytest.fixture(scope="module")
def folder(built: Workbench) -> Path:
    return built.store.table_folder


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
    assert sorted(resource.name for resource in package.resources) == NAMES
    for resource in package.resources:
        frame = pl.read_parquet(folder / resource.path)
        key = resource.schema.primary_key
        assert not key or not frame.select(key).is_duplicated().any(), resource.path
        assert [field.name for field in resource.schema.fields] == frame.columns
        assert resource.hash == f"sha256:{file_sha256(folder / resource.path)}"
    assert package.licenses == [{"name": "CC0-1.0"}]
    assert "Simulated" in package.description
    assert [source["title"].split()[0] for source in package.sources] == [
        "samples", "method", "method",
    ]  # fmt: skip


def described(folder: Path, **about: str) -> dict:
    """The description of a folder with the tables of a database about itself, empty."""
    files = {folder / f"{name}.parquet": schema for name, schema in ABOUT.items()}
    for path, schema in files.items():
        write_parquet(schema.create_empty(), path)
    write_package(folder, files, MEASURED | about, [("a", "0" * 64)])
    return _read(folder / "datapackage.json")


def test_a_damaged_file_is_noticed_and_described_again(tmp_path):
    described(tmp_path)
    assert package_is_whole(tmp_path)
    (tmp_path / "contents.parquet").write_bytes(b"PAR1")
    assert not package_is_whole(tmp_path)
    described(tmp_path)
    assert package_is_whole(tmp_path)


def test_publisher_and_licence_are_those_of_the_archive(tmp_path):
    package = described(tmp_path, publisher="The federation", licence="https://example.org/licence")
    assert package["licenses"] == [{"path": "https://example.org/licence"}]
    assert package["contributors"] == [{"title": "The federation", "roles": ["publisher"]}]
    package = described(tmp_path)
    assert "licenses" not in package
    assert "declares no licence" in package["description"]
