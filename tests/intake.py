"""An archive read without a scheduler."""

from pathlib import Path

from warehouse.intake import seasons as intake
from warehouse.store.store import Store


def bring_in(store: Store, root: Path) -> None:
    """Brings what changed in an archive into the lake in this process.

    Raises:
        HerijkError: as `intake.index`.
    """
    intake.index(store, root)
    intake.forget_unlisted_seasons(store)
    for season in intake.stale_seasons(store, root):
        intake.read_season(store, root, season)
