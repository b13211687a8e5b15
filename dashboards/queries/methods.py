"""A method explained: what each step does here, a boat worked through, and what is voted on."""

from collections.abc import Sequence
from typing import Any

import polars as pl

from dashboards.guides import find_method_guide
from dashboards.queries.boats import NEGLIGIBLE_CHANGE
from dashboards.queries.results import Data, Results
from pipeline.messages import LANGUAGES
from pipeline.method.definition import COMPLETE, Method
from pipeline.method.options import START, STEP_ORDER, Steps, find_basis
from pipeline.method.variant import Difference, list_differences
from pipeline.register.register import STUDIED_METHOD
from pipeline.tables.row import Row
from warehouse.queries.views import prepare_curve_figure
from warehouse.store.methods import KnownMethods


def read_method(results: Results, name: str) -> Data:
    """Return a method of the last rebuild, explained against the first method of this archive.

    Raises:
        MissingKnowledgeError: there is no such method.
    """
    known = KnownMethods.from_store(results.views.store)
    first = known.get(results.views.table("methods")["method"][0])
    shown = known.get(name)
    ladder = results.views.table("correction_steps").filter(from_method=first.name, to_method=name)
    changed = list_differences(shown, first)
    return {
        "method_name": name,
        "others": {
            other: get_method_page(results, other) for other in results.methods if other != name
        },
        "steps": _explain_steps(shown, changed, ladder),
        "voted": group_by_status(changed),
        "validity": shown.validity,
        "certain": _measure_certainty(results, shown),
        "worked": _work_through(results, name, ladder),
        "guide": {tag: find_method_guide(tag) for tag in LANGUAGES},
        "is_studied": name == STUDIED_METHOD,
    }


def get_method_page(results: Results, name: str) -> str:
    """Return the page of a method; that of the one shown first is the page of the method."""
    return "method.html" if name == results.method else f"method-{name}.html"


def _explain_steps(
    method: Method, changed: Sequence[Difference], ladder: pl.DataFrame
) -> list[Row]:
    """Return every step in the order of exchange: its options, and what it does here.

    `kept` is the first option with its value in the last seasons, for a step that is unchanged.

    Args:
        method: what is explained.
        changed: options that the first method has otherwise.
        ladder: rows of `correction_steps` from the first method.
    """
    size = pl.col("factor").log().abs()
    moved = pl.col("factor").filter((pl.col("factor") - 1).abs() >= NEGLIGIBLE_CHANGE)
    by_step = (
        ladder.filter(pl.col("step") != START).sort("tow_id").group_by("step", maintain_order=True)
    )
    effects = by_step.agg(
        tows=pl.len(),
        moved=moved.len(),
        median=moved.median(),
        largest=pl.col("factor").sort_by(size).last(),
        tow=pl.col("tow_id").sort_by(size).last(),
    )
    effect_by_step = effects.rows_by_key("step", named=True, unique=True, include_key=True)
    last_steps = method.ranges[-1].steps
    explained = []
    for step in dict.fromkeys((*STEP_ORDER, *Steps.model_fields)):
        first_option = None
        if step in Steps.model_fields:
            options: Any = getattr(last_steps, step)
            option = next(iter(type(options).model_fields))
            value = getattr(options, option)
            basis = find_basis(step, option, value)
            first_option = {"option": option, "after": value, "basis": basis}
        explained.append(
            {
                "step": step,
                "effect": effect_by_step.get(step),
                "changed": [describe_option(one) for one in changed if one.step == step],
                "kept": first_option,
            }
        )
    return explained


def describe_option(one: Difference) -> Row:
    """Return an option that differs as a row, with who decided or proposed it."""
    return vars(one) | {"basis": find_basis(one.step, one.option, one.after)}


def group_by_status(changed: Sequence[Difference]) -> dict[str, dict[str, list[Row]]]:
    """Return changed options by who decided them, and within that by step."""
    found: dict[str, dict[str, list[Row]]] = {"decided": {}, "proposed": {}, "inferred": {}}
    for one in map(describe_option, changed):
        found[one["basis"].status].setdefault(one["step"], []).append(one)
    return {status: steps for status, steps in found.items() if steps}


def _measure_certainty(results: Results, method: Method) -> Row | None:
    """Return how wide an interval of Cw is here, and what it consists of; None without a curve."""
    curves = results.views.table("curves").filter(method=method.name).drop_nulls("cw_lo_kg_m")
    if curves.is_empty():
        return None
    half_width = (pl.col("cw_hi_kg_m") - pl.col("cw_lo_kg_m")) / 2 / pl.col("cw_kg_m")
    parts = results.views.table("uncertainty_budget").filter(method=method.name)
    largest = parts.group_by("component", maintain_order=True).agg(pl.col("u_ratio").median())
    return {
        "half_width": curves.select(half_width.median()).item(),
        "tows": curves.height,
        "is_complete": method.interval == COMPLETE,
        "components": largest.sort("u_ratio", "component")["component"].reverse().to_list(),
    }


def _work_through(results: Results, method: str, ladder: pl.DataFrame) -> Data | None:
    """Return a tow from a run to its number; None where no tow changes."""
    tow_id = _choose_typical_tow(ladder)
    if tow_id is None:
        return None
    views, key = results.views, {"method": method, "tow_id": tow_id}
    curves = views.ask("curves").filter(**key)
    run = views.table("run_points").filter("used", **key).sort("run").row(0, named=True)
    figure = prepare_curve_figure(views.table("curve_points"), views.table("run_points"), curves)
    steps = ladder.filter(tow_id=tow_id).sort("position")
    return {
        "curve": curves.row(0, named=True),
        "run": run,
        "force_n": run["gross_cw_kg_m"] * run["speed_m_s"] ** 2,
        "old_cw_kg_m": steps["cw_kg_m"][0],
        "causes": [
            {"cause": "method", "step": step, "factor": factor}
            for step, factor in steps.select("step", "factor").rows()
            if abs(factor - 1) >= NEGLIGIBLE_CHANGE
        ],
        "drawn": pl.concat(figure.values(), how="diagonal_relaxed"),
    }


def _choose_typical_tow(ladder: pl.DataFrame) -> str | None:
    """Return the tow that most steps change, of several the one nearest to their median change."""
    is_moved = (pl.col("factor") - 1).abs() >= NEGLIGIBLE_CHANGE
    tows = ladder.group_by("tow_id", maintain_order=True).agg(
        steps=is_moved.sum(), change=pl.col("factor").log().sum()
    )
    most = tows.filter(pl.col("steps") == pl.col("steps").max())
    distance = (pl.col("change") - pl.col("change").median()).abs().round(9)
    nearest = most.sort(distance, "tow_id")
    return str(nearest["tow_id"][0]) if nearest.height else None


def describe_method(store_methods: KnownMethods, name_or_file: str, language: str) -> Data:
    """Return a method, and the options that differ from the one it extends.

    Args:
        store_methods: the methods of a data folder.
        name_or_file: a name or a TOML file.
        language: of its title and description.

    Returns:
        All options where it extends none.

    Raises:
        HerijkError: there is no such method or file, or it has an error.
    """
    shown = store_methods.find(name_or_file)
    if shown.extends:
        options = list_differences(shown, store_methods.get(shown.extends))
    else:
        options = [
            Difference(step, option, block.first, block.last, (), value)
            for block in shown.ranges
            for step, step_options in block.steps
            for option, value in step_options
        ]
    return {
        "method": shown.name,
        "title": shown.get_title(language),
        "description": shown.get_description(language).strip(),
        "content_hash": shown.content_hash,
        "extends": shown.extends,
        "options": options,
    }
