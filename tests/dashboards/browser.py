"""What the tests in a real browser look for on any page."""

import os
import shutil

import pytest
from axe_playwright_python.sync_playwright import Axe

from tests.architecture.repository import ROOT

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
FLAGS = [
    *("--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-sync"),
    *("--disable-background-networking", "--disable-component-update"),
]
HIDDEN_BARS = ["--hide-scrollbars"]
"""What a browser without a window is told by itself: people's windows have bars."""
OWN = ("file:", "data:", "blob:", "http://127.0.0.1:")
"""All that a page may ask for: of the site, which names no address, its own files."""
IN_CI = "HERIJK_CI" in os.environ
SHOTS = ROOT / "ci-output"
WIDTHS = {
    "wide": {"width": 1920, "height": 1080},
    "desktop": {"width": 1280, "height": 900},
    "phone": {"width": 390, "height": 844},
}
NEEDED = [
    pytest.mark.more,
    pytest.mark.skipif(
        CHROMIUM is None and not IN_CI,
        reason="no Chromium on this machine: install the package chromium to run the browser tests",
    ),
]
SERIOUS = {"serious", "critical"}


def too_wide(page, boxes):
    """What is wider than the window, or in these boxes wider than they are.

    A box has a bar at its side, as those with many rows have.
    """
    return page.evaluate(
        "boxes => [document.documentElement, ...document.querySelectorAll(boxes)].filter(b => {"
        " if (b.matches('.scroll')) b.style.overflowY = 'scroll';"
        " return b.scrollWidth > b.clientWidth; }).map(b => b.outerHTML.slice(0, 80))",
        boxes,
    )


def barriers(page):
    """What axe-core finds that keeps people out: rule and the first element.

    It takes long over parts that are all alike: of a table it sees a few rows, and a picture, which
    has to have a name, only from outside.
    """
    page.evaluate(
        "document.querySelectorAll('tbody').forEach(body =>"
        " body.replaceChildren(...[...body.rows].slice(0, 3)))"
    )
    page.wait_for_function("!document.querySelector('svg:not([role][aria-label], [aria-hidden])')")
    only = {"resultTypes": ["violations"], "preload": False}
    found = Axe().run(page, {"exclude": ["svg"]}, only).response["violations"]
    return [
        f"{rule['id']}: {rule['nodes'][0]['html']} {rule['nodes'][0]['failureSummary']}"
        for rule in found
        if rule["impact"] in SERIOUS
    ]


def picture(page, name):
    """In CI, pictures of what is seen first, and of the whole by day and by night."""
    if not IN_CI:
        return
    SHOTS.mkdir(exist_ok=True)
    page.screenshot(path=SHOTS / f"{name}-first.png")
    for scheme in ("dark", "light"):
        page.emulate_media(color_scheme=scheme)
        page.screenshot(path=SHOTS / f"{name}-{scheme}.png", full_page=True)
