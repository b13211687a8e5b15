"""Whether a rebuild has work to do, as fingerprints say. Dagster, slow to import, is not asked."""

from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Final

from dashboards.guides import GUIDES, guide_file
from pipeline.errors import MissingKnowledgeError
from pipeline.messages import CATALOGUES, LANGUAGES
from pipeline.method.definition import Method
from warehouse.derive.database import DATABASE_TABLE
from warehouse.derive.graph import STEPS
from warehouse.derive.inputs import forget_other_methods
from warehouse.intake import seasons as intake
from warehouse.queries.change_report import is_reported
from warehouse.store.code import COMPUTING, code_hash
from warehouse.store.files import file_sha256
from warehouse.store.store import Store, fingerprint

SITE_CODE: Final = ("dashboards", "warehouse.queries", "warehouse.editions", *COMPUTING)
SITE_TABLE: Final = "site"
"""An empty table that remembers what the site was made from."""


def is_stale(
    archive: Path, store: Store, methods: Sequence[Method], wanted: Collection[int] | None
) -> bool:
    """Looks through the archive, and whether anything made of it has to be made again.

    Raises:
        MissingKnowledgeError: there is no archive, or nothing of the seasons that are wanted.
    """
    intake.index(store, archive)
    intake.forget_unlisted_seasons(store)
    forget_other_methods(store, {method.name for method in methods})
    _check_listed(wanted, intake.listed_seasons(store))
    return (
        bool(intake.stale_seasons(store, archive, wanted))
        or any(step.stale(store, methods) for step in STEPS)
        or not is_reported(store)
        or site_is_stale(store)
    )


def _check_listed(wanted: Collection[int] | None, listed: Sequence[int]) -> None:
    """Refuses seasons of which the archive lists no tow: a typing error would pass unseen.

    Raises:
        MissingKnowledgeError: it lists none in any of them.
    """
    if wanted is not None and listed and not set(wanted) & set(listed):
        raise MissingKnowledgeError(
            "the archive lists no tow in the seasons asked for; it has tows of {}",
            ", ".join(map(str, listed)),
        )


def site_made_from(store: Store) -> str:
    """The database, and the code and files that make pages of it."""
    folder = Path(__file__).parents[1] / "dashboards"
    files = [f for f in folder.rglob("*.*") if f.parent.name in {"static", "templates"}]
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
