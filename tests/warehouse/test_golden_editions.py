"""Editions published by the code of before keep their integrity, and are read."""

import hashlib
import json
import shutil
from pathlib import Path

import polars as pl
import pytest

from pipeline.register.causes import summarise_causes
from tests.warehouse.edition_bench import diff
from warehouse.editions.lineage import lineage
from warehouse.editions.sheets import compute_verification_codes
from warehouse.editions.verify import verify
from warehouse.store.editions import read_edition
from warehouse.store.store import Store

GOLDEN = Path(__file__).parents[1] / "data" / "golden-editions"
EDITIONS = ("2014-1", "gedrukt-2014")
HEAD = "1a63d14197126924f5d7a3a93a553103187270d602e7b299f3886e64b57d1e96"
MADE_AGAIN = {"unchecked", "differs"}
"""What `verify` finds where there is no archive to make them again from."""


@pytest.fixture
def store(tmp_path):
    """A data folder with nothing but the editions, to change at will."""
    shutil.copytree(GOLDEN, tmp_path / "editions", ignore=shutil.ignore_patterns("README.md"))
    return Store(tmp_path)


def integrity(store):
    """What is wrong with files, seals and chain: edition and place."""
    findings = verify(store, head=HEAD).findings
    return {(f.edition, f.where) for f in findings if f.wrong and f.kind not in MADE_AGAIN}


def sealed(about):
    """What an edition says of itself under a new seal, as somebody in the know would make it."""
    content = {name: about[name] for name in about.keys() - {"seal", "texts_version"}}
    text = json.dumps(content, sort_keys=True)
    return about | {"seal": hashlib.sha256(text.encode()).hexdigest()}


def test_they_are_whole(store):
    report = verify(store, head=HEAD)
    assert integrity(store) == set()
    assert report.head == HEAD
    assert [one.edition for one in report.editions] == list(EDITIONS)


def test_another_head_is_found(store):
    findings = verify(store, head="0" * 64).findings
    assert ("", "chain") in {(f.edition, f.where) for f in findings if f.wrong}


@pytest.mark.parametrize("edition", EDITIONS)
def test_one_flipped_bit_of_any_file_is_found(store, edition):
    for file in sorted((store.editions / edition).iterdir()):
        whole = file.read_bytes()
        flipped = bytearray(whole)
        flipped[len(whole) // 2] ^= 1
        file.write_bytes(bytes(flipped))
        assert file.name in {where for name, where in integrity(store) if name == edition}
        file.write_bytes(whole)


def test_a_copy_out_of_the_chain_with_other_numbers_is_found(store):
    path = shutil.copytree(store.editions / "2014-1", store.editions / "2014-2")
    register = pl.read_parquet(path / "register.parquet")
    register.with_columns(pl.col("cw_kg_m") * 0.9).write_parquet(path / "register.parquet")
    about = json.loads((path / "edition.json").read_text(encoding="utf-8"))
    digest = hashlib.sha256((path / "register.parquet").read_bytes()).hexdigest()
    forged = about | {
        "edition": "2014-2",
        "number": None,
        "after_seal": None,
        "files": about["files"] | {"register.parquet": digest},
    }
    (path / "edition.json").write_text(json.dumps(sealed(forged)), encoding="utf-8")
    assert integrity(store) == {("2014-2", "chain")}


def test_the_seal_of_this_test_is_that_of_the_editions(store):
    for edition in EDITIONS:
        text = (store.editions / edition / "edition.json").read_text(encoding="utf-8")
        assert sealed(json.loads(text)) == json.loads(text)


def test_they_are_read_with_the_lines_that_were_printed(store):
    edition = read_edition(store, "2014-1")
    lines = edition.register.select("fsn_no", "status", "basis", pl.col("cw_kg_m").round(3)).rows()
    assert ("FSN101", "valid", "measured", 39.992) in lines
    assert ("FSN106", "valid", "printed_not_rebased", 43.897) in lines
    assert ("FSN104", "excluded", None, None) in lines
    assert read_edition(store, "gedrukt-2014").method is None


@pytest.mark.parametrize("name", EDITIONS)
def test_their_verification_codes_follow_from_their_lines(store, name):
    edition = read_edition(store, name)
    codes = compute_verification_codes(edition.register, edition.manifest.method_hash)
    assert codes == edition.register["verification_code"].to_list()


def test_a_line_leads_to_its_files_and_seconds(store):
    (line,) = lineage(store, "2014-1", "FSN101").lines
    assert line["code"] == "L5GGRO35HO"
    (file,) = line["files"]
    assert file["path"] == "meetdata_2014/kuikensloep 001 8d 2014.csv.gz"
    assert len(line["runs"]) == 6


def test_their_comparison_is_that_of_the_day_of_publication(store):
    lines = diff(store, "gedrukt-2014", "2014-1")
    assert dict(lines["change"].value_counts().rows()) == {"added": 1, "changed": 2, "same": 1}
    assert [one["cause"] for one in summarise_causes(lines.drop_nulls("cw_ratio"))] == [
        "printed_and_tow"
    ]
