"""Questions to the finished database, answered as plain data that a command prints or a page shows.

Reads only `warehouse.duckdb`; computes no new number about a boat. What is behind one boat
or one type is in `warehouse.queries.audit`.
"""

from dataclasses import dataclass
from typing import Final

from pipeline.register.register import default_method
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


@dataclass(frozen=True)
class LogErrorReport:
    """The log error of every season under a method.

    Attributes:
        simulated: whether the archive is.
        method: whose factors.
        factors: rows of `log_factors` with what each rests on.
        parts: the same per part of a season and log.
        diagnosis: faults of the season, with their size, that are not sound.
        levels: what all tows of each season have in common, against the other tows of their boats.
    """

    simulated: bool
    method: str
    factors: list[Row]
    parts: list[Row]
    diagnosis: list[Row]
    levels: list[Row]


def rebuild_report(store: Store) -> RebuildReport:
    """Return what the warehouse holds: tows by season, and what is set aside."""
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


def log_error_report(store: Store, method: str | None = None) -> LogErrorReport:
    """Return the log factor of every season under a method, and what the estimated ones rest on.

    Args:
        store: the data folder.
        method: the method; the best that was applied when left out.
    """
    with open_database(store.database) as db:
        applied = rows(db, "SELECT DISTINCT method FROM log_factors ORDER BY method")
        chosen = method or default_method([row["method"] for row in applied])
        return LogErrorReport(
            simulated=is_simulated(db),
            method=chosen,
            factors=rows(db, _LOG_FACTORS, chosen),
            parts=rows(db, _LOG_PARTS, chosen),
            diagnosis=rows(db, _DIAGNOSIS, chosen),
            levels=rows(db, _LEVELS, chosen),
        )


# A season in which a log was replaced has a factor per part: its line here has the mean, and those
# of the parts stand below.
_LOG_FACTORS = """
WITH own AS (
    SELECT method, season, sum(n_tows) AS n_tows, sum(n_links) AS n_links,
           max(component) AS component
    FROM season_links GROUP BY method, season
)
SELECT f.season, f.factor, f.lo, f.hi, f.source, l.n_tows, l.n_links, l.component
FROM log_factors AS f LEFT JOIN own AS l USING (method, season)
WHERE f.method = ? ORDER BY f.season
"""

_LOG_PARTS = """
SELECT season, part, source, n_tows, n_links, factor, lo, hi FROM season_links
WHERE method = ? AND season IN (SELECT season FROM season_links WHERE part > 0)
ORDER BY season, part
"""

SIZED_FAULTS: Final = """
SELECT * EXCLUDE (estimate, lo, hi)
         REPLACE (CASE unit WHEN '1' THEN '%' ELSE unit END AS unit),
       CASE unit WHEN '1' THEN 100 * (exp(estimate) - 1) ELSE estimate END AS size,
       CASE unit WHEN '1' THEN 100 * (exp(lo) - 1) ELSE lo END AS size_lo,
       CASE unit WHEN '1' THEN 100 * (exp(hi) - 1) ELSE hi END AS size_hi
FROM season_diagnosis
"""
"""What may be wrong with instruments, with its size in per cent or N instead of a logarithm."""

_DIAGNOSIS = f"""
SELECT season, part, instrument, unit, size, size_lo, size_hi, p_fault, distance_sd, verdict,
       first_tow, rests_on, shown_by, confused_with
FROM ({SIZED_FAULTS})
WHERE method = ? AND verdict NOT IN ('sound', 'estimated')
  AND (instrument != 'season_level' OR verdict = 'alarm')
ORDER BY season, part, instrument
"""  # noqa: S608

_LEVELS = f"""
SELECT season, verdict, size, size_lo, size_hi, unit, rests_on
FROM ({SIZED_FAULTS})
WHERE method = ? AND instrument = 'season_level'
ORDER BY season
"""  # noqa: S608
