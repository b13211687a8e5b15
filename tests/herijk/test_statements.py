"""A statement says the same wherever it stands: another value of it is shown on every surface."""

import json
from dataclasses import replace

import pytest

from dashboards.documents import certificate, proposal
from dashboards.site.boats import boat_pages
from dashboards.site.pages import shared_pages
from dashboards.site.render import Edition
from dashboards.site.types import type_pages
from dashboards.statements import Change, Number, Statement
from tests.conftest import METHODS
from warehouse.queries.views import Views
from warehouse.store.methods import KnownMethods

DRAFT = f"concept-{METHODS[-1]}"
SENTINEL = 7654321
SHOWN_ON = {
    "register": {"register.html", "register"},
    "changed_lines": {"index.html", "changes.html", "proposal"},
    "statuses": {"quality.html"},
    "cw": {"boat", "audit"},
    "interval": {"boat", "audit", "certificate"},
    "cause": {"boat", "audit"},
    "two_hours": {"boat", "audit"},
    "next_tow": {"boat", "audit"},
    "level": {"types", "type", "audit of a type"},
    "slope": {"types", "type", "audit of a type"},
    "bends": {"types", "type", "audit of a type"},
}
"""Pages, commands and documents that show a kind of statement."""


def level_known(views):
    """The type of which most tows are on a line against weight."""
    lines = views.table("type_lines").filter(
        method=METHODS[-1], quantity="cw_standard_kg_m", explaining="weight_kg", within="all",
        tows="newest",
    )  # fmt: skip
    return lines.drop_nulls("slope").sort("n")["boat_type"][-1]


def surfaces(store, herijk, kept):
    """The text of every surface by its name."""
    shown = {}
    with Views(store) as views:
        line = views.register().filter(edition=DRAFT).drop_nulls("cw_kg_m").row(0, named=True)
        site, made = Edition(views, "en"), shared_pages(views, by_reports=False)
        pages = [
            page for name in ("start", "register", "changes", "quality") for page in made[name]()
        ]
        shown |= {page.path: site.html(page) for page in pages}
        own = dict(boat_pages(views, METHODS))[line["fsn_no"]]
        shown["boat"] = site.html(own())
        of_type = level_known(views)
        shown["types"] = site.html(made["types"]()[0])
        shown["type"] = next(
            site.html(page) for page in type_pages(views, METHODS) if page.name == of_type
        )
        certificate.certificates(views, DRAFT, line["fsn_no"], "en", certificate.Issued())
        against = f"concept-{METHODS[0]}"
        proposal.proposal(views, [METHODS[-1]], against, "en", KnownMethods.of(store))
    shown |= dict(zip(("certificate", "proposal"), map(json.dumps, kept), strict=True))
    kept.clear()
    commands = {
        "audit": ("audit", line["fsn_no"], "--edition", DRAFT),
        "register": ("register", DRAFT),
        "audit of a type": ("audit", of_type),
    }
    for name, command in commands.items():
        shown[name] = herijk(*command, "--data", store.root)[1]
    return {name: " ".join(text.split()) for name, text in shown.items()}


def planted(kind, made):
    """Makes statements of a kind say the sentinel in place of their first number."""
    real = Statement.__init__

    def init(self, *parts, **named):
        real(self, *parts, **named)
        if self.kind != kind:
            return
        numbers = [(n, v) for n, v in self.values.items() if isinstance(v, Number | Change | int)]
        if not numbers:
            return
        name, value = numbers[0]
        if isinstance(value, Change):
            other = Change(SENTINEL)
        else:
            other = SENTINEL if isinstance(value, int) else replace(value, value=SENTINEL)
        object.__setattr__(self, "values", {**self.values, name: other})
        made.append(self)

    return init


@pytest.mark.parametrize("kind", SHOWN_ON)
def test_another_value_of_a_statement_is_shown_everywhere(kind, built, herijk, monkeypatch):
    kept = []
    for module in (certificate, proposal):
        monkeypatch.setattr(module, "pdf", lambda _, content: kept.append(content) or b"")
    made = []
    monkeypatch.setattr(Statement, "__init__", planted(kind, made))
    shown = surfaces(built.store, herijk, kept)
    sentinel = str(100 * (SENTINEL - 1) if kind == "cause" else SENTINEL)
    assert {name for name, text in shown.items() if sentinel in text} == SHOWN_ON[kind]
    assert made
