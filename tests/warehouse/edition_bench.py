"""A small simulated archive and its warehouse, made without Dagster, for tests of editions."""

import datetime as dt
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Self

import polars as pl

from herijk.simulate import WorldSettings, simulate_world
from herijk.simulate.archive_writer import write_simulated_archive
from pipeline.method.definition import Method
from pipeline.method.reading import read_shipped_method
from tests.tables import make_tables
from warehouse.editions.compare import compare
from warehouse.editions.publish import Terms, publish
from warehouse.store.editions import read_edition
from warehouse.store.store import Store

SMALL = WorldSettings(seasons=(2009, 2014), tows_per_season=8, rate_hz=10, seed=5)
"""Season 2009 is written as plain CSV; a line of either season is valid in June 2014."""

METHODS = ("as-published", "rebased")
DAY = dt.date(2014, 6, 1)


@dataclass(frozen=True)
class EditionBench:
    """An archive and a data folder that a test may change."""

    archive: Path
    data: Path

    @classmethod
    def simulated(cls, root: Path) -> Self:
        bench = cls(root / "archive", root / "data")
        write_simulated_archive(bench.archive, simulate_world(SMALL))
        bench.rebuild()
        return bench

    def copy(self, root: Path) -> Self:
        """A copy to change at will; the warehouse knows its archive by the new place."""
        shutil.copytree(self.archive, root / "archive")
        shutil.copytree(self.data, root / "data")
        copied = type(self)(root / "archive", root / "data")
        about = copied.store.read("about_archive")
        place = pl.lit(str(copied.archive.resolve())).alias("root")
        copied.store.write("about_archive", about.with_columns(place), made_from="")
        return copied

    @property
    def store(self) -> Store:
        return Store(self.data)

    def rebuild(
        self, methods: tuple[Method, ...] = tuple(map(read_shipped_method, METHODS))
    ) -> None:
        """Everything that a rebuild does up to the registers."""
        make_tables(self.store, self.archive, methods, DAY)

    def publish(
        self,
        edition: str,
        method: str | Method = "as-published",
        valid_from: dt.date = DAY,
        carry: str | None = None,
    ) -> Path:
        chosen = read_shipped_method(method) if isinstance(method, str) else method
        return publish(self.store, chosen, terms(edition, valid_from), carry)

    def tow(self, season: int) -> dict:
        """The first sound tow of a season."""
        return self.store.read("tows").filter(pl.col("season") == season).row(0, named=True)

    def change_samples(self, tow_id: str, change: Callable[[str], str]) -> str:
        """Changes the text of a tow's samples (plain CSV); gives their path."""
        listed = self.store.read("listed_tows").filter(tow_id=tow_id)
        path: str = listed["samples_path"].item()
        file = self.archive / path
        file.write_bytes(change(file.read_bytes().decode("utf-8")).encode("utf-8"))
        return path

    def change_force(self, tow_id: str, change: Callable[[float], float]) -> None:
        """Changes the forces in a tow's samples."""

        def changed(text: str) -> str:
            head, *rows = text.splitlines()
            place = next(i for i, name in enumerate(head.split(";")) if name.startswith("kracht"))
            cells = [row.split(";") for row in rows]
            for row in cells:
                force = change(float(row[place].replace(",", ".")))
                row[place] = f"{force:.3f}".replace(".", ",")
            return "\n".join([head, *(";".join(row) for row in cells), ""])

        self.change_samples(tow_id, changed)


def terms(edition: str, valid_from: dt.date = DAY) -> Terms:
    return Terms(edition, valid_from, "besluit van de ALV", valid_from)


def diff(store: Store, old: str, new: str) -> pl.DataFrame:
    return compare(store, *(read_edition(store, name) for name in (old, new)))
