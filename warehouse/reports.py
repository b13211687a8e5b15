"""Questions to the finished database, answered as plain data that a command prints or a page shows.

Reads only `warehouse.duckdb`; computes no new number about a boat.
"""

from pathlib import Path
from typing import Any

import duckdb
import polars as pl

from pipeline.errors import MissingKnowledgeError
from warehouse.store import Store

Report = dict[str, Any]
BIGGEST = 10
FIRST_FAULTS = 10


def _open(database: Path) -> duckdb.DuckDBPyConnection:
    if not database.exists():
        raise MissingKnowledgeError(
            f"{database} is not there; make it with: herijk rebuild --archive DIR --data "
            f"{database.parent}"
        )
    return duckdb.connect(database, read_only=True)


def _rows(connection: duckdb.DuckDBPyConnection, query: str, *values: object) -> list[Report]:
    found = connection.execute(query, list(values))
    names = [column[0] for column in found.description or []]
    return [dict(zip(names, row, strict=True)) for row in found.fetchall()]


def rebuild_report(store: Store) -> Report:
    """What the warehouse holds: seasons, set-aside rows, curves by status, biggest changes."""
    with _open(store.database) as db:
        return {
            "database": str(store.database),
            "simulated": _is_simulated(db),
            "seasons": _rows(
                db, "SELECT season, count(*) AS tows FROM tows GROUP BY season ORDER BY season"
            ),
            "set_aside": _rows(
                db,
                "SELECT reason_code, count(*) AS number FROM quarantine "
                "GROUP BY reason_code ORDER BY number DESC, reason_code",
            ),
            "first_faults": _rows(
                db,
                "SELECT path, tow_id, line, message FROM quarantine ORDER BY path, line LIMIT ?",
                FIRST_FAULTS,
            ),
            "curves": _rows(
                db,
                "SELECT method, status, count(*) AS number FROM curves "
                "GROUP BY method, status ORDER BY method, status",
            ),
            "by_season": _rows(db, _BY_SEASON),
            "biggest_changes": _rows(db, _BIGGEST_CHANGES, BIGGEST),
        }


def log_error_report(store: Store, method: str) -> Report:
    """The log factor of every season under a method, and what the estimated ones rest on."""
    with _open(store.database) as db:
        return {
            "simulated": _is_simulated(db),
            "method": method,
            "factors": _rows(db, _LOG_FACTORS, method),
        }


_LOG_FACTORS = """
SELECT f.season, f.factor, f.lo, f.hi, f.source, l.n_tows, l.n_links, l.component, l.influence,
       l.influence_boat, l.factor_no_boats, l.agreement
FROM log_factors AS f LEFT JOIN season_links AS l USING (method, season)
WHERE f.method = ? ORDER BY f.season
"""

_BY_SEASON = """
SELECT new.method, new.season, count(*) AS tows,
       median(new.cw_kg_m / old.cw_kg_m) AS median_ratio,
       min(new.cw_kg_m / old.cw_kg_m) AS lowest_ratio,
       max(new.cw_kg_m / old.cw_kg_m) AS highest_ratio,
       (SELECT min(from_edition) FROM register_changes) AS compared_with
FROM curves AS new JOIN curves AS old USING (tow_id)
WHERE 'concept-' || old.method = (SELECT min(from_edition) FROM register_changes)
  AND new.method != old.method AND new.cw_kg_m IS NOT NULL AND old.cw_kg_m IS NOT NULL
GROUP BY new.method, new.season ORDER BY new.method, new.season
"""

_BIGGEST_CHANGES = """
SELECT c.from_edition, c.to_edition, c.fsn_no, b.name, c.rowers, c.crew_class,
       c.cw_ratio, c.time_ratio, c.change
FROM register_changes AS c LEFT JOIN boats AS b USING (fsn_no)
WHERE c.cw_ratio IS NOT NULL
ORDER BY abs(ln(c.cw_ratio)) DESC, c.to_edition, c.fsn_no LIMIT ?
"""


def audit_boat(store: Store, fsn_no: str) -> Report:
    """Everything behind a boat's numbers: its tows, and per method each step from run to curve.

    Raises:
        MissingKnowledgeError: there is no such boat.
    """
    with _open(store.database) as db:
        boats = _rows(db, "SELECT * FROM boats WHERE fsn_no = ?", fsn_no)
        if not boats:
            raise MissingKnowledgeError(
                f"there is no boat {fsn_no}; boats are named by FSN number, for example "
                f"{_an_example(db)}"
            )
        tows = _rows(db, "SELECT * FROM tows WHERE fsn_no = ? ORDER BY tow_date, tow_id", fsn_no)
        for tow in tows:
            tow["curves"] = _rows(
                db, "SELECT * FROM curves WHERE tow_id = ? ORDER BY method", tow["tow_id"]
            )
            for curve in tow["curves"]:
                curve["run_points"] = _rows(
                    db,
                    "SELECT * FROM run_points WHERE tow_id = ? AND method = ? ORDER BY run",
                    tow["tow_id"],
                    curve["method"],
                )
        return {
            "simulated": _is_simulated(db),
            "boat": boats[0],
            "tows": tows,
            "set_aside": _rows(
                db,
                "SELECT * FROM quarantine WHERE message LIKE '%' || ? || '%' ORDER BY path",
                fsn_no,
            ),
            "register": _rows(db, "SELECT * FROM register WHERE fsn_no = ? ORDER BY ALL", fsn_no),
        }


def _an_example(db: duckdb.DuckDBPyConnection) -> str:
    row = db.execute("SELECT min(fsn_no) FROM tows").fetchone()
    return str(row[0]) if row else "FSN211"


def _is_simulated(db: duckdb.DuckDBPyConnection) -> bool:
    row = db.execute("SELECT value FROM about WHERE key = 'simulated'").fetchone()
    return row is not None and row[0] == "true"


def read_table(store: Store, name: str) -> pl.DataFrame:
    """A table of the database, in the order in which it was written."""
    with _open(store.database) as db:
        return pl.DataFrame(db.sql(f'SELECT * FROM "{name}"').pl())  # noqa: S608
