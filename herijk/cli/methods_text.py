"""A method as text for a committee member: what it is, and its options with what they were."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from dashboards.option_labels import text
from herijk.cli.render import Part, Section, prose
from pipeline.messages import LANGUAGE, say, tell
from pipeline.method.definition import Method
from pipeline.method.options import find_basis
from pipeline.method.variant import Difference, differences
from pipeline.method.writing import range_text
from pipeline.tables.row import Row
from warehouse.store.methods import KnownMethods
from warehouse.store.store import Store


@dataclass(frozen=True)
class MethodReport:
    """A method, and what it does other than the one it extends.

    Attributes:
        method, title, description: what it is called, and what it is.
        content_hash: SHA-256 of what it says.
        extends: the method it extends.
        options: those that differ from it; all where it extends none.
    """

    method: str
    title: str
    description: str
    content_hash: str
    extends: str | None
    options: list[Difference]


def report_on(store: Store, name_or_file: str) -> MethodReport:
    """What there is to say of a method.

    Raises:
        HerijkError: there is no such method or file, or it has an error.
    """
    known = KnownMethods.of(store)
    shown = known.named(name_or_file)
    options = differences(shown, known.get(shown.extends)) if shown.extends else _all_options(shown)
    return MethodReport(
        method=shown.name,
        title=shown.get_title(LANGUAGE.get()),
        description=shown.get_description(LANGUAGE.get()).strip(),
        content_hash=shown.content_hash,
        extends=shown.extends,
        options=list(options),
    )


def _all_options(shown: Method) -> list[Difference]:
    return [
        Difference(step, option, block.first, block.last, (), value)
        for block in shown.ranges
        for step, options in block.steps
        for option, value in options
    ]


def methods(report: dict[str, list[Row]]) -> Iterator[Part]:
    """The list of methods."""
    rows = [row | {"content_hash": row["content_hash"][:12]} for row in report["methods"]]
    yield Section(rows=rows, columns="method title content_hash")


def method(report: MethodReport) -> Iterator[Part]:
    """A method with its options."""
    yield f"{report.method}: {report.title}"
    yield prose(report.description)
    about = (
        tell("It extends {}, and differs from it in:", report.extends)
        if report.extends
        else tell("It extends no other method; all its options:")
    )
    yield options_table(report.options, report.extends or "", report.method, about)
    yield tell("Content hash {}", report.content_hash)


def options_table(options: Sequence[Difference], old: str, new: str, title: str = "") -> Section:
    """Options, one a line, as a method's file has them and in words, with what they were."""
    rows = [
        {
            "name": f"{one.step}.{one.option}",
            "seasons": range_text(one.first, one.last),
            "before": ", ".join(map(json.dumps, one.before)),
            "after": json.dumps(one.after),
            "in_words": tell(text(f"{one.step}.{one.option}")),
            "status": tell(text(f"status.{find_basis(one.step, one.option, one.after).status}")),
        }
        for one in options
    ]
    heads = {"name": say("option"), "seasons": say("seasons"), "before": old, "after": new}
    columns = f"name seasons {'before ' if old else ''}after in_words status"
    return Section(title, rows=rows, columns=columns, heads=heads)
