"""One number, wherever it is read: page, terminal, JSON, PDF and spreadsheet say the same."""

import io
import json
import re
from contextvars import copy_context

import openpyxl
import pytest
from click.testing import CliRunner
from pypdf import PdfReader

from dashboards.language import Language
from dashboards.paper import make_pdf
from dashboards.queries.papers import read_certificates
from herijk.cli.main import app
from tests.dashboards.conftest import EDITIONS
from warehouse.editions.sheets import REGISTER_FIELDS
from warehouse.queries.views import Views
from warehouse.store.editions import XLSX, get_edition_path

EDITION = EDITIONS[-1]
NUMBERS = ("a_kg_m", "b_m_s", "declared_speed_m_s", "cw_kg_m")
NL = Language("nl")


@pytest.fixture(scope="module")
def lines(store):
    """The lines of an edition with a number, by boat and crew."""
    with Views(store) as views:
        known = views.register().filter(edition=EDITION).drop_nulls("cw_kg_m")
    found = {get_key(line): line for line in known.to_dicts()}
    assert len(found) * len(NUMBERS) >= 40
    return found


def get_key(line):
    return (line["fsn_no"], str(line["rowers"]), line["crew_class"])


def write(line):
    """The numbers of a line as people read them, in Dutch."""
    return [NL.write(name, line[name]) for name in NUMBERS]


def run(store, *options):
    command = ("register", EDITION, "--data", str(store.root), "--lang", "nl", *options)
    shown = copy_context().run(CliRunner().invoke, app, command)  # it sets the language
    assert shown.exit_code == 0, shown.output
    return shown.output


def test_json_has_the_numbers_of_the_tables(store, lines):
    shown = json.loads(run(store, "--json"))["lines"]
    found = {get_key(line): line for line in shown if line["cw_kg_m"] is not None}
    assert found.keys() == lines.keys()
    for key, line in lines.items():
        assert [found[key][name] for name in NUMBERS] == [line[name] for name in NUMBERS]


def test_page_and_terminal_show_them_rounded_alike(store, site, lines):
    page = (site / "register.html").read_text("utf-8")
    body = re.search(rf'<tbody data-edition="{EDITION}"[^>]*>(.*?)</tbody>', page, re.DOTALL)[1]
    on_page = [
        re.sub("<[^>]+>", "\t", row).replace("\t\t", "\t").split("\t") for row in body.splitlines()
    ]
    in_terminal = [line.split() for line in run(store, "--wide").splitlines()]
    for key, line in lines.items():
        for rows in (on_page, in_terminal):
            (own,) = [row for row in rows if set(key) <= set(row) and write(line)[-1] in row]
            assert [number for number in write(line) if number not in own] == []


def test_a_certificate_prints_them(store, lines):
    with Views(store) as views:
        made = read_certificates(views, EDITION, None)
    pdf = make_pdf("certificate", made, "nl", "x", simulated=True)
    pages = [page.extract_text() for page in PdfReader(io.BytesIO(pdf)).pages]
    assert len(pages) == len(lines)
    for one, text in zip(made, pages, strict=True):
        line = lines[get_key(one["line"])]
        for name, number in zip(NUMBERS, write(line), strict=True):
            decimals = 3 if name in ("a_kg_m", "b_m_s") else 2
            printed = NL.write_number(line[name], decimals)
            assert printed in text
            assert abs(float(printed.replace(",", ".")) - float(number.replace(",", "."))) < 0.006


def test_the_spreadsheet_holds_them(store, lines):
    sheet = openpyxl.load_workbook(get_edition_path(store, EDITION) / XLSX).worksheets[0]
    titles, *rows = sheet.iter_rows(values_only=True)
    fields = {field.column: field for field in REGISTER_FIELDS}

    def read(row, column):
        return row[titles.index(fields[column].header)]

    found = {(read(row, "fsn_no"), str(read(row, "rowers")), read(row, "crew_class")): row
             for row in rows}  # fmt: skip
    for key, line in lines.items():
        for name in NUMBERS:
            assert read(found[key], name) == round(line[name], fields[name].decimals)
