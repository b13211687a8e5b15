"""What `herijk audit` prints: a short answer, and all that is behind it."""

import json
import re
from html import unescape

import duckdb
import polars as pl
import pytest

from dashboards import words
from dashboards.document import Document
from dashboards.language import Language
from dashboards.queries.boats import NEGLIGIBLE_CHANGE
from dashboards.queries.types import choose_decimals
from dashboards.templates import get_template
from tests.conftest import METHODS


def squeeze(text):
    return " ".join(text.split())


@pytest.fixture
def audit(herijk, built):
    def run(*arguments):
        status, out, err = herijk("audit", *arguments, "--data", built.data)
        assert (status, err) == (0, "")
        if "--json" not in arguments:
            assert not re.search(r"\bNone\b|\bnan\b|\binf\b|few_boats|no_type", out)
        return squeeze(out) if "--steps" in arguments else out

    return run


EDITION = f"concept-{METHODS[1]}"


def test_the_answer_about_a_boat_is_short_and_has_the_number_of_the_register(audit, built):
    line = built.table("register").filter(edition=EDITION).drop_nulls("cw_kg_m")
    line = line.row(0, named=True)
    answer = audit(line["fsn_no"], "--edition", EDITION)
    assert answer.startswith("SIMULATED")
    assert f"{line['cw_kg_m']:.2f} kg/m" in squeeze(answer)
    assert len(audit(line["fsn_no"]).splitlines()) < 40


def test_steps_show_every_tow_curve_run_and_component(herijk, built):
    boat = built.table("tows")["fsn_no"][0]
    call = ("audit", boat, "--steps", "--data", built.data)
    out = squeeze(herijk(*call)[1])
    curves = built.table("curves").filter(fsn_no=boat).drop_nulls("cw_kg_m")
    language = Language("en")
    name_code = language.name_code

    def name_method(method):
        return re.escape(language.say(words.name_method(method)))

    for tow_id, method, cw in curves.select("tow_id", "method", "cw_kg_m").rows():
        assert re.search(rf"{tow_id} \S+ · \w+ {name_method(method)} [^:]*{cw:.2f}", out)
    mine = pl.col("tow_id").is_in(curves["tow_id"].to_list())
    for speed in built.table("run_points").filter(mine)["speed_m_s"]:
        assert f" {speed:.2f} " in out
    budget = built.table("uncertainty_budget").filter(mine, pl.col("u_ratio") >= NEGLIGIBLE_CHANGE)
    for component, u_ratio in budget.select("component", "u_ratio").rows():
        assert re.search(rf"{re.escape(name_code(component))} [\w ]+ {100 * u_ratio:.1f} %", out)
    one = squeeze(herijk(*call, "--method", "rebased-2015")[1])
    assert "as published 2" not in one.split("Through the years")[1]


def test_the_steps_of_a_tow_multiply_to_the_total_printed(audit, built):
    steps = built.table("correction_steps").filter(to_method="rebased-2015")
    tow = steps.sort((pl.col("factor") - 1).abs(), descending=True)["tow_id"][0]
    fsn_no = built.table("tows").filter(tow_id=tow)["fsn_no"].item()
    total = 100 * (steps.filter(tow_id=tow)["factor"].product() - 1)
    part = audit(fsn_no, "--steps").split("What each step does to its Cw")[1]
    said = f"{total:+.1f}".replace("-", "\N{MINUS SIGN}")
    assert re.search(rf"{tow} as published rules of 2015 {re.escape(said)} %", part)


def test_the_answer_about_types_has_every_line_with_its_interval_and_n(audit, built):
    types = sorted(built.table("boats")["boat_type"].drop_nulls().unique())
    rows = built.table("type_consistency").filter(
        pl.col("weight_slope").is_not_null(), method="rebased-2015"
    )
    assert rows.height > 0
    names = Document(Language("en")).get_names()
    say_slope = get_template("type_parts.html.j2").make_module(names).slope
    pages = {t: squeeze(audit(t, "--method", "rebased-2015")) for t in types}
    for row in rows.iter_rows(named=True):
        row["weight_decimals"] = choose_decimals(row, "weight")
        said = squeeze(unescape(str(say_slope(row, "weight"))))
        assert re.search(rf" {row['n']} .*{re.escape(said)}", pages[row["boat_type"]])
    assert "Are they equal?" in audit(types[0], "--steps")


def test_a_type_is_judged_by_the_newest_tow_of_each_boat_and_crew(audit, built):
    (of_type,) = json.loads(audit("Kuikensloep", "--json"))["types"]
    assert len({row["method"] for row in of_type["rows"]}) == len(METHODS)
    for row in of_type["rows"]:
        own = {"method": row["method"], "boat_type": "Kuikensloep"}
        tows = built.table("compared_tows").filter("newest", **own)
        if row["quantity"] == "b_m_s":
            assert row["n"] == tows.height
    newest = set(built.table("compared_tows").filter("newest")["tow_id"])
    assert {row["tow_id"] for row in of_type["stand_out"]} <= newest


def test_boats_that_stand_out_are_those_of_the_verdict_with_what_may_explain_it(herijk, bench):
    with duckdb.connect(bench.store.database) as db:
        db.execute("UPDATE type_consistency SET outside = []")
        db.execute("UPDATE compared_tows SET cw_outside = false, b_outside = false")
    call = ("audit", "Kuikensloep", "--data", bench.data)
    assert "These stand out" not in herijk(*call)[1]
    with duckdb.connect(bench.store.database) as db:
        fsn_no = db.execute(
            "SELECT min(fsn_no) FROM compared_tows WHERE boat_type = 'Kuikensloep' AND newest"
        ).fetchall()[0][0]
        db.execute("UPDATE type_consistency SET outside = [?], verdict = 'differ'", [fsn_no])
        db.execute(
            "UPDATE compared_tows SET cw_outside = true, candidates = ['askew'] WHERE fsn_no = ?",
            [fsn_no],
        )
    said = herijk(*call)[1]
    assert re.search(rf"These stand out: .*{fsn_no} \(perhaps pulled askew\)", said)


def test_two_types_stand_side_by_side(audit, built):
    assert audit("Kuiken sloep", "barkas").count("\nKuikensloep\n") == 1
    report = json.loads(audit("Kuiken sloep", "barkas", "--json"))
    assert [one["boat_type"] for one in report["types"]] == ["Kuikensloep", "Barkas"]
    boat = built.table("tows")["fsn_no"][0]
    assert json.loads(audit(boat, "--json"))["boat"]["fsn_no"] == boat


def test_one_tow_alone_is_shown(herijk, built):
    fsn_no = built.table("tows")["fsn_no"].mode().min()
    tows = built.table("tows").filter(fsn_no=fsn_no)["tow_id"].sort().to_list()
    call = ("audit", fsn_no, "--steps", "--data", built.data)
    assert len(tows) > 1
    assert {row["tow_id"] for row in json.loads(herijk(*call, "--json")[1])["runs"]} == {*tows}
    one = json.loads(herijk(*call, "--tow", tows[0], "--json")[1])
    for table in ("tows", "curves", "runs", "budget"):
        assert {row["tow_id"] for row in one[table]} == {tows[0]}, table


def test_json_has_the_statements_of_the_terminal_and_the_number_of_the_table(herijk, built):
    edition = f"concept-{METHODS[1]}"
    line = built.table("register").filter(edition=edition).drop_nulls("cw_kg_m")
    line = line.row(0, named=True)
    call = ("audit", line["fsn_no"], "--edition", edition, "--data", built.data)
    printed = squeeze(herijk(*call)[1])
    result = json.loads(herijk(*call, "--json")[1])
    about = f"{line['fsn_no']} {line['rowers']}{line['crew_class']}"
    own = [one for one in result["statements"] if one["about"] == about]
    assert {"interval", "objection"} <= {one["kind"] for one in own}
    assert [one["text"] for one in own if squeeze(one["text"]) not in printed] == []
    numbers = [one["cw_kg_m"] for one in result["answers"] if one["tow_id"] == line["tow_id"]]
    assert numbers == [line["cw_kg_m"]]


def test_with_an_edition_it_goes_from_line_to_files_runs_and_seconds(herijk, published):
    tow = published.tow(2014)
    call = ("audit", tow["fsn_no"], "--edition", "2014-2", "--data", published.data)
    status, out, err = herijk(*call)
    assert (status, err) == (0, "")
    for part in ("Verification code", tow["samples_path"], tow["samples_sha256"], "Why not"):
        assert part in out
    assert json.loads(herijk(*call, "--json")[1])["about"]["edition"] == "2014-2"
