"""The database that readers use: all tables in one file, made from the lake."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

import polars as pl

from herijk.tables.schemas import TABLES, conform
from herijk.warehouse.build.version import code_version
from herijk.warehouse.store.database import build_database
from herijk.warehouse.store.files import file_sha256
from herijk.warehouse.store.store import Store

if TYPE_CHECKING:
    from herijk.warehouse.build.step import Inputs

DATABASE_TABLE: Final = "warehouse_database"
"""What the file was made from, and its hash."""


def warehouse_database(inputs: "Inputs") -> dict[str, pl.DataFrame]:
    """All tables in one DuckDB file, swapped in whole."""
    found = {name: conform(name, inputs[name]) for name in inputs.names if name in TABLES}
    about = {
        "simulated": str(inputs["about_archive"]["simulated"][0]).lower(),
        "code_version": code_version(),
    }
    found["about"] = pl.DataFrame({"key": list(about), "value": list(about.values())})
    found["contents"] = _contents(found)
    build_database(inputs.store.database, found)
    sha256 = pl.lit(file_sha256(inputs.store.database)).alias("sha256")
    return {DATABASE_TABLE: found["contents"].select("table", "rows", sha256)}


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
    return store.database.exists() and made == file_sha256(store.database)
