"""Views of the database: the questions that people ask most, each under the name they look for.

SQL that any DuckDB since 1.1 understands. A view joins and counts what tables hold, and takes means
of it; it computes nothing else but Cw of a curve at another speed.
"""

from collections.abc import Mapping
from typing import Final, NamedTuple


class View(NamedTuple):
    """A named question.

    Attributes:
        meaning: what a row is.
        query: the question in SQL.
        tables: where its columns come from; these say what a column means.
        own: meaning of the columns that no table has.
    """

    meaning: str
    query: str
    tables: tuple[str, ...]
    own: Mapping[str, str] = {}


VIEWS: Final = {
    "register_now": View(
        "The published register that counts today: one line per boat and crew.",
        """
SELECT b.name, b.boat_type, r.*
FROM register AS r JOIN boats AS b USING (fsn_no)
WHERE r.edition = (
    SELECT edition FROM editions WHERE valid_from <= current_date
    ORDER BY valid_from DESC, published_on DESC, edition DESC LIMIT 1
)""",
        ("register", "boats"),
    ),
    "curves_at_standard_speed": View(
        "Every curve at the common speed of its type and class, where boats can be compared.",
        """
WITH typed AS (
    SELECT c.*, b.name, b.boat_type, median(c.declared_speed_m_s)
        OVER (PARTITION BY c.method, b.boat_type, c.crew_class) AS standard_speed_m_s,
        (1 - c.a_kg_m / c.cw_kg_m) / c.declared_speed_m_s ^ 2 AS bend_s2_m2
    FROM curves AS c JOIN boats AS b USING (fsn_no)
    WHERE c.cw_kg_m IS NOT NULL
)
SELECT method, boat_type, crew_class, rowers, fsn_no, name, tow_id, season, status,
    standard_speed_m_s, declared_speed_m_s, a_kg_m, b_m_s,
    CASE WHEN bend_s2_m2 * standard_speed_m_s ^ 2 < 1
        THEN a_kg_m / (1 - bend_s2_m2 * standard_speed_m_s ^ 2) END AS cw_standard_kg_m
FROM typed
ORDER BY method, tow_id""",
        ("curves", "boats"),
        {
            "standard_speed_m_s": "median declared speed of the type and class [m/s]",
            "cw_standard_kg_m": "Cw at that speed; empty where the curve has none there [kg/m]",
        },
    ),
    "boats_by_type": View(
        "Per method, type and class: boats, tows, and the middle of A, B and Cw.",
        """
SELECT method, boat_type, crew_class, count(DISTINCT fsn_no) AS boats, count(*) AS tows,
    median(a_kg_m) AS a_kg_m, median(b_m_s) AS b_m_s, median(cw_standard_kg_m) AS cw_standard_kg_m
FROM curves_at_standard_speed
GROUP BY method, boat_type, crew_class
ORDER BY method, boat_type, crew_class""",
        ("curves", "boats"),
        {
            "boats": "boats of the type with a curve",
            "tows": "their tows with a curve",
            "a_kg_m": "median of A [kg/m]",
            "b_m_s": "median of B, over the tows that have one [m/s]",
            "cw_standard_kg_m": "median of Cw at the common speed of the type and class [kg/m]",
        },
    ),
    "season_ladder": View(
        "The ladder per season: what each step does to Cw on average.",
        """
SELECT from_method, to_method, season, position, step, count(*) AS tows,
    exp(avg(ln(factor))) AS factor
FROM correction_steps JOIN tows USING (tow_id)
WHERE position > 0
GROUP BY ALL
ORDER BY from_method, to_method, season, position""",
        ("correction_steps", "tows"),
        {"tows": "tows", "factor": "geometric mean of the factor on Cw; they multiply [1]"},
    ),
    "quality_counts": View(
        "How many curves have each status and flag, and how many runs do not count, and why.",
        """
WITH events AS (
    SELECT method, 'status' AS kind, status AS code, season FROM curves
    UNION ALL
    SELECT method, 'flag', unnest(flags), season FROM curves
    UNION ALL
    SELECT p.method, 'run', p.reason, c.season
    FROM run_points AS p JOIN curves AS c USING (method, tow_id) WHERE NOT p.used
)
SELECT method, kind, code, CAST(season AS VARCHAR) AS scope, count(*) AS number
FROM events GROUP BY ALL
UNION ALL
SELECT method, kind, code, 'all', count(*) FROM events GROUP BY ALL
ORDER BY ALL""",
        ("curves",),
        {
            "kind": "status, flag or run",
            "code": "the status, flag or reason",
            "scope": "a season, or all",
            "number": "how many",
        },
    ),
    "check_counts": View(
        "How often each check was made, and found something beyond its limit.",
        """
SELECT method, "check", severity, count(*) AS tows, count(*) FILTER (WHERE flagged) AS beyond
FROM assessments
GROUP BY ALL
ORDER BY method, "check", severity""",
        ("assessments",),
        {"tows": "tows on which it was made", "beyond": "of which beyond the limit"},
    ),
    "changes_by_cause": View(
        "One row per changed line and cause; the factors of a line multiply to its cw_ratio.",
        """
SELECT from_edition, to_edition, fsn_no, rowers, crew_class, empty_thwart, change, cw_ratio,
    part ->> '$.cause' AS cause, part ->> '$.step' AS step,
    CAST(part ->> '$.factor' AS DOUBLE) AS factor
FROM (SELECT *, unnest(CAST(causes AS JSON[])) AS part FROM register_changes)""",
        ("register_changes",),
        {
            "cause": "why the line changed",
            "step": "step of the method, where a method is the cause",
            "factor": "what it does to Cw: new / old [1]",
        },
    ),
}
