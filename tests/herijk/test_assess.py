"""A tow on the quay: in seconds, without a trace, and what the next rebuild says of it."""

import shutil

import pytest

from dashboards.speech import Speech
from dashboards.statements.tow import statements
from pipeline.method.definition import shipped_method
from tests.conftest import METHODS
from warehouse.queries.assess import assess
from warehouse.store.files import file_sha256

METHOD = METHODS[-1]


def hashes(folder):
    return {str(f): file_sha256(f) for f in sorted(folder.rglob("*")) if f.is_file()}


@pytest.fixture
def new_tow(bench):
    """A tow that the last rebuild did not have: its file came afterwards."""
    tow = bench.table("tows").filter(season=2014).row(-1, named=True)
    file, kept = bench.archive / tow["samples_path"], bench.archive.parent / "later"
    shutil.move(file, kept)
    bench.rebuild(METHODS)
    assert bench.table("tows").filter(tow_id=tow["tow_id"]).is_empty()
    shutil.move(kept, file)
    return tow


def test_a_new_tow_has_the_number_of_the_next_rebuild_and_leaves_no_trace(bench, new_tow):
    before = hashes(bench.data)
    found = assess(bench.store, bench.archive, new_tow["tow_id"], shipped_method(METHOD))
    assert hashes(bench.data) == before
    bench.rebuild(METHODS)
    then = bench.table("curves").filter(tow_id=new_tow["tow_id"], method=METHOD)
    assert found.curve["cw_lo_kg_m"] <= then["cw_kg_m"][0] <= found.curve["cw_hi_kg_m"]
    assert then["cw_kg_m"][0] == pytest.approx(found.curve["cw_kg_m"], rel=1e-9)
    assert [run["run"] for run in found.runs] == [1, 2, 3, 4, 5, 6]
    assert found.of_type["lowest"] <= found.of_type["median"] <= found.of_type["highest"]


def said(found):
    return {one.kind: one(Speech("nl")) for one in statements(found, log_known=True)}


def test_what_to_do_now(built):
    tow_id = built.table("tows")["tow_id"][-1]
    found = assess(built.store, built.archive, tow_id, shipped_method(METHOD))
    run = found.runs[3]
    run |= {"cw_kg_m": 1.05 * run["fitted_cw_kg_m"]}
    assert "Run 4 " in said(found)["run_off"]
    assert "+5,0" in said(found)["run_off"]
    run |= {"cw_kg_m": None}
    assert "geen gelijkmatig deel" in said(found)["run_lost"]
    assert "let_go" not in said(found)
    for run in found.runs:
        run |= {"cw_kg_m": 30.0, "fitted_cw_kg_m": 30.0}
    found.curve.update(cw_kg_m=30.0, cw_lo_kg_m=29.5, cw_hi_kg_m=30.5)
    last = {"tow_date": found.tow["tow_date"], "cw_kg_m": 30.2, "cw_lo_kg_m": 29.7,
            "cw_hi_kg_m": 30.7}  # fmt: skip
    object.__setattr__(found, "own_before", last)
    assert "let_go" in said(found)
    last |= {"cw_kg_m": 33.0, "cw_lo_kg_m": 32.5, "cw_hi_kg_m": 33.5}
    assert "differs_from_last" in said(found)
    found.curve.update(cw_kg_m=None)
    assert "tow_again" in said(found)


def test_the_command_says_that_it_is_provisional(built, herijk):
    tow_id = built.table("tows")["tow_id"][-1]
    folders = ("--archive", built.archive, "--data", built.data)
    code, out, _ = herijk("assess", tow_id, *folders)
    assert (code, "Provisional: Cw is" in out, "Its runs" in out) == (0, True, True)
