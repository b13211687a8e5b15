"""Causes of a change: one file, one option, the code, another tow, each under its own name."""

import datetime as dt
import json
import math
import shutil

import polars as pl
import pytest

import pipeline.recompute.computed
import pipeline.studies.ladder
from pipeline.method.reading import parse_method, read_shipped_method
from pipeline.register.changes import compare_lines
from pipeline.register.replay import RaceRules
from pipeline.tables.keys import LINE
from tests.warehouse.edition_bench import diff, terms
from warehouse.derive.archive_tables import read_archive
from warehouse.editions.compare import report, report_with_races
from warehouse.editions.publish import publish_printed
from warehouse.store.decisions import FILE_NAME
from warehouse.store.editions import read_edition

pytestmark = pytest.mark.more

VARIANT = """
name = "variant"
title = "proef"
extends = "as-published"

[[overrides]]
range = "2014:"
runs = { highest_target_ratio = 1.05 }
"""


def causes(lines):
    """Per line the list of (cause, step, factor), those that changed nothing left out."""
    return [
        [
            (c["cause"], c.get("step"), c["factor"])
            for c in json.loads(text)
            if abs(c["factor"] - 1) > 1e-9
        ]
        for text in lines["causes"]
    ]


def names(lines):
    return {(cause, step) for line in causes(lines) for cause, step, _ in line}


def assert_factors_multiply(lines):
    for row in lines.drop_nulls("cw_ratio").iter_rows(named=True):
        product = math.prod(c["factor"] for c in json.loads(row["causes"]))
        assert product == pytest.approx(row["cw_ratio"], rel=1e-10)


AS_PUBLISHED = (read_shipped_method("as-published"),)


def new_code(monkeypatch):
    """Another version of the code, which finds other run points."""
    original = pipeline.recompute.computed.still_air_coefficient_kg_m
    monkeypatch.setattr(
        pipeline.recompute.computed,
        "still_air_coefficient_kg_m",
        lambda area, drag: 1.5 * original(area, drag),
    )
    for user in ("derive.registers", "editions.publish"):
        monkeypatch.setattr(f"warehouse.{user}.code_version", lambda: "0.2.0+other")


def test_between_methods_only_steps_are_causes_and_they_multiply(published):
    lines = diff(published.store, "2014-1", "2014-2")
    assert lines["cw_ratio"].null_count() == 0
    found = names(lines)
    assert {cause for cause, _ in found} <= {"method"}
    assert {"wind", "temperature", "run_point"} <= {step for _, step in found}
    assert_factors_multiply(lines)


def test_one_option_shows_under_its_own_step_alone(bench_of_editions):
    bench = bench_of_editions
    variant = parse_method(VARIANT, "variant.toml")
    bench.rebuild((read_shipped_method("as-published"), variant))
    bench.publish("a", "as-published")
    bench.publish("b", variant)
    lines = diff(bench.store, "a", "b")
    assert names(lines) == {("method", "runs")}
    assert_factors_multiply(lines)
    seasons = bench.store.read("tows").select(tow_id_of="tow_id", season="season")
    moved = lines.filter(pl.col("change") == "changed").join(
        seasons, left_on="new_tow_id", right_on="tow_id_of"
    )
    assert set(moved["season"]) == {2014}


def test_one_file_shows_as_input_on_its_own_line_alone(bench_of_editions):
    bench = bench_of_editions
    bench.publish("a")
    tow = line_with_season(bench, "a", 2009)
    bench.change_force(tow, lambda n: 1.02 * n)
    bench.rebuild(AS_PUBLISHED)
    bench.publish("b")
    lines = diff(bench.store, "a", "b")
    changed = lines.filter(pl.col("change") == "changed")
    assert changed["new_tow_id"].to_list() == [tow]
    ((cause,),) = causes(changed)
    assert cause[:2] == ("input", None)
    assert cause[2] == pytest.approx(1.02, abs=0.003)
    assert names(lines) == {("input", None)}


def line_with_season(bench, edition, season):
    register = read_edition(bench.store, edition).register
    return register.filter(pl.col("tow_date").dt.year() == season)["tow_id"][0]


def test_method_code_and_one_file_together_are_told_apart(bench_of_editions, monkeypatch):
    bench = bench_of_editions
    bench.publish("a", "as-published")
    tow = line_with_season(bench, "a", 2009)
    bench.change_force(tow, lambda n: 1.02 * n)
    new_code(monkeypatch)
    bench.rebuild((read_shipped_method("rebased"),))
    bench.publish("b", "rebased")
    lines = diff(bench.store, "a", "b")
    assert_factors_multiply(lines)
    own = lines.filter(pl.col("new_tow_id") == tow)
    assert {cause for cause, _ in names(own)} == {"method", "input_and_code"}
    others = lines.filter(pl.col("new_tow_id") != tow)
    assert {cause for cause, _ in names(others)} == {"method", "code_or_other_input"}


def test_another_tow_shows_as_tow_beside_the_steps(bench_of_editions):
    bench = bench_of_editions
    bench.publish("a", "as-published")
    twice, _ = towed_twice(bench)
    (bench.data / FILE_NAME).write_text(
        f'[[besluit]]\nsleep_id = "{twice["tow_id"]}"\noordeel = "uitsluiten"\n'
        'reden = "scheef getrokken"\nwie = "SKC"\ndatum = 2014-05-01\n',
        encoding="utf-8",
    )
    bench.publish("b", "rebased")
    lines = diff(bench.store, "a", "b")
    row = lines.filter(*(pl.col(name) == twice[name] for name in LINE))
    assert row["old_tow_id"].item() != row["new_tow_id"].item()
    assert {cause for cause, _ in names(row)} == {"tow", "method"}
    assert_factors_multiply(lines)


def test_the_summary_names_gainers_losers_and_the_largest(published):
    same = diff(published.store, "2014-1", "2014-1")
    assert (set(same["change"]), names(same)) == ({"same"}, set())
    both = [read_edition(published.store, name) for name in ("2014-1", "2014-2")]
    found = report(*both, diff(published.store, "2014-1", "2014-2"))
    moved = [r for r in found.rows if r["change"] == "changed"]
    assert found.gain["lines"] + found.loss["lines"] == len(moved)
    assert found.gain["lines"] == sum(r["power_ratio"] > 1 for r in moved)
    sizes = [abs(math.log(r["cw_ratio"])) for r in found.largest]
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[0] == max(abs(math.log(r["cw_ratio"])) for r in moved)
    row = found.largest[0]
    assert row["new_power_w"] == pytest.approx(row["old_power_w"] * row["power_ratio"])
    assert row["gain_in_two_hours_s"] == pytest.approx(7200 * (row["time_ratio"] - 1))
    assert found.exceeds_interval == len([r for r in moved if r["exceeds_interval"]])


def test_races_are_replayed_under_both(bench_of_editions):
    bench = bench_of_editions
    bench.publish("a", "as-published")
    bench.publish("b", "rebased")
    both = [read_edition(bench.store, name) for name in ("a", "b")]
    register = both[0].register.drop_nulls("cw_kg_m")
    rows = [
        f"Proefrace;2014-06-07;18,4;{r['fsn_no']};{r['rowers']};{r['crew_class']};2:1{i}:00;;"
        for i, r in enumerate(register.head(6).iter_rows(named=True))
    ]
    head = "wedstrijd;datum;afstand [km];fsn_nr;roeiers;klasse;roeitijd;stroom [km];straf [W]"
    folder = empty_races(bench)
    (folder / "proefrace_2014.csv").write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    read_archive(bench.store, bench.archive)
    replayed = report_with_races(bench.store, *both, RaceRules())
    assert len(replayed.races) == 6
    assert None not in [result["old_power_w"] for result in replayed.races]
    assert all(0 <= winner["change_probability"] <= 1 for winner in replayed.winners)


def empty_races(bench):
    folder = bench.archive / "wedstrijden"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    return folder


# Printed registers

HEAD = "fsn_nr;roeiers;klasse;A;B;Cw;roeisnelheid [m/s];sleepdatum"


def publish_printed_row(bench, line, day):
    """A register of 2014 with one line, towed on a day, published as edition `printed`."""
    cells = (line["fsn_no"], line["rowers"], line["crew_class"], 31.6, 4.44, 43.89, 2.35, day)
    file = bench.archive / "sloepregister" / "sloepregister_2014.csv"
    file.write_text(f"{HEAD}\n{';'.join(map(str, cells))}\n", encoding="utf-8")
    bench.rebuild(AS_PUBLISHED)
    publish_printed(bench.store, 2014, terms("printed", dt.date(2014, 5, 1)))


def towed_twice(bench):
    """The line of a boat and crew with more than one tow, under the edition `a`, and its tows."""
    tows = bench.store.read("tows").sort("tow_date")
    for row in read_edition(bench.store, "a").register.iter_rows(named=True):
        mine = tows.filter(*(pl.col(name) == row[name] for name in LINE))
        if mine.height > 1:
            return row, mine
    raise AssertionError


def test_a_printed_line_of_an_earlier_tow_is_told_apart_from_the_newer_tow(bench_of_editions):
    bench = bench_of_editions
    bench.publish("a")
    line, tows = towed_twice(bench)
    publish_printed_row(bench, line, tows["tow_date"][0])
    lines = diff(bench.store, "printed", "a").filter(change="changed")
    assert names(lines) == {("reproduction", None), ("tow", None)}
    assert_factors_multiply(lines)
    curves = read_edition(bench.store, "a").tables["curves"]
    before = curves.filter(tow_id=tows["tow_id"][0]).row(0, named=True)
    printed = 31.6 / (1 - (before["declared_speed_m_s"] / 4.44) ** 2)
    ((_, _, factor), _) = causes(lines)[0]
    assert factor == pytest.approx(before["cw_kg_m"] / printed, rel=1e-9)


def test_print_of_2014_is_held_against_the_method_of_that_year(bench_of_editions):
    """Early in 2015 the tows of 2014 were recomputed: those steps are causes, not the print."""
    bench = bench_of_editions
    bench.rebuild((read_shipped_method("as-published-2014"), *AS_PUBLISHED))
    curves = bench.store.read("curves", "as-published-2014").filter(season=2014)
    tow = bench.store.read("tows").filter(tow_id=curves.drop_nulls("b_m_s")["tow_id"][0])
    line, curve = tow.row(0, named=True), curves.filter(tow_id=tow["tow_id"]).row(0, named=True)
    cells = [line[n] for n in ("fsn_no", "rowers", "crew_class")]
    cells += [round(curve[n], 2) for n in ("a_kg_m", "b_m_s", "cw_kg_m")]
    cells += [line["declared_speed_m_s"], line["tow_date"]]
    file = bench.archive / "sloepregister" / "sloepregister_2014.csv"
    file.write_text(f"{HEAD}\n{';'.join(map(str, cells))}\n", encoding="utf-8")
    bench.rebuild(AS_PUBLISHED)
    publish_printed(bench.store, 2014, terms("printed", dt.date(2014, 5, 1)))
    bench.publish("a", "as-published")
    lines = diff(bench.store, "printed", "a").filter(change="changed")
    assert_factors_multiply(lines)
    (found,) = causes(lines)
    factors = {step or cause: factor for cause, step, factor in found}
    assert factors.pop("reproduction") == pytest.approx(1, abs=1e-3)
    assert {"window", "calibration", "wind"} <= factors.keys()


def test_curves_that_agree_at_one_speed_alone_are_not_the_same(published):
    register = read_edition(published.store, "2014-1").register.drop_nulls("b_m_s")
    steeper = pl.col("b_m_s") * 0.97
    ratio = (1 - (pl.col("declared_speed_m_s") / steeper) ** 2) / (
        1 - (pl.col("declared_speed_m_s") / pl.col("b_m_s")) ** 2
    )
    bent = register.with_columns(pl.col("a_kg_m") * ratio, b_m_s=steeper)
    lines = compare_lines(register, bent)
    assert lines["cw_ratio"].to_list() == pytest.approx([1.0] * lines.height)
    assert set(lines["change"]) == {"changed"}
    assert (lines["cw_ratio_fast"] > 1.0005).all()
