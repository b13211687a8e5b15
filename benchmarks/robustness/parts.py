"""Rebuilds random parts of a simulated archive: every step and every page is made, of any of them.

    PYTHONPATH=. python benchmarks/robustness/parts.py [archives] [seed]

A part has some of the seasons, boats and tows; columns of its lists are cut and cells blanked. An
archive in which no tow can be used may be refused; anything else that is raised is a failure. Each
part follows from the seed and its number alone, so a failure can be made again.
"""

import csv
import io
import os
import random
import shutil
import sys
import tempfile
import traceback
from collections import Counter
from pathlib import Path
from typing import Final

from dashboards.site.render import build_site
from herijk.simulate import WorldSettings, simulate_world
from herijk.simulate.archive_writer import write_simulated_archive
from pipeline.errors import HerijkError
from pipeline.method.definition import shipped_method, shipped_methods
from tests.intake import bring_in
from warehouse.derive.graph import STEPS
from warehouse.store.store import Store

WORLD: Final = WorldSettings(tuple(range(2009, 2024)), 20, 20)
NEEDED: Final = {"fsn_nr", "datum", "meetfile", "sleep_id"}
"""Columns without which a list tells of no tow."""
SHARE_CUT: Final = 0.02
"""Of the other columns."""
LISTS: Final = ("sleeplijsten", "sloepregister", "wedstrijden")


def draw_part(chosen: random.Random, whole: Path, part: Path) -> None:
    """Links the samples of an archive, and writes a part of its lists."""
    shutil.copytree(whole, part, copy_function=os.link)
    seasons = [path for path in sorted(part.glob("sleeplijsten/*")) if chosen.random() < 0.5]
    for path in sorted(part.glob("sleeplijsten/*")):
        if path not in seasons[: chosen.choice((1, 2, 5, 17))]:
            path.unlink()
    share_of_boats, share_of_tows = chosen.choice((0.05, 0.3, 1.0)), chosen.choice((0.1, 0.5, 1.0))
    blank = chosen.choice((0.0, 0.01, 0.1))
    boats = {f"FSN{number}" for number in range(100, 400) if chosen.random() < share_of_boats}
    for path in sorted(file for name in LISTS for file in part.glob(f"{name}/*.csv")):
        text = path.read_bytes().decode("latin-1").removeprefix("\xef\xbb\xbf")
        path.unlink()  # it is a link to the file of the whole archive
        path.write_bytes(_thinned(chosen, text, boats, share_of_tows, blank).encode("latin-1"))


def _thinned(chosen: random.Random, text: str, boats: set[str], share: float, blank: float) -> str:
    """A list with some of its rows, columns and cells."""
    delimiter = max(";\t,", key=text.splitlines()[0].count)
    header, *rows = csv.reader(io.StringIO(text), delimiter=delimiter)
    fsn = header.index("fsn_nr")
    kept = [i for i, name in enumerate(header) if name in NEEDED or chosen.random() > SHARE_CUT]
    rows = [row for row in rows if row[fsn] in boats and chosen.random() < share]
    written = io.StringIO()
    writer = csv.writer(written, delimiter=delimiter, lineterminator="\n")
    writer.writerow([header[i] for i in kept])
    writer.writerows(
        [row[i] if header[i] in NEEDED or chosen.random() >= blank else "" for i in kept]
        for row in rows
    )
    return written.getvalue()


def make_all(archive: Path, data: Path) -> None:
    """Every table under every method that ships, and the site."""
    store = Store(data)
    bring_in(store, archive)
    methods = [shipped_method(name) for name in shipped_methods()]
    for step in STEPS:
        for scope in step.scopes(store, methods):
            step.make(scope)
    build_site(store)


def main() -> None:
    """Tries so many parts; exit code 1 where one failed."""
    given = sys.argv[1:]
    number, seed = map(int, [*given, *("50", "1")[len(given) :]])
    outcomes: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        whole = Path(folder) / "whole"
        write_simulated_archive(whole, simulate_world(WORLD))
        for place in range(number):
            part, data = Path(folder) / "part", Path(folder) / "data"
            try:
                draw_part(random.Random(f"{seed} {place}"), whole, part)
                make_all(part, data)
                outcomes["made"] += 1
            except HerijkError as refusal:
                outcomes[f"refused: {str(refusal).partition(':')[0]}"] += 1
            except Exception:
                outcomes["FAILED"] += 1
                print(f"part {place} of seed {seed}:\n{traceback.format_exc()}", flush=True)
            shutil.rmtree(part, ignore_errors=True)
            shutil.rmtree(data, ignore_errors=True)
    for outcome, count in outcomes.most_common():
        print(f"{count:6d}  {outcome}")
    sys.exit(outcomes["FAILED"] > 0)


if __name__ == "__main__":
    main()
