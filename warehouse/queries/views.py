"""What people look at, as frames: tables of the database, joined and sorted for a page or chart.

Reads the database; writes and computes nothing: every number here is in a table.
"""

import datetime as dt
from functools import cached_property
from typing import Final, Self

import polars as pl

from pipeline.register.register import LINE
from warehouse.queries.reports import SIZED_FAULTS
from warehouse.store.database import open_database
from warehouse.store.editions import get_edition_path, list_edition_names, read_manifest, read_table
from warehouse.store.store import Store

DRAFT: Final = "concept-"


class Views:
    """The open database, with the questions pages ask; as of a day, if one is given."""

    def __init__(self, store: Store, as_of: dt.date | None = None) -> None:
        self.store = store
        self._db = open_database(store.database)
        self._db.execute("SET threads = 1")  # rows in one order: same tables, same bytes
        self._tables: dict[str, pl.DataFrame] = {}
        known = self.frame("SELECT edition FROM editions")["edition"]
        has_all_editions = set(known) == set(list_edition_names(store))
        if has_all_editions and as_of is None:
            return
        from warehouse.queries import as_of as overlays  # noqa: PLC0415 - all that makes registers

        if not has_all_editions:
            overlays.overlay_editions(self._db, store)
        if as_of is not None:
            overlays.overlay_register(self._db, store, as_of)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._db.close()

    def frame(self, query: str, *values: object) -> pl.DataFrame:
        """Return the rows of a query with these values for its parameters."""
        return pl.DataFrame(self._db.sql(query, params=values or None).pl())

    def ask(self, question: str, *values: object) -> pl.DataFrame:
        """Return the rows of one of the `QUESTIONS`."""
        return self.frame(QUESTIONS[question], *values)

    def table(self, name: str) -> pl.DataFrame:
        """Return a whole table, in the order in which it was written."""
        if name not in self._tables:  # read-only: read once
            self._tables[name] = self.frame(f'SELECT * FROM "{name}"')  # noqa: S608
        return self._tables[name]

    @cached_property
    def _contents(self) -> dict[str, int]:
        return dict(self.frame('SELECT "table", rows FROM contents').rows())

    def has(self, table: str) -> bool:
        """Return whether the table is there and holds rows."""
        return self._contents.get(table, 0) > 0

    def comments(self) -> dict[str, str]:
        """Return meaning and unit of every column, as `table.column`."""
        return dict(self.ask("comments").rows())

    def about(self) -> dict[str, str]:
        """Return facts about the database itself, by key."""
        return dict(self.table("about").rows())

    def register(self) -> pl.DataFrame:
        """Return the lines of every edition with name and type of the boat."""
        lines = self.ask("register")
        key = ("edition",) + LINE
        for edition in list_edition_names(self.store):
            own = read_table(get_edition_path(self.store, edition), "register")
            own = own.select(pl.col(key), "name", "boat_type")
            lines = lines.update(own, on=key, include_nulls=True)
        called = pl.col("name").str.to_lowercase()
        return lines.sort("edition", called, pl.col(LINE), nulls_last=True, maintain_order=True)

    def simulated(self, edition: str) -> bool:
        """Return whether the tows behind an edition or draft are simulated."""
        if edition.startswith(DRAFT):
            return self.about().get("simulated") == "true"
        return read_manifest(get_edition_path(self.store, edition)).simulated

    def type_names(self) -> list[str]:
        """Return the types of the listed boats, sorted."""
        return self.ask("types")["boat_type"].to_list()

    def race_days(self) -> list[tuple[str, dt.date]]:
        """Return races that were replayed, the last one first."""
        return self.ask("race_days").rows()


def prepare_curve_figure(
    lines: pl.DataFrame, runs: pl.DataFrame, curves: pl.DataFrame
) -> dict[str, pl.DataFrame]:
    """Return rows of the figure `resistance_curve`, by their `kind`.

    Args:
        lines: rows of `curve_points`.
        runs: rows of `run_points`.
        curves: those to draw: rows of `curves` with the `interval` of their method.

    Returns:
        `line` and `declared` (Cw at the declared speed) with `interval`, `point` (a run) without;
        all with `fsn_no`, `tow_id` and `method`.
    """
    of_tow = pl.col("fsn_no", "tow_id", "method")
    numbers = pl.col("speed_m_s", "cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m", "interval")
    of_run = pl.col("run", "direction", "speed_m_s", "cw_kg_m", "used")
    own = curves.select(of_tow, "interval")
    drawn = lines.join(own, on=["tow_id", "method"], maintain_order="left").drop_nulls("cw_kg_m")
    points = runs.join(own, on=["tow_id", "method"], maintain_order="left").drop_nulls("cw_kg_m")
    declared = curves.with_columns(speed_m_s="declared_speed_m_s").drop_nulls("cw_kg_m")
    return {
        "line": drawn.select(of_tow, numbers, kind=pl.lit("line")),
        "point": points.select(of_tow, of_run, kind=pl.lit("point")),
        "declared": declared.select(of_tow, numbers, kind=pl.lit("declared")),
    }


QUESTIONS: Final = {
    # How often each check was made and found something, most often first.
    "checks": 'SELECT * FROM check_counts ORDER BY method, beyond DESC, "check"',
    "comments": """
SELECT table_name || '.' || column_name AS name, comment FROM duckdb_columns()
WHERE comment IS NOT NULL ORDER BY 1
""",
    # Counts of one kind over all seasons.
    "counts": """
SELECT method, code, number FROM quality_counts WHERE kind = ? AND scope = 'all'
ORDER BY method, number DESC, code
""",
    # Curves with the day, name and what was on board.
    "curves": """
SELECT c.*, t.tow_date, t.weight_kg, t.water_temperature_c, t.salinity_g_kg, t.water_depth_m,
       t.altered, b.name, b.boat_type, m.interval
FROM curves AS c JOIN tows AS t USING (tow_id) JOIN methods AS m USING (method)
LEFT JOIN boats AS b ON b.fsn_no = c.fsn_no
ORDER BY c.fsn_no, t.tow_date, c.tow_id, c.method
""",
    # Accepted tows that a later check doubts, with the boat's name.
    "doubted_acceptances": """
SELECT a.*, b.name FROM acceptances AS a LEFT JOIN boats AS b USING (fsn_no)
WHERE len(a.doubted_by) > 0 ORDER BY a.method, a.tow_id
""",
    # Every boat and crew under every method, the tow that expires first on top.
    "due_list": """
SELECT d.*, b.name, b.boat_type FROM due_list AS d LEFT JOIN boats AS b USING (fsn_no)
ORDER BY d.method, d.valid_until NULLS LAST, lower(b.name), d.fsn_no, d.rowers, d.crew_class
""",
    # Checks that found something beyond its limit.
    "flagged": 'SELECT * FROM assessments WHERE flagged ORDER BY method, tow_id, "check"',
    # Every flag of every curve with its tow and boat.
    "flagged_boats": """
SELECT c.method, c.flag, c.tow_id, b.name, c.fsn_no, c.rowers, c.crew_class, t.tow_date
FROM (SELECT *, unnest(flags) AS flag FROM curves) AS c JOIN tows AS t USING (tow_id)
LEFT JOIN boats AS b ON b.fsn_no = c.fsn_no
ORDER BY c.method, c.flag, lower(b.name), c.fsn_no, t.tow_date
""",
    # Newest tows that stand out from their type in Cw or B, furthest first, with the boat's name.
    "outliers": """
WITH standing_out AS (
  SELECT *, 'cw_standard_kg_m' AS quantity, cw_standard_kg_m AS "value",
         cw_expected_kg_m AS expected, cw_deviation_sd AS deviation_sd
  FROM compared_tows WHERE cw_outside
  UNION ALL
  SELECT *, 'b_m_s', b_m_s, b_expected_m_s, b_deviation_sd FROM compared_tows WHERE b_outside
)
SELECT o.*, b.name FROM standing_out AS o LEFT JOIN boats AS b USING (fsn_no)
ORDER BY method, abs(deviation_sd) DESC, tow_id, quantity
""",
    # The log factor of each season, and what it rests on.
    "log_factors": """
SELECT f.*, l.n_tows, l.n_links FROM log_factors AS f
LEFT JOIN (
    SELECT method, season, sum(n_tows) AS n_tows, sum(n_links) AS n_links
    FROM season_links GROUP BY method, season
) AS l USING (method, season)
ORDER BY season, method
""",
    "race_days": "SELECT DISTINCT race, race_date FROM race_changes ORDER BY race_date DESC, race",
    # Results of races under two editions, with the boat's name.
    "races": """
SELECT t.*, b.name FROM race_changes AS t LEFT JOIN boats AS b USING (fsn_no)
ORDER BY from_edition, to_edition, race_date, race, crew_class, new_rank NULLS LAST, fsn_no
""",
    "register": """
SELECT r.edition, r.fsn_no, b.name, b.boat_type, r.rowers, r.crew_class, r.empty_thwart,
       r.waterline_length_m, r.beam_m, r.bow_height_m, r.weight_kg, r.tow_date, r.valid_until,
       r.as_of, r.status, r.declared_speed_m_s, r.a_kg_m, r.b_m_s, r.cw_kg_m, r.cw_lo_kg_m,
       r.cw_hi_kg_m, r.flags, r.tow_id, r.method, r.verification_code
FROM register AS r LEFT JOIN boats AS b USING (fsn_no)
""",
    # Who won each race, by name.
    "year_winners": """
SELECT t.* REPLACE (coalesce(old.name, t.published_winner) AS published_winner,
                    coalesce(new.name, t.winner) AS winner)
FROM year_winners AS t
LEFT JOIN boats AS old ON old.fsn_no = t.published_winner
LEFT JOIN boats AS new ON new.fsn_no = t.winner
ORDER BY method, year, race_date, race, crew_class
""",
    # The register of every year with the boat's name.
    "register_years": """
SELECT t.*, b.name, b.boat_type FROM register_years AS t LEFT JOIN boats AS b USING (fsn_no)
ORDER BY method, year, fsn_no, rowers, crew_class, empty_thwart
""",
    # Repeat tows with the boat's name.
    "repeat_pairs": """
SELECT t.* EXCLUDE ln_ratio, b.name FROM repeat_pairs AS t LEFT JOIN boats AS b USING (fsn_no)
ORDER BY method, tow_id
""",
    # Run points with boat and season; the angle of the wind is 0 from ahead, minus from port.
    "run_points": """
SELECT p.* REPLACE ((wind_angle_deg + 180) % 360 - 180 AS wind_angle_deg),
       t.fsn_no, t.season, t.declared_speed_m_s
FROM run_points AS p JOIN tows AS t USING (tow_id) ORDER BY method, tow_id, run
""",
    "season_diagnosis": f"SELECT * FROM ({SIZED_FAULTS}) ORDER BY season, part, instrument, method",  # noqa: S608
    # Curves per method, season and status.
    "statuses": """
SELECT method, CAST(scope AS INTEGER) AS season, code AS status, number
FROM quality_counts WHERE kind = 'status' AND scope != 'all' ORDER BY ALL
""",
    # Every tow of a boat of a known type, under every method, with the boat's name.
    "type_tows": """
SELECT c.*, b.name, v.cw_kg_m, v.cw_lo_kg_m, v.cw_hi_kg_m
FROM compared_tows AS c JOIN curves AS v USING (method, tow_id)
LEFT JOIN boats AS b ON b.fsn_no = c.fsn_no
WHERE c.boat_type != 'unknown'
ORDER BY c.method, c.boat_type, lower(b.name), c.fsn_no, c.rowers, c.crew_class, c.tow_id
""",
    "types": "SELECT DISTINCT boat_type FROM boats WHERE boat_type != '' ORDER BY boat_type",
}
"""What pages ask, in SQL; a question mark stands for a value that is given."""
