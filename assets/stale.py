"""Whether a rebuild has work to do, as fingerprints say. Dagster, slow to import, is not asked."""

from collections.abc import Collection, Sequence
from pathlib import Path

from assets.site import SITE
from pipeline.errors import MissingKnowledgeError
from pipeline.method.definition import Method
from warehouse.derive.graph import STEPS
from warehouse.derive.inputs import forget_other_methods
from warehouse.intake import seasons as intake
from warehouse.queries.change_report import is_reported
from warehouse.store.store import Store


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
        or any(step.stale(store, methods) for step in (*STEPS, SITE))
        or not is_reported(store)
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
