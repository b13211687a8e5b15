"""The site of plain files, made from the database that is in place."""

import logging

import dagster as dg
import polars as pl

from assets import workers
from assets.resources import Setup
from assets.stale import SITE_CODE, SITE_TABLE, site_is_stale, site_made_from
from pipeline.messages import say
from warehouse.derive.database import DATABASE_TABLE
from warehouse.store.code import code_hash


@dg.asset(
    deps=[DATABASE_TABLE],
    group_name="site",
    code_version=code_hash(*SITE_CODE),
)
def site(setup: Setup) -> dg.MaterializeResult:
    """Pages people can look at, swapped in whole."""
    store = setup.store
    if is_stale := site_is_stale(store):
        logging.getLogger("herijk").info(say("making the site"))
        from dashboards.site.render import build_site  # noqa: PLC0415 - Altair takes a second

        build_site(store, workers.in_parallel)
        store.write(SITE_TABLE, pl.DataFrame(), site_made_from(store))
    index = store.root / "site" / "index.html"
    return dg.MaterializeResult(
        data_version=dg.DataVersion(site_made_from(store)),
        metadata={"new": is_stale, "index": dg.MetadataValue.path(str(index.resolve()))},
    )
