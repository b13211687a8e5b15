"""A small simulated archive and its warehouse, made without Dagster, for tests of editions."""

import datetime as dt
import shutil
from dataclasses import dataclass
from pathlib import Path

import polars as pl

from herijk.simulate import WorldSettings, simulate_world
from herijk.simulate.archive_writer import write_simulated_archive
from pipeline.method.definition import Method, shipped_method
from warehouse.derive.graph import ARCHIVE, METHOD
from warehouse.derive.inputs import Scope
from warehouse.editions.compare import DiffReport, compare, report
from warehouse.editions.publish import Terms, publish
from warehouse.intake.seasons import bring_in
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
    def simulated(cls, root: Path) -> "EditionBench":
        bench = cls(root / "archive", root / "data")
        write_simulated_archive(bench.archive, simulate_world(SMALL))
        bench.rebuild()
        return bench

    def copy(self, root: Path) -> "EditionBench":
        """A copy to change at will; the warehouse knows its archive by the new place."""
        shutil.copytree(self.archive, root / "archive")
        shutil.copytree(self.data, root / "data")
        copied = EditionBench(root / "archive", root / "data")
        about = copied.store.read("about_archive")
        place = pl.lit(str(copied.archive.resolve())).alias("root")
        copied.store.write("about_archive", about.with_columns(place), made_from="")
        return copied

    @property
    def store(self) -> Store:
        return Store(self.data)

    def rebuild(self, methods: tuple[Method, ...] = tuple(map(shipped_method, METHODS))) -> None:
        """Everything that a rebuild does up to the curves."""
        store = self.store
        bring_in(store, self.archive)
        ARCHIVE.make(Scope(store, (), today=DAY))
        for method in methods:
            METHOD.make(Scope(store, [method]))

    def publish(
        self,
        edition: str,
        method: str | Method = "as-published",
        valid_from: dt.date = DAY,
        carry: str | None = None,
    ) -> Path:
        chosen = shipped_method(method) if isinstance(method, str) else method
        return publish(self.store, chosen, terms(edition, valid_from), carry)

    def tow(self, season: int) -> dict:
        """The first sound tow of a season."""
        return self.store.read("tows").filter(pl.col("season") == season).row(0, named=True)

    def stretch_force(self, samples_path: str, factor: float) -> None:
        """Makes the forces in a samples file (plain CSV) larger by a factor."""
        path = self.archive / samples_path
        head, *rows = path.read_text(encoding="utf-8").splitlines()
        place = next(i for i, name in enumerate(head.split(";")) if name.startswith("kracht"))
        changed = [head]
        for row in rows:
            cells = row.split(";")
            force = float(cells[place].replace(",", ".")) * factor
            cells[place] = f"{force:.3f}".replace(".", ",")
            changed.append(";".join(cells))
        path.write_text("\n".join(changed) + "\n", encoding="utf-8")


def terms(edition: str, valid_from: dt.date = DAY) -> Terms:
    return Terms(edition, valid_from, "besluit van de ALV", valid_from)


def diff(store: Store, old: str, new: str) -> pl.DataFrame:
    return compare(store, *(read_edition(store, name) for name in (old, new)))


def diff_report(store: Store, old: str, new: str) -> DiffReport:
    editions = [read_edition(store, name) for name in (old, new)]
    return report(*editions, compare(store, *editions))
