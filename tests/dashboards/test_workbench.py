"""The workbench without a browser: controls, answers, files, and whom it refuses."""

import dataclasses
import json
import urllib.error
import urllib.request
from urllib.parse import urlencode

import pytest
from polars.testing import assert_frame_equal

from dashboards import words
from dashboards.guard import listen
from dashboards.workbench.bench import SCENARIO, Saving
from dashboards.workbench.form import CONTROLS, write
from dashboards.workbench.server import LOOPBACK
from pipeline.assessment.checks import CODES
from pipeline.errors import HerijkError, UnavailableError
from pipeline.method.options import Steps
from pipeline.method.reading import parse_method
from pipeline.recompute.run_cache import RunCache
from warehouse.editions.compare import compare
from warehouse.editions.publish import draft_edition

PARENT = "rebased-2015"
SIDE = {"wind.side": "0.77"}


def asked(workbench, **query):
    return workbench.read_address({"base": PARENT, "against": "as-published"} | query)


def saving(name="own", changes=SIDE):
    return Saving(address={"base": PARENT, **changes}, name=name, title="T", reason="R")


def side(method):
    return {block.steps.wind.side for block in method.ranges}


def test_every_option_of_the_model_has_a_control():
    model = {
        (step, option)
        for step, field in Steps.model_fields.items()
        for option in field.annotation.model_fields
    }
    assert set(CONTROLS) == model


@pytest.mark.parametrize(("step", "option"), CONTROLS)
def test_what_a_control_offers_is_a_value_of_the_model(step, option):
    one = CONTROLS[step, option]
    model = Steps.model_fields[step].annotation
    several = [one.values] if one.kind == "several" else one.values
    needed = {name: CONTROLS[step, name].values[0] for name, f in model.model_fields.items()
              if f.is_required()}  # fmt: skip
    for value in [one.least, one.most] if one.kind == "number" else several:
        read = one.read(write(value))
        model.model_validate(needed | {option: read})


def test_kinds_of_options():
    assert CONTROLS["wind", "model"].values == ["head", "oblique"]
    factor, seconds = CONTROLS["speed", "factor"], CONTROLS["wind", "averaging_s"]
    assert (factor.least, factor.most) == (0.85, 1.2)
    assert (seconds.most, seconds.unit) == (15, "s")
    assert set(CONTROLS["assessment", "reject"].values) == set(CODES)


def test_every_option_and_value_has_a_text():
    keys = [f"{step}.{option}" for step, option in CONTROLS]
    keys += [f"step.{step}" for step, _ in CONTROLS]
    keys += [f"choice.{v}" for c in CONTROLS.values() if c.kind == "choice" for v in c.values]
    known = {*words.OPTIONS, *(f"choice.{code}" for code in words.CODES)}
    assert [key for key in keys if key not in known] == []
    assert words.name_option("speed.something_new") == "something_new"


def test_an_address_without_anything_asks_the_usual(workbench):
    usual = workbench.read_address({})
    unknown = workbench.read_address({"boat": "none"})
    assert (usual.base, usual.against, usual.at) == ("rebased", "rebased", "")
    assert usual.boat == workbench.boats["fsn_no"][0] == unknown.boat


def test_an_address_asks_again_what_it_was_made_from(workbench):
    one = asked(workbench, at="2009", boat=workbench.boats["fsn_no"][1], **SIDE)
    query = dict(pair.split("=") for pair in one.address()[1:].split("&"))
    assert workbench.read_address(query) == one


def test_a_change_holds_for_all_seasons_or_for_those_from_one_on(workbench):
    assert side(workbench.make_method(asked(workbench, **SIDE))) == {0.77}
    method = workbench.make_method(asked(workbench, **SIDE, **{"wind.side.2014": "0.9"}))
    assert (method.get_steps(2009).wind.side, method.get_steps(2014).wind.side) == (0.77, 0.9)
    assert [d.option for d in workbench.list_changes(asked(workbench, **SIDE))] == ["side"]


def test_a_page_shows_what_is_asked(workbench):
    boat = workbench.boats["fsn_no"][0]
    shown = workbench.compute_results(asked(workbench, boat=boat, **SIDE))
    assert set(shown["curves"]["method"]) == {"as-published", SCENARIO}
    assert shown["lines"].height == workbench.make_draft(asked(workbench)).register.height
    assert set(shown["consistency"]["method"]) == {"as-published", SCENARIO}


def test_a_method_against_itself_shows_no_change(workbench):
    summary = workbench.compare_drafts(asked(workbench, against=PARENT)).summary()
    assert summary["same"] == summary["lines"]


@pytest.mark.parametrize(
    ("query", "words"),
    [
        ({"base": "best"}, "no method 'best'"),
        ({"wind.side": "9"}, "between 0.0 and 2.0, and is 9"),
        ({"wind.side": "x"}, "and is x"),
        ({"wind.model": "sideways"}, "cannot be sideways"),
        ({"wind.force": "1"}, "no option wind.force"),
    ],
)
def test_what_cannot_be_is_refused(workbench, query, words):
    with pytest.raises(HerijkError, match=words):
        workbench.make_method(asked(workbench, **query))


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"wind.ahead": "0.62", "wind.model": "head", "run_point.estimator": "ratio_of_means"},
        {"window.rule": "all", "speed.correction.2014": "estimated"},
    ],
)
def test_the_register_of_a_saved_file_is_the_one_that_was_shown(workbench, history, changes):
    shown = workbench.make_draft(asked(workbench, **changes)).register
    path = workbench.save(saving(changes=changes))
    read = parse_method(path.read_text(encoding="utf-8"), str(path))
    again = dataclasses.replace(history, cache=RunCache()).recompute_under(read).register
    assert_frame_equal(again.drop("edition"), shown.drop("edition"))


def test_a_comparison_finds_what_the_workbench_showed(workbench, built):
    lines = workbench.compare_drafts(asked(workbench, **SIDE)).register_lines
    path = workbench.save(saving())
    method = parse_method(path.read_text(encoding="utf-8"), str(path))
    drafts = (
        draft_edition(built.store, one) for one in (workbench.known.get("as-published"), method)
    )
    compared = compare(built.store, *drafts)
    changed = compared.filter(change="changed")
    assert changed.height == lines.filter(change="changed").height > 0
    key = ("fsn_no", "rowers", "crew_class")
    shown = {tuple(row[k] for k in key): row["cw_ratio"] for row in lines.to_dicts()}
    for row in changed.to_dicts():
        assert shown[tuple(row[k] for k in key)] == pytest.approx(row["cw_ratio"], rel=1e-9)


def test_a_saved_file_is_a_base_from_then_on_and_is_never_written_over(workbench):
    path = workbench.save(saving())
    before = path.read_bytes()
    assert side(workbench.make_method(workbench.read_address({"base": "own"}))) == {0.77}
    with pytest.raises(HerijkError, match="choose another name"):
        workbench.save(saving(changes={"wind.side": "1.0"}))
    assert path.read_bytes() == before
    assert [f.name for f in workbench.known.folder.iterdir()] == ["own.toml"]


@pytest.mark.parametrize("name", ["rebased", SCENARIO])
def test_names_that_mean_something_else_are_refused(workbench, name):
    with pytest.raises(HerijkError, match="another"):
        workbench.save(saving(name))


@pytest.mark.parametrize("name", ["../own", "a/b", "Own", "", ".own", "a\n", "x" * 61])
def test_a_name_cannot_lead_out_of_the_folder(name):
    with pytest.raises(ValueError, match="name"):
        saving(name)


def ask(url, path="", body=None, **headers):
    """Status and text of a request, as the workbench's own page makes it unless told otherwise."""
    own = {"Origin": url.rstrip("/"), "Content-Type": "application/json"}
    data = None if body is None else json.dumps(body).encode()
    request = urllib.request.Request(url + path, data, own | headers)  # noqa: S310 - loopback
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


def test_only_its_own_page_is_answered_and_may_save(url, workbench):
    body, query = saving().model_dump(mode="json"), f"?{urlencode(SIDE)}"
    for path in ("", "static/workbench.js"):
        assert ask(url, path, Host="evil.example")[0] == 400
    assert ask(url, "save/nl", body, Origin="http://evil.example")[0] == 403
    assert ask(url, query, **{"Sec-Fetch-Site": "cross-site"})[0] == 403
    assert ask(url, query, **{"Sec-Fetch-Site": "none"})[0] == 200
    assert ask(url, "save/nl")[0] == 405
    assert ask(url, "static/../bench.py")[0] == 404
    assert not workbench.known.folder.exists()
    saved, again = (json.loads(ask(url, "save/nl", body)[1]) for _ in range(2))
    assert saved["command"].startswith(f"herijk compare {PARENT}")
    assert "bestaat al" in again["refused"]
    assert "refused" in json.loads(ask(url, "save/nl", body | {"name": "../x"})[1])


@pytest.mark.parametrize(
    ("path", "words"),
    [("", "moet tussen 0,0 en 2,0 liggen, en is 9"), ("en/", "has to lie between 0.0 and 2.0")],
)
def test_a_refusal_is_in_the_language_of_the_page(url, path, words):
    status, page = ask(url, f"{path}?wind.side=9")
    assert status == 200
    assert words in page
    assert ("GESIMULEERD" in page) is (path == "")


def test_an_unknown_method_is_refused_on_a_page_of_the_usual_one(url):
    page = ask(url, "?base=best")[1]
    assert "best" in page
    assert 'value="rebased" selected' in page
