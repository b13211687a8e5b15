"""The site of plain files, made from the database that is in place."""

import base64
from pathlib import Path

import dagster as dg
import polars as pl

from herijk.assets.resources import Setup
from herijk.warehouse.build.database import DATABASE_TABLE
from herijk.warehouse.queries.views import Views
from herijk.warehouse.store.code import code_hash
from herijk.warehouse.store.files import file_sha256
from herijk.warehouse.store.store import Store, fingerprint

SITE_CODE = "herijk.dashboards.site"
SITE_TABLE = "site"
"""An empty table that remembers what the site was made from."""


def site_made_from(store: Store) -> str:
    """The database, and the code and files that make pages of it."""
    folder = Path(__file__).parents[1] / "dashboards"
    files = [f for f in folder.rglob("*.*") if f.parent.name in {"static", "templates"}]
    return fingerprint(
        store.made_from(DATABASE_TABLE),
        code_hash(SITE_CODE),
        [file_sha256(file) for file in sorted(files)],
    )


def site_is_stale(store: Store) -> bool:
    """Whether the pages have to be made again."""
    there = (store.root / "site" / "index.html").exists()
    return not there or store.made_from(SITE_TABLE) != site_made_from(store)


@dg.asset(
    deps=[DATABASE_TABLE],
    group_name="site",
    kinds={"html"},
    owners=["team:register"],
    tags={"herijk/subject": "site"},
    code_version=code_hash(SITE_CODE),
)
def site(setup: Setup) -> dg.MaterializeResult:
    """Pages people can look at, swapped in whole."""
    from herijk.dashboards.site import build_site  # noqa: PLC0415 - Altair takes a second to import

    size = build_site(setup.store)
    setup.store.write(SITE_TABLE, pl.DataFrame(), site_made_from(setup.store))
    index = setup.store.root / "site" / "index.html"
    return dg.MaterializeResult(
        metadata={
            **size,
            "index": dg.MetadataValue.path(str(index.resolve())),
            "reproducibility": dg.MetadataValue.md(_reproducibility(setup.store)),
        }
    )


def _reproducibility(store: Store) -> str:
    """The figure that says best whether a rebuild made things better, as a picture."""
    from herijk.dashboards.figures import png  # noqa: PLC0415 - Altair takes a second to import
    from herijk.dashboards.words import speaker  # noqa: PLC0415

    with Views(store) as views:
        picture = png("reproducibility", views.table("reproducibility"), speaker("nl"))
    return f"![reproducibility](data:image/png;base64,{base64.b64encode(picture).decode()})"
