"""Whether a finished rebuild is what it promises: schemas, counts, the share set aside.

Reads only. What checks are called and how bad they are is said in `assets.checks`.
"""

from collections.abc import Sequence

import polars as pl

from pipeline.method.definition import Method
from pipeline.tables.schemas import TABLES
from warehouse.derive.inputs import IN_DATABASE, PER_METHOD
from warehouse.derive.studies import ladders_that_do_not_multiply
from warehouse.store.database import open_database
from warehouse.store.store import Store


def schema_faults(store: Store) -> list[str]:
    """Tables of the database that are not as their schema promises, a sentence each."""
    with open_database(store.database) as db:
        return [
            f"{name} is not as declared in pipeline/tables"
            for name in IN_DATABASE
            if not TABLES[name].is_valid(db.sql(f'FROM "{name}"').pl())
        ]


def count_faults(store: Store, methods: Sequence[Method]) -> list[str]:
    """Tables with other numbers of rows than in the lake."""
    expected = {name: _rows_in_lake(store, name, methods) for name in IN_DATABASE}
    with open_database(store.database) as db:
        counts = {name: len(db.table(name)) for name in expected}
    return [
        f"{name} has {counts[name]} rows, and {number} in the lake"
        for name, number in expected.items()
        if counts[name] != number
    ]


def lost_curves(store: Store, methods: Sequence[Method]) -> list[str]:
    """Methods that lost a tow."""
    with open_database(store.database) as db:
        curves = dict(db.sql("SELECT method, count(*) FROM curves GROUP BY method").fetchall())
        tows = len(db.table("tows"))
    return [
        f"{m.name} has {curves.get(m.name, 0)} curves of {tows} tows"
        for m in methods
        if curves.get(m.name) != tows
    ]


def lost_tows(store: Store) -> list[str]:
    """Listed tows of the seasons read that are neither accepted nor set aside: there are none."""
    known = pl.concat([store.read(name, columns=["tow_id"]) for name in ("tows", "quarantine")])
    return list(store.read_all("season_tows").join(known, on="tow_id", how="anti")["tow_id"])


def broken_ladders(store: Store, methods: Sequence[Method]) -> list[str]:
    """Tows of which the factors of a ladder do not multiply to its total."""
    names = [method.name for method in methods]
    return ladders_that_do_not_multiply(store.read_all("correction_steps", names))


def _rows_in_lake(store: Store, name: str, methods: Sequence[Method]) -> int:
    if name not in PER_METHOD:
        return store.count_rows(name)
    return sum(store.count_rows(name, m.name) for m in methods)


def set_aside_tows(store: Store) -> tuple[int, int]:
    """How many tows are set aside, and how many are listed."""
    aside = store.read("quarantine").filter(lost="tow")["tow_id"].n_unique()
    return aside, aside + store.read("tows").height
