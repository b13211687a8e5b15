"""A document that Herijk itself fails on costs that document: it is told, the others are made."""

import shutil

import pypdf
import pytest

from dashboards import site
from dashboards.queries import papers
from tests.conftest import METHODS

EDITION = f"concept-{METHODS[1]}"


@pytest.fixture
def data(built, tmp_path):
    kept = shutil.ignore_patterns("site", "report")
    return shutil.copytree(built.data, tmp_path / "data", ignore=kept)


@pytest.fixture
def fails(herijk, data, monkeypatch):
    """Exports while a function fails on some things, which costs one document."""

    def run(document, owner, name, is_one, *command):
        real = getattr(owner, name)

        def planted(*arguments):
            if is_one(*arguments):
                raise ZeroDivisionError("planted")
            return real(*arguments)

        with monkeypatch.context() as patched:
            patched.setattr(owner, name, planted)
            status, _, err = herijk("export", *command, "--data", data)
        assert (status, document in err) == (1, True), err
        trace = data / "unforeseen" / f"{document}.txt"
        assert trace.read_text(encoding="utf-8").startswith("Traceback")

    return run


def test_of_all_certificates(fails, herijk, data, built, tmp_path):
    lines = built.table("register").filter(edition=EDITION).drop_nulls("cw_kg_m")
    line = lines.row(0, named=True)
    lost = f"certificate-{EDITION}-{line['fsn_no']}-{line['rowers']}{line['crew_class']}"
    command = ("certificate", "--edition", EDITION, "--out", tmp_path / "all.pdf")
    fails(
        lost, papers, "compute_line_curve", lambda one, _: one["tow_id"] == line["tow_id"], *command
    )
    assert len(pypdf.PdfReader(tmp_path / "all.pdf").pages) == lines.height - 1
    assert herijk("export", *command, "--data", data)[0] == 0
    assert not (data / "unforeseen" / f"{lost}.txt").exists()


def test_of_a_proposal(fails, tmp_path):
    out = tmp_path / "out.pdf"
    command = ("proposal", METHODS[1], "--out", out)
    fails(f"proposal-{METHODS[1]}", papers, "summarise_causes", lambda *_: True, *command)
    assert not out.exists()


@pytest.mark.more
def test_of_pages_in_an_empty_folder(fails, tmp_path):
    (tmp_path / "pages").mkdir()
    command = ("pages", "--out", tmp_path / "pages")
    fails("page-boats.html", site, "render_page", lambda path, *_: path == "boats.html", *command)
    assert not (tmp_path / "pages" / "boats.html").exists()
    assert (tmp_path / "pages" / "register.html").exists()
    assert (tmp_path / "pages" / "index.html").exists()
