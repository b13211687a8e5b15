"""Whether a finished rebuild is what it promises: schemas, counts, the share set aside.

Reads only. What checks are called and how bad they are is said in `assets.checks`.
"""

from collections.abc import Sequence
from typing import Final

from herijk.pipeline.method.definition import Method
from herijk.tables.schemas import TABLES
from herijk.warehouse.build.graph import DATABASE
from herijk.warehouse.build.inputs import METHOD_TABLES
from herijk.warehouse.store.database import open_database
from herijk.warehouse.store.store import Store, count_rows

DATABASED: Final = tuple(name for name in DATABASE.inputs if name in TABLES)


def schema_faults(store: Store) -> list[str]:
    """Tables of the database that are not as their schema promises, a sentence each."""
    with open_database(store.database) as db:
        return [
            f"{name} is not as declared in herijk/tables"
            for name in DATABASED
            if not TABLES[name].is_valid(db.sql(f'FROM "{name}"').pl())
        ]


def count_faults(store: Store, methods: Sequence[Method]) -> list[str]:
    """Tables with other numbers of rows than in the lake, and methods that lost a tow."""
    expected = {name: _rows_in_lake(store, name, methods) for name in DATABASED}
    with open_database(store.database) as db:
        counts = {name: len(db.table(name)) for name in expected}
        curves = dict(db.sql("SELECT method, count(*) FROM curves GROUP BY method").fetchall())
    return [
        *(
            f"{name} has {counts[name]} rows, and {number} in the lake"
            for name, number in expected.items()
            if counts[name] != number
        ),
        *(
            f"{m.name} has {curves.get(m.name, 0)} curves of {expected['tows']} tows"
            for m in methods
            if curves.get(m.name) != expected["tows"]
        ),
    ]


def _rows_in_lake(store: Store, name: str, methods: Sequence[Method]) -> int:
    if name not in METHOD_TABLES:
        return count_rows(store.table_path(name))
    return sum(count_rows(store.table_path(name, m.name)) for m in methods)


def set_aside_tows(store: Store) -> tuple[int, int]:
    """How many tows are set aside, and how many are listed."""
    aside = store.read("quarantine").filter(lost="tow")["tow_id"].n_unique()
    return aside, aside + store.read("tows").height
