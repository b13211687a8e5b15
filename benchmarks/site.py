"""Time and size of the site, and how soon its pages can be used.

    PYTHONPATH=. python benchmarks/site.py [DATA]

DATA is a data folder that a rebuild made; without it a small one is simulated. A large one:

    herijk simulate big --seasons 2009:2022 --tows-per-season 72 --rate 10
    herijk rebuild --archive big --data DATA

Pages are timed in Chromium, from the start of loading until tables are filtered and every chart in
view is drawn: the largest boat pages, and all others. Beside it what the page's main thread used of
a processor till then, which other programs on the machine do not lengthen.
"""

import shutil
import statistics
import sys
import tempfile
import time
from pathlib import Path

from playwright.sync_api import sync_playwright

from assets.rebuild import rebuild
from dashboards.site.pages import MENU
from dashboards.site.render import build_site
from herijk.simulate import WorldSettings, simulate_world
from herijk.simulate.archive_writer import write_simulated_archive
from pipeline.method.definition import shipped_methods
from tests.quiet import Quiet
from warehouse.queries.views import Views
from warehouse.store.store import Store

READY = (
    "[...document.querySelectorAll('.chart')].every(chart => chart.querySelector('svg')"
    " || !chart.offsetParent || chart.getBoundingClientRect().top > innerHeight)"
)
"""Every chart that is in view is drawn."""
COUNTED = "!document.querySelector('.count b:empty')"
REPEATS = 5
BOATS = 5
SMALL = WorldSettings((2009, 2014, 2018), 10, 10)


def simulated(folder: Path) -> Path:
    """A small data folder of simulated tows, rebuilt by all methods."""
    write_simulated_archive(folder / "archive", simulate_world(SMALL))
    rebuild(folder / "archive", folder / "data", shipped_methods(), Quiet())
    return folder / "data"


def page_times(site: Path, names: list[str]) -> dict[str, tuple[float, float]]:
    """Seconds until each page can be used, and of a processor, each the best of a few."""
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        found = {}
        for name in names:
            times = [_load(browser, site / name) for _ in range(REPEATS)]
            found[name] = tuple(min(column) for column in zip(*times, strict=True))
        browser.close()
    return found


def _load(browser, path: Path) -> tuple[float, float]:
    page = browser.new_page(viewport={"width": 1280, "height": 900}, bypass_csp=True)
    inner = page.context.new_cdp_session(page)
    inner.send("Performance.enable", {"timeDomain": "threadTicks"})
    start = time.perf_counter()
    page.goto(path.as_uri())
    page.wait_for_function(COUNTED)
    page.wait_for_function(READY)
    seconds = time.perf_counter() - start
    metrics = {m["name"]: m["value"] for m in inner.send("Performance.getMetrics")["metrics"]}
    page.close()
    return seconds, metrics["TaskDuration"]


def main():
    with tempfile.TemporaryDirectory() as folder:
        measure(Path(sys.argv[1]) if len(sys.argv) > 1 else simulated(Path(folder)))


def measure(data: Path) -> None:
    """Builds the site of a data folder and opens its pages."""
    store = Store(data)
    with Views(store) as views:
        rows = views.row_counts()
    print(f"{rows['boats']} boats, {rows['tows']} tows, {rows['curves']} curves")
    wall, cpu = time.perf_counter(), time.process_time()
    size = build_site(store)
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    print(f"built in {wall:.1f} s ({cpu:.1f} s of processor), "
          f"{size['files']} files, {size['bytes'] / 1e6:.1f} MB")  # fmt: skip
    site = store.root / "site"
    boats = sorted(site.glob("boats/*.html"), key=lambda f: f.stat().st_size)[-BOATS:]
    names = [*(f"{name}.html" for name in MENU), *(str(f.relative_to(site)) for f in boats)]
    times = page_times(site, names)
    for name, (seconds, cpu) in times.items():
        kilobytes = (site / name).stat().st_size / 1e3
        print(f"  {name:24s} {kilobytes:8.0f} kB {seconds:6.2f} s ({cpu:.2f} s of processor)")
    all_seconds = [seconds for seconds, _ in times.values()]
    slowest, middle = max(all_seconds), statistics.median(all_seconds)
    print(f"usable after {slowest:.2f} s at most, {middle:.2f} s median")


if __name__ == "__main__":
    main()
