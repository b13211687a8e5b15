"""The classes of crews that the archive of a data folder declares."""

import polars as pl

from pipeline.crews import STANDARD_CREWS
from warehouse.store.store import Store


def read_crew_classes(store: Store) -> pl.DataFrame:
    """Return the table `crew_classes`; the default where no archive was read yet."""
    if store.read_fingerprint("crew_classes") is None:
        return STANDARD_CREWS
    return store.read("crew_classes")
