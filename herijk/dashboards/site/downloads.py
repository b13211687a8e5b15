"""The sheets of published editions, put beside the pages so that the site is complete by itself."""

from pathlib import Path
from typing import Final

from herijk.warehouse.store.editions import (
    CSV,
    NOTES,
    NOTES_EN,
    NOTICE,
    NOTICE_EN,
    XLSX,
    edition_names,
    edition_path,
)
from herijk.warehouse.store.store import Store

DOWNLOADS: Final = "downloads"
SHEETS: Final = (CSV, XLSX, NOTICE, NOTES, NOTICE_EN, NOTES_EN)


def copy_sheets(store: Store, folder: Path) -> None:
    """Copies the sheets of every edition to `downloads/<edition>/`, byte for byte."""
    for edition in edition_names(store):
        target = folder / DOWNLOADS / edition
        target.mkdir(parents=True)
        for name in SHEETS:
            (target / name).write_bytes((edition_path(store, edition) / name).read_bytes())
