"""The text that goes with an edition: a notice to the members, in Dutch and English.

All words are in a template per language, kept for every version of the words: earlier editions are
made again with theirs. Here are the facts that it is filled in with, and how a language writes
numbers and days. No number is computed here.
"""

import datetime as dt
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Final

import jinja2
import polars as pl

from pipeline.errors import MissingKnowledgeError
from pipeline.messages import DECIMALS
from pipeline.method.definition import COMPLETE
from pipeline.register.register import NEWER_TOW_UNMEASURED
from warehouse.editions.compare import report
from warehouse.editions.printed import NOT_REBASED, REBASED
from warehouse.store.editions import CHANGES, NOTICE, NOTICE_EN, Edition

TEMPLATES: Final = Path(__file__).parent / "templates"
VERSION: Final = "1"
"""Of the words: the folder of the templates. Other words come in a new folder; this one stays."""

TEXTS: Final = {NOTICE: "nl", NOTICE_EN: "en"}
"""The texts of an edition, each with its language; a template has the name of its text."""


def texts(edition: Edition, previous: Edition | None) -> dict[str, str]:
    """All texts of an edition as Markdown, by file name, in the words of its version.

    Raises:
        MissingKnowledgeError: there are no such words.
    """
    facts = _facts(edition) | {"changes": None}
    if previous is not None:
        facts["changes"] = report(previous, edition, edition.tables[CHANGES])
    version = edition.manifest.texts_version or VERSION
    try:
        templates = {
            name: _environment(language).get_template(f"{version}/{name}")
            for name, language in TEXTS.items()
        }
    except jinja2.TemplateNotFound as error:
        raise MissingKnowledgeError(
            "its texts were written by another version of Herijk"
        ) from error
    return {name: template.render(facts) + "\n" for name, template in templates.items()}


def _facts(edition: Edition) -> dict[str, object]:
    register, method = edition.register, edition.method
    statuses = register["status"].value_counts().sort("count", "status", descending=True)
    rests_on_older_tow = pl.col("flags").list.contains(NEWER_TOW_UNMEASURED)
    return {
        "about": edition.manifest,
        "decision": edition.manifest.decision.strip().rstrip("."),
        "method": method,
        "statuses": statuses.rows(),
        "carried": register.filter(basis=REBASED).height,
        "not_rebased": register.filter(basis=NOT_REBASED).height,
        "unmeasured": register.filter(rests_on_older_tow).to_dicts(),
        "members": "ensemble" in edition.tables,
        "complete": method is not None and method.interval == COMPLETE,
    }


@cache
def _environment(language: str) -> jinja2.Environment:
    """Templates of a language, which write its numbers and days."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES),
        undefined=jinja2.StrictUndefined,
        autoescape=False,  # noqa: S701 - Markdown, not HTML
        trim_blocks=True,
        lstrip_blocks=True,
    )

    def written(form: str) -> Callable[[float | None], str]:
        def write(value: float | None) -> str:
            return "-" if value is None else format(value, form).replace(".", DECIMALS[language])

        return write

    def per_cent(ratio: float | None) -> str:
        return "-" if ratio is None else written("+z.2f")(100 * (ratio - 1)) + " %"

    def day(value: dt.date) -> str:
        from babel.dates import format_date  # noqa: PLC0415 - needed where texts are written

        return format_date(value, "d MMMM y", locale=language)

    environment.filters |= {
        "number": written(".2f"),
        "per_cent": per_cent,
        "seconds": lambda value: "-" if value is None else f"{value:+.0f} s",
        "day": day,
        "cell": lambda text: text.replace("|", r"\|").replace("\n", " "),
    }
    return environment
