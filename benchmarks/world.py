"""The archive that is measured on, and which of its tows a comparison uses.

Made once and kept: simulating 1,020 tows takes ten minutes. The lake beside it holds what
`herijk rebuild` would have put there, without Dagster.
"""

import os
from dataclasses import dataclass
from pathlib import Path

import polars as pl

from herijk.simulate import WorldSettings, simulate_world
from herijk.simulate.archive_writer import write_simulated_archive
from tests.intake import bring_in
from warehouse.derive.graph import ARCHIVE
from warehouse.derive.inputs import Scope
from warehouse.store.store import Store

SEASONS = tuple(range(2009, 2026))
RATE_HZ = 1000
FOLDER = Path(os.environ.get("BENCH_FOLDER", "benchmarks/data"))
HEADERS = {
    "run": "run",
    "log1_m_s": "log1 [m/s]",
    "log2_m_s": "log2 [m/s]",
    "gps_m_s": "gps [m/s]",
    "force_n": "kracht [N]",
    "wind_speed_m_s": "wind [m/s]",
    "wind_angle_deg": "wind [gra]",
}
"""Column of a sample, and its header in the text."""
PLAIN_HEADER = ";".join(list(HEADERS.values())[:4]) + ";"
"""Files that begin like this are spelled as pandas, DuckDB and Polars can read them unaided."""


@dataclass(frozen=True)
class World:
    """A simulated archive with its data folder."""

    tows_per_season: int

    @property
    def archive(self) -> Path:
        return FOLDER / f"{self.tows_per_season}" / "archive"

    @property
    def store(self) -> Store:
        return Store(FOLDER / f"{self.tows_per_season}" / "data")

    def make(self) -> None:
        """Makes what is not there yet."""
        if not self.archive.exists():
            settings = WorldSettings(SEASONS, self.tows_per_season, RATE_HZ)
            write_simulated_archive(self.archive, simulate_world(settings))
        bring_in(self.store, self.archive)
        if ARCHIVE.is_stale(Scope(self.store, ())):
            last = max(self.store.read("listed_tows")["tow_date"])
            ARCHIVE.make(Scope(self.store, (), today=last))

    def tows(self, count: int | None = None, plain: bool = False) -> pl.DataFrame:
        """Sound tows with their place in the lake, evenly spread over the seasons.

        Args:
            count: so many of them, all when left out.
            plain: only those whose text any reader understands as it stands.
        """
        index = self.store.read_all("season_index").drop_nulls("samples_key")
        found = self.store.read("tows").join(
            index.select("tow_id", "samples_key", "blocks_key"), on="tow_id"
        )
        if plain:
            found = found.filter(
                pl.col("second_path").is_null()
                & pl.col("samples_path").map_elements(self._is_plain, pl.Boolean)
            )
        found = found.sort("tow_id")
        if count is None or count >= found.height:
            return found
        return found[[i * found.height // count for i in range(count)]]

    def _is_plain(self, path: str) -> bool:
        file = self.archive / path
        with file.open("rb") as opened:
            return file.suffix == ".csv" and opened.read(40).startswith(PLAIN_HEADER.encode())
