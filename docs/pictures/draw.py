"""Takes the pictures of README.md from the site of the demo: `make pictures`. Needs Chromium."""

import shutil
from pathlib import Path
from typing import Final

from playwright.sync_api import sync_playwright

HERE: Final = Path(__file__).parent
SITE: Final = HERE.parents[1] / "demo" / "data" / "site" / "en"
PICTURES: Final = {
    "boat.png": ("boats/FSN106.html", "section.answer"),
    "seasons.png": ("seasons.html", "#season-change .chart"),
}
"""Each picture: the page of the site, and what of it is shown."""


def main() -> None:
    """Writes every picture beside this file."""
    with sync_playwright() as player:
        browser = player.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox"]
        )
        page = browser.new_page(viewport={"width": 900, "height": 900})
        for name, (address, part) in PICTURES.items():
            page.goto((SITE / address).as_uri())
            shown = page.locator(part).first
            shown.scroll_into_view_if_needed()
            shown.locator("svg, canvas").first.wait_for()
            shown.screenshot(path=HERE / name)
        browser.close()


if __name__ == "__main__":
    main()
