"""The tables of the lake described for any program: as a data package.

`lake/tables/` can be copied and passed on as it is. Of its Parquet files, one per table or per
method, `datapackage.json` (Frictionless Data Package, version 2) gives columns, keys, licence,
sources and hashes. It is written last.
"""

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final, Self

import polars as pl

from warehouse.store.files import file_sha256, written_beside
from warehouse.store.store import Store, count_rows

if TYPE_CHECKING:
    from pipeline.tables.declare import dy

DESCRIPTOR: Final = "datapackage.json"
_NO_LICENCE: Final = "The archive declares no licence. Ask its owner before passing this on."
_SIMULATED: Final = "Simulated: these are not the federation's measurements."
_TYPES: Final[Mapping[type[pl.DataType], str]] = {
    **dict.fromkeys((pl.Int8, pl.Int16, pl.Int32, pl.Int64, pl.UInt32), "integer"),
    pl.Float64: "number",
    pl.String: "string",
    pl.Boolean: "boolean",
    pl.Date: "date",
    pl.List: "array",
}
"""The names of types in a data package."""


@dataclass(frozen=True)
class Rights:
    """Who publishes what is made from an archive, and what others may do with it.

    Attributes:
        publisher: its name, if the archive says so.
        licence: SPDX name or web address of the licence, if the archive says so.
    """

    publisher: str | None = None
    licence: str | None = None

    @classmethod
    def of(cls, store: Store) -> Self:
        """What the archive of a data folder declares."""
        about = store.read("about_archive").row(0, named=True)
        return cls(about.get("publisher"), about.get("licence"))

    @property
    def described(self) -> dict[str, object]:
        """The same as the fields of a data package."""
        fields: dict[str, object] = {}
        if self.publisher:
            fields["contributors"] = [{"title": self.publisher, "roles": ["publisher"]}]
        if self.licence:
            key = "path" if "://" in self.licence else "name"
            fields["licenses"] = [{key: self.licence}]
        return fields


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
        about: the table of that name, by key.
        sources: title and hash of all that they were made from.
    """
    resources = [_resource(folder, path, schema) for path, schema in sorted(files.items())]
    rights = Rights(about.get("publisher"), about.get("licence"))
    said = [_SIMULATED] if about["simulated"] == "true" else []
    said += [] if rights.licence else [_NO_LICENCE]
    hashes = "".join(str(resource["hash"]) for resource in resources)
    package = {
        "$schema": "https://datapackage.org/profiles/2.0/datapackage.json",
        "name": "herijk",
        "id": f"urn:sha256:{hashlib.sha256(hashes.encode()).hexdigest()}",
        "title": "Tow tests, curves and registers of Dutch rowing sloops, recomputed by Herijk",
        "description": " ".join(
            [*said, "A file per table or method; SI units, named in each field."]
        ),
        "version": about["code_version"],
        "sources": [{"title": title, "sha256": sha256} for title, sha256 in sources],
        **rights.described,
        "resources": resources,
    }
    with written_beside(folder / DESCRIPTOR) as beside:
        beside.write_text(json.dumps(package, indent=1, ensure_ascii=False), encoding="utf-8")


def package_is_whole(folder: Path) -> bool:
    """Whether every file is there as it was described."""
    try:
        package = json.loads((folder / DESCRIPTOR).read_text(encoding="utf-8"))
        described = {resource["path"]: resource["hash"] for resource in package["resources"]}
        return all(
            f"sha256:{file_sha256(folder / path)}" == hashed for path, hashed in described.items()
        )
    except (OSError, ValueError, KeyError, TypeError):
        return False


def _resource(folder: Path, path: Path, schema: "type[dy.Schema]") -> dict[str, object]:
    """Describes one file; that of a method is named `table.method`."""
    within = path.relative_to(folder)
    return {
        "name": ".".join(within.with_suffix("").parts),
        "type": "table",
        "path": within.as_posix(),
        "format": "parquet",
        "mediatype": "application/vnd.apache.parquet",
        "description": schema.__doc__,
        "hash": f"sha256:{file_sha256(path)}",
        "rowcount": count_rows(path),
        "schema": {
            "fields": [_field(*column) for column in schema.columns().items()],
            "primaryKey": schema.primary_key(),
            "missingValues": [],
        },
    }


def _field(name: str, column: "dy.Column") -> dict[str, object]:
    unit = (column.metadata or {}).get("unit")
    limits = {"minimum": "min", "maximum": "max", "pattern": "regex"}
    constraints = {key: getattr(column, limit, None) for key, limit in limits.items()}
    return {
        "name": name,
        "type": _TYPES[column.dtype.base_type()],
        "description": column.description,
        **({"unit": unit} if unit else {}),
        "constraints": {
            "required": not column.nullable,
            **{key: value for key, value in constraints.items() if value is not None},
        },
    }
