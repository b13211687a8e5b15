"""The tables of the lake described for any program: a Frictionless Data Package, version 2.

`lake/tables/` can be copied and passed on as it is. Of its Parquet files, one per table or per
method, `datapackage.json` gives columns, keys, licence, sources and hashes. It is written last.
"""

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Final

import polars as pl

from warehouse.store.files import file_sha256, written_beside

if TYPE_CHECKING:
    from pipeline.tables.declare import dy

DESCRIPTOR: Final = "datapackage.json"
_TYPES: Final[Mapping[type[pl.DataType], str]] = {
    pl.Float64: "number",
    pl.String: "string",
    pl.Boolean: "boolean",
    pl.Date: "date",
    pl.List: "array",
}
"""The names of types in a package; other columns hold whole numbers."""


def write_package(
    folder: Path,
    files: "Mapping[Path, type[dy.Schema]]",
    about: Mapping[str, str],
    sources: Iterable[tuple[str, str]],
) -> None:
    """Describes tables that lie there.

    Args:
        folder: holds the files, and their description.
        files: the declared table of each file.
        about: the rows of the table of that name.
        sources: title and hash of all that they were made from.
    """
    publisher, licence = about.get("publisher"), about.get("licence", "")
    said = ["A file per table or method; SI units, named in each field."]
    if about["simulated"] == "true":
        said.insert(0, "Simulated: these are not the federation's measurements.")
    if not licence:
        said.append("The archive declares no licence. Ask its owner before passing this on.")
    package = {
        "$schema": "https://datapackage.org/profiles/2.0/datapackage.json",
        "name": "herijk",
        "title": "Tow tests, curves and registers of Dutch rowing sloops, recomputed by Herijk",
        "description": " ".join(said),
        "version": about["code_version"],
        "contributors": [{"title": publisher, "roles": ["publisher"]}] if publisher else None,
        "licenses": [{"path" if "://" in licence else "name": licence}] if licence else None,
        "sources": [{"title": title, "sha256": sha256} for title, sha256 in sources],
        "resources": [_resource(folder, path, schema) for path, schema in sorted(files.items())],
    }
    known = {name: value for name, value in package.items() if value is not None}
    with written_beside(folder / DESCRIPTOR) as beside:
        beside.write_text(json.dumps(known, indent=1, ensure_ascii=False), encoding="utf-8")


def _resource(folder: Path, path: Path, schema: "type[dy.Schema]") -> dict[str, object]:
    """One file; that of a method is named `table.method`."""
    within = path.relative_to(folder)
    fields = [
        {
            "name": name,
            "type": _TYPES.get(column.dtype.base_type(), "integer"),
            "description": column.description,
            "unit": (column.metadata or {}).get("unit", ""),
            "constraints": {"required": not column.nullable},
        }
        for name, column in schema.columns().items()
    ]
    return {
        "name": ".".join(within.with_suffix("").parts),
        "type": "table",
        "path": within.as_posix(),
        "format": "parquet",
        "description": schema.__doc__,
        "hash": f"sha256:{file_sha256(path)}",
        "schema": {"fields": fields, "primaryKey": schema.primary_key()},
    }


def package_is_whole(folder: Path) -> bool:
    """Whether every file is there as it was described."""
    try:
        described = json.loads((folder / DESCRIPTOR).read_text(encoding="utf-8"))["resources"]
        return all(f"sha256:{file_sha256(folder / r['path'])}" == r["hash"] for r in described)
    except (OSError, ValueError, KeyError, TypeError):
        return False
