"""The site of plain files, made from the database that is in place."""

import base64
from concurrent.futures import Executor
from typing import Final

import dagster as dg
import polars as pl

from herijk.assets.resources import Setup
from herijk.assets.side_by_side import helper
from herijk.assets.site_state import SITE_CODE, SITE_TABLE, site_made_from
from herijk.warehouse.build.database import DATABASE_TABLE
from herijk.warehouse.queries.views import Views
from herijk.warehouse.store.code import code_hash
from herijk.warehouse.store.store import Store

SPREAD: Final = "reproducibility"
"""The figure that says best whether a rebuild made things better, which Dagster shows."""


@dg.asset(
    deps=[DATABASE_TABLE],
    group_name="site",
    kinds={"html"},
    owners=["team:register"],
    tags={"herijk/subject": "site"},
    code_version=code_hash(*SITE_CODE),
)
def site(setup: Setup) -> dg.MaterializeResult:
    """Pages people can look at, swapped in whole."""
    with helper() as other:
        return make_site(setup.store, other)


def make_site(store: Store, other: Executor) -> dg.MaterializeResult:
    """Makes the pages with the help of a second process, and remembers from what."""
    from herijk.dashboards.figures import png  # noqa: PLC0415 - Altair takes a second to import
    from herijk.dashboards.site.render import build_site  # noqa: PLC0415

    with Views(store) as views:
        spread = views.table(SPREAD)
    picture = other.submit(png, SPREAD, spread, "nl")
    size = build_site(store, other)
    store.write(SITE_TABLE, pl.DataFrame(), site_made_from(store))
    index = store.root / "site" / "index.html"
    encoded = base64.b64encode(picture.result()).decode()
    return dg.MaterializeResult(
        asset_key="site",
        metadata={
            **size,
            "index": dg.MetadataValue.path(str(index.resolve())),
            SPREAD: dg.MetadataValue.md(f"![{SPREAD}](data:image/png;base64,{encoded})"),
        },
    )
