"""The workbench without a browser: controls, answers, files, and whom it refuses."""

import dataclasses
import json
import subprocess
import sys
import urllib.error
import urllib.request

import pytest
from polars.testing import assert_frame_equal

from dashboards.guard import listen
from dashboards.workbench import texts
from dashboards.workbench.bench import KEPT, SCENARIO, Base, Bench, Named, Question
from dashboards.workbench.form import _kind, controls
from dashboards.workbench.server import LOOPBACK
from pipeline.assessment.checks import CODES
from pipeline.errors import HerijkError, MissingKnowledgeError, UnavailableError
from pipeline.method.definition import MethodFileError, Steps, parse_method
from pipeline.recompute.run_cache import RunCache
from tests.architecture.repository import ROOT
from tests.dashboards.conftest import served
from warehouse.queries.history import History
from warehouse.queries.scenario import rebase
from warehouse.store.store import Store

CONTROLS = {(s["step"], c["option"]): c for s in controls() for c in s["options"]}
PARENT = "rebased-2015"


@pytest.fixture(scope="module")
def history(built):
    return History.of(built.store)


@pytest.fixture
def bench(history, tmp_path):
    """A workbench that saves into a folder of its own."""
    return Bench(Store(tmp_path), history)


def steps(bench, base=PARENT, **changes):
    """The steps of a base with options changed: `wind={"ahead": 0.4}`."""
    held = bench.base(Base(name=base))["ranges"]
    return tuple(
        Steps.model_validate(r["steps"] | {k: r["steps"][k] | v for k, v in changes.items()})
        for r in held
    )


def question(bench, base=PARENT, against="as-published", boat="", **changes):
    made = steps(bench, base, **changes)
    return Question(base=Base(name=base), steps=made, against=against, boat=boat)


def named(bench, name="own", **changes):
    return Named(
        base=Base(name=PARENT), steps=steps(bench, **changes), name=name, title="T", reason="R"
    )


# Controls


def test_every_option_of_the_model_has_a_control():
    model = {
        (step, option)
        for step, field in Steps.model_fields.items()
        for option in field.annotation.model_fields
    }
    assert set(CONTROLS) == model
    assert "fixed" not in {control["kind"] for control in CONTROLS.values()}


@pytest.mark.parametrize(("step", "option"), CONTROLS)
def test_the_ends_of_a_control_are_values_of_the_model(step, option):
    control = CONTROLS[step, option]
    model = Steps.model_fields[step].annotation
    ends = [control["least"], control["most"]] if control["kind"] == "number" else []
    several = [control["values"]] if control["kind"] == "several" else []
    values = control["values"] if control["kind"] == "choice" else []
    needed = {name: CONTROLS[step, name]["values"][0] for name, f in model.model_fields.items()
              if f.is_required()}  # fmt: skip
    for value in (*ends, *several, *values):
        model.model_validate(needed | {option: value})


def test_kinds_of_options():
    assert CONTROLS["wind", "model"]["values"] == ["head", "oblique"]
    factor = CONTROLS["speed", "factor"]
    assert (factor["least"], factor["most"], factor["whole"]) == (0.85, 1.2, False)
    assert CONTROLS["wind", "averaging_s"]["by"] == 1
    assert CONTROLS["wind", "averaging_s"]["unit"] == "s"
    assert set(CONTROLS["assessment", "reject"]["values"]) == set(CODES)


@pytest.mark.parametrize(
    ("rule", "kind"),
    [
        ({"type": "boolean"}, "choice"),
        ({"type": "number", "minimum": 0.0}, "fixed"),
        ({"type": "string"}, "fixed"),
        ({"anyOf": [{"type": "integer"}, {"type": "null"}]}, "fixed"),
        ({"type": "array", "items": {"type": "string"}}, "fixed"),
    ],
)
def test_an_option_of_a_new_kind_appears_too(rule, kind):
    assert _kind(rule)["kind"] == kind


def test_every_option_and_value_has_a_text():
    keys = [f"{step}.{option}" for step, option in CONTROLS]
    keys += [f"step.{step}" for step, _ in CONTROLS]
    keys += [f"choice.{v}" for c in CONTROLS.values() if c["kind"] == "choice" for v in c["values"]]
    assert [key for key in keys if key not in texts.TEXTS] == []


def test_a_name_without_a_text_stands_for_itself():
    assert texts.text("speed.something_new") == "something_new"


# Answers


def test_a_base_is_cut_at_the_seasons_of_the_archive(bench):
    ranges = bench.base(Base(name=PARENT))["ranges"]
    assert [(r["first"], r["last"], r["seasons"]) for r in ranges] == [
        (2009, 2011, [2009]), (2012, 2013, []), (2014, 9999, [2014]),
    ]  # fmt: skip


def test_an_answer_is_plain_data_for_json(bench, history):
    boat = history.tows["fsn_no"][0]
    answer = bench.answer(question(bench, boat=boat, wind={"side": 1.2}))
    text = json.dumps(answer, allow_nan=False)
    assert answer["summary"]["lines"] == len(answer["register"])
    assert {row["method"] for row in answer["boat_curves"]} == {"as-published", SCENARIO}
    assert [d["option"] for d in answer["changed_options"]] == ["side"]
    assert SCENARIO in text


def test_types_are_judged_by_the_tows_that_are_chosen(bench):
    asked = question(bench).model_copy(update={"tows": "2014"})
    answer = bench.answer(asked)
    assert {row["season"] for row in answer["types"]} == {2014}
    every = bench.answer(question(bench))
    assert len(every["types"]) > len(answer["types"])
    assert sum(r["n_boats"] for r in every["homogeneity"]) > sum(
        r["n_boats"] for r in answer["homogeneity"]
    )


def test_a_method_against_itself_shows_no_change(bench):
    summary = bench.answer(question(bench, against=PARENT))["summary"]
    assert summary["same"] == summary["lines"]


def test_a_file_that_was_opened_is_a_base(bench):
    text = f'name = "x"\ntitle = "X"\nextends = "{PARENT}"\n[steps]\nwind = {{ side = 0.9 }}\n'
    found = bench.base(Base(name="x.toml", text=text))
    assert {r["steps"]["wind"]["side"] for r in found["ranges"]} == {0.9}
    with pytest.raises(MethodFileError, match=r"x\.toml"):
        bench.base(Base(name="x.toml", text="no toml ="))


def test_what_is_not_known_is_refused(bench):
    with pytest.raises(MissingKnowledgeError, match="no method 'best'"):
        bench.base(Base(name="best"))
    with pytest.raises(HerijkError, match="ranges"):
        bench.answer(question(bench).model_copy(update={"steps": ()}))


# Files


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"wind": {"ahead": 0.62, "model": "head"}, "run_point": {"estimator": "ratio_of_means"}},
        {"window": {"rule": "all"}, "speed": {"correction": "estimated"}},
    ],
)
def test_the_register_of_a_saved_file_is_the_one_that_was_shown(bench, history, changes):
    shown = bench.register(question(bench, **changes))
    path = bench.save(named(bench, **changes))
    read = parse_method(path.read_text(encoding="utf-8"), str(path))
    again = dataclasses.replace(history, cache=RunCache()).under(read).register
    assert_frame_equal(again.drop("edition"), shown.drop("edition"))


def test_rebase_finds_what_the_workbench_showed(bench, built):
    changes = {"wind": {"side": 0.5}}
    answer = bench.answer(question(bench, **changes))
    path = bench.save(named(bench, **changes))
    method = parse_method(path.read_text(encoding="utf-8"), str(path))
    against = bench.history.under(parse_method(_extending("as-published"), "x")).method
    report = rebase(built.store, method, against)
    counts = {row["change"]: row["count"] for row in report.changes}
    assert counts.get("changed", 0) == answer["summary"]["changed"]
    shown = {(r["fsn_no"], r["rowers"], r["crew_class"]): r["cw_ratio"] for r in answer["register"]}
    for row in report.boats:
        key = row["fsn_no"], row["rowers"], row["crew_class"]
        assert shown[key] == pytest.approx(row["cw_ratio"], rel=10.0 ** (1 - KEPT))


def _extending(name):
    return f'name = "x"\ntitle = "X"\nextends = "{name}"\n'


def test_a_saved_file_is_a_base_from_then_on(bench):
    bench.save(named(bench, wind={"side": 0.77}))
    assert bench.start()["saved"] == ["own"]
    ranges = bench.base(Base(name="own"))["ranges"]
    assert {r["steps"]["wind"]["side"] for r in ranges} == {0.77}


def test_no_file_is_written_over(bench):
    path = bench.save(named(bench))
    before = path.read_bytes()
    with pytest.raises(HerijkError, match="choose another name"):
        bench.save(named(bench, wind={"side": 1.0}))
    assert path.read_bytes() == before
    assert [f.name for f in bench.known.folder.iterdir()] == ["own.toml"]


@pytest.mark.parametrize("name", ["rebased", SCENARIO])
def test_names_that_mean_something_else_are_refused(bench, name):
    with pytest.raises(HerijkError, match="another"):
        bench.save(named(bench, name))


@pytest.mark.parametrize("name", ["../own", "a/b", "Own", "", ".own", "a\n", "x" * 61])
def test_a_name_cannot_lead_out_of_the_folder(bench, name):
    with pytest.raises(ValueError, match="name"):
        named(bench, name)


# The server


@pytest.fixture
def url(bench):
    with served(bench) as address:
        yield address


def ask(url, path="", body=None, **headers):
    """Status and text of a request, as the workbench's own page makes it unless told otherwise."""
    own = {"Origin": url.rstrip("/"), "Content-Type": "application/json"}
    kept = {name: value for name, value in (own | headers).items() if value is not None}
    data = None if body is None else json.dumps(body).encode()
    request = urllib.request.Request(url + path, data, kept)  # noqa: S310 - loopback
    try:
        with urllib.request.urlopen(request) as response:  # noqa: S310
            return response.status, response.read().decode()
    except urllib.error.HTTPError as error:
        return error.code, error.read().decode()


def test_it_listens_on_loopback_only(url):
    assert url.startswith("http://127.0.0.1:")
    held = listen(LOOPBACK, 0)
    assert held.getsockname()[0] == "127.0.0.1"
    with pytest.raises(UnavailableError, match="--port"):
        listen(LOOPBACK, int(url.rsplit(":", 1)[1].rstrip("/")))
    held.close()


@pytest.mark.parametrize("path", ["", "static/workbench.js"])
@pytest.mark.parametrize("host", ["evil.example", "evil.example:80", "127.0.0.1.evil.example", ""])
def test_a_page_that_comes_under_another_name_is_refused(url, path, host):
    assert ask(url, path, Host=host)[0] == 403


@pytest.mark.parametrize(
    "headers",
    [
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": "http://127.0.0.1:1"},
        {"Content-Type": "text/plain"},
        {"Content-Type": "application/x-www-form-urlencoded"},
    ],
)
def test_only_its_own_page_may_ask_and_save(url, bench, headers):
    body = named(bench).model_dump(mode="json")
    assert ask(url, "save", body, **headers)[0] == 403
    assert not bench.known.folder.exists()
    assert ask(url, "save", body)[0] == 200
    assert bench.known.folder.is_dir()


def test_questions_are_not_asked_by_address(url):
    assert ask(url, "save")[0] == 405
    assert ask(url, "static/../bench.py")[0] == 404


def test_what_cannot_be_is_answered_with_a_sentence(url, bench):
    body = question(bench).model_dump(mode="json")
    body["steps"][0]["wind"]["ahead"] = 9
    status, text = ask(url, "answer", body)
    refused = json.loads(text)
    assert status == 200
    assert refused["where"] == "wind.ahead"
    assert "less than or equal to 2" in refused["refused"]
    body["steps"][0]["wind"] = {"model": "sideways"}
    assert "'sideways'" in json.loads(ask(url, "answer", body)[1])["refused"]
    assert "refused" in json.loads(ask(url, "answer", {"base": {}})[1])


def test_the_page_says_that_the_archive_is_simulated(url):
    assert "GESIMULEERD" in ask(url)[1]


def test_the_command_does_not_load_the_web_stack_before_it_is_asked():
    code = (
        "import sys, herijk.cli.main; heavy = {'starlette', 'uvicorn', 'altair', 'dagster'};"
        "sys.exit(', '.join(sorted(heavy & sys.modules.keys())) or 0)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
