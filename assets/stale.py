"""What a rebuild has to make, as fingerprints say. Dagster, slow to import, is not asked."""

from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Final

from dashboards.guides import GUIDES, guide_file
from pipeline.errors import MissingKnowledgeError
from pipeline.messages import CATALOGUES, LANGUAGES
from pipeline.method.definition import Method
from warehouse.derive.database import DATABASE_TABLE
from warehouse.derive.graph import DATABASE, STEPS
from warehouse.derive.inputs import forget_other_methods
from warehouse.intake import seasons as intake
from warehouse.queries.change_report import is_reported
from warehouse.store.code import COMPUTING, code_hash
from warehouse.store.files import file_sha256
from warehouse.store.store import Store, fingerprint

SITE_CODE: Final = ("dashboards", "warehouse.queries", "warehouse.editions", *COMPUTING)
SITE_TABLE: Final = "site"
"""An empty table that remembers what the site was made from."""


def stale_assets(
    archive: Path, store: Store, methods: Sequence[Method], wanted: Collection[int] | None
) -> list[str]:
    """Looks through the archive, and at what was made of it.

    Returns:
        What has to be made again, or to be confirmed as what it is made from is; nothing where all
        is as it should be.

    Raises:
        MissingKnowledgeError: there is no archive, or nothing of the seasons that are wanted.
    """
    intake.index(store, archive)
    intake.forget_unlisted_seasons(store)
    forget_other_methods(store, {method.name for method in methods})
    _check_listed(wanted, intake.listed_seasons(store))
    again = {*intake.SEASON_TABLES} if intake.stale_seasons(store, archive, wanted) else set()
    made: list[str] = []
    others = _others_were_applied(store, methods)
    for step in STEPS:
        if others or not again.isdisjoint(step.reads) or step.stale(store, methods):
            again.update(step.outputs)
            made += step.outputs
    if again.isdisjoint(DATABASE.outputs) and not is_reported(store):
        made += DATABASE.outputs
    if not (made or site_is_stale(store)):
        return []
    return [*intake.INDEXED, "samples", "blocks", *made, SITE_TABLE]


def _others_were_applied(store: Store, methods: Sequence[Method]) -> bool:
    """Whether the last rebuild applied other methods than these."""
    if store.made_from("methods") is None:
        return True
    return list(store.read("methods")["method"]) != sorted(method.name for method in methods)


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
