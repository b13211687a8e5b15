"""Publishing: what an edition holds, and that nothing half-written ever shows."""

import csv
import datetime as dt
import errno
import io
import json
import os
from pathlib import Path

import polars as pl
import pytest
from polars.testing import assert_frame_equal

from pipeline.errors import BrokenPromiseError, MissingKnowledgeError
from pipeline.method.definition import parse_method, shipped_method
from pipeline.register.register import LINE
from tests.warehouse.edition_bench import terms
from warehouse.derive.published import published_made_from, published_tables
from warehouse.editions import publish as publish_module
from warehouse.editions import sheets
from warehouse.editions.compare import diff
from warehouse.editions.making import MADE
from warehouse.editions.publish import publish_printed
from warehouse.store.decisions import FILE_NAME
from warehouse.store.editions import (
    CHANGES,
    edition_names,
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
    "inputs.csv",
    "datapackage.json",
    "manifest.json",
    "method.toml",
    "decisions.json",
    "bericht.md",
    "notice.md",
    "toelichting.md",
    "release_notes.md",
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
    assert about.method_hash == shipped_method("as-published").content_hash
    assert edition_of(published).tables.keys() == set(TABLES)


@pytest.mark.parametrize("name", MADE)
def test_an_edition_holds_what_the_rebuild_made(published, name):
    made = published.store.read(name, "rebased")
    assert_frame_equal(edition_of(published, "2014-2").tables[name], made, rel_tol=1e-12)


def test_all_editions_as_rows_of_the_warehouse(published):
    tables = published_tables(published.store)
    register = {"register", "register_history", "register_changes"}
    assert tables.keys() == {"editions", "lineage"} | register
    editions = tables["editions"].select("edition", "kind", "previous").rows()
    assert editions == [("2014-1", "recomputed", None), ("2014-2", "recomputed", "2014-1")]
    heights = [edition_of(published, name).register.height for name in ("2014-1", "2014-2")]
    assert tables["register"]["edition"].value_counts().sort("edition").rows() == [
        ("2014-1", heights[0]),
        ("2014-2", heights[1]),
    ]
    codes = tables["register"].select("edition", *LINE, "verification_code")
    own = edition_of(published, "2014-2").register
    assert codes.filter(edition="2014-2").equals(own.select(codes.columns))
    assert set(tables["register_changes"]["to_edition"]) == {"2014-2"}
    assert set(tables["lineage"]["edition"]) == {"2014-1", "2014-2"}
    assert published_made_from(published.store).keys() == {"2014-1", "2014-2"}


def test_the_method_text_stands_alone(published):
    text = (folder(published, "2014-2") / "method.toml").read_text(encoding="utf-8")
    method = parse_method(text, "method.toml")
    shipped = shipped_method("rebased")
    assert method.content_hash == shipped.content_hash
    assert method.validity == shipped.validity
    assert method.extends is None


def test_a_line_of_an_expired_tow_has_no_numbers(bench_of_editions):
    bench_of_editions.publish("2018-1", valid_from=dt.date(2018, 6, 1))
    register = edition_of(bench_of_editions, "2018-1").register
    expired = register.filter(pl.col("status") == "expired")
    assert expired["tow_date"].dt.year().unique().to_list() == [2009]
    assert expired.height > 0
    assert expired["cw_kg_m"].null_count() == expired["a_kg_m"].null_count() == expired.height
    assert register.filter(pl.col("status") == "valid")["cw_kg_m"].null_count() == 0


def test_a_later_tow_does_not_count_in_an_earlier_edition(bench_of_editions):
    bench_of_editions.publish("2013-1", valid_from=dt.date(2013, 1, 1))
    towed = edition_of(bench_of_editions, "2013-1").register.drop_nulls("tow_date")
    assert towed["tow_date"].dt.year().unique().to_list() == [2009]


# Sheets


def csv_rows(register):
    text = sheets.csv_bytes(register, sheets.REGISTER_FIELDS).decode("utf-8-sig")
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
    content = sheets.xlsx_bytes(register, sheets.REGISTER_FIELDS, edition.manifest)
    assert sheets.read_xlsx_cells(content)["register"][1][2] == name


def test_numbers_in_the_sheets_are_those_of_the_register(published):
    register = edition_of(published).register
    head, *rows = sheets.read_xlsx_cells((folder(published) / "register.xlsx").read_bytes())[
        "register"
    ]
    typed = [dict(zip(head, row, strict=True)) for row in rows]
    for line, cells, printed in zip(
        register.iter_rows(named=True), typed, csv_rows(register), strict=True
    ):
        assert cells["roeiers"] == line["rowers"]
        if line["cw_kg_m"] is not None:
            assert cells["Cw [kg/m]"] == pytest.approx(line["cw_kg_m"], abs=5e-4)
            assert printed["Cw [kg/m]"] == f"{line['cw_kg_m']:.3f}".replace(".", ",")
            assert cells["sleepdatum"] == line["tow_date"]


def test_the_data_package_validates_with_its_own_tool(published):
    import frictionless  # noqa: PLC0415 - takes seconds to import

    report = frictionless.validate(str(folder(published) / "datapackage.json"))
    assert report.valid, report.flatten(["type", "message"])
    assert report.stats["tasks"] == 2


def test_the_largest_changes_are_those_of_the_table(published):
    text = (folder(published, "2014-2") / "notice.md").read_text(encoding="utf-8")
    changes = edition_of(published, "2014-2").tables[CHANGES].drop_nulls("cw_ratio")
    by_size = changes.filter(change="changed").sort(
        pl.col("cw_ratio").log().abs(), "fsn_no", descending=[True, False]
    )
    rows = [line.split(" | ") for line in text.splitlines() if line.startswith("| FSN")]
    assert [row[0].removeprefix("| ") for row in rows] == by_size["fsn_no"].head(10).to_list()
    shown = [f"{100 * (ratio - 1):+.2f} %" for ratio in by_size["power_ratio"].head(10)]
    assert [row[5] for row in rows] == shown


# Verification codes


def test_a_code_follows_from_inputs_method_and_printed_numbers(published):
    register = edition_of(published).register
    codes = sheets.verification_codes(register, "m")
    assert sheets.verification_codes(register, "m") == codes
    for changed in (
        sheets.verification_codes(register, "other"),
        sheets.verification_codes(register.with_columns(pl.lit("x").alias("inputs_sha256")), "m"),
        sheets.verification_codes(register.with_columns(pl.col("cw_kg_m") + 0.001), "m"),
    ):
        valid = register["cw_kg_m"].is_not_null()
        pairs = zip(codes, changed, valid, strict=True)
        assert all(one != other for one, other, is_valid in pairs if is_valid)
    unseen = register.with_columns(pl.col("cw_kg_m") * (1 + 1e-12))
    assert sheets.verification_codes(unseen, "m") == codes


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
    assert edition_names(bench_of_editions.store) == []
    assert [f for f in bench_of_editions.store.editions.iterdir() if f.is_dir()] == []


@pytest.mark.parametrize("name", ["", "../x", ".x", "concept-x", "a/b", "x" * 61])
def test_a_name_that_cannot_be_one_is_refused(published, name):
    with pytest.raises(MissingKnowledgeError, match="cannot name an edition"):
        published.publish(name)


def test_tables_of_another_method_or_code_are_not_published(published, monkeypatch):
    with pytest.raises(MissingKnowledgeError, match="herijk rebuild"):
        published.publish("x", "rebased-2015")
    monkeypatch.setattr("warehouse.derive.step.code_hash", lambda *_: "other")
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


def test_an_excluded_tow_does_not_count_and_the_edition_says_so(bench_of_editions):
    tow = bench_of_editions.tow(2014)
    decide(bench_of_editions, tow["tow_id"], "uitsluiten")
    bench_of_editions.publish("x")
    line = line_of(bench_of_editions, tow)
    assert line["tow_id"] != tow["tow_id"]
    kept = json.loads((folder(bench_of_editions, "x") / "decisions.json").read_text())
    assert kept[0] | {"reden": "wind", "wie": "SKC"} == kept[0]


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


def test_a_printed_register_stands_as_an_edition(with_printed):
    publish_register_of(with_printed)
    edition = edition_of(with_printed, "gedrukt-2012")
    assert edition.manifest.kind == "as_printed"
    assert edition.method is None
    by_boat = {row["fsn_no"]: row for row in edition.register.iter_rows(named=True)}
    assert by_boat["FSN900"]["cw_kg_m"] == 41.63
    assert by_boat["FSN900"]["basis"] == "printed"
    assert by_boat["FSN901"]["status"] == "no_valid_curve"
    assert by_boat["FSN901"]["cw_kg_m"] is None


def test_a_printed_register_with_a_line_that_cannot_be_read_is_not_published(with_printed):
    file = with_printed.archive / "sloepregister" / "sloepregister_2012.csv"
    file.write_text(
        file.read_text("utf-8").replace("32,62;5,59;41,63;2,60;2014", "x;5,59;41,63;2,60;2014")
    )
    with pytest.raises(MissingKnowledgeError, match=r"2012\.csv: Line 5: column 'A' .*Mend"):
        publish_register_of(with_printed)
    assert not folder(with_printed, "gedrukt-2012").exists()


def test_a_printed_line_is_rebased_in_closed_form_where_nothing_was_measured(with_printed):
    publish_register_of(with_printed)
    corrected = shipped_method("corrected-2013")
    with_printed.rebuild((corrected, shipped_method("as-published")))
    with_printed.publish("2014-1", "corrected-2013", carry="gedrukt-2012")
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
    notes = (published / "toelichting.md").read_text("utf-8")
    assert "Niet herijkt: 1 regel van gedrukt-2012" in notes
    measured = line_of(with_printed, with_printed.tow(2014), "2014-1")
    assert measured["basis"] == "measured"
    lines = diff(with_printed.store, "gedrukt-2012", "2014-1").lines
    causes = {row["fsn_no"]: json.loads(row["causes"]) for row in lines.iter_rows(named=True)}
    assert [c["cause"] for c in causes["FSN900"]] == ["closed_form"]
    assert [c["cause"] for c in causes[measured["fsn_no"]]] == ["printed_and_tow"]
