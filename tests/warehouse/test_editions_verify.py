"""Verify: every kind of tampering is found and named; what is whole passes."""

import datetime as dt
import os
import shutil

import polars as pl
import pytest

import pipeline.recompute.computed
import warehouse.editions.verify
from pipeline.errors import MissingKnowledgeError
from pipeline.method.reading import read_shipped_method
from pipeline.tables.keys import LINE
from tests.tables import compute_tables
from tests.warehouse.edition_bench import DAY, terms
from warehouse.editions.lineage import lineage
from warehouse.editions.publish import publish_printed
from warehouse.editions.verify import find_differences, verify
from warehouse.store.editions import find_chain_head, find_manifest, read_edition, read_manifest
from warehouse.store.files import file_sha256


def folder(bench, name="2014-1"):
    return bench.store.editions / name


def found(bench, afresh=False, **wanted):
    report = verify(bench.store, afresh)
    wanted = wanted.items()
    findings = [f for f in report.findings if wanted <= vars(f).items()]
    return findings, report.wrong


@pytest.fixture
def _files_alone(monkeypatch):
    """Editions are not made again, which takes three quarters of the time."""
    monkeypatch.setattr(
        warehouse.editions.verify, "check_reproduction", lambda store, checked: (checked, [])
    )


FILES_ALONE = pytest.mark.usefixtures("_files_alone")


def test_untouched_editions_pass_and_come_out_equal_when_made_again(published):
    report = verify(published.store)
    assert report.findings == []
    assert not report.wrong
    for one in report.editions:
        register = read_edition(published.store, one.edition).register
        assert one.equal == register.height > 0


@FILES_ALONE
def test_a_damaged_description_does_not_stop_the_others(published_copy):
    (folder(published_copy) / "manifest.json").write_bytes(b"\xff\xfe")
    report = verify(published_copy.store)
    assert report.wrong
    assert [e.edition for e in report.editions] == ["2014-2"]


@FILES_ALONE
def test_an_added_file_is_found(published_copy):
    (folder(published_copy) / "~lock.register.xlsx#").write_text("x", encoding="utf-8")
    findings, wrong = found(published_copy, kind="altered")
    assert wrong
    assert [finding.where for finding in findings] == ["~lock.register.xlsx#"]


@FILES_ALONE
def test_swapped_and_missing_samples_files_are_named(published_copy):
    first, second = (published_copy.tow(season)["samples_path"] for season in (2009, 2014))
    content = (published_copy.archive / first).read_bytes()
    (published_copy.archive / second).write_bytes(content)
    (published_copy.archive / first).unlink()
    for kind, path in (("swapped", second), ("missing", first)):
        findings, wrong = found(published_copy, kind=kind)
        assert wrong
        assert {(f.edition, f.where) for f in findings} == {("2014-1", path), ("2014-2", path)}


def test_a_changed_tow_list_is_named_by_tow_and_fact(published_copy):
    tow = published_copy.tow(2014)
    file = published_copy.archive / "sleeplijsten" / "sleeplijst_2014.csv"
    text = file.read_text(encoding="utf-8")
    row = next(line for line in text.splitlines() if line.startswith(tow["tow_id"]))
    weight = f"{tow['weight_kg']:.0f}"
    assert f",{weight}," in row
    file.write_text(text.replace(row, row.replace(f",{weight},", ",777,", 1)), encoding="utf-8")
    findings, wrong = found(published_copy, True, edition="2014-1", kind="swapped")
    assert wrong
    assert [f.where for f in findings] == [f"tow {tow['tow_id']}"]
    assert f"weight_kg {tow['weight_kg']:g} > 777" in findings[0].message


@pytest.mark.more
def test_a_file_changed_and_rebuilt_makes_another_number_and_says_why(published_copy):
    tow = published_copy.tow(2009)["tow_id"]
    published_copy.change_force(tow, lambda n: 1.02 * n)
    published_copy.rebuild((read_shipped_method("as-published"),))
    report = verify(published_copy.store, afresh=False)
    assert report.wrong
    own = [f for f in report.findings if f.kind == "differs" and f.edition == "2014-1"]
    register = read_edition(published_copy.store, "2014-1").register
    counts = register.filter(tow_id=tow).height
    assert len(own) == counts
    assert all("tows that went into it changed" in f.message for f in own)


@pytest.mark.more
def test_what_other_code_makes_otherwise_stands_where_the_head_is_known(
    published_copy, monkeypatch
):
    original = pipeline.recompute.computed.still_air_coefficient_kg_m
    monkeypatch.setattr(
        pipeline.recompute.computed,
        "still_air_coefficient_kg_m",
        lambda area, drag: 1.5 * original(area, drag),
    )
    report = verify(published_copy.store, afresh=False)
    assert report.wrong
    assert {f.kind for f in report.findings} == {"differs"}
    assert all("either the code changed since, or" in f.message for f in report.findings)
    assert not verify(published_copy.store, False, report.head).wrong


@pytest.mark.more
def test_editions_of_other_code_come_out_equal_where_their_numbers_do(
    bench_of_editions, monkeypatch
):
    bench_of_editions.publish("2014-1", "as-published")
    with monkeypatch.context() as then:
        for user in ("derive.registers", "editions.publish"):
            then.setattr(f"warehouse.{user}.code_version", lambda: "0.9.0+other")
        bench_of_editions.rebuild()
        bench_of_editions.publish("2014-2", "as-published")
    assert verify(bench_of_editions.store, afresh=False).findings == []


def test_an_edition_of_a_method_with_options_that_are_gone_was_made_by_other_code(published_copy):
    path = folder(published_copy, "2014-2")
    text = (path / "method.toml").read_text(encoding="utf-8")
    then = text.replace("calibration = { ", 'calibration = { stream = "drifting", ')
    assert then != text
    (path / "method.toml").write_text(then, encoding="utf-8")
    sealed_anew(path, method_hash="0" * 64)
    assert read_edition(published_copy.store, "2014-2").method is not None
    own = [f for f in verify(published_copy.store, afresh=False).findings if f.edition == "2014-2"]
    assert any("made by other code" in finding.message for finding in own)


# Lineage


def test_a_boat_or_edition_that_is_not_there_is_named(published):
    with pytest.raises(MissingKnowledgeError, match="boat FSN000 is not in edition 2014-1"):
        lineage(published.store, "2014-1", "FSN000")
    with pytest.raises(MissingKnowledgeError, match="published: 2014-1, 2014-2"):
        lineage(published.store, "2014-9", "FSN000")


# Printed lines, and lines carried over from print

PRINTED = """fsn_nr;roeiers;klasse;A;B;Cw;roeisnelheid [m/s];sleepdatum
FSN900;8;H;32,62;5,59;41,63;2,60;2011-03-06
FSN901;6;H;0,99;25,00;1,00;2,20;
"""


@pytest.fixture(scope="module")
def carried(edition_archive, tmp_path_factory):
    """A printed edition, and one that carries over its line; read only."""
    bench = edition_archive.copy(tmp_path_factory.mktemp("carried"))
    file = bench.archive / "sloepregister" / "sloepregister_2012.csv"
    file.write_text(PRINTED, encoding="utf-8")
    bench.rebuild((read_shipped_method("corrected-2013"),))
    publish_printed(bench.store, 2012, terms("printed", dt.date(2012, 5, 1)))
    bench.publish("2014-1", "corrected-2013", carry="printed")
    return bench


@pytest.fixture
def carrying(carried, tmp_path):
    """The same, to change at will."""
    return carried.copy(tmp_path)


@pytest.mark.more
def test_carried_and_printed_lines_are_made_again_too(carrying):
    report = verify(carrying.store, afresh=False)
    assert not report.wrong
    for one in report.editions:
        register = read_edition(carrying.store, one.edition).register
        assert one.equal == register.height
    carried = read_edition(carrying.store, "2014-1").register.filter(basis="printed_rebased")
    assert carried["fsn_no"].to_list() == ["FSN900"]


# A chain of editions, and what a new seal does not hide


def sealed_anew(path, *more, **said):
    """The hashes of what lies there now, under a new seal, with what else it says of itself."""
    files = {file: file_sha256(path / file) for file in (*read_manifest(path).files, *more)}
    manifest = read_manifest(path).model_copy(update={"files": files} | said).sealed()
    find_manifest(path).write_text(manifest.model_dump_json(), encoding="utf-8")


def rewritten(path, table, **columns):
    frame = pl.read_parquet(path / f"{table}.parquet")
    frame.with_columns(**columns).write_parquet(path / f"{table}.parquet")


def reworded(path, file, was, now):
    text = (path / file).read_bytes().decode("utf-8")
    assert was in text
    (path / file).write_bytes(text.replace(was, now, 1).encode("utf-8"))


EVERY_LINE = {
    "cw_kg_m": pl.col("cw_kg_m") * 0.9,
    "flags": pl.lit(["doubted"]),
    "weight_kg": pl.lit(1.0),
    "valid_until": pl.lit(dt.date(2031, 12, 31)),
}
TABLES = {
    "register_changes": {"cw_ratio": pl.col("cw_ratio") * 1.5},
    "ensemble": {"cw_kg_m": pl.col("cw_kg_m") * 1.001},
    "run_points": {"cw_kg_m": pl.col("cw_kg_m") * 1.001},
    "curves": {"power_w": pl.col("power_w") * 1.001},
    "log_factors": {"factor": pl.col("factor") * 1.001},
}
TEXTS = {
    "decisions.json": ("[]", "[ ]"),
    "register.csv": ("controlecode\r\n", "controlecode \r\n"),
}


def test_every_forged_column_of_a_line_is_named_whatever_version_is_sealed(published_copy):
    path = folder(published_copy, "2014-2")
    rewritten(path, "register", **EVERY_LINE)
    sealed_anew(path, code_version="9.9.9")
    findings = verify(published_copy.store, afresh=False).findings
    assert {(f.edition, f.kind, f.wrong) for f in findings} == {("2014-2", "differs", True)}
    assert len(findings) == read_edition(published_copy.store, "2014-2").register.height
    messages = " ".join(finding.message for finding in findings)
    assert [column for column in EVERY_LINE if column not in messages] == []


def test_every_forged_table_text_and_sheet_is_named(published_copy):
    path = folder(published_copy, "2014-2")
    for table, columns in TABLES.items():
        rewritten(path, table, **columns)
    for file, (was, now) in TEXTS.items():
        reworded(path, file, was, now)
    sealed_anew(path)
    findings = verify(published_copy.store, afresh=False).findings
    assert {(f.edition, f.kind, f.wrong) for f in findings} == {("2014-2", "differs", True)}
    tables = {f"{table}.parquet" for table in TABLES}
    assert {f.where for f in findings} == {*tables, *TEXTS}


@pytest.mark.more
def test_forged_doubts_come_out_otherwise(published_copy):
    path = folder(published_copy, "2014-2")
    rewritten(path, "tows", doubts=pl.lit(["far_from_type"]))
    sealed_anew(path)
    findings = verify(published_copy.store, afresh=False).findings
    assert {(f.edition, f.kind, f.wrong) for f in findings} == {("2014-2", "differs", True)}


def test_a_line_that_is_there_twice_differs(published):
    register = read_edition(published.store, "2014-2").register
    twice = pl.concat([register, register.head(1)])
    (row,) = find_differences(twice, register, LINE).iter_rows(named=True)
    assert (row["there"], row["there now"]) == (True, None)


@FILES_ALONE
def test_the_head_decides_whether_an_edition_was_forged(published_copy):
    minutes = find_chain_head(published_copy.store).seal
    path = folder(published_copy, "2014-2")
    rewritten(path, "register", **EVERY_LINE)
    sealed_anew(path)
    forged = find_chain_head(published_copy.store).seal
    wrong = [verify(published_copy.store, False, head).wrong for head in (forged, minutes)]
    assert wrong == [False, True]


def test_forged_inputs_of_an_edition_are_named(published_copy):
    tow = published_copy.tow(2014)
    heavier = pl.when(tow_id=tow["tow_id"]).then(pl.col("weight_kg") + 1)
    path = folder(published_copy, "2014-2")
    rewritten(path, "tows", weight_kg=heavier.otherwise("weight_kg"))
    sealed_anew(path)
    findings, wrong = found(published_copy, kind="swapped")
    assert wrong
    assert [f.where for f in findings] == [f"tow {tow['tow_id']}"]


@pytest.mark.more
def test_an_edition_of_other_blocks_than_the_samples_give_comes_out_otherwise(bench_of_editions):
    store, tow = bench_of_editions.store, bench_of_editions.tow(2014)
    powers = {"force": 1, "log1_cw": 1, "log1_cw2": 2}
    blocks = store.read("blocks")
    forged = blocks.with_columns(
        pl.when(tow_id=tow["tow_id"]).then(pl.col(n) * 1.06**power).otherwise(n).alias(n)
        for n, power in powers.items()
    )
    store.write("blocks", forged)
    compute_tables(store, [read_shipped_method("as-published")], DAY)
    bench_of_editions.publish("2014-1")
    findings, wrong = found(bench_of_editions, True, kind="differs")
    assert wrong
    assert any("cw_kg_m" in finding.message for finding in findings)


@pytest.mark.more
@pytest.mark.parametrize(("edition", "boat"), [("2014-1", "FSN900"), ("printed", "FSN900")])
def test_a_changed_carried_or_printed_line_comes_out_otherwise(carrying, edition, boat):
    mine = pl.when(fsn_no=boat).then(pl.col("a_kg_m") + 1)
    rewritten(folder(carrying, edition), "register", a_kg_m=mine.otherwise("a_kg_m"))
    findings, wrong = found(carrying, kind="differs", edition=edition)
    assert wrong
    assert [f.where for f in findings] == [f"{boat} 8H"]
    assert "a_kg_m" in findings[0].message


def test_an_edition_that_is_gone_breaks_the_chain(published_copy):
    editions = published_copy.data / "editions"
    first = min(
        (p for p in editions.glob("[!.]*")), key=lambda path: read_manifest(path).number or 0
    )
    shutil.rmtree(first)
    findings, wrong = found(published_copy, kind="altered", where="chain")
    assert wrong
    assert findings


@FILES_ALONE
def test_a_link_in_place_of_a_file_is_told(published_copy, tmp_path):
    path = next((published_copy.data / "editions").glob("[!.]*")) / "register.csv"
    path.rename(tmp_path / "elsewhere.csv")
    path.symlink_to(tmp_path / "elsewhere.csv")
    findings, wrong = found(published_copy, kind="altered", where="register.csv")
    assert wrong
    assert "link" in findings[0].message


@pytest.mark.more
def test_samples_changed_with_the_same_size_and_time_are_found(published_copy):
    path = published_copy.archive / published_copy.tow(2009)["samples_path"]
    before, text = path.stat(), path.read_bytes()
    path.write_bytes(text[:-3] + bytes([text[-3] ^ 1]) + text[-2:])
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))
    assert found(published_copy, True, kind="swapped")[1]
