"""The Dagster code location: what `dg`, `dagster dev` and `herijk serve` load."""

import os
from pathlib import Path

from herijk.assets.location import build_defs
from herijk.assets.settings import read_settings

defs = build_defs(
    os.environ.get("HERIJK_ARCHIVE", "archive"),
    os.environ.get("HERIJK_DATA", "data"),
    read_settings(Path(os.environ.get("HERIJK_DATA", "data"))),
    os.environ.get("HERIJK_SITE", ""),
)
