"""The documents and the reference of the library as pages: `make docs`. No network is needed."""

from collections.abc import Iterator
from importlib.metadata import version as installed_version
from typing import Any

import typer.main
from typer.testing import CliRunner

from herijk.cli.main import app

project = "Herijk"
author = "The Herijk authors"
copyright = author  # noqa: A001 - Sphinx's name
version = release = installed_version("herijk")
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx.ext.mathjax"]
root_doc = "index"
exclude_patterns = ["_build"]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
# Pages link to files outside docs/, as on a forge; tests/architecture looks whether they are there.
suppress_warnings = ["myst.xref_missing", "misc.highlighting_failure"]  # the latter: mermaid
autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_type_aliases = {"ArrayLike": "ArrayLike", "FloatArray": "FloatArray"}
html_theme = "alabaster"
html_theme_options = {"description": "the register of rowing sloops, recomputed"}

CONTENTS = """
```{toctree}
:hidden:
:glob:

*
nl/*
decisions/*
```
"""


def _add_contents(_app: Any, name: str, text: list[str]) -> None:
    """Lists all pages beside each; in the source it would show as code on a forge."""
    if name == root_doc:
        text[0] += CONTENTS
    if name == "command-line":
        text[0] += "".join(_helps())


def _helps() -> Iterator[str]:
    """What each command says of itself."""
    for command in sorted(typer.main.get_command(app).commands):
        said = CliRunner().invoke(app, ["--lang", "en", command, "--help"]).output
        yield f"\n## herijk {command}\n\n```text\n{said}\n```\n"


def setup(app: Any) -> None:
    """Called by Sphinx."""
    app.connect("source-read", _add_contents)
