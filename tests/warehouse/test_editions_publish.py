"""Publishing: what an edition holds, and that nothing half-written ever shows."""

import csv
import datetime as dt
import errno
import io
import json
import os
import re
import zipfile
from pathlib import Path

import polars as pl
import pytest
from polars.testing import assert_frame_equal

from pipeline.errors import BrokenPromiseError, MissingKnowledgeError
from pipeline.method.reading import read_shipped_method
from pipeline.register.register import LINE
from tests.warehouse.edition_bench import diff, terms
from warehouse.derive.registers import read_published_tables
from warehouse.editions import publish as publish_module
from warehouse.editions import sheets
from warehouse.editions.making import MADE
from warehouse.editions.publish import list_lines_to_look_at, publish_printed
from warehouse.editions.verify import verify
from warehouse.store.decisions import FILE_NAME
from warehouse.store.editions import (
    list_edition_names,
    read_edition,
    read_manifest,
)

TABLES = (
    *("register", "tows", "tow_runs", "curves", "run_points", "log_factors", "season_links"),
    *("tow_instruments", "ensemble"),
)
FILES = {
    "register.csv",
    "register.xlsx",
    "manifest.json",
    "method.toml",
    "decisions.json",
    "bericht.md",
    "notice.md",
    *(f"{name}.parquet" for name in TABLES),
}
"""Files of the first edition."""


def edition_of(bench, name="2014-1"):
    return read_edition(bench.store, name)


def folder(bench, name="2014-1"):
    return bench.store.editions / name


def test_an_edition_holds_everything_behind_it(published):
    path = folder(published)
    assert {f.name for f in path.iterdir()} == FILES
    about = read_manifest(path)
    assert set(about.files) == FILES - {"manifest.json"}
    assert (about.method, about.valid_from) == ("as-published", dt.date(2014, 6, 1))
    assert about.seal == about.expected_seal
    assert about.method_hash == read_shipped_method("as-published").content_hash
    assert edition_of(published).tables.keys() == set(TABLES)
    edition = edition_of(published, "2014-2")
    shipped = read_shipped_method("rebased")
    assert edition.method.content_hash == edition.manifest.method_hash == shipped.content_hash
    assert (edition.method.validity, edition.method.extends) == (shipped.validity, None)
    assert edition.manifest.previous == "2014-1"
    rows = read_published_tables(published.store)
    own = rows["register"].filter(edition="2014-2")
    codes = [*LINE, "verification_code"]
    assert own.select(codes).equals(edition.register.select(codes))
    assert set(rows["register_changes"]["to_edition"]) == {"2014-2"}
    assert set(rows["lineage"]["edition"]) == {"2014-1", "2014-2"}


def test_what_counts_is_judged_on_the_day_of_the_edition(bench_of_editions):
    """A line of an expired tow has no numbers, a later tow does not count, nor an excluded one."""
    bench, tow = bench_of_editions, bench_of_editions.tow(2014)
    bench.publish("2018-1", valid_from=dt.date(2018, 6, 1))
    register = edition_of(bench, "2018-1").register
    expired = register.filter(status="expired")
    assert expired["tow_date"].dt.year().unique().to_list() == [2009]
    assert expired["cw_kg_m"].null_count() == expired["a_kg_m"].null_count() == expired.height > 0
    assert register.filter(status="valid")["cw_kg_m"].null_count() == 0
    bench.publish("2013-1", valid_from=dt.date(2013, 1, 1))
    towed = edition_of(bench, "2013-1").register.drop_nulls("tow_date")
    assert towed["tow_date"].dt.year().unique().to_list() == [2009]
    decide(bench, tow["tow_id"], "uitsluiten")
    bench.publish("x")
    assert line_of(bench, tow)["tow_id"] != tow["tow_id"]
    kept = json.loads((folder(bench, "x") / "decisions.json").read_text())
    assert kept[0] | {"reden": "wind", "wie": "SKC"} == kept[0]


@pytest.mark.parametrize("name", MADE)
def test_an_edition_holds_what_the_rebuild_made(published, name):
    made = published.store.read(name, "rebased")
    assert_frame_equal(edition_of(published, "2014-2").tables[name], made, rel_tol=1e-12)


# Sheets


def csv_rows(register):
    text = sheets.encode_csv(register, sheets.REGISTER_FIELDS).decode("utf-8-sig")
    return list(csv.DictReader(io.StringIO(text, newline=""), delimiter=";"))


@pytest.mark.parametrize(
    ("name", "written"),
    [
        *((name, name) for name in ("de;drie", 'zij "wij"', "twee\nregels", "Zeeëgel", "\tx")),
        *(("=1+1", "'=1+1"), ("+31", "'+31"), ("-x", "'-x"), ("@cmd", "'@cmd")),
        *(("\t=1", "\t'=1"), ("x;=1", "x;'=1")),
    ],
)
def test_a_name_survives_the_sheets_and_is_no_formula_in_them(published, name, written):
    edition = edition_of(published)
    register = edition.register.with_columns(pl.lit(name).alias("name"))
    assert {row["sloep"] for row in csv_rows(register)} == {written}


def test_numbers_in_the_sheet_are_those_of_the_register(published):
    register = edition_of(published).register
    for line, cells in zip(register.iter_rows(named=True), csv_rows(register), strict=True):
        assert cells["roeiers"] == str(line["rowers"])
        if line["cw_kg_m"] is not None:
            assert cells["Cw [kg/m]"] == f"{line['cw_kg_m']:.3f}".replace(".", ",")
            assert cells["sleepdatum"] == str(line["tow_date"])


# Verification codes


def test_a_code_follows_from_inputs_method_and_printed_numbers(published):
    register = edition_of(published).register
    codes = sheets.compute_verification_codes(register, "m")
    assert sheets.compute_verification_codes(register, "m") == codes
    for changed in (
        sheets.compute_verification_codes(register, "other"),
        sheets.compute_verification_codes(
            register.with_columns(pl.lit("x").alias("inputs_sha256")), "m"
        ),
        sheets.compute_verification_codes(register.with_columns(pl.col("cw_kg_m") + 0.001), "m"),
    ):
        valid = register["cw_kg_m"].is_not_null()
        pairs = zip(codes, changed, valid, strict=True)
        assert all(one != other for one, other, is_valid in pairs if is_valid)
    unseen = register.with_columns(pl.col("cw_kg_m") * (1 + 1e-12))
    assert sheets.compute_verification_codes(unseen, "m") == codes


# Whole or not at all


def test_an_edition_is_never_published_twice(published):
    before = {f.name: f.read_bytes() for f in folder(published).iterdir()}
    with pytest.raises(BrokenPromiseError, match=r"already published .* another name"):
        published.publish("2014-1", "rebased")
    assert {f.name: f.read_bytes() for f in folder(published).iterdir()} == before


def test_two_publications_at_once_have_numbers_of_their_own(bench_of_editions, monkeypatch):
    bench, write = bench_of_editions, publish_module.write_folder

    def after_another(*arguments):
        monkeypatch.setattr(publish_module, "write_folder", write)
        bench.publish("2014-1")
        return write(*arguments)

    monkeypatch.setattr(publish_module, "write_folder", after_another)
    bench.publish("2014-2")
    first, second = (read_manifest(folder(bench, name)) for name in ("2014-1", "2014-2"))
    assert (first.number, second.number, second.after_seal) == (1, 2, first.seal)


def test_a_full_disk_leaves_nothing(bench_of_editions, monkeypatch):
    written = []

    def full(path, content):
        written.append(path)
        if len(written) == 4:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        with path.open("wb") as file:
            file.write(content)

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(BrokenPromiseError, match=r"No space left .* make room"):
        bench_of_editions.publish("2014-1")
    assert list_edition_names(bench_of_editions.store) == []
    assert [f for f in bench_of_editions.store.editions.iterdir() if f.is_dir()] == []


@pytest.mark.parametrize("name", ["", "../x", "concept-x", "x" * 61])
def test_a_name_that_cannot_be_one_is_refused(published, name):
    with pytest.raises(MissingKnowledgeError, match="cannot name an edition"):
        published.publish(name)


def test_tables_of_another_method_or_code_are_not_published(published, monkeypatch):
    with pytest.raises(MissingKnowledgeError, match="herijk rebuild"):
        published.publish("x", "rebased-2015")
    monkeypatch.setattr("warehouse.editions.publish.code_version", lambda *_: "other")
    with pytest.raises(MissingKnowledgeError, match="not those of the archive and code of today"):
        published.publish("x", "rebased")


# Decisions of people


def decide(bench, tow, verdict):
    bench.data.joinpath(FILE_NAME).write_text(
        f'[[besluit]]\nsleep_id = "{tow}"\noordeel = "{verdict}"\nreden = "wind"\n'
        'wie = "SKC"\ndatum = 2014-05-01\n',
        encoding="utf-8",
    )


def line_of(bench, tow, edition="x"):
    key = [tow[name] for name in ("fsn_no", "rowers", "crew_class")]
    names = ("fsn_no", "rowers", "crew_class")
    register = edition_of(bench, edition).register
    return register.filter(
        *(pl.col(name) == value for name, value in zip(names, key, strict=True))
    ).row(0, named=True)


def test_a_decision_about_an_unknown_tow_stops_the_publication(bench_of_editions):
    decide(bench_of_editions, "1999-001", "uitsluiten")
    with pytest.raises(MissingKnowledgeError, match=r"1999-001.*mend the sleep_id"):
        bench_of_editions.publish("x")


# Printed registers


PRINTED = """fsn_nr;roeiers;klasse;A;B;Cw;roeisnelheid [m/s];sleepdatum
{boat};{rowers};{crew};31,60;4,44;43,89;2,35;2011-03-10
FSN900;8;H;32,62;5,59;41,63;2,60;2011-03-06
FSN901;6;H;0,99;25,00;1,00;2,20;
FSN902;8;H;32,62;5,59;41,63;2,60;2014-03-06
"""


@pytest.fixture
def with_printed(bench_of_editions):
    tow = bench_of_editions.tow(2014)
    text = PRINTED.format(boat=tow["fsn_no"], rowers=tow["rowers"], crew=tow["crew_class"])
    file = bench_of_editions.archive / "sloepregister" / "sloepregister_2012.csv"
    file.write_text(text, encoding="utf-8")
    bench_of_editions.rebuild(())
    return bench_of_editions


def publish_register_of(bench, season=2012, edition="gedrukt-2012"):
    return publish_printed(bench.store, season, terms(edition, dt.date(2012, 5, 1)))


def test_a_printed_register_with_a_line_that_cannot_be_read_is_not_published(with_printed):
    file = with_printed.archive / "sloepregister" / "sloepregister_2012.csv"
    file.write_text(
        file.read_text("utf-8").replace("32,62;5,59;41,63;2,60;2014", "x;5,59;41,63;2,60;2014")
    )
    with_printed.rebuild(())
    with pytest.raises(MissingKnowledgeError, match=r"2012\.csv: Line 5: column 'A' .*Mend"):
        publish_register_of(with_printed)
    assert not folder(with_printed, "gedrukt-2012").exists()


@pytest.mark.more
def test_a_printed_line_is_rebased_in_closed_form_where_nothing_was_measured(with_printed):
    publish_register_of(with_printed)
    corrected = read_shipped_method("corrected-2013")
    with_printed.rebuild((corrected, read_shipped_method("as-published")))
    with_printed.publish("2014-1", "corrected-2013", carry="gedrukt-2012")
    printed = edition_of(with_printed, "gedrukt-2012")
    assert (printed.manifest.kind, printed.method) == ("as_printed", None)
    lines = printed.register.select("fsn_no", "cw_kg_m", "basis", "status").rows()
    assert ("FSN900", 41.63, "printed", "valid") in lines
    assert ("FSN901", None, None, "no_valid_curve") in lines
    register = edition_of(with_printed).register
    line = register.filter(pl.col("fsn_no") == "FSN900").row(0, named=True)
    assert (line["basis"], line["status"]) == ("printed_rebased", "valid")
    assert line["a_kg_m"] == pytest.approx(32.62 / 1.06**2, rel=1e-12)
    assert line["b_m_s"] == pytest.approx(5.59 * 1.06, rel=1e-12)
    calibrated = register.filter(pl.col("fsn_no") == "FSN902").row(0, named=True)
    assert (calibrated["basis"], calibrated["a_kg_m"]) == ("printed_not_rebased", 32.62)
    assert (line["method"], calibrated["method"]) == ("corrected-2013", "as-printed")
    published = folder(with_printed, "2014-1")
    sheet = (published / "register.csv").read_text("utf-8")
    assert "gedrukt, niet herijkt" in next(row for row in sheet.splitlines() if "FSN902" in row)
    notes = (published / "bericht.md").read_text("utf-8")
    assert "**Niet herijkt**: 1 regel van gedrukt-2012" in notes
    measured = line_of(with_printed, with_printed.tow(2014), "2014-1")
    assert measured["basis"] == "measured"
    lines = diff(with_printed.store, "gedrukt-2012", "2014-1")
    causes = {row["fsn_no"]: json.loads(row["causes"]) for row in lines.iter_rows(named=True)}
    assert [c["cause"] for c in causes["FSN900"]] == ["closed_form"]
    assert [c["cause"] for c in causes[measured["fsn_no"]]] == ["closed_form", "tow"]


# The newest tow counts


def with_newer_print(bench):
    """A boat towed in 2009 alone, whose tow of 2011 is in print and has no samples."""
    tows = bench.store.read("tows")
    later = tows.filter(season=2014).select(LINE[:-1])
    tow = tows.filter(season=2009).join(later, on=LINE[:-1], how="anti").row(0, named=True)
    text = PRINTED.format(boat=tow["fsn_no"], rowers=tow["rowers"], crew=tow["crew_class"])
    file = bench.archive / "sloepregister" / "sloepregister_2012.csv"
    file.write_text(text, encoding="utf-8")
    bench.rebuild()
    publish_register_of(bench)
    return tow


@pytest.mark.more
def test_a_line_whose_newest_tow_has_no_samples_is_named(bench_of_editions):
    tow = with_newer_print(bench_of_editions)
    bench_of_editions.publish("x", "rebased")
    line = line_of(bench_of_editions, tow)
    assert (line["tow_id"], line["basis"]) == (tow["tow_id"], "measured")
    assert "newer_tow_without_samples" in line["flags"]
    look_at = list_lines_to_look_at(edition_of(bench_of_editions, "x"))
    assert tow["tow_id"] in {one["tow_id"] for one in look_at}
    notes = (folder(bench_of_editions, "x") / "notice.md").read_text("utf-8")
    assert "Newest tow without samples.** 1 line rests on an older tow" in notes
    assert verify(bench_of_editions.store, afresh=False).findings == []


@pytest.mark.more
def test_carried_the_newer_printed_line_counts_instead_of_the_older_tow(bench_of_editions):
    tow = with_newer_print(bench_of_editions)
    bench_of_editions.publish("x", "rebased", carry="gedrukt-2012")
    line = line_of(bench_of_editions, tow)
    assert (line["tow_id"], line["basis"]) == (None, "printed_rebased")
    assert line["tow_date"] == dt.date(2011, 3, 10)
    assert verify(bench_of_editions.store, afresh=False).findings == []


@pytest.mark.more
def test_an_excluded_tow_does_not_come_back_from_print(bench_of_editions):
    bench = bench_of_editions
    tow = with_newer_print(bench)
    file = bench.archive / "sloepregister" / "sloepregister_2012.csv"
    day = tow["tow_date"].isoformat()
    file.write_text(file.read_text("utf-8").replace("2011-03-10", day), encoding="utf-8")
    bench.rebuild()
    publish_register_of(bench, edition="gedrukt-2")
    decide(bench, tow["tow_id"], "uitsluiten")
    bench.publish("x", "rebased", carry="gedrukt-2")
    assert line_of(bench, tow)["status"] == "excluded"


def test_the_workbook_says_the_day_of_publication_not_the_time_of_writing(published):
    with zipfile.ZipFile(folder(published) / "register.xlsx") as book:
        about = book.read("docProps/core.xml").decode()
    day = read_manifest(folder(published)).published_on
    assert re.findall(r"\d{4}-\d\d-\d\dT[\d:]+Z", about) == [f"{day}T00:00:00Z"] * 2
