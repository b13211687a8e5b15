"""The order of rows is stated wherever Polars leaves it open.

Polars numbers groups by a hash that differs between processes, and a join without an order follows
whichever side is larger. Sums over such rows differ in their last digits, and pages in their bytes.
"""

import ast

from tests.architecture.repository import ROOT, modules

NO_ORDER_OF_THEIR_OWN = ("semi", "anti", "cross")
"""Joins that keep the order of the left side, or of both."""


def _without_order(source):
    """Lines of joins and groups of frames whose order of rows is left open."""
    calls = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Call)]
    return [call.lineno for call in calls if _is_open(call)]


def _is_open(call):
    options = {keyword.arg: keyword.value for keyword in call.keywords}
    name = getattr(call.func, "attr", None)
    if "maintain_order" in options or name not in ("join", "group_by"):
        return False
    if name == "group_by":
        return True
    how = options.get("how", ast.Constant("inner"))
    of_frames = bool(options.keys() & {"on", "left_on", "right_on"})
    return of_frames and ast.literal_eval(how) not in NO_ORDER_OF_THEIR_OWN


def test_a_join_or_group_without_order_is_told():
    source = """
a.join(b, on='k')
a.join(b, on='k', how='left', maintain_order='left')
a.join(b, on='k', how='anti')
'-'.join(words)
a.group_by('k')
a.group_by('k', maintain_order=True)
"""
    assert _without_order(source) == [2, 6]


def test_every_join_and_group_states_its_order():
    left_open = [
        f"{file.relative_to(ROOT)}:{line}"
        for file in modules()
        for line in _without_order(file.read_text("utf-8"))
    ]
    assert left_open == []
