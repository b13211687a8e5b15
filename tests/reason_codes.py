"""The reason codes that `docs/archive.md` explains."""

import re
from pathlib import Path

_PAGE = Path(__file__).parents[1].joinpath("docs/archive.md").read_text("utf-8")
_SET_ASIDE = _PAGE.split("\n## What is set aside\n")[1].split("\n## ")[0]

REASON_CODES = set(re.findall(r"^\| `(\w+)` \|", _SET_ASIDE, re.MULTILINE))
