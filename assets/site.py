"""The site of plain files, made from the database that is in place."""

import base64
from typing import Final

import dagster as dg
import polars as pl

from assets import workers
from assets.progress import Progress
from assets.resources import Setup
from assets.site_state import SITE_CODE, SITE_TABLE, site_is_stale, site_made_from
from warehouse.derive.database import DATABASE_TABLE
from warehouse.queries.views import Views
from warehouse.store.code import code_hash

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
def site(setup: Setup, progress: dg.ResourceParam[Progress]) -> dg.MaterializeResult:
    """Pages people can look at, swapped in whole."""
    if is_stale := site_is_stale(setup.store):
        progress.step("making the site")
        make_site(setup)
    store = setup.store
    index = store.root / "site" / "index.html"
    return dg.MaterializeResult(
        data_version=dg.DataVersion(site_made_from(store)),
        metadata={
            "new": is_stale,
            "index": dg.MetadataValue.path(str(index.resolve())),
            SPREAD: _picture(setup),
        },
    )


def make_site(setup: Setup) -> None:
    """Makes the pages, with pictures drawn by other processes, and remembers from what."""
    from dashboards.site.render import build_site  # noqa: PLC0415 - Altair takes a second

    build_site(setup.store, workers.workers(setup.dask))
    setup.store.write(SITE_TABLE, pl.DataFrame(), site_made_from(setup.store))


def _picture(setup: Setup) -> dg.MarkdownMetadataValue:
    from dashboards.figures import png  # noqa: PLC0415 - Altair takes a second

    with Views(setup.store) as views:
        drawn = png(SPREAD, views.table(SPREAD), "nl")
    encoded = base64.b64encode(drawn).decode()
    return dg.MetadataValue.md(f"![{SPREAD}](data:image/png;base64,{encoded})")
