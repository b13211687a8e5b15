"""A document that Herijk itself fails on costs that document: it is told, the others are made."""

import shutil

import pypdf
import pytest

from dashboards import slide_book, slides
from dashboards.documents import certificate, proposal
from dashboards.site import render
from tests.conftest import METHODS
from warehouse.store.unforeseen import failures

EDITION = f"concept-{METHODS[1]}"


@pytest.fixture
def data(built, tmp_path):
    kept = shutil.ignore_patterns("site", "report")
    return shutil.copytree(built.data, tmp_path / "data", ignore=kept)


@pytest.fixture
def fails(herijk, data, monkeypatch):
    """Runs a command while a function fails on some things; gives what it printed."""

    def run(document, owner, name, is_one, *command):
        real = getattr(owner, name)

        def planted(*arguments):
            if is_one(*arguments):
                raise ZeroDivisionError("planted")
            return real(*arguments)

        with monkeypatch.context() as patched:
            patched.setattr(owner, name, planted)
            status, out, err = herijk(*command, "--data", data)
        assert (status, document in err) == (1, True), err
        trace = data / "unforeseen" / f"{document}.txt"
        assert trace.read_text(encoding="utf-8").startswith("Traceback")
        assert failures(data) == []  # no rebuild answers for it
        return out

    return run


@pytest.fixture
def lines(built):
    return built.table("register").filter(edition=EDITION).drop_nulls("cw_kg_m")


def certificate_of(line):
    return f"certificate-{EDITION}-{line['fsn_no']}-{line['rowers']}{line['crew_class']}"


def test_of_all_certificates(fails, herijk, data, lines, tmp_path):
    line = lines.row(0, named=True)
    lost = certificate_of(line)
    command = ("export", "certificate", "--edition", EDITION, "--out", tmp_path / "all.pdf")
    fails(lost, certificate, "crew_name", lambda one, _: one["tow_id"] == line["tow_id"], *command)
    assert len(pypdf.PdfReader(tmp_path / "all.pdf").pages) == lines.height - 1
    assert herijk(*command, "--data", data)[0] == 0
    assert not (data / "unforeseen" / f"{lost}.txt").exists()


def test_the_only_certificate(fails, lines, tmp_path):
    line = lines.row(0, named=True)
    command = (
        "export",
        "certificate",
        line["fsn_no"],
        "--edition",
        EDITION,
        "--out",
        tmp_path / "one.pdf",
    )
    fails(certificate_of(line), certificate, "crew_name", lambda *_: True, *command)
    assert not (tmp_path / "one.pdf").exists()


def test_a_proposal(fails, tmp_path):
    command = ("export", "proposal", METHODS[1], "--out", tmp_path / "p.pdf")
    fails(f"proposal-{METHODS[1]}", proposal, "_types", lambda *_: True, *command)
    assert not (tmp_path / "p.pdf").exists()


@pytest.mark.parametrize(
    ("lost", "owner", "name"),
    [("slide-hull-speed", slide_book.Book, "hull_speed"), ("slides", slides, "pdf")],
)
def test_a_slide(lost, owner, name, fails, tmp_path):
    book = tmp_path / "book.pdf"
    fails(lost, owner, name, lambda *_: True, "export", "slides", "--out", book)
    assert book.exists() == (lost != "slides")


def test_a_page(fails, tmp_path):
    command = ("export", "pages", "--out", tmp_path / "pages")
    fails(
        "page-boats.html", render, "_write_page", lambda _, p, *__: p.path == "boats.html", *command
    )
    assert not (tmp_path / "pages" / "boats.html").exists()
    assert (tmp_path / "pages" / "register.html").exists()
