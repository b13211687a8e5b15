"""The site of plain files as a step: made from the database that is in place."""

from pathlib import Path
from typing import Final

import polars as pl

from assets import workers
from dashboards.guides import GUIDES, guide_file
from pipeline.messages import CATALOGUES, LANGUAGES
from warehouse.derive.step import Step
from warehouse.store.code import COMPUTING
from warehouse.store.files import file_sha256
from warehouse.store.store import Store, fingerprint


def site(warehouse_database: pl.DataFrame, store: Store) -> pl.DataFrame:  # noqa: ARG001 - a step reads what it names
    """Pages people can look at, swapped in whole."""
    from dashboards.site.render import build_site  # noqa: PLC0415 - Altair takes a second

    build_site(store, workers.in_parallel)
    return pl.DataFrame()


def _files() -> str:
    """The files, beside code, of which pages are made."""
    folder = Path(__file__).parents[1] / "dashboards"
    files = [f for f in folder.rglob("*.*") if f.parent.name in {"static", "templates"}]
    files += Path(CATALOGUES).rglob("*.mo")
    files += [guide_file(name, language) for name in GUIDES for language in LANGUAGES]
    return fingerprint([file_sha256(file) for file in sorted(files)])


SITE: Final = Step(
    "site",
    site,
    ("site",),
    code=("dashboards", "warehouse.queries", "warehouse.editions", *COMPUTING),
    also=_files(),
    is_whole=lambda store: (store.root / "site" / "index.html").exists(),
)
