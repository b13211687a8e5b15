"""Questions to the finished database, answered as plain data that a command prints or a page shows.

Reads only `warehouse.duckdb`; computes no new number about a boat.
"""

from dataclasses import dataclass
from typing import Final

from pipeline.tables.row import Row
from warehouse.store.database import is_simulated, open_database, rows
from warehouse.store.store import Store

FIRST_FAULTS = 10
_FAULTS_BY_REASON = """
SELECT lost, reason_code, count(*) AS number FROM quarantine GROUP BY lost, reason_code
ORDER BY list_position(['file', 'tow', 'row', 'run', 'cell', 'seconds'], lost), number DESC,
         reason_code
"""
_FIRST_FAULTS = """
WITH causes AS (
    SELECT lost, reason_code, count(*) AS number,
           first(quarantine ORDER BY path, line, tow_id) AS one
    FROM quarantine GROUP BY lost, reason_code, cause
)
SELECT one.path, one.tow_id, one.line, reason_code, one.message, one.message_nl, number FROM causes
ORDER BY list_position(['file', 'tow', 'row', 'run', 'cell', 'seconds'], lost), number DESC,
         one.path, one.line
LIMIT ?
"""


@dataclass(frozen=True)
class RebuildReport:
    """What the warehouse has after a rebuild.

    Attributes:
        database, site, report: where they are.
        simulated: whether the archive is.
        seasons: `season` and `tows`.
        set_aside: `lost`, `reason_code` and their `number`.
        first_faults: one line per cause: its first place and sentence, and how many there are.
    """

    database: str
    site: str
    report: str
    simulated: bool
    seasons: list[Row]
    set_aside: list[Row]
    first_faults: list[Row]


def rebuild_report(store: Store) -> RebuildReport:
    """Return the contents of the warehouse: tows by season, and faults."""
    with open_database(store.database) as db:
        return RebuildReport(
            database=str(store.database),
            site=str(store.root / "site" / "index.html"),
            report=str(store.root / "report" / "latest.html"),
            simulated=is_simulated(db),
            seasons=rows(
                db, "SELECT season, count(*) AS tows FROM tows GROUP BY season ORDER BY season"
            ),
            set_aside=rows(db, _FAULTS_BY_REASON),
            first_faults=rows(db, _FIRST_FAULTS, FIRST_FAULTS),
        )


SIZED_FAULTS: Final = """
SELECT * EXCLUDE (estimate, lo, hi)
         REPLACE (CASE unit WHEN '1' THEN '%' ELSE unit END AS unit),
       CASE unit WHEN '1' THEN 100 * (exp(estimate) - 1) ELSE estimate END AS size,
       CASE unit WHEN '1' THEN 100 * (exp(lo) - 1) ELSE lo END AS size_lo,
       CASE unit WHEN '1' THEN 100 * (exp(hi) - 1) ELSE hi END AS size_hi
FROM season_diagnosis
"""
"""What may be wrong with instruments, with its size in per cent or N instead of a logarithm."""
