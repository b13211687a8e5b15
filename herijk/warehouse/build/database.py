"""The database that readers use: all tables in one file, made from the lake."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

import dataframely as dy
import polars as pl

from herijk.tables.schemas import TABLES, conform
from herijk.tables.views import VIEWS
from herijk.warehouse.build.version import code_version
from herijk.warehouse.store.database import build_database, left_wal
from herijk.warehouse.store.files import file_sha256
from herijk.warehouse.store.store import Store

if TYPE_CHECKING:
    from herijk.warehouse.build.inputs import Inputs


def _meanings(schema: type[dy.Schema]) -> list[str]:
    return [f"{name}: {column.description}" for name, column in schema.columns().items()]


DATABASE_TABLE: Final = "warehouse_database"
"""The tables in the file, and its hash."""

MEANINGS: Final = str(
    {name: [schema.__doc__, *_meanings(schema)] for name, schema in TABLES.items()} | VIEWS
)
"""What the file says of its tables, and its views."""


def warehouse_database(inputs: "Inputs") -> dict[str, pl.DataFrame]:
    """All tables in one DuckDB file, swapped in whole."""
    found = {name: conform(name, inputs[name]) for name in inputs.names if name in TABLES}
    found["about"] = _about(inputs.store)
    found["contents"] = _contents(found)
    build_database(inputs.store.database, found)
    sha256 = pl.lit(file_sha256(inputs.store.database)).alias("sha256")
    return {DATABASE_TABLE: found["contents"].select("table", "rows", sha256)}


def database_without_tows(store: Store, found: Mapping[str, pl.DataFrame]) -> None:
    """A first database where no tow can be used, so that readers see what was set aside."""
    if not store.database.exists():
        empty = {name: schema.create_empty() for name, schema in TABLES.items()}
        known = {name: conform(name, frame) for name, frame in found.items()}
        build_database(store.database, {**empty, **known, "about": _about(store)})


def _about(store: Store) -> pl.DataFrame:
    about = {
        "simulated": str(store.read("about_archive")["simulated"][0]).lower(),
        "code_version": code_version(),
    }
    return pl.DataFrame({"key": list(about), "value": list(about.values())})


def _contents(found: Mapping[str, pl.DataFrame]) -> pl.DataFrame:
    """Every table with its rows and meaning, for those who open the database."""
    names = sorted(set(found) & set(TABLES))
    return pl.DataFrame(
        {
            "table": names,
            "rows": [found[name].height for name in names],
            "meaning": [TABLES[name].__doc__ for name in names],
        }
    )


def is_whole(store: Store) -> bool:
    """Whether the file is there as it was made; it may have been damaged since."""
    made = store.read(DATABASE_TABLE)["sha256"][0]
    left = left_wal(store.database).exists()  # a reader would replay it
    return store.database.exists() and not left and made == file_sha256(store.database)
