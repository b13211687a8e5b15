"""Methods: a federation lists, begins, checks, compares and publishes one of its own."""

import json

import pytest

from assets.lake import Folders
from dashboards.language import Language
from pipeline.method.options import Steps
from pipeline.method.reading import list_shipped_methods
from tests.conftest import METHODS, quickly
from warehouse.store.methods import methods_to_apply
from warehouse.store.store import Store


def test_methods_are_listed_and_shown_with_what_differs_from_their_parent(herijk):
    listed = json.loads(herijk("methods", "--json")[1])["methods"]
    assert [one["method"] for one in listed] == list(list_shipped_methods())
    for name in METHODS:
        assert name in herijk("methods")[1]
    shown = json.loads(herijk("methods", "show", "corrected-2013", "--json")[1])
    assert {(o["step"], o["option"], o["after"]) for o in shown["options"]} >= {
        ("speed", "factor", 1.06)
    }
    whole = json.loads(herijk("methods", "show", "as-published", "--json")[1])
    assert whole["extends"] is None
    steps = Steps.model_json_schema()["$defs"].values()
    options = {(o["step"], o["option"]) for o in whole["options"]}
    assert len(options) == sum(len(step["properties"]) for step in steps)


def test_a_method_is_begun_checked_and_compared(herijk, built, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    data = ("--data", built.data)
    assert herijk("methods", "new", "ours", "--from", "rebased-2015", *data, "--json")[0] == 0
    assert "sound" in herijk("methods", "check", "ours.toml", *data)[1]
    pair = ("rebased-2015", "ours.toml")
    assert "say the same" in herijk("compare", *pair, "--data", tmp_path / "none")[1]
    file = tmp_path / "ours.toml"
    file.write_text(file.read_text(encoding="utf-8") + "[steps.wind]\nside = 0.3\n", "utf-8")
    report = json.loads(herijk("compare", *pair, "--json", *data)[1])
    assert [(o["step"], o["option"], o["after"]) for o in report["options"]] == [
        ("wind", "side", 0.3)
    ]
    assert report["effect"]["causes"]
    printed = herijk("compare", "concept-rebased-2015", "ours.toml", *data)[1]
    assert Language("en").name_option("wind.side") in printed


@pytest.mark.more
def test_a_method_of_ones_own_is_rebuilt_and_published(herijk, bench, tmp_path):
    file = tmp_path / "ours.toml"
    file.write_text('name = "ours"\ntitle = "Onze"\nextends = "rebased-2015"\n', encoding="utf-8")
    folders = ("--archive", bench.archive, "--data", bench.data)
    with quickly(bench.store):
        printed = herijk("rebuild", *folders, "--method", file)[1]
    assert "Seasons read: none. Methods applied: as-published, rebased-2015, ours." in printed
    assert "Method ours: new" in printed
    assert set(bench.table("methods")["method"]) == {*METHODS, "ours"}
    assert set(bench.table("register")["method"]) == {*METHODS, "ours"}
    terms = ("--method", "ours", "--valid-from", "2015-01-01", "--decision", "ALV")
    assert herijk("publish", "2015-1", *terms, "--data", bench.data)[0] == 0
    assert herijk("verify", "--data", bench.data)[0] == 0


@pytest.mark.more
def test_a_method_goes_by_a_list_without_it_and_the_report_says_so(herijk, bench):
    folders = ("--archive", bench.archive, "--data", bench.data)
    (bench.data / "beheer.toml").write_text(f'methods = ["{METHODS[1]}"]', encoding="utf-8")
    with quickly(bench.store):
        printed = herijk("rebuild", *folders)[1]
        assert f"Method {METHODS[0]}: gone" in printed
        assert set(bench.table("register")["method"]) == {METHODS[1]}
        assert herijk("rebuild", *folders, "--method", "corrected-2013")[0] == 0
    assert set(bench.table("methods")["method"]) == {METHODS[1], "corrected-2013"}


def test_without_a_list_all_that_ship_are_applied_and_those_that_are_there(tmp_path, built):
    assert methods_to_apply(Store(tmp_path), ()) == list(list_shipped_methods())
    assert methods_to_apply(Store(tmp_path), (), ["rebased"]) == ["rebased"]
    assert methods_to_apply(built.store, (), ["rebased"]) == ["as-published", "rebased", METHODS[1]]
    assert methods_to_apply(built.store, ("rebased",)) == ["rebased"]
    folders = Folders(archive="", data=str(built.data))
    assert [method.name for method in folders.get_methods()] == list(list_shipped_methods())


def test_editions_and_methods_are_compared_with_each_other(herijk, published):
    data = ("--data", published.data)
    report = json.loads(herijk("compare", "2014-1", "rebased", *data, "--json")[1])
    assert report["effect"]["rows"]
    assert json.loads(herijk("compare", "rebased", "2014-1", *data, "--json")[1])["options"]
