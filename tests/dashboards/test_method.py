"""A method explained: effects from the tables, one boat worked through, and what is voted on."""

import re

import polars as pl
import pytest

from dashboards.option_labels import text
from dashboards.speech import Speech
from dashboards.statements.edition import NEGLIGIBLE
from dashboards.statements.method import explained, voted_steps
from pipeline.method.options import Steps, find_basis
from pipeline.method.reading import read_shipped_method
from pipeline.method.variant import differences
from tests.conftest import METHODS
from warehouse.queries.views import Views

ENGLISH = Speech("en")
FIRST, METHOD = METHODS


@pytest.fixture(scope="module")
def views(built):
    with Views(built.store) as views:
        yield views


@pytest.fixture(scope="module")
def told(views):
    return explained(views, METHOD)


def the_step(told, name):
    (step,) = (step for step in told.steps if step.name == text(f"step.{name}"))
    return step


def test_an_effect_is_the_median_of_the_tows_that_a_step_changes(built, told):
    ladder = built.table("correction_steps").filter(to_method=METHOD, step="window")
    moved = ladder.filter((pl.col("factor") - 1).abs() >= NEGLIGIBLE)
    effect = the_step(told, "window").statements[0]
    assert (effect.values["moved"], effect.values["tows"]) == (moved.height, ladder.height)
    assert effect.values["median"].ratio == moved["factor"].median()
    largest = ladder.filter(tow_id=effect.values["tow"])["factor"][0]
    assert abs(pl.Series([largest]).log()[0]) == ladder["factor"].log().abs().max()


def test_every_step_is_explained_and_every_change_is_voted_on(told):
    assert {step.name for step in told.steps} == {
        text(f"step.{name}") for name in Steps.model_fields
    }
    changed = differences(read_shipped_method(METHOD), read_shipped_method(FIRST))
    voted = [s.values["options"] for s in told.vote if "options" in s.values]
    options = [option for steps in voted for step in steps for option in step.values["options"]]
    assert sorted(option.values["option"] for option in options) == sorted(
        text(f"{one.step}.{one.option}") for one in changed
    )


def test_a_boat_worked_through_adds_up_as_printed(told):
    said = {one.kind: one(ENGLISH).replace("\N{MINUS SIGN}", "-") for one in told.worked.statements}
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


def test_steps_by_status_fit_on_a_slide(views):
    said = {one.kind: one(ENGLISH) for one in voted_steps(views, METHOD)}
    assert "Window" in said["decided"]
    assert "Wind" in said["proposed"]
    assert explained(views, FIRST).worked is None
