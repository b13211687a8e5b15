"""The tables as of a day: registers, who is due and races as they stood then, by the same rules.

The database judges on the day of the archive's last tow or race. Here the tables that depend on the
day are made again for another one, and laid over those of the open database; so are those of
editions that were published since it was made.
"""

import datetime as dt
from typing import Final

import duckdb
import polars as pl

from pipeline.errors import MissingKnowledgeError
from pipeline.register.register import CURVE_COLUMNS, LINE, list_lines_on_days, name_draft
from pipeline.tables.keys import SIZES
from pipeline.tables.schemas import TABLES, conform
from warehouse.derive.registers import list_due_lines, read_published_tables
from warehouse.store.crew_classes import read_crew_classes
from warehouse.store.editions import CHANGES
from warehouse.store.store import Store

NOT_YET: Final = "never_towed"


def overlay_register(db: duckdb.DuckDBPyConnection, store: Store, day: dt.date) -> None:
    """Make a connection answer as of a day: tables `register`, `due_list` and `race_changes`.

    Args:
        db: the open database, read-only.
        store: the data folder, for the results of races.
        day: tows and races of later days do not exist yet.

    Raises:
        MissingKnowledgeError: there was no tow by then.
    """
    read = {
        name: pl.DataFrame(db.table(name).pl())
        for name in ("register", "register_history", "boats", "tows", "methods", "race_changes")
    }
    if not (read["tows"]["tow_date"] <= day).any():
        raise MissingKnowledgeError("the archive has no tow of {} or before", day)
    register = register_on(read["register"], read["register_history"], read["tows"], day)
    drafts = {m: register.filter(edition=name_draft(m)) for m in read["methods"]["method"]}
    made = {
        "register": register,
        "due_list": list_due_lines(
            drafts, read["boats"], store.read("listed_races"), day, read_crew_classes(store)
        ),
        "race_changes": read["race_changes"].filter(pl.col("race_date") <= day),
    }
    for name, frame in made.items():
        _lay_over(db, name, frame)


def overlay_editions(db: duckdb.DuckDBPyConnection, store: Store) -> None:
    """Make a connection answer with the editions of now instead of those that it knows."""
    editions = pl.DataFrame(db.table("editions").pl())["edition"].to_list()
    for name, published in read_published_tables(store).items():
        edition = "to_edition" if name == CHANGES else "edition"
        drafts = pl.DataFrame(db.table(name).pl()).filter(~pl.col(edition).is_in(editions))
        _lay_over(db, name, pl.concat([conform(name, drafts), published]))


def _lay_over(db: duckdb.DuckDBPyConnection, name: str, frame: pl.DataFrame) -> None:
    db.register("frame", frame.select(TABLES[name].column_names()).to_arrow())
    db.execute(f'CREATE OR REPLACE TEMP TABLE "{name}" AS SELECT * FROM frame')  # noqa: S608
    db.unregister("frame")


def register_on(
    register: pl.DataFrame, history: pl.DataFrame, tows: pl.DataFrame, day: dt.date
) -> pl.DataFrame:
    """Return rows of `register` as they stood on a day, of every edition.

    A line whose tow was made later is listed as never towed. The verification code is of the
    published line, and stands only where that line is the one that counted.
    """
    key = ("edition",) + LINE
    codes = register.select(pl.col(key), "tow_id", "verification_code")
    counted = (
        list_lines_on_days(history.sort(key + ("position",)), [day], key)
        .join(tows.select("tow_id", pl.col(SIZES)), on="tow_id", how="left", maintain_order="left")
        .join(codes, on=key + ("tow_id",), how="left", nulls_equal=True, maintain_order="left")
    )
    later = pl.col("tow_date").is_not_null()
    without_tow = register.join(counted, on=key, how="anti").select(
        pl.exclude(CURVE_COLUMNS + SIZES + ("verification_code", "as_of", "status")),
        status=pl.when(later).then(pl.lit(NOT_YET)).otherwise("status"),
    )
    # What the lines without a tow lack becomes null.
    both = pl.concat([counted.drop("as_of"), without_tow], how="diagonal_relaxed")
    return both.with_columns(as_of=pl.lit(day)).select(register.columns).sort(key)
