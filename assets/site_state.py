"""Whether the site is that of the database that is in place."""

from pathlib import Path
from typing import Final

from dashboards.guides import GUIDES, guide_file
from pipeline.messages import CATALOGUES, LANGUAGES
from warehouse.derive.database import DATABASE_TABLE
from warehouse.store.code import COMPUTING, code_hash
from warehouse.store.files import file_sha256
from warehouse.store.store import Store, fingerprint

SITE_CODE: Final = (
    *("dashboards", "warehouse.queries", "warehouse.editions"),
    *COMPUTING,
)
SITE_TABLE: Final = "site"
"""An empty table that remembers what the site was made from."""


def site_made_from(store: Store) -> str:
    """The database, and the code and files that make pages of it."""
    folder = Path(__file__).parents[1] / "dashboards"
    files = [f for f in folder.rglob("*.*") if f.parent.name in {"static", "templates", "guides"}]
    files += Path(CATALOGUES).rglob("*.mo")
    files += [guide_file(name, language) for name in GUIDES for language in LANGUAGES]
    return fingerprint(
        store.contents(DATABASE_TABLE),
        code_hash(*SITE_CODE),
        [file_sha256(file) for file in sorted(files)],
    )


def site_is_stale(store: Store) -> bool:
    """Whether the pages have to be made again."""
    there = (store.root / "site" / "index.html").exists()
    return not there or store.made_from(SITE_TABLE) != site_made_from(store)
