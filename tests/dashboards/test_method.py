"""A method explained: effects from the tables, one boat worked through, and what is voted on."""

import re

import polars as pl
import pytest

from dashboards.document import Document
from dashboards.language import Language
from dashboards.queries.boats import NEGLIGIBLE_CHANGE
from dashboards.queries.methods import read_method
from dashboards.queries.results import Results
from dashboards.reading import read_blocks
from dashboards.templates import get_template
from pipeline.method.options import Steps, find_basis
from pipeline.method.reading import read_shipped_method
from pipeline.method.variant import list_differences
from tests.conftest import METHODS
from warehouse.queries.views import Views

FIRST, METHOD = METHODS


@pytest.fixture(scope="module")
def explained(built):
    with Views(built.store) as views:
        return {name: read_method(Results(views), name) for name in METHODS}


def test_an_effect_is_the_median_of_the_tows_that_a_step_changes(built, explained):
    ladder = built.table("correction_steps").filter(to_method=METHOD, step="window")
    moved = ladder.filter((pl.col("factor") - 1).abs() >= NEGLIGIBLE_CHANGE)
    (effect,) = [one["effect"] for one in explained[METHOD]["steps"] if one["step"] == "window"]
    assert (effect["moved"], effect["tows"]) == (moved.height, ladder.height)
    assert effect["median"] == moved["factor"].median()
    largest = ladder.filter(tow_id=effect["tow"])["factor"][0]
    assert abs(pl.Series([largest]).log()[0]) == ladder["factor"].log().abs().max()


def test_every_step_is_explained_and_every_change_is_voted_on(explained):
    data = explained[METHOD]
    assert {one["step"] for one in data["steps"]} == set(Steps.model_fields)
    changed = list_differences(read_shipped_method(METHOD), read_shipped_method(FIRST))
    voted = [
        (one["step"], one["option"], one["first"])
        for steps in data["voted"].values()
        for options in steps.values()
        for one in options
    ]
    assert sorted(voted) == sorted((one.step, one.option, one.first) for one in changed)


def test_a_boat_worked_through_adds_up_as_printed(explained):
    names = Document(Language("en")).get_names()
    html = (
        get_template("method_parts.html.j2").make_module(names).worked(explained[METHOD]["worked"])
    )
    said = {b.said: b.text.replace("\N{MINUS SIGN}", "-") for b in read_blocks(str(html))}
    numbers = {
        kind: [*map(float, re.findall(r"[-+]?\d+(?:\.\d+)?", s))] for kind, s in said.items()
    }
    _, _, _, force, speed, _, gross = numbers["worked_run"]
    assert force / speed**2 == pytest.approx(gross, rel=0.01)
    *parts, cw = numbers["worked_corrections"]
    parts = [part for part in parts if part != 15]  # water of 15 degrees
    assert gross + sum(parts) == pytest.approx(cw, abs=0.005 * (len(parts) + 2))
    a, b, declared, *_, cw = numbers["worked_curve"]
    assert a / (1 - (declared / b) ** 2) == pytest.approx(cw, rel=0.01)
    old, *per_cents = numbers["worked_change"]
    product = old
    for by in per_cents:
        product *= 1 + by / 100
    assert product == pytest.approx(cw, rel=0.0005 * (len(per_cents) + 2))


@pytest.mark.parametrize(
    ("value", "status"), [("mean_of_ratios", "decided"), ("ratio_of_means", "proposed")]
)
def test_a_value_has_the_status_of_who_asked_for_it(value, status):
    assert find_basis("run_point", "estimator", value).status == status


def test_the_first_method_has_nothing_to_work_through(explained):
    assert explained[FIRST]["worked"] is None
