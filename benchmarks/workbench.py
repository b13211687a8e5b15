"""A change at the workbench: from the question to the answer, and to the drawn page.

    PYTHONPATH=. python benchmarks/workbench.py [tows per season]

Ten simulated seasons at 20 Hz, in memory; the page is opened in Chromium where there is one.
"""

import dataclasses
import json
import platform
import shutil
import sys
import tempfile
import threading
import time
from pathlib import Path

import polars as pl

from dashboards.guard import listen
from dashboards.workbench.bench import Base, Bench, Question
from dashboards.workbench.server import LOOPBACK, address, serving
from herijk.simulate import WorldSettings, simulate_world
from pipeline.method.definition import Steps
from pipeline.recompute.run_cache import RunCache
from tests.worlds import measure
from warehouse.queries.history import History
from warehouse.store.store import Store

SEASONS = tuple(range(2009, 2019))
CHANGES = {
    "wind.side": (0.30, 0.35, 0.40, 0.45, 0.50),
    "temperature.reference_c": (10, 11, 12, 13, 14),
    "window.minimum_s": (25, 26, 27, 28, 29),
}


def history(settings):
    """All tows of a simulated world."""
    held, world = measure(settings), simulate_world(settings)
    types = {t.boat.fsn_no: t.boat.boat_type.name for t in world.tows}
    boats = pl.DataFrame({"fsn_no": list(types), "name": list(types), "boat_type": types.values()})
    crews = held.tows.select("fsn_no", "rowers", "crew_class").unique(maintain_order=True)
    tows = held.tows.join(boats.select("fsn_no", "boat_type"), on="fsn_no", how="left")
    return History(tows, boats, crews, held.blocks, simulated=True)


def answers(bench, option, values, clock):
    """Seconds from question to JSON for each value of an option."""
    start = bench.start()
    step, name = option.split(".")
    ranges = bench.base(Base(name=start["base"]))["ranges"]
    boat = start["boats"][0]["fsn_no"]
    times = []
    for value in values:
        steps = tuple(
            Steps.model_validate(r["steps"] | {step: r["steps"][step] | {name: value}})
            for r in ranges
        )
        asked = Question(
            base=Base(name=start["base"]), steps=steps, against=start["against"], boat=boat
        )
        began = clock()
        json.dumps(bench.answer(asked))
        times.append(clock() - began)
    return times


def drawn(url, chromium):
    """Seconds from a change at a control to the drawn page, as the page itself says."""
    from playwright.sync_api import sync_playwright  # noqa: PLC0415 - not on every machine

    found = {}
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        page.goto(url)
        page.wait_for_function("document.documentElement.dataset.seconds")
        for option, values in CHANGES.items():
            found[option] = []
            for value in values:
                page.evaluate("delete document.documentElement.dataset.seconds")
                box = page.locator(f"[data-option='{option}']").first.get_by_role("spinbutton")
                box.fill(str(value))
                page.wait_for_function("document.documentElement.dataset.seconds")
                found[option].append(
                    float(page.evaluate("document.documentElement.dataset.seconds"))
                )
        browser.close()
    return found


def report(what, times):
    found = ", ".join(f"{option} {min(t):.2f}-{max(t):.2f} s" for option, t in times.items())
    print(f"  {what:10} {found}")


def main():
    tows = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    held = history(WorldSettings(SEASONS, tows, 20))
    print(f"python {platform.python_version()}, polars {pl.__version__}")
    print(f"{held.tows.height} tows of {held.boats.height} boats; least and most of five")
    with tempfile.TemporaryDirectory() as folder:
        for what, clock in (("answered", time.perf_counter), ("processor", time.process_time)):
            bench = Bench(Store(Path(folder)), dataclasses.replace(held, cache=RunCache()))
            times = {option: answers(bench, option, v, clock) for option, v in CHANGES.items()}
            report(what, times)
        chromium = shutil.which("chromium")
        if chromium:
            fresh = Bench(Store(Path(folder)), dataclasses.replace(held, cache=RunCache()))
            socket, server = listen(LOOPBACK, 0), serving(fresh)
            thread = threading.Thread(target=server.run, kwargs={"sockets": [socket]})
            thread.start()
            report("drawn", drawn(address(socket), chromium))
            server.should_exit = True
            thread.join()


if __name__ == "__main__":
    main()
