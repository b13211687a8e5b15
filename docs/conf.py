"""The documents and the reference of the library as pages: `make docs`. No network is needed."""

import re
from collections.abc import Iterable, Iterator
from dataclasses import astuple
from importlib.metadata import version as installed_version
from typing import Any, Literal, get_args, get_origin

from click.testing import CliRunner
from pydantic.fields import FieldInfo

from herijk.cli.main import app
from pipeline.assessment.checks import CHECK, Check
from pipeline.method.options import Steps
from pipeline.tables.schemas import STUDY, TABLES, summarize_table
from pipeline.tables.views import VIEWS

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

OPTIONS = {
    f"{step}.{option}": field
    for step, options in Steps.model_fields.items()
    for option, field in options.annotation.model_fields.items()
}

HEADS = {
    "| check | what is observed | source of the limit |": "asks | limit |",
    "| option | meaning |": "status | source | values | default |",
}

CONTENTS = """
```{toctree}
:hidden:
:glob:

*
nl/*
```
"""


def _add_contents(_app: Any, name: str, text: list[str]) -> None:
    """Adds what the program knows: pages, helps, tables, limits of checks, values of options."""
    if name == root_doc:
        text[0] += CONTENTS
    if name == "command-line":
        text[0] += "".join(_helps())
    if name == "results":
        text[0] += "".join(_tables())
    if name == "method-details":
        for head, added in HEADS.items():
            lines = "| --- " * added.count("|")
            text[0] = text[0].replace(f"{head}\n", f"{head} {added}\n{lines}")
        text[0] = re.sub(r"^\| .*\|$", lambda row: _with_columns(row[0]), text[0], flags=re.M)


def _tables() -> Iterator[str]:
    """Every table and view with the first sentence of its meaning."""
    yield "\n## All tables\n\n| table | a row is |\n| --- | --- |\n"
    for name, table in TABLES.items():
        yield f"| `{'study.' * (name in STUDY)}{name}` | {summarize_table(table)} |\n"
    for name, view in VIEWS.items():
        yield f"| `{name}` | {view.meaning} |\n"


def _with_columns(row: str) -> str:
    """A row of a table of checks or options, with the columns that the program knows."""
    names = re.findall(r"`([\w.]+)`", row.partition(" | ")[0])
    if names and set(names) <= set(CHECK):
        checks = [CHECK[name] for name in names]
        return f"{row} {_one(c.severity for c in checks)} | {_one(map(_limit, checks))} |"
    if names and set(names) <= set(OPTIONS):
        fields = [OPTIONS[name] for name in names]
        given = (_status, _source, _values, _default)
        return " ".join([row, *(f"{_one(map(of, fields))} |" for of in given)])
    return row


def _one(texts: Iterable[str]) -> str:
    """The texts, each once."""
    return "; ".join(dict.fromkeys(texts))


def _limit(check: Check) -> str:
    def of_class(crew_class: str) -> str:
        low, high = check.limits(crew_class)
        if low is None:
            return f"at most {high:g}"
        return f"at least {low:g}" if high is None else f"{low:g} to {high:g}"

    men, women = map(of_class, "HD")
    limit = men if men == women else f"H {men}, D {women}"
    return limit if check.unit == "1" else f"{limit} {check.unit}"


def _status(field: FieldInfo) -> str:
    return _of_values(field, "status", 0)


def _source(field: FieldInfo) -> str:
    return _of_values(field, "source", 1)


def _of_values(field: FieldInfo, name: str, place: int) -> str:
    """Where an option comes from, and the values of it that come from elsewhere."""
    basis = field.json_schema_extra
    others = (f"`{value}`: {other[place]}" for value, other in basis["but"].items())
    return "; ".join([str(basis[name]), *others])


def _values(field: FieldInfo) -> str:
    if get_origin(field.annotation) is Literal:
        return ", ".join(f"`{value}`" for value in get_args(field.annotation))
    bounds = [f"{number:g}" for bound in field.metadata for number in astuple(bound)]
    return " to ".join(bounds) or "codes of checks"


def _default(field: FieldInfo) -> str:
    return "must be given" if field.is_required() else f"`{field.default}`"


def _helps() -> Iterator[str]:
    """What each command says of itself."""
    for name, command in sorted(app.commands.items()):
        for path in ([name], *([name, inner] for inner in getattr(command, "commands", ()))):
            said = CliRunner().invoke(app, [*path, "--help", "--lang", "en"]).output
            yield f"\n## herijk {' '.join(path)}\n\n```text\n{said}\n```\n"


def setup(app: Any) -> None:
    """Called by Sphinx."""
    app.connect("source-read", _add_contents)
