"""Take the pictures of README.md from the site of the demo: `make pictures`. Needs Chromium.

`python docs/pictures/draw.py SITE FOLDER` takes them from another site, into another folder.
"""

import shutil
import sys
from pathlib import Path
from typing import Final

from playwright.sync_api import sync_playwright

HERE: Final = Path(__file__).parent
SITE: Final = HERE.parents[1] / "demo" / "data" / "site" / "en"
PICTURES: Final = {
    "boat.png": ("boats/FSN106.html", "section.answer", "section.answer"),
    "seasons.png": ("seasons.html", "#season-change", "#season-change svg"),
}
"""Each picture: the page of the site, a section of it, and what of the section is shown."""


def take_pictures(site: Path = SITE, folder: Path = HERE) -> None:
    """Write every picture into a folder, from the pages of a site in one language."""
    with sync_playwright() as player:
        browser = player.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox"]
        )
        page = browser.new_page(viewport={"width": 900, "height": 900})
        for name, (address, section, part) in PICTURES.items():
            page.goto((site / address).as_uri())
            page.locator(section).scroll_into_view_if_needed()
            page.locator(part).first.screenshot(path=folder / name)
        browser.close()


if __name__ == "__main__":
    take_pictures(*map(Path, sys.argv[1:3]))
