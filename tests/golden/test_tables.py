"""The numbers of every table stay: a line per column in `tests/data/golden-tables.txt`.

Nothing here says that a number is right; other tests do. A change that moves one has its line in
CHANGELOG.md, and `python -m tests.golden.test_tables` writes the lines anew. What a table holds at
all is declared in `pipeline.tables`, so a column that comes or goes is no concern of this file.
"""

import re
import tempfile
from pathlib import Path

import numpy as np
import polars as pl
import pytest

from dashboards.page import render_page
from dashboards.queries.results import Results
from dashboards.reading import read_blocks
from dashboards.site import list_pages
from herijk.simulate import WorldSettings, world_settings
from pipeline.assessment.tow_summary import summarize_tows
from pipeline.blocks.tows import Tows
from pipeline.method.reading import read_shipped_method
from pipeline.recompute.recompute import recompute
from pipeline.season_log import estimate_season_factors
from tests.architecture.repository import ROOT
from tests.conftest import METHODS, Workbench, build_small
from tests.pipeline.consistency_fleet import consistency_tables, fleet
from tests.pipeline.season_worlds import HARD, simulate
from tests.worlds import measure, recompute_world
from warehouse.queries.views import Views
from warehouse.store.store import Store

LINES = ROOT / "tests" / "data" / "golden-tables.txt"
SAME = 1e-6
"""Difference, as a share of a column's size, that another processor or library may make."""

MOST_CODES = 12
"""Distinct codes of a column that are counted one by one."""

FRAME = {"has_reports": False}
"""What a page is told besides what its query finds."""

NOT_HELD = {"about", "about_archive", "contents", "methods", "season_index", "seasons"}
"""Tables with times, hashes and sizes of files."""


def frames(of: object) -> dict[str, pl.DataFrame]:
    """The tables among the attributes of an object."""
    return {name: value for name, value in vars(of).items() if isinstance(value, pl.DataFrame)}


def recomputed() -> dict[str, pl.DataFrame]:
    """Three methods on tows with repeats, in seasons without GPS, with GPS and calibrated."""
    methods = [read_shipped_method(name) for name in (*METHODS, "rebased")]
    return frames(recompute_world(WorldSettings((2010, 2012, 2015), 10, 20, 11), methods)[0])


def with_two_files() -> dict[str, pl.DataFrame]:
    """Tows of two files, each with a log of its own; and what every tow shows by itself."""
    world = measure(
        world_settings("two-files", seasons=(2010, 2014), tows_per_season=8, rate_hz=10, seed=3)
    )
    made = recompute(read_shipped_method("rebased"), world.tows, world.blocks)
    summary = vars(summarize_tows(Tows.from_frames(world.tows, world.blocks)))
    arrays = {name: pl.Series(values) for name, values in summary.items() if name != "tows"}
    return frames(made) | {"tow_summary": pl.DataFrame(arrays).fill_nan(None)}


def of_a_fleet() -> dict[str, pl.DataFrame]:
    """Comparisons of the boats of one type, two of which were towed slowly."""
    speeds = [2.0, 2.1, *np.linspace(2.4, 2.7, 7)]
    seasons = {"seasons": (2010, 2014, 2018), "boats": 9, "speeds_m_s": speeds}
    tables = fleet(40, b_cv=0.03, height_sd=0.03, season_sd=0.02, tow_sd=0.01, **seasons)
    return consistency_tables(*tables)


def of_logs() -> dict[str, pl.DataFrame]:
    """Season factors of a hard archive, and what is doubted in it."""
    found = estimate_season_factors(simulate(HARD, 1002).tows)
    return frames(found)


def of_statements(store: Store) -> dict[str, pl.DataFrame]:
    """What every page says: the numbers in the English of each kind of statement, in order."""
    said: dict[str, list[dict[str, object]]] = {}
    with Views(store) as views:
        about = views.about()
        for page in list_pages(Results(views)):
            html = render_page(page.path, page.template, page.query() | FRAME, "en", about)
            for block in read_blocks(html, folded=True):
                kind, _, verdict = block.said.partition(" ")
                text = block.text.replace("\N{MINUS SIGN}", "-")
                numbers = enumerate(map(float, re.findall(r"-?\d+(?:\.\d+)?", text)), start=1)
                row = {"verdict": verdict} | {str(place): number for place, number in numbers}
                said.setdefault(kind, []).append(row)
    del said[""]
    assert len(said) > 20
    return {kind: pl.DataFrame(rows, infer_schema_length=None) for kind, rows in said.items()}


MADE = {
    "recomputed": recomputed,
    "two-files": with_two_files,
    "fleet": of_a_fleet,
    "logs": of_logs,
}


def summary(column: pl.Series) -> str | None:
    """How many values, their mean and spread; or how often which code. None of other text."""
    if isinstance(column.dtype, pl.List):
        column = column.explode()
    column = column.drop_nulls()
    if column.dtype == pl.String:
        counts = column.value_counts(sort=True).sort(column.name)
        codes = column.str.contains(r"^[a-z0-9_]*$").all() and counts.height <= MOST_CODES
        return " ".join(f"{code or '-'}:{n}" for code, n in counts.rows()) if codes else None
    if not (column.dtype.is_numeric() or column.dtype == pl.Boolean):
        return None
    column = column.cast(pl.Float64)
    mean, sd = column.mean() or 0.0, column.std(ddof=0) or 0.0
    return f"{column.len()} {mean:.9g} {sd:.9g}"


def lines(world: str, tables: dict[str, pl.DataFrame]) -> dict[str, str]:
    """A line per column with numbers or codes."""
    found = {
        f"{world} {name}.{column.name}": summary(column)
        for name in sorted(tables.keys() - NOT_HELD)
        for column in tables[name]
    }
    return {where: said for where, said in found.items() if said is not None}


def differs(was: str, now: str) -> bool:
    """Whether a column has other codes or numbers than it had."""
    if not re.fullmatch(r"\d+ \S+ \S+", was) or was.count(" ") != now.count(" "):
        return was != now
    (n, *before), (m, *after) = (tuple(map(float, said.split())) for said in (was, now))
    size = abs(before[0]) + before[1]
    return n != m or any(abs(a - b) > SAME * size for a, b in zip(before, after, strict=True))


def changed(now: dict[str, str], whole: str | None = None) -> dict[str, tuple[str, str]]:
    """The columns that differ from those kept; of a `whole` world also those missing."""
    kept = dict(line.split(": ", 1) for line in LINES.read_text("utf-8").splitlines())
    both = [where for where in now if where in kept]
    assert len(both) > 0.9 * len(now)
    gone = {where for where in kept.keys() - now.keys() if where.split()[0] == whole}
    found = {w: (kept[w], now[w]) for w in both if differs(kept[w], now[w])}
    return found | {where: (kept[where], "") for where in gone}


@pytest.mark.parametrize("world", MADE)
def test_the_numbers_of_tables_stay(world):
    assert changed(lines(world, MADE[world]())) == {}


def of_archive(bench: Workbench) -> dict[str, str]:
    """Lines of a rebuilt archive, and of the pages about it."""
    return lines("built", bench.tables()) | lines("statements", of_statements(bench.store))


def test_the_numbers_of_a_rebuilt_archive_and_its_pages_stay(built):
    assert changed(of_archive(built), whole="statements") == {}


def write_anew() -> None:
    """Writes the lines of today."""
    with tempfile.TemporaryDirectory() as folder:
        build_small(Path(folder))
        now = of_archive(Workbench(Path(folder) / "archive", Path(folder) / "data"))
    for world, make in MADE.items():
        now |= lines(world, make())
    LINES.write_text("".join(f"{where}: {said}\n" for where, said in now.items()), "utf-8")


if __name__ == "__main__":
    write_anew()
