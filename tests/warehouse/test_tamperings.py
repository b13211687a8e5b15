"""What a forger can do to a published edition, each with the finding that names it.

The second of two editions is changed, often sealed anew; the first keeps its verdict.
"""

import json
import os
import shutil

import openpyxl
import polars as pl
import pytest

from warehouse.editions.verify import verify
from warehouse.store.editions import Manifest, find_chain_head, find_manifest, read_manifest
from warehouse.store.files import file_sha256

FIRST, SECOND = "2014-1", "2014-2"


def seal(path, **fields):
    """Write the manifest of an edition again, with hashes and seal that fit."""
    files = {file: file_sha256(path / file) for file in read_manifest(path).files}
    about = json.loads(find_manifest(path).read_text(encoding="utf-8"))
    about |= {"files": files} | fields
    sealed = Manifest.model_validate(about).sealed()
    find_manifest(path).write_text(sealed.model_dump_json(indent=1) + "\n", encoding="utf-8")


def rewrite(path, table, change):
    file = path / f"{table}.parquet"
    change(pl.read_parquet(file)).write_parquet(file)
    seal(path)


def rename_copy(path, name, **fields):
    copy = shutil.copytree(path, path.parent / name)
    seal(copy, edition=name, **fields)


def double_key(path):
    text = find_manifest(path).read_text(encoding="utf-8")
    first = '"edition": "2014-2",'
    assert first in text
    find_manifest(path).write_text(text.replace(first, f'"decision": "x", {first}'), "utf-8")


def put_in_place(make):
    """Replace register.csv by something that is no file of its own."""

    def change(path):
        file = path / "register.csv"
        content = file.read_bytes()
        file.unlink()
        make(file, content)

    return change


def link_elsewhere(file, content):
    other = file.parent.parent / ".elsewhere"
    other.write_bytes(content)
    file.symlink_to(other)


def change_workbook(change):
    def changed(path):
        file = path / "register.xlsx"
        book = openpyxl.load_workbook(file)
        change(book["register"])
        book.save(file)
        seal(path)

    return changed


def show_other_decimals(sheet):
    for row in sheet.iter_rows(min_row=2):
        for cell in row:
            if cell.number_format == "0.000":
                cell.number_format = "0"


def hide_row(sheet):
    sheet.row_dimensions[2].hidden = True


def hide_column(sheet):
    sheet.column_dimensions["I"].hidden = True


def write_other_number(sheet):
    cell = next(c for c in sheet[2] if c.number_format == "0.000" and c.value is not None)
    cell.value = cell.value + 1


def without(table):
    def change(path):
        files = {f: h for f, h in read_manifest(path).files.items() if f != f"{table}.parquet"}
        seal(path)
        about = json.loads(find_manifest(path).read_text(encoding="utf-8")) | {"files": files}
        sealed = Manifest.model_validate(about).sealed()
        find_manifest(path).write_text(sealed.model_dump_json(indent=1) + "\n", encoding="utf-8")

    return change


OF_FILES = {
    "a key twice in the manifest": (double_key, SECOND, "manifest.json"),
    "the decision": (lambda path: seal(path, decision="other"), SECOND, "manifest.json: decision"),
    "the day": (
        lambda path: seal(path, valid_from="2014-07-01"), SECOND, "manifest.json: valid_from",
    ),
    "simulated": (lambda path: seal(path, simulated=False), SECOND, "manifest.json: simulated"),
    "the kind": (lambda path: seal(path, kind="as_printed"), SECOND, "manifest.json: kind"),
    "none before": (lambda path: seal(path, previous=None), SECOND, "manifest.json: previous"),
    "itself before": (lambda path: seal(path, previous=SECOND), SECOND, "manifest.json: previous"),
    "carried from itself": (
        lambda path: seal(path, carried_from=SECOND), SECOND, "manifest.json: carried_from",
    ),
    "an unknown key": (lambda path: seal(path, title="x"), SECOND, "manifest.json: title"),
    "a capital seal": (
        lambda path: find_manifest(path).write_text(
            json.dumps(json.loads(find_manifest(path).read_text()) | {
                "seal": read_manifest(path).seal.upper()
            })
        ),
        SECOND, "manifest.json",
    ),
    "no register listed": (without("register"), SECOND, "manifest.json: files"),
    "no tows listed": (without("tows"), SECOND, "manifest.json: files"),
    "garbage": (lambda path: find_manifest(path).write_bytes(b"\xff\xfe"), SECOND, "manifest.json"),
    "brackets": (
        lambda path: find_manifest(path).write_text("[" * 200_000), SECOND, "manifest.json",
    ),
    "a folder": (put_in_place(lambda file, _: file.mkdir()), SECOND, "register.csv"),
    "a pipe": (put_in_place(lambda file, _: os.mkfifo(file)), SECOND, "register.csv"),
    "a link": (put_in_place(link_elsewhere), SECOND, "register.csv"),
    "a hard link": (
        put_in_place(lambda file, _: os.link(file.parent.parent / FIRST / "register.csv", file)),
        SECOND, "register.csv",
    ),
    "an added file": (lambda path: (path / "x").write_text("x"), SECOND, "x"),
    "an added folder": (lambda path: (path / "x").mkdir(), SECOND, "x"),
    "a look-alike": (
        lambda path: (path / "regi\u0455ter.csv").write_text("x"), SECOND, "regi\u0455ter.csv",
    ),
    "number 4": (lambda path: rename_copy(path, "2014-4", number=4), "2014-4", "chain"),
    "number 0": (lambda path: rename_copy(path, "2014-0", number=0), "2014-0", "chain"),
    "number -1": (lambda path: rename_copy(path, "2014-x", number=-1), "2014-x", "chain"),
    "number 10^30": (lambda path: rename_copy(path, "2014-9", number=10**30), "2014-9", "chain"),
    "a number twice": (lambda path: rename_copy(path, "2014-3", number=2), "2014-3", "chain"),
    "a look-alike name": (
        lambda path: rename_copy(path, "2014\u20102", number=3),
        "2014\u20102", "manifest.json: edition",
    ),
    "a name with a blank": (
        lambda path: rename_copy(path, "2014-2 ", number=3), "2014-2 ", "manifest.json: edition",
    ),
    "the last edition removed": (shutil.rmtree, SECOND, SECOND),
}  # fmt: skip
"""By what is done: how, the edition that is named, and where."""


@pytest.fixture(scope="module")
def rebuilt(published, tmp_path_factory):
    """Two editions, after a rebuild that has noted them; read only."""
    bench = published.copy(tmp_path_factory.mktemp("rebuilt"))
    bench.rebuild()
    return bench


@pytest.fixture
def rebuilt_copy(rebuilt, tmp_path):
    """The same, to change at will."""
    return rebuilt.copy(tmp_path)


@pytest.mark.parametrize("name", OF_FILES)
def test_what_is_done_to_files_is_named_and_the_other_edition_keeps_its_verdict(
    rebuilt_copy, monkeypatch, name
):
    monkeypatch.setattr(
        "warehouse.editions.verify.check_reproduction", lambda _, checked: (checked, [])
    )
    change, edition, where = OF_FILES[name]
    change(rebuilt_copy.store.editions / SECOND)
    report = verify(rebuilt_copy.store, afresh=False)
    wrong = {(finding.edition, finding.where) for finding in report.findings if finding.wrong}
    assert (edition, where) in wrong
    others = {FIRST} if name == "a hard link" else set()  # which of both was made first?
    assert {found for found, _ in wrong} <= {edition, SECOND, "", *others}
    assert report.wrong


MADE_AGAIN = {
    "other decimals": (change_workbook(show_other_decimals), "register.xlsx"),
    "a hidden row": (change_workbook(hide_row), "register.xlsx"),
    "a hidden column": (change_workbook(hide_column), "register.xlsx"),
    "another number in the workbook": (change_workbook(write_other_number), "register.xlsx"),
    "a column added": (
        lambda path: rewrite(path, "register", lambda t: t.with_columns(x=pl.lit(1))),
        "register.parquet",
    ),
    "an empty column added": (
        lambda path: rewrite(path, "register", lambda t: t.with_columns(x=pl.lit(None, pl.String))),
        "register.parquet",
    ),
    "no rows of tows": (lambda path: rewrite(path, "tows", lambda t: t.head(0)), ""),
    "another samples file": (
        lambda path: rewrite(path, "tows", lambda t: t.with_columns(samples_path=pl.lit("x"))), "",
    ),
    "not a number": (
        lambda path: rewrite(
            path, "register", lambda t: t.with_columns(cw_lo_kg_m=pl.lit(float("nan")))
        ),
        "",
    ),
    "no register": (
        lambda path: (path / "register.parquet").write_bytes(b"PAR1"), "register.parquet",
    ),
}  # fmt: skip


@pytest.mark.more
@pytest.mark.parametrize("name", MADE_AGAIN)
def test_what_is_sealed_anew_is_found_when_it_is_made_again(rebuilt_copy, name):
    change, where = MADE_AGAIN[name]
    change(rebuilt_copy.store.editions / SECOND)
    report = verify(rebuilt_copy.store, afresh=False)
    found = [f for f in report.findings if f.wrong and f.edition == SECOND]
    assert found
    assert where in {finding.where for finding in found} | {""}
    assert [f for f in report.findings if f.wrong and f.edition == FIRST] == []
    assert min(one.equal or 0 for one in report.editions) >= 0


def test_only_the_head_shows_that_the_last_edition_is_gone_before_a_rebuild(published_copy):
    head = find_chain_head(published_copy.store).seal
    shutil.rmtree(published_copy.store.editions / SECOND)
    unseen = verify(published_copy.store, afresh=False)
    assert (unseen.wrong, unseen.is_without_head) == (False, True)
    assert verify(published_copy.store, afresh=False, head=head).wrong


def test_what_lies_among_the_editions_is_named_and_wrong_is_nothing(published_copy):
    (published_copy.store.editions / "notes.txt").write_text("x", encoding="utf-8")
    (published_copy.store.editions / "empty").mkdir()
    report = verify(published_copy.store, afresh=False)
    assert [finding.where for finding in report.findings] == ["empty", "notes.txt"]
    assert not report.wrong


def test_without_the_archive_files_are_still_judged(published_copy):
    published_copy.archive.rename(published_copy.archive.with_name("gone"))
    (published_copy.store.editions / SECOND / "x").mkdir()
    kinds = {(f.edition, f.kind) for f in verify(published_copy.store).findings}
    assert kinds >= {(FIRST, "unchecked"), (SECOND, "unchecked"), (SECOND, "altered")}
