"""The definitions after a change of the code of the steps, as Dagster loads them."""

import assets.archive  # noqa: F401 - before: its code stays what it is
from warehouse.store import code

code.code_hash = lambda *_: "other"

from assets.definitions import defs  # noqa: E402, F401
