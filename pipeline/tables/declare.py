"""Dataframely, in which tables are declared; imported from here only.

By itself it imports SQLAlchemy, for the dtypes of other databases. Nothing here uses those, and
the import takes longer than most commands take to answer.
"""

import sys

_NOT_YET_THERE = "sqlalchemy" not in sys.modules
if _NOT_YET_THERE:
    sys.modules["sqlalchemy"] = None  # type: ignore[assignment]  # an import of it now fails
try:
    import dataframely as dy
finally:
    if _NOT_YET_THERE:
        del sys.modules["sqlalchemy"]

__all__ = ["dy"]
