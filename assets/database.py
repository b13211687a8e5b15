"""What readers use: the database and the site; and what the checks and the report say of them."""

import datetime as dt
from typing import Final

import dagster as dg
import polars as pl

from assets.checks import evaluate_checks
from assets.lake import Folders, incremental
from assets.report import write_report
from assets.workers import map_in_parallel
from warehouse.derive import database as duck
from warehouse.store.code import hash_code

SHOWING: Final = ("dashboards", "pipeline", "warehouse")
"""Packages with which pages are made; their words count too."""


@dg.asset
@incremental()
def objection_terms(folders: Folders) -> pl.DataFrame:
    """To whom, until when and on which grounds a number can be objected to, by `beheer.toml`."""
    settings = folders.settings
    until = settings.objections_until
    terms = {
        "objections_to": settings.objections_to,
        "objections_until": until.isoformat() if until else "",
        "objection_grounds": settings.objection_grounds,
    }
    return pl.DataFrame({"key": list(terms), "value": list(terms.values())})


@dg.asset(deps=duck.IN_DATABASE)
@incremental(also=duck.describe_contents(), is_whole=duck.is_whole)
def warehouse_database(
    folders: Folders, about_archive: pl.DataFrame, objection_terms: pl.DataFrame
) -> pl.DataFrame:
    """All tables in one DuckDB file, swapped in whole, with the meaning of each column."""
    tables = {name: folders.store.read(name) for name in duck.IN_DATABASE}
    return duck.warehouse_database(tables, about_archive, objection_terms, folders.store)


@dg.asset(deps=[warehouse_database], code_version=hash_code(*SHOWING, __name__))
@incremental(code=SHOWING, is_whole=lambda store: (store.root / "site" / "index.html").exists())
def site(folders: Folders) -> pl.DataFrame:
    """Pages people can look at, swapped in whole; the table lists the pages that failed."""
    from dashboards.site import build_site  # noqa: PLC0415 - Typst takes a while

    made = build_site(folders.store, each=map_in_parallel)
    return pl.DataFrame([made], schema_overrides={"failed": pl.List(pl.String)})


@dg.asset(deps=[warehouse_database, site, "samples", "unforeseen", "quarantine"])
def check_results(folders: Folders) -> dg.MaterializeResult:
    """Make every check of the tables; Dagster's checks and the report show the outcome."""
    frame = evaluate_checks(folders.store, folders.settings)
    failed = frame.filter(pl.col("number") > 0)
    return dg.MaterializeResult(value=frame, metadata={"failed": failed["check"].to_list()})


@dg.asset(deps=[warehouse_database])
def report(folders: Folders, check_results: pl.DataFrame) -> dg.MaterializeResult:
    """Return what changed since the last report: a page, JSON, and its headlines."""
    news = write_report(folders.store, check_results, dt.datetime.now().astimezone())
    return dg.MaterializeResult(
        value=pl.DataFrame({"headline": news.headlines}, schema={"headline": pl.String}),
        metadata={
            "headlines": news.headlines,
            "page": dg.MetadataValue.path(str(folders.store.root / "report" / "latest.html")),
        },
    )
