"""The site: every page, escaped, alone, and the same bytes from the same tables."""

import hashlib
import json
import re

import polars as pl
import pytest

from dashboards import words
from dashboards.addresses import boat_path, edition_page, race_path, trace_path, type_path
from dashboards.document import Document
from dashboards.guides import GUIDES
from dashboards.language import Language
from dashboards.queries.pages import SHEETS
from dashboards.queries.results import Results
from dashboards.queries.votes import PAGE as PARTS
from dashboards.site import build_site, list_pages
from pipeline.register.register import choose_default_method
from pipeline.tables.display import TITLES, Kind, get_column
from tests.conftest import METHODS
from tests.dashboards.conftest import ATTACK, EDITIONS
from tests.dashboards.test_answer import LINE
from tests.texts import said
from warehouse.queries.answers import choose_newest_edition, read_line_answers
from warehouse.queries.views import Views
from warehouse.store.store import Store

FILE_OF_LINK = r"([^\"#:?]+)(?:[?#][^\"]*)?"
"""The file that a link of the site names; what is shown of it may follow."""


def pages(site):
    return sorted(site.rglob("*.html"))


def hashes(site):
    return {
        str(f.relative_to(site)): hashlib.sha256(f.read_bytes()).hexdigest()
        for f in sorted(site.rglob("*"))
        if f.is_file()
    }


@pytest.fixture(scope="module")
def results(store, site):
    with Views(store) as views:
        yield Results(views)


def test_every_page_is_there(site, built, results):
    names = {str(f.relative_to(site)) for f in pages(site)}
    listed = {page.path for page in list_pages(results)}
    assert names == listed | {f"en/{path}" for path in listed}
    subjects = {boat_path(fsn_no) for fsn_no in built.table("boats")["fsn_no"]}
    subjects |= {f"{name}.html" for name in GUIDES}
    subjects |= {edition_page(edition) for edition in EDITIONS}
    subjects |= {
        f"method-{name}.html" for name in METHODS if name != choose_default_method(METHODS)
    }
    subjects |= {type_path(name) for name in results.views.type_names()}
    subjects |= {race_path(race, day) for race, day in results.views.race_days()}
    assert subjects - listed == set()
    assert PARTS in listed


@pytest.mark.more
def test_without_a_proposal_no_page_leads_to_its_parts(bench):
    bench.rebuild(METHODS[:1])
    with Views(bench.store) as views:
        results = Results(views)
        listed = {page.path: page for page in list_pages(results)}
        assert PARTS not in listed
        assert not any(listed[path].query()["has_parts"] for path in ("index.html", "changes.html"))


def test_every_page_can_be_reached_from_the_first(site):
    """By links, or by the search for boats, types and races."""
    script = (site / "static" / "find.js").read_text("utf-8")
    found = [path for _, _, path in json.loads(script.partition("=")[2].rstrip(";\n"))]
    reached, ahead = set(), [site / "index.html", *(site / path for path in found)]
    while ahead:
        page = ahead.pop().resolve()
        if page in reached or page.suffix != ".html" or not page.is_relative_to(site.resolve()):
            continue
        reached.add(page)
        links = re.findall(rf'href="{FILE_OF_LINK}"', page.read_text("utf-8"))
        ahead += [page.parent / link for link in links]
    lost = [str(file) for file in pages(site) if file.resolve() not in reached]
    assert lost == [], "link each from a page of its subject, or from the menu in page.html.j2"


def test_every_page_says_that_it_is_simulated(site):
    marks = {"nl": "GESIMULEERD", "en": "SIMULATED"}
    for file in pages(site):
        language = "en" if file.is_relative_to(site / "en") else "nl"
        assert marks[language] in file.read_text("utf-8"), file


def test_names_are_escaped_everywhere(site, attacked):
    escaped = ATTACK.replace("<", "&lt;").replace(">", "&gt;")
    assert not any(ATTACK in file.read_text("utf-8") for file in pages(site))
    for name in ("boats.html", boat_path(attacked)):
        assert escaped in (site / name).read_text("utf-8")
    assert ATTACK not in (site / "static" / "find.js").read_text("utf-8")


def test_an_answer_is_told_all_that_it_says(results):
    columns = read_line_answers(results.views, EDITIONS[-1]).columns
    assert LINE.keys() - {"objection"} <= set(columns)


def test_no_file_names_an_address(site):
    own = [f for f in site.rglob("*") if f.suffix in {".html", ".css", ".js", ".svg"}]
    texts = {f.name: re.sub(r' xmlns(:\w+)?="[^"]+"', "", f.read_text("utf-8")) for f in own}
    assert [name for name, text in texts.items() if re.search(r"https?://|//[a-z]+\.", text)] == []


def test_links_lead_to_files(site):
    broken = [
        f"{file.name}: {link}"
        for file in pages(site)
        for link in re.findall(rf'(?:href|src)="{FILE_OF_LINK}"', file.read_text("utf-8"))
        if not (file.parent / link).exists()
    ]
    assert broken == []


def test_what_is_searched_leads_to_pages(site):
    script = (site / "static" / "find.js").read_text("utf-8")
    found = json.loads(script.partition("=")[2].rstrip(";\n"))
    assert found
    assert all((site / path).exists() for _, _, path in found)


@pytest.mark.more
def test_same_tables_same_bytes(store, site):
    before = hashes(site)
    build_site(store)
    assert hashes(site) == before


def test_a_number_on_a_page_is_the_warehouse_s(site, built):
    line = built.table("register").filter(pl.col("cw_kg_m").is_not_null()).row(0, named=True)
    text = (site / boat_path(line["fsn_no"])).read_text("utf-8")
    shown = f"{line['cw_kg_m']:.2f}".replace(".", ",")
    assert f"<td>{shown}<" in text


def rows_of(html):
    """Yield the rows of a table: whether each is hidden, and its cells."""
    for attributes, body in re.findall(r"<tbody([^>]*)>(.*?)</tbody>", html, re.DOTALL):
        for cells in body.split("<tr>")[1:]:
            yield " hidden" in attributes, re.findall(r"<td[^>]*>(.*?)(?=<td|$)", cells)


def tables(page):
    """The tables of a page: titles, and rows with whether each is hidden and its cells."""
    text = page.read_text("utf-8")
    for table in re.findall(r'<div class="table".*?</table>', text, re.DOTALL):
        head, body = re.search(r"<thead>(.*?)</thead>(.*)", table, re.DOTALL).groups()
        titles = [
            re.sub(r"^[^>]*>|[\u00ad\u200b]", "", cell).strip() for cell in head.split("<th")[1:]
        ]
        yield titles, list(rows_of(body))


def test_the_edition_that_is_chosen_is_shown_and_the_others_are_hidden(site, results):
    titles, rows = next(tables(site / "register.html"))
    codes = [(hidden, cells[titles.index("Controlecode")]) for hidden, cells in rows]
    lines = results.register
    chosen = lines.filter(edition=EDITIONS[-1])["verification_code"].to_list()
    assert [code for hidden, code in codes if not hidden] == chosen
    others = lines.filter(pl.col("edition") != EDITIONS[-1])["verification_code"].drop_nulls()
    assert set(others) <= {code for _, code in codes}
    assert any(hidden for hidden, _ in codes)


def test_no_two_columns_of_a_table_go_by_one_name_and_none_is_a_logarithm(site):
    heads = [titles for page in pages(site) for titles, _ in tables(page)]
    assert len(heads) > 50
    assert [names for names in heads if len(set(names)) < len(names)] == []
    assert not any(re.search(r"\bln\b", name) for names in heads for name in names)
    of_pages = [str(text) for file, text in said() if file.startswith("dashboards")]
    assert [text for text in of_pages if re.search(r"\bln\b|logarit", text)] == []


def test_a_due_list_is_shown_whole(site, results):
    _, rows = next(tables(site / "boats.html"))
    due = results.views.table("due_list").filter(method=results.method)
    assert len(rows) == due.height > 0


def test_a_column_and_a_code_of_a_page_have_a_text(results, monkeypatch):
    """None is shown by its name in the tables."""
    shown, codes = set(), set()
    real = Document.table

    def noted(document, rows, columns, **settings):
        frame = rows if isinstance(rows, pl.DataFrame) else pl.DataFrame()
        for name in columns.replace("|", " ").split():
            shown.add(name)
            if name in frame.columns and get_column(name).kind is Kind.CODE:
                values = frame[name].drop_nulls().to_list()
                lists = [value if isinstance(value, list) else value.split(",") for value in values]
                codes.update(code for one in lists for code in one)
        return real(document, rows, columns, **settings)

    monkeypatch.setattr(Document, "table", noted)
    frame = {"simulated": True, "has_reports": False, "path": "", "site_root": "", "other": "",
             "other_page": "", "code_version": ""}  # fmt: skip
    for page in list_pages(results):
        data = page.query()
        Document(Language("en"), "", data.get("chosen"), pictures=False).render(
            page.template, **frame, **data
        )
    titles = "give each a title in pipeline/tables/display.py"
    assert shown - TITLES.keys() == {"who"} & shown, titles
    words_like_codes = {code for code in codes if re.fullmatch(r"[a-z_]+", code)}
    assert "above_target_speed" in codes
    assert words_like_codes - words.CODES.keys() == set(), "name each in dashboards/words.py"


def test_a_column_without_anything_in_it_is_not_shown():
    frame = pl.DataFrame(
        {"n": [0, 0], "size": [None, None], "slow": [False, True], "name": ["", ""]}
    )
    shown = Document(Language("en")).table(frame, "n size slow name")
    assert re.findall(r"<th(?: [^>]*)?>([^<]*)", shown) == ["n", "Too little power"]
    assert Document(Language("en")).table(frame.clear(), "n size") == ""


def test_a_selector_without_a_choice_shows_what_it_would_choose_by():
    frame = pl.DataFrame({"method": ["a", "b", "b"], "tow_id": ["1", "1", "2"], "n": [3, 3, 4]})

    def show(**chosen):
        return Document(Language("en"), "", chosen).table(frame, "n", follows="tow_id method")

    chosen = show(tow_id="1", method="b")
    assert list(rows_of(chosen)) == [(False, ["3"]), (True, ["4"])]
    assert 'data-method="a|b"' in chosen
    assert [hidden for hidden, _ in rows_of(show())] == [False] * 3


def test_a_failing_build_leaves_nothing_half_made_and_the_old_site(
    store, site, tmp_path, monkeypatch
):
    before = hashes(site)
    monkeypatch.setattr("dashboards.site.list_pages", lambda *_: 1 / 0)
    for target in (tmp_path / "site", None):
        with pytest.raises(ZeroDivisionError):
            build_site(store, target)
    assert list(tmp_path.iterdir()) == []
    assert hashes(site) == before


@pytest.mark.parametrize(
    ("fsn_no", "path"), [("FSN101", "boats/FSN101.html"), ("../x", r"boats/-x-\w{8}\.html")]
)
def test_a_boat_s_file_stays_in_its_folder(fsn_no, path):
    assert re.fullmatch(path, boat_path(fsn_no))


def test_what_is_shown_first_is_among_what_there_is():
    assert choose_default_method(["as-published", "rebased", "rebased-2015"]) == "rebased"
    assert choose_default_method(["concept-rebased", "concept-x"]) == "concept-rebased"
    assert choose_default_method(["a", "b"]) == "b"
    drafts = ["concept-as-published", "concept-corrected-2013"]
    assert choose_newest_edition([*drafts, "2026-1"], "concept-as-published") == "2026-1"
    assert choose_newest_edition(drafts, "concept-as-published") == "concept-as-published"
    assert choose_newest_edition(drafts, "concept-rebased") == "concept-corrected-2013"


def test_traces_lie_once_for_both_languages(site, built, attacked):
    tows = built.table("tows").filter(fsn_no=attacked)["tow_id"]
    for folder in ("", "en/"):
        page = site / folder / boat_path(attacked)
        text = page.read_text("utf-8")
        for tow_id in tows:
            (source,) = re.findall(rf'src="([^"]*{re.escape(trace_path(tow_id))})"', text)
            assert (page.parent / source).resolve() == (site / trace_path(tow_id)).resolve()
    assert not (site / "en" / "traces").exists()


def test_every_page_forbids_the_network_and_eval(site):
    for file in pages(site):
        policy = re.search(r'Content-Security-Policy" content="([^"]+)"', file.read_text("utf-8"))
        assert policy[1].startswith("default-src 'none'")
        assert "eval" not in policy[1]
        assert "http" not in policy[1]


def test_an_edition_is_there_with_its_codes_sheets_and_notices(store, site):
    with Views(Store(site.parent)) as views:
        lines = views.table("register").filter(pl.col("edition") == EDITIONS[1])
    assert lines["verification_code"].null_count() == 0
    register = (site / "register.html").read_text("utf-8")
    line = lines.row(0, named=True)
    assert line["verification_code"] in register
    assert line["verification_code"] in (site / boat_path(line["fsn_no"])).read_text("utf-8")
    assert "SKC &lt;8 mei&gt;" in register
    for edition in EDITIONS:
        for name in SHEETS:
            published = store.root / "editions" / edition / name
            assert (site / "downloads" / edition / name).read_bytes() == published.read_bytes()
        for name in ("bericht.pdf", "notice.pdf"):
            assert (site / "downloads" / edition / name).read_bytes().startswith(b"%PDF")
