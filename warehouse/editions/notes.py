"""The text that goes with an edition: a notice to the members, in Dutch and English.

Filled in from the edition and its comparison with the one before; no number is computed here. What
it says is in the templates beside this module, the words in `warehouse.editions.words`.
"""

from functools import cache
from pathlib import Path
from typing import Final

import jinja2

from pipeline.method.definition import COMPLETE
from pipeline.tables.row import Row
from warehouse.editions.compare import (
    Comparison,
    DiffReport,
    Group,
    report,
)
from warehouse.editions.printed import NOT_REBASED, REBASED
from warehouse.editions.words import (
    CHANGES,
    CREWS,
    DUTCH,
    ENGLISH,
    STATUSES,
    Language,
    table,
)
from warehouse.store.editions import NOTICE, NOTICE_EN, Edition

TEMPLATES: Final = Path(__file__).parent / "templates"
TEXTS: Final = {NOTICE: DUTCH, NOTICE_EN: ENGLISH}
"""The texts of an edition, each with its language; a template has the name of its text."""

CAUSE_HEAD: Final = (
    ("oorzaak", "cause"),
    ("regels", "lines"),
    ("mediaan", "median"),
    ("laagst", "lowest"),
    ("hoogst", "highest"),
)
LARGEST_HEAD: Final = (
    ("sloep", "boat"),
    ("naam", "name"),
    ("ploeg", "crew"),
    ("Cw oud [kg/m]", "Cw old [kg/m]"),
    ("Cw nieuw [kg/m]", "Cw new [kg/m]"),
    ("verschil", "change"),
    ("in twee uur", "in two hours"),
)
UNKNOWN_METHOD: Final = (
    "zoals destijds gedrukt; welke methode is niet vastgelegd",
    "as printed at the time; which one is not recorded",
)


def texts(edition: Edition, previous: Comparison | None) -> dict[str, str]:
    """All texts of an edition as Markdown, by file name."""
    changes = None if previous is None else report(previous)
    return {
        name: _template(name).render(_facts(edition, language) | _changes(changes, language)) + "\n"
        for name, language in TEXTS.items()
    }


@cache
def _template(name: str) -> jinja2.Template:
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES),
        undefined=jinja2.StrictUndefined,
        autoescape=False,  # noqa: S701 - Markdown, not HTML
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template(name)


def _facts(edition: Edition, language: Language) -> dict[str, object]:
    manifest = edition.manifest
    counts = edition.register["status"].value_counts().sort("count", "status", descending=True)
    carried, as_it_was = (
        edition.register.filter(basis=basis).height for basis in (REBASED, NOT_REBASED)
    )
    return {
        "edition": manifest.edition,
        "simulated": manifest.simulated,
        "decision": manifest.decision.strip().rstrip("."),
        "published_on": language.day(manifest.published_on),
        "valid_from": language.day(manifest.valid_from),
        "code_version": manifest.code_version,
        "method": _method(edition, language),
        "statuses": ", ".join(
            f"{count} {language.word(STATUSES, status)}" for status, count in counts.rows()
        ),
        "carried": language.count(carried) if carried else None,
        "not_rebased": language.count(as_it_was) if as_it_was else None,
        "carried_from": manifest.carried_from,
        "members": "ensemble" in edition.tables,
        "complete": edition.method is not None and edition.method.interval == COMPLETE,
    }


def _method(edition: Edition, language: Language) -> str:
    if edition.method is None:
        return language.one_of(UNKNOWN_METHOD)
    method = edition.method
    return f"{method.titled(language.code)} ({method.name}, {method.content_hash[:12]})"


def _changes(difference: DiffReport | None, language: Language) -> dict[str, object]:
    if difference is None:
        return {"changes": False}
    cause_head, largest_head = (
        tuple(map(language.one_of, head)) for head in (CAUSE_HEAD, LARGEST_HEAD)
    )
    unknown = difference.interval_unknown
    largest = [_largest(line, language) for line in difference.largest]
    named = [_cause(cause, language) for cause in difference.causes]
    return {
        "changes": True,
        "previous": difference.from_edition,
        "change_counts": ", ".join(
            f"{language.count(number)} {language.word(CHANGES, change)}"
            for change, number in difference.changes.items()
        ),
        "causes": table(cause_head, named) if named else "",
        "gain": _group(difference.gain, language),
        "loss": _group(difference.loss, language),
        "known": unknown < difference.changes.get("changed", 0),
        "exceeding": language.count(difference.exceeds_interval),
        "unknown": language.count(unknown) if unknown else "",
        "runs_alone": difference.runs_alone,
        "largest": table(largest_head, largest) if largest else "",
        "largest_count": len(largest),
    }


def _group(group: Group, language: Language) -> str:
    if not group.lines:
        return language.count(0)
    of_class = ", ".join(
        f"{language.word(CREWS, crew)} {number}" for crew, number in group.of_class.items()
    )
    median = language.one_of(("mediaan", "median"))
    return (
        f"{language.count(group.lines)} ({of_class}; {median} "
        f"{language.per_cent(group.median_power_ratio)}, "
        f"{language.seconds(group.median_seconds)})"
    )


def _cause(cause: Row, language: Language) -> tuple[str, ...]:
    factors = (cause[f"{which}_factor"] for which in ("median", "lowest", "highest"))
    return (
        language.cause(cause["cause"], cause["step"]),
        str(cause["lines"]),
        *(language.per_cent(factor) for factor in factors),
    )


def _largest(line: Row, language: Language) -> tuple[str, ...]:
    return (
        line["fsn_no"],
        line["name"] or "",
        f"{line['rowers']}{line['crew_class']}",
        language.number(line["old_cw_kg_m"]),
        language.number(line["new_cw_kg_m"]),
        language.per_cent(line["new_cw_kg_m"] / line["old_cw_kg_m"]),
        language.seconds(line["gain_in_two_hours_s"]),
    )
