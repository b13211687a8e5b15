"""What people look at, as frames: tables of the database, joined and sorted for a page or chart.

Reads the database; writes and computes nothing: every number here is in a table.
"""

import datetime as dt
from typing import Final, Self

import polars as pl

from pipeline.register.register import LINE, with_empty_thwart
from warehouse.queries.as_of import lay_over, lay_published
from warehouse.queries.due import RETOW_CHOICE
from warehouse.store.database import open_results
from warehouse.store.editions import edition_names, edition_path, read_manifest, read_table
from warehouse.store.store import Store

DRAFT: Final = "concept-"


class Views:
    """The open database, with the questions pages ask; as of a day, if one is given."""

    def __init__(self, store: Store, as_of: dt.date | None = None) -> None:
        self.store = store
        self._contents: dict[str, int] = {}
        self._db = open_results(store.database)
        self._db.execute("SET threads = 1")  # rows in one order: same tables, same bytes
        lay_published(self._db, store)
        if as_of is not None:
            lay_over(self._db, store, as_of)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._db.close()

    def frame(self, query: str, *values: str) -> pl.DataFrame:
        """Rows of a query with these values for its parameters, as a frame."""
        return pl.DataFrame(self._db.sql(query, params=values or None).pl())

    def _named(
        self, table: str, order: str, where: str = "true", columns: str = "t.*"
    ) -> pl.DataFrame:
        """Rows of a table, called t, with the boat's name."""
        return self.frame(
            f"SELECT {columns}, b.name FROM {table} AS t LEFT JOIN boats AS b USING (fsn_no) "  # noqa: S608
            f"WHERE {where} ORDER BY {order}"
        )

    def has(self, table: str) -> bool:
        """Whether the table is there and holds rows."""
        return self.row_counts().get(table, 0) > 0

    def row_counts(self) -> dict[str, int]:
        """Rows by table, as the database says of itself."""
        if not self._contents:
            self._contents = dict(self.frame('SELECT "table", rows FROM contents').iter_rows())
        return self._contents

    def table(self, name: str) -> pl.DataFrame:
        """A whole table, in the order in which it was written."""
        return self.frame(f'SELECT * FROM "{name}"')  # noqa: S608

    def comments(self) -> dict[str, str]:
        """Meaning and unit of every column, as `table.column`."""
        rows = self.frame(
            "SELECT table_name || '.' || column_name AS name, comment FROM duckdb_columns() "
            "WHERE comment IS NOT NULL ORDER BY 1"
        )
        return dict(rows.iter_rows())

    def about(self) -> dict[str, str]:
        """What is known about the database itself."""
        return dict(self.frame("SELECT key, value FROM about ORDER BY key").iter_rows())

    def register(self) -> pl.DataFrame:
        """Lines of every edition with the boat's name and type: as published, or as listed now."""
        lines = self.frame(_REGISTER)
        key = ["edition", *LINE]
        for edition in edition_names(self.store):
            own = with_empty_thwart(read_table(edition_path(self.store, edition), "register"))
            own = own.select(*key, "name", "boat_type")
            lines = lines.update(own, on=key, include_nulls=True)
        called = pl.col("name").str.to_lowercase()
        return lines.sort("edition", called, *LINE, nulls_last=True, maintain_order=True)

    def simulated(self, edition: str) -> bool:
        """Whether an edition is of simulated tows; a draft, whether today's archive is."""
        if edition.startswith(DRAFT):
            return self.about().get("simulated") == "true"
        return read_manifest(edition_path(self.store, edition)).simulated

    def curves(self) -> pl.DataFrame:
        """Curves with the day, name and what was on board."""
        return self.frame(_CURVES)

    def flagged(self) -> pl.DataFrame:
        """Checks that found something beyond its limit."""
        return self.frame(
            'SELECT * FROM assessments WHERE flagged ORDER BY method, tow_id, "check"'
        )

    def run_points(self) -> pl.DataFrame:
        """Run points with boat and season; `wind_angle_deg` is 0 from ahead, minus from port."""
        return self.frame(
            "SELECT p.* REPLACE ((wind_angle_deg + 180) % 360 - 180 AS wind_angle_deg), "
            "t.fsn_no, t.season, t.declared_speed_m_s FROM run_points AS p "
            "JOIN tows AS t USING (tow_id) ORDER BY method, tow_id, run"
        )

    def type_tows(self) -> pl.DataFrame:
        """Every tow of a boat of a known type, under every method, with the boat's name."""
        return self.frame(_TYPE_TOWS)

    def compared_tows(self) -> pl.DataFrame:
        """Every tow next to its type under every method, with the boat's name."""
        return self._tows("compared_tows")

    def _tows(self, table: str) -> pl.DataFrame:
        """Rows of a table of tows with the boat's name, or else its number."""
        named = self._named(table, "method, tow_id")
        return named.with_columns(pl.coalesce("name", "fsn_no"))

    def curve_points_of(self, fsn_no: str) -> pl.DataFrame:
        """The curves of all tows of a boat under every method, with season and crew."""
        return self.frame(
            "SELECT p.*, t.season, t.rowers || t.crew_class AS crew, "
            "coalesce(b.name, t.fsn_no) AS name FROM curve_points AS p "
            "JOIN tows AS t USING (tow_id) LEFT JOIN boats AS b USING (fsn_no) "
            "WHERE t.fsn_no = ? ORDER BY method, tow_id, speed_m_s",
            fsn_no,
        )

    def repeat_pairs(self) -> pl.DataFrame:
        """Repeat tows with the boat's name."""
        return self._named("repeat_pairs", "method, tow_id", columns="t.* EXCLUDE ln_ratio")

    def predicted(self) -> pl.DataFrame:
        """Predicted Cw next to the tow's, with the boat's name."""
        known, columns = "predicted_cw_kg_m IS NOT NULL", "t.* EXCLUDE ln_ratio"
        return self._named("predicted_cw", "method, tow_id", known, columns)

    def outliers(self) -> pl.DataFrame:
        """Boats that differ from their type, furthest first; Cw itself instead of its logarithm."""
        order = "method, abs(deviation_sd) DESC, tow_id, t.quantity"
        return self._named("type_outliers", order, "outside", _WITHOUT_LOGARITHMS)

    def counts(self, kind: str) -> pl.DataFrame:
        """Counts of one kind over all seasons: `method, code, number`."""
        return self.frame(
            f"SELECT method, code, number FROM quality_counts WHERE kind = '{kind}' "  # noqa: S608
            "AND scope = 'all' ORDER BY method, number DESC, code"
        )

    def status_counts(self) -> pl.DataFrame:
        """Curves per method, season and status."""
        return self.frame(
            "SELECT method, CAST(scope AS INTEGER) AS season, code AS status, number "
            "FROM quality_counts WHERE kind = 'status' AND scope != 'all' ORDER BY ALL"
        )

    def checks(self) -> pl.DataFrame:
        """How often each check was made and found something, most often first."""
        return self.frame('SELECT * FROM check_counts ORDER BY method, beyond DESC, "check"')

    def due_list(self) -> pl.DataFrame:
        """Every boat and crew under every method, the tow that expires first on top."""
        return self.frame(_DUE)

    def retow_choice(self) -> pl.DataFrame:
        """Boats whose next tow narrows the season factors most, with name and next speed."""
        return self.frame(RETOW_CHOICE)

    def flagged_boats(self) -> pl.DataFrame:
        """Every flag of every curve with its tow and boat: `method, flag, tow_id, name`."""
        return self.frame(_FLAGGED_BOATS)

    def type_names(self) -> list[str]:
        """Types of which a boat is listed, sorted."""
        types = self.table("boats")["boat_type"].drop_nulls().unique().sort()
        return [name for name in types.to_list() if name]

    def race_days(self) -> list[tuple[str, dt.date]]:
        """Races that were replayed, the last one first."""
        days = self.table("race_changes").select("race", "race_date").unique()
        return days.sort("race_date", "race", descending=[True, False]).rows()

    def races(self) -> pl.DataFrame:
        """Rows of `race_changes`, with the boat's name."""
        place = "race_date, race, crew_class, new_rank NULLS LAST, fsn_no"
        return self._named("race_changes", f"from_edition, to_edition, {place}")

    def season_steps(self) -> pl.DataFrame:
        """Steps of seasons in per cent instead of logarithms."""
        return self.frame(_SEASON_STEPS)

    def season_diagnosis(self) -> pl.DataFrame:
        """What may be wrong with instruments: `size, size_lo, size_hi` in per cent, or in N."""
        return self.frame(_SEASON_DIAGNOSIS)


_WITHOUT_LOGARITHMS = """
t.* REPLACE (
  CASE quantity WHEN 'ln_cw_standard' THEN exp("value") ELSE "value" END AS "value",
  CASE quantity WHEN 'ln_cw_standard' THEN exp(expected) ELSE expected END AS expected,
  replace(quantity, 'ln_cw_standard', 'cw_standard_kg_m') AS quantity
)"""

_SEASON_STEPS = """
SELECT *, 100 * (exp(level_step) - 1) AS level_step_percent, 100 * level_step_sd
       AS level_sd_percent, 100 * (exp(force_step) - 1) AS force_step_percent,
       100 * force_step_sd AS force_sd_percent
FROM season_steps
"""

_SEASON_DIAGNOSIS = """
SELECT * REPLACE (CASE unit WHEN '1' THEN '%' ELSE unit END AS unit),
       CASE unit WHEN '1' THEN 100 * (exp(estimate) - 1) ELSE estimate END AS size,
       CASE unit WHEN '1' THEN 100 * (exp(lo) - 1) ELSE lo END AS size_lo,
       CASE unit WHEN '1' THEN 100 * (exp(hi) - 1) ELSE hi END AS size_hi
FROM season_diagnosis
"""

_REGISTER = """
SELECT r.edition, r.fsn_no, b.name, b.boat_type, r.rowers, r.crew_class, r.empty_thwart,
       r.waterline_length_m, r.beam_m, r.bow_height_m, r.weight_kg, r.tow_date, r.valid_until,
       r.as_of, r.status, r.declared_speed_m_s, r.a_kg_m, r.b_m_s, r.cw_kg_m, r.cw_lo_kg_m,
       r.cw_hi_kg_m, r.tow_id, r.method, r.verification_code
FROM register AS r LEFT JOIN boats AS b USING (fsn_no)
"""

_DUE = """
SELECT d.*, b.name, b.boat_type FROM due_list AS d LEFT JOIN boats AS b USING (fsn_no)
ORDER BY d.method, d.valid_until NULLS LAST, lower(b.name), d.fsn_no, d.rowers, d.crew_class
"""

_CURVES = """
SELECT c.*, t.tow_date, t.weight_kg, t.water_temperature_c, t.altered, b.name, b.boat_type,
       m.interval
FROM curves AS c JOIN tows AS t USING (tow_id) JOIN methods AS m USING (method)
LEFT JOIN boats AS b ON b.fsn_no = c.fsn_no
ORDER BY c.fsn_no, t.tow_date, c.tow_id, c.method
"""

_FLAGGED_BOATS = """
SELECT c.method, c.flag, c.tow_id, b.name, c.fsn_no, c.rowers, c.crew_class, t.tow_date
FROM (SELECT *, unnest(flags) AS flag FROM curves) AS c JOIN tows AS t USING (tow_id)
LEFT JOIN boats AS b ON b.fsn_no = c.fsn_no
ORDER BY c.method, c.flag, lower(b.name), c.fsn_no, t.tow_date
"""

_TYPE_TOWS = """
SELECT c.*, b.name, v.cw_kg_m, v.cw_lo_kg_m, v.cw_hi_kg_m
FROM compared_tows AS c JOIN curves AS v USING (method, tow_id)
LEFT JOIN boats AS b ON b.fsn_no = c.fsn_no
WHERE c.boat_type != 'unknown'
ORDER BY c.method, c.boat_type, lower(b.name), c.fsn_no, c.rowers, c.crew_class, c.tow_id
"""
