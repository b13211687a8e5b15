"""A statement says the same wherever it stands: another value of it is shown on every surface."""

import json
from collections import defaultdict
from dataclasses import replace
from itertools import count

import pytest

from dashboards.documents import certificate, proposal
from dashboards.site.boats import boat_pages
from dashboards.site.pages import shared_pages
from dashboards.site.render import Edition
from dashboards.speech import Speech
from dashboards.statements import Change, Number, Statement
from dashboards.statements.rebuild import LastRun, headlines, judged, mail
from tests.conftest import METHODS
from warehouse.queries.answers import line_changes
from warehouse.queries.change_report import ChangeReport
from warehouse.queries.views import Views
from warehouse.store.methods import KnownMethods

DRAFT = f"concept-{METHODS[-1]}"
SENTENCE = 40
"""What is shorter may be said by chance."""
SHOWN_ON = {
    "assess assess--json": "like_boats log2_differs others_of_season provisional",
    "assess assess--json audit-boat audit-boat--json boats certificate": "interval",
    "audit-boat audit-boat--json boats": (
        "cause cw next_tow place_in_type power predicted race_place two_hours"
    ),
    "audit-type audit-type--json types": "other_causes quantity",
    "audit-type audit-type--json types types.html": "farthest slope spread",
    "audit-type--json types types.html": "classes hull_speed",
    "boats.html register-due register-due--json": "due",
    "certificate": "before certified",
    "changes.html compare index.html proposal": "beyond changed_lines",
    "index.html mail rebuild": "number",
    "index.html seasons.html": "season_change",
    "mail": "by",
    "mail rebuild": "factors judged lines",
    "method-as-published.html method.html proposal": "register_rule runs_alone",
    "method.html proposal": (
        "correction effect worked_cause worked_change worked_corrections worked_curve "
        "worked_power worked_run worked_tow"
    ),
    "proposal": "flagged",
    "quality.html": "statuses",
    "years.html": "register_then",
    "register register--json register.html": "register",
    "seasons seasons--json seasons.html": "log_off",
    "seasons.html": "reproducibility",
}
"""By the surfaces the kinds of statement that they show."""


def most_of(frame, column):
    return frame.group_by(column).len().sort("len", column)[column][-1]


@pytest.fixture
def papers(monkeypatch):
    """What is set as PDF, instead of setting it."""
    kept = {}
    for module in (certificate, proposal):
        name = module.__name__.rpartition(".")[2]
        monkeypatch.setattr(
            module, "pdf", lambda _, content, name=name: kept.update({name: content}) or b""
        )
    return kept


@pytest.fixture
def surfaces(built, herijk, papers):
    """Gives the text of every surface by its name."""
    with Views(built.store) as views:
        lines = views.register().filter(edition=DRAFT).drop_nulls("cw_kg_m")
        line = lines.row(0, named=True)
        boat_type = most_of(views.table("compared_tows"), "boat_type")
        changed = line_changes(views).filter(change="changed").head(3).to_dicts()
    news = ChangeReport(
        first=False, tows=[{"what": "new"}], seasons_gone=[], editions=[], methods=[], set_aside=[],
        factors=[{}], lines=changed,
        judged={"method": DRAFT, "accepted": 1, "flagged": 1, "rejected": 0},
    )  # fmt: skip
    run = LastRun("2026-11-20T03:00:00+01:00", "changed", "", "2026-11-20T03:00:00+01:00")
    commands = {
        "audit-boat": ("audit", line["fsn_no"], "--edition", DRAFT),
        "audit-type": ("audit", boat_type),
        "register": ("register", DRAFT),
        "register-due": ("register", DRAFT, "--due"),
        "compare": ("compare", METHODS[0], METHODS[-1]),
        "seasons": ("seasons", "--method", METHODS[-1]),
        "assess": ("assess", line["tow_id"], "--archive", built.archive),
    }

    def pages(views):
        for make in shared_pages(views, by_reports=False).values():
            for page in make():
                yield "/".join(page.path.split("/")[:-1]) or page.path, page
        yield "boats", dict(boat_pages(views, METHODS))[line["fsn_no"]]()

    def shown():
        with Views(built.store) as views:
            site = Edition(views, "en")
            texts = defaultdict(str)
            for path, page in pages(views):
                texts[path] += site.html(page)
            certificate.certificates(views, DRAFT, line["fsn_no"], "en", certificate.Issued())
            against = f"concept-{METHODS[0]}"
            proposal.proposal(views, [METHODS[-1]], against, "en", KnownMethods.of(built.store))
        texts |= {name: json.dumps(content, default=str) for name, content in papers.items()}
        for name, command in commands.items():
            for form in ((), ("--json",)):
                text = herijk(*command, *form, "--data", built.store.root)[1]
                texts["".join((name, *form))] = text
        texts["mail"] = "\n".join(mail(news, (), simulated=True, run=run))
        texts["rebuild"] = "\n".join(
            one(Speech("en")) for one in [*headlines(news, ()), judged(news)]
        )
        return {name: " ".join(text.split()) for name, text in texts.items()}

    return shown


def with_sentinels(kinds):
    """Makes the first number of every statement a number of its kind."""
    real = Statement.__init__

    def init(self, *parts, **named):
        real(self, *parts, **named)
        for name, value in self.values.items():
            if isinstance(value, Number | Change) or type(value) is int:
                mark = kinds[self.kind]
                if isinstance(value, Number):
                    other = replace(value, value=mark)
                else:
                    other = Change(1 + mark / 100) if isinstance(value, Change) else mark
                object.__setattr__(self, "values", {**self.values, name: other})
                return

    return init


def test_another_value_of_a_statement_is_shown_everywhere(surfaces, monkeypatch):
    said = set()
    speak = Statement.__call__
    numbers = count(7_613_041)  # like no number that is said
    kinds = defaultdict(lambda: next(numbers))

    def recorded(self, speech):
        text = speak(self, speech)
        if any(isinstance(value, Number | Change | int) for value in self.values.values()):
            said.add(" ".join(text.split()))
        return text

    with monkeypatch.context() as patched:
        patched.setattr(Statement, "__call__", recorded)
        surfaces()
    monkeypatch.setattr(Statement, "__init__", with_sentinels(kinds))
    shown = surfaces()
    found = {
        kind: " ".join(sorted(name for name, text in shown.items() if str(mark) in text))
        for kind, mark in kinds.items()
    }
    assert found == {kind: on for on, of in SHOWN_ON.items() for kind in of.split()}
    old = [text for text in said if len(text) > SENTENCE]
    assert old
    assert [(name, one) for name, text in shown.items() for one in old if one in text] == []
