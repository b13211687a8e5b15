"""From templates to HTML: what the site and the workbench share.

Everything that comes from the archive is escaped: by Jinja in HTML, by `as_json` in data blocks.
"""

import json
import re
from pathlib import Path

import jinja2


def environment(*templates: Path, **names: object) -> jinja2.Environment:
    """Templates of folders, which know these names; a name that they do not know is an error."""
    made = jinja2.Environment(
        loader=jinja2.FileSystemLoader(templates),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    made.globals.update(names)
    made.filters["keep_units"] = keep_units
    return made


def keep_units(text: str) -> str:
    """A sentence in which a number and its unit stay on one line."""
    return re.sub(r"(?<=\d) (?=(%|kg/m|m/s|kg|W|N|s)(\W|$))", "\u00a0", text)


def as_json(value: object) -> str:
    """JSON that may be put inside a script element: no text in it can close the element."""
    text = json.dumps(value, separators=(",", ":"), ensure_ascii=False, default=str)
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")
