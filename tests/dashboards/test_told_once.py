"""What a document says is the same on its page, in a terminal and in JSON, in either language."""

import re

import pytest

from dashboards import reports
from dashboards.document import Document
from dashboards.language import Language
from dashboards.queries.boats import read_boat
from dashboards.queries.results import Results
from dashboards.reading import read_blocks
from dashboards.site import list_pages
from dashboards.templates import get_template
from dashboards.terminal import to_text
from pipeline.assessment.checks import CODES
from pipeline.messages import LANGUAGES
from warehouse.queries.change_report import read_last_changes
from warehouse.queries.views import Views

FRAME = {"simulated": True, "has_reports": False, "path": "", "site_root": "", "other": "",
         "other_page": "", "code_version": ""}  # fmt: skip


@pytest.fixture(scope="module")
def results(store, site):
    with Views(store) as views:
        yield Results(views)


def render(template, data, language, **settings):
    document = Document(Language(language), "", data.get("chosen"), **settings)
    return document.render(template, **FRAME, **data)


def squeeze(text):
    return re.sub(r"\s+", " ", text)


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_terminal_says_every_statement_of_a_boats_page(results, language):
    for fsn_no in results.views.table("tows")["fsn_no"].unique().sort().head(6):
        page = render("boat", read_boat(results, fsn_no), language, pictures=False)
        said = [block.text for block in read_blocks(page, folded=True) if block.said]
        in_terminal = squeeze(to_text(page))
        assert said
        assert [text for text in said if squeeze(text) not in in_terminal] == []


def test_a_narrow_terminal_keeps_numbers_whole_and_names_what_it_leaves_out():
    rows = [{"name": "Razende Snol", "cw_kg_m": 31.25, "weight_kg": 812.0, "note": "word " * 9}]
    made = Document(Language("en")).table(rows, "name cw_kg_m | weight_kg note")
    for width in (200, 24):
        lines = to_text(made, width=width).splitlines()
        assert any("31.25" in line for line in lines)
        assert ("812" in "".join(lines)) == (width == 200)
        assert any("Weight" in line for line in lines)


def test_a_table_of_any_width_loses_no_letter_and_is_no_wider():
    rows = [
        {
            "name": "Razende Snol",
            "note": "het gelijkmatige deel",
            "why": "gemiddelde van quotiënten",
        },
        {"name": "Vlet", "note": "alles", "why": "verhouding van robuuste gemiddelden"},
    ]
    made = Document(Language("en")).table(rows, "name note why")
    for width in range(20, 110):
        table, _, left_out = to_text(made, width=width).partition("Left out")
        assert max(map(len, table.splitlines())) <= width
        for name in ("name", "note", "why"):
            title = Language("en").get_title(name)
            if title not in left_out:
                words = " ".join(row[name] for row in rows).split()
                assert [word for word in words if word not in table.split()] == [], (width, name)


def test_a_terminal_shows_headings_in_bold_and_verdicts_in_colour_and_says_the_same():
    html = '<h1>Vlet</h1><p data-said="let_go good">In orde.</p><p>Klaar.</p>'
    coloured = to_text(html, coloured=True)
    assert "\x1b[1mVlet\x1b[0m" in coloured
    assert "\x1b[32mIn orde.\x1b[0m\nKlaar." in coloured
    assert re.sub(r"\x1b\[\d+m", "", coloured).strip() == to_text(html)


def test_every_check_has_its_sentence_on_the_quay():
    names = Document(Language("en")).get_names()
    told = get_template("findings.html.j2").make_module(names).sentences
    assert set(CODES) - told.keys() == set(), "say it in dashboards/templates/findings.html.j2"


def get_words(block):
    """The words of a block without its numbers; of a table its titles."""
    text = " | ".join(block.rows[0]) if block.kind == "table" else block.text
    if block.kind == "terms":
        text = " | ".join(name for name, _ in block.rows)
    text = re.sub(r"\+[0-9a-f]{12}\b", "", text)  # of the code
    return re.sub(r"[-+\u2212]?\d[\d.,:]*", "9", text)


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_template_says_what_it_said(results, snapshot, language):
    """A page of each template, without numbers, names and pictures; guides are documents."""
    shown = {}
    for page in list_pages(results):
        if page.template not in (*shown, "guide"):
            html = render(page.template, page.query(), language, pictures=False)
            words = [get_words(block) for block in read_blocks(html, folded=True)]
            shown[page.template] = dict.fromkeys(filter(None, words))
    names = results.views.table("boats").select("name", "fsn_no", "boat_type").rows()
    text = "\n\n".join("\n".join((f"# {name}", *words)) for name, words in shown.items())
    known = {value for row in names for value in row if value}
    for value in sorted(known, key=len, reverse=True):
        text = text.replace(value, "*").replace(re.sub(r"\d+", "9", value), "*")
    snapshot(f"pages-{language}", text + "\n")


def test_nothing_is_left_unsaid(site):
    """No brace of a template, no None and no code of Python reaches a reader."""
    for file in sorted(site.rglob("*.html")):
        page = file.read_text("utf-8")
        text = re.sub(r"<(style|script|svg)\b.*?</\1>|<[^>]*>", " ", page, flags=re.DOTALL)
        assert not re.search(r"\{[a-z_]+\}|\bNone\b|datetime|\[\]|\bnan\b", text), file


def test_a_mail_says_what_the_page_says(built):
    run = reports.LastRun("2026-11-20T03:00", "changed", "", "2026-11-20T03:00")
    changes = read_last_changes(built.store)
    pages = reports.make_report_pages(built.store, changes, [], run)
    _, text = reports.write_mail(changes, [], simulated=True, run=run)
    in_page = squeeze(re.sub("<[^>]*>", "", pages["latest.html"]).replace("\u00a0", " "))
    lines = [line for line in text.split("\n\n")[1].splitlines() if line]
    assert lines
    assert [line for line in lines if squeeze(line.replace("\u00a0", " ")) not in in_page] == []
