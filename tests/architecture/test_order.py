"""The order of rows is stated wherever Polars leaves it open.

Polars numbers groups by a hash that differs between processes, and a join without an order follows
whichever side is larger. Sums over such rows differ in their last digits, and pages in their bytes.
"""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

import herijk

ROOT = Path(herijk.__file__).parent
NO_ORDER_OF_THEIR_OWN = ("semi", "anti", "cross")
"""Joins that keep the order of the left side, or of both."""


def _calls(source: str) -> Iterator[tuple[ast.Call, str, dict[str, ast.expr]]]:
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            yield node, node.func.attr, {k.arg: k.value for k in node.keywords if k.arg}


def _without_order(source: str) -> list[int]:
    """Lines of joins and groups of frames whose order of rows is left open."""
    return [
        call.lineno
        for call, name, named in _calls(source)
        if "maintain_order" not in named
        and (
            name == "group_by"
            or (
                name == "join"
                and named.keys() & {"on", "left_on", "right_on"}
                and ast.literal_eval(named.get("how", ast.Constant("inner")))
                not in NO_ORDER_OF_THEIR_OWN
            )
        )
    ]


@pytest.mark.parametrize(
    ("source", "open_lines"),
    [
        ("a.join(b, on='k')", [1]),
        ("a.join(b, on='k', how='left')", [1]),
        ("a.join(b, on='k', maintain_order='left')", []),
        ("a.join(b, on='k', how='anti')", []),
        ("'-'.join(words)", []),
        ("a.group_by('k')", [1]),
        ("a.group_by('k', maintain_order=True)", []),
    ],
)
def test_a_join_or_group_without_order_is_told(source: str, open_lines: list[int]) -> None:
    assert _without_order(source) == open_lines


def test_every_join_and_group_states_its_order() -> None:
    left_open = [
        f"{file.relative_to(ROOT)}:{line}"
        for file in sorted(ROOT.rglob("*.py"))
        for line in _without_order(file.read_text("utf-8"))
    ]
    assert left_open == []
