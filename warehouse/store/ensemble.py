"""The members of a method's ensemble, read back from the lake.

What they are and what can be counted in them is in `pipeline.uncertainty.ensemble`; they are
written with the other tables of a method (`warehouse.derive.method_tables`).
"""

import polars as pl

from pipeline.errors import MissingKnowledgeError
from warehouse.store.store import Store

ENSEMBLE = "ensemble"


def read_ensemble(store: Store, method: str) -> pl.DataFrame:
    """The 200 equally likely values of Cw of every tow under a method.

    The members of a register are those of the tows its lines name.

    Returns:
        Rows of the table `ensemble`, sorted by tow and member.

    Raises:
        MissingKnowledgeError: the method was not applied to this archive.
    """
    path = store.table_path(ENSEMBLE, method)
    if not path.exists():
        raise MissingKnowledgeError(
            "{} is not there; make it with: herijk rebuild --archive DIR --data {} --method {}",
            path,
            store.root,
            method,
        )
    return store.read(ENSEMBLE, method)
