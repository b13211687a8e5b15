"""What people look at, as frames: tables of the database joined and summed for a page or chart.

Reads the database and the blocks; writes nothing. A number about a boat is taken from its table;
only the means of each second, which no table holds, are made here from the blocks.
"""

from types import TracebackType
from typing import Final, Self

import duckdb
import polars as pl

from pipeline.errors import MissingKnowledgeError
from warehouse.store import Store


class Views:
    """The open database, with the questions pages ask."""

    def __init__(self, store: Store) -> None:
        if not store.database.exists():
            raise MissingKnowledgeError(f"{store.database} is not there; make it with rebuild")
        self._store = store
        self._rows: dict[str, int] = {}
        self._db = duckdb.connect(store.database, read_only=True)
        self._db.execute("SET threads = 1")  # sums in one order: same tables, same bytes

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        tb: TracebackType | None,
    ) -> None:
        self._db.close()

    def frame(self, query: str) -> pl.DataFrame:
        """Rows of a query, as a frame."""
        return pl.DataFrame(self._db.sql(query).pl())

    def has(self, table: str) -> bool:
        """Whether the table is there and holds rows."""
        return self.row_counts().get(table, 0) > 0

    def row_counts(self) -> dict[str, int]:
        """Rows by table, sorted by name; counted once."""
        if not self._rows:
            names = self.frame("SELECT table_name FROM duckdb_tables() ORDER BY 1")["table_name"]
            self._rows = {name: self._count(name) for name in names}
        return self._rows

    def _count(self, table: str) -> int:
        return int(self.frame(f'SELECT count(*) AS n FROM "{table}"')["n"][0])  # noqa: S608

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
        """Lines of every edition with the boat's name and type."""
        return self.frame(_REGISTER)

    def changes(self) -> pl.DataFrame:
        """Changes between editions with the boat's name; without the unchanged lines."""
        return self.frame(_CHANGES)

    def curves(self) -> pl.DataFrame:
        """Curves with the day, name and what was on board."""
        return self.frame(_CURVES)

    def flagged(self) -> pl.DataFrame:
        """Checks that found something beyond its limit."""
        return self.frame(
            'SELECT * FROM assessments WHERE flagged ORDER BY method, tow_id, "check"'
        )

    def run_points(self) -> pl.DataFrame:
        """Run points with the boat and season they belong to."""
        return self.frame(
            "SELECT p.*, t.fsn_no, t.season, t.declared_speed_m_s FROM run_points AS p "
            "JOIN tows AS t USING (tow_id) ORDER BY method, tow_id, run"
        )

    def type_boats(self) -> pl.DataFrame:
        """The newest tow of each boat and crew of a known type, under every method."""
        return self.frame(_TYPE_BOATS)

    def shared_bends(self) -> pl.DataFrame:
        """B of every boat as it is, shared in part, and shared wholly with its type."""
        return self.frame(
            "SELECT p.*, b.name, p.fsn_no || ' ' || p.rowers || p.crew_class AS crew "
            "FROM pooled_curves AS p LEFT JOIN boats AS b USING (fsn_no) "
            "WHERE p.boat_type != 'unknown' ORDER BY method, tow_id, pooling"
        )

    def season_ladder(self) -> pl.DataFrame:
        """Mean factor of each step per season: the geometric mean, so that steps multiply."""
        return self.frame(_SEASON_LADDER)

    def option_spread(self) -> pl.DataFrame:
        """How much each option of judgement moves Cw: median and the middle 90 % of tows."""
        return self.frame(_OPTION_SPREAD)

    def season_change(self) -> pl.DataFrame:
        """Cw of each method / Cw of the first method: median and range per season."""
        return self.frame(_SEASON_CHANGE)

    def repeat_pairs(self) -> pl.DataFrame:
        """Repeat tows with the boat's name."""
        return self.frame(
            "SELECT r.*, b.name FROM repeat_pairs AS r LEFT JOIN boats AS b USING (fsn_no) "
            "ORDER BY method, tow_id"
        )

    def predicted(self) -> pl.DataFrame:
        """Predicted Cw next to the tow's, with the boat's name."""
        return self.frame(
            "SELECT p.*, b.name FROM predicted_cw AS p LEFT JOIN boats AS b USING (fsn_no) "
            "WHERE predicted_cw_kg_m IS NOT NULL ORDER BY method, tow_id"
        )

    def outliers(self) -> pl.DataFrame:
        """Boats that differ from their type, furthest first."""
        return self.frame(
            "SELECT o.*, b.name FROM type_outliers AS o LEFT JOIN boats AS b USING (fsn_no) "
            "WHERE outside ORDER BY method, abs(deviation_sd) DESC, tow_id, quantity"
        )

    def status_counts(self) -> pl.DataFrame:
        """Curves per method, season and status."""
        return self.frame(
            "SELECT method, season, status, count(*) AS number FROM curves "
            "GROUP BY ALL ORDER BY ALL"
        )

    def flag_counts(self) -> pl.DataFrame:
        """How often each flag is raised, per method."""
        return self.frame(
            "SELECT method, flag, count(*) AS number FROM "
            "(SELECT method, unnest(flags) AS flag FROM curves) GROUP BY ALL ORDER BY ALL"
        )

    def run_reason_counts(self) -> pl.DataFrame:
        """Why runs do not count, per method."""
        return self.frame(
            "SELECT method, reason, count(*) AS number FROM run_points WHERE NOT used "
            "GROUP BY ALL ORDER BY ALL"
        )

    def curve_lines(self) -> pl.DataFrame:
        """Every curve over its valid range with its 95 % band: the table `curve_points`."""
        return self.table("curve_points")

    def traces(self) -> pl.DataFrame:
        """Means over every second of every run: what the instruments said.

        Returns:
            `tow_id, run, second, speed_m_s` (log 1)`, gps_m_s, force_n, wind_m_s, wind_angle_deg`.
        """
        frames = [
            pl.scan_parquet(self._store.table_path("blocks", season), hive_partitioning=False)
            .select(*_TRACE)
            .collect()
            for season in self._store.partitions("blocks")
        ]
        return pl.concat([f for f in frames if f.height])


def _mean(name: str) -> pl.Expr:
    return pl.col(name) / pl.col("n")


_TRACE: Final = (
    pl.col("tow_id", "run", "second"),
    _mean("log1_v").alias("speed_m_s"),
    pl.when(pl.col("gps_n") > 0).then(pl.col("gps") / pl.col("gps_n")).alias("gps_m_s"),
    _mean("force").alias("force_n"),
    _mean("wind_v").alias("wind_m_s"),
    (pl.arctan2("wind_sin", "wind_cos").degrees() % 360.0).alias("wind_angle_deg"),
)


_REGISTER = """
SELECT r.edition, r.fsn_no, b.name, b.boat_type, r.rowers, r.crew_class, r.tow_date, r.valid_until,
       r.status, r.declared_speed_m_s, r.a_kg_m, r.b_m_s, r.cw_kg_m, r.cw_lo_kg_m, r.cw_hi_kg_m,
       r.tow_id, r.method
FROM register AS r LEFT JOIN boats AS b USING (fsn_no)
ORDER BY edition, b.name, fsn_no, rowers, crew_class
"""

_CHANGES = """
SELECT c.from_edition, c.to_edition, c.fsn_no, b.name, b.boat_type, c.rowers, c.crew_class,
       c.change, c.cw_ratio, c.power_ratio, c.time_ratio, c.causes
FROM register_changes AS c LEFT JOIN boats AS b USING (fsn_no)
WHERE c.change != 'same'
ORDER BY from_edition, to_edition, b.name, fsn_no, rowers, crew_class
"""

_CURVES = """
SELECT c.*, t.tow_date, t.weight_kg, t.water_temperature_c, t.altered, t.remark, b.name, b.boat_type
FROM curves AS c JOIN tows AS t USING (tow_id) LEFT JOIN boats AS b ON b.fsn_no = c.fsn_no
ORDER BY c.fsn_no, t.tow_date, c.tow_id, c.method
"""

_TYPE_BOATS = """
SELECT p.method, p.fsn_no, b.name, p.boat_type, p.rowers, p.crew_class, p.tow_id, c.season,
       t.weight_kg, c.declared_speed_m_s, c.a_kg_m, c.b_m_s, c.b_lo_m_s, c.b_hi_m_s, c.cw_kg_m,
       c.cw_lo_kg_m, c.cw_hi_kg_m, exp(o.value) AS cw_standard_kg_m
FROM pooled_curves AS p JOIN curves AS c USING (method, tow_id) JOIN tows AS t USING (tow_id)
LEFT JOIN boats AS b ON b.fsn_no = p.fsn_no
LEFT JOIN type_outliers AS o
       ON o.method = p.method AND o.tow_id = p.tow_id AND o.quantity = 'ln_cw_standard'
WHERE p.pooling = 'own' AND p.boat_type != 'unknown'
ORDER BY p.method, p.boat_type, b.name, p.fsn_no, p.rowers, p.crew_class
"""

_SEASON_LADDER = """
SELECT s.from_method, s.to_method, t.season, s.position, s.step,
       exp(avg(ln(s.factor))) AS factor, count(*) AS tows
FROM correction_steps AS s JOIN tows AS t USING (tow_id)
WHERE s.position > 0 GROUP BY ALL ORDER BY ALL
"""

_OPTION_SPREAD = """
SELECT method, option, count(*) AS tows, median(cw_effect_ratio) AS median_ratio,
       quantile_cont(cw_effect_ratio, 0.05) AS lo_ratio,
       quantile_cont(cw_effect_ratio, 0.95) AS hi_ratio
FROM option_effects WHERE cw_effect_ratio IS NOT NULL GROUP BY ALL ORDER BY ALL
"""

_SEASON_CHANGE = """
SELECT new.method, new.season, count(*) AS tows,
       median(new.cw_kg_m / old.cw_kg_m) AS median_ratio,
       min(new.cw_kg_m / old.cw_kg_m) AS lowest_ratio,
       max(new.cw_kg_m / old.cw_kg_m) AS highest_ratio
FROM curves AS new JOIN curves AS old USING (tow_id)
WHERE old.method = (SELECT min(from_method) FROM correction_steps) AND new.method != old.method
  AND new.cw_kg_m IS NOT NULL AND old.cw_kg_m IS NOT NULL
GROUP BY ALL ORDER BY ALL
"""
