"""The text that goes with an edition: a notice to the members, in Dutch and English.

The words are in a template per language. Here are the facts that it is filled in with, and how a
language writes numbers and days. No number is computed here.
"""

import datetime as dt
from functools import cache
from pathlib import Path
from typing import Final

import jinja2
import polars as pl

from pipeline.messages import DECIMALS, write_in_language
from pipeline.method.definition import COMPLETE
from pipeline.register.printed import NOT_REBASED, REBASED
from pipeline.register.register import NEWER_TOW_UNMEASURED
from pipeline.tables.causes import name_cause
from pipeline.tables.row import Row
from warehouse.editions.compare import report
from warehouse.store.editions import CHANGES, NOTICE, NOTICE_EN, Edition

TEMPLATES: Final = Path(__file__).parent / "templates"
LANGUAGES: Final = {NOTICE: "nl", NOTICE_EN: "en"}
"""The texts of an edition, each with its language; a template has the name of its text."""


def texts(edition: Edition, previous: Edition | None) -> dict[str, str]:
    """Return all texts of an edition as Markdown, by file name."""
    register, method = edition.register, edition.method
    rests_on_older_tow = pl.col("flags").list.contains(NEWER_TOW_UNMEASURED)
    statuses = register["status"].value_counts().sort("count", "status", descending=True)
    facts = {
        "about": edition.manifest,
        "decision": edition.manifest.decision.strip().rstrip("."),
        "method": method,
        "statuses": statuses.rows(),
        "carried": register.filter(basis=REBASED).height,
        "not_rebased": register.filter(basis=NOT_REBASED).height,
        "unmeasured": register.filter(rests_on_older_tow).to_dicts(),
        "members": "ensemble" in edition.tables,
        "complete": method is not None and method.interval == COMPLETE,
        "changes": None,
    }
    if previous is not None:
        facts["changes"] = report(previous, edition, edition.tables[CHANGES])
    return {
        name: _make_environment(language).get_template(name).render(facts) + "\n"
        for name, language in LANGUAGES.items()
    }


@cache
def _make_environment(language: str) -> jinja2.Environment:
    """Return the template environment of a language, which writes its numbers and days."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES),
        undefined=jinja2.StrictUndefined,
        autoescape=False,  # noqa: S701 - Markdown, not HTML
        trim_blocks=True,
        lstrip_blocks=True,
    )

    def number(value: float | None, form: str = ".2f") -> str:
        return "-" if value is None else format(value, form).replace(".", DECIMALS[language])

    def per_cent(ratio: float | None) -> str:
        return "-" if ratio is None else number(100 * (ratio - 1), "+z.2f") + " %"

    def day(value: dt.date) -> str:
        from babel.dates import format_date  # noqa: PLC0415 - needed where texts are written

        return format_date(value, "d MMMM y", locale=language)

    def cause(found: Row) -> str:
        return str(write_in_language(name_cause(found["cause"], found["step"]), language))

    environment.filters |= {
        "number": number,
        "per_cent": per_cent,
        "seconds": lambda value: "-" if value is None else f"{value:+.0f} s",
        "day": day,
        "cause": cause,
        "cell": lambda text: text.replace("|", r"\|").replace("\n", " "),
    }
    return environment
