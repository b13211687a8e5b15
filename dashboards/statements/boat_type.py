"""Whether the boats of a type are equal."""

from typing import Final

import polars as pl

from dashboards.statements import Number, Statement
from pipeline.messages import say

CLEAR_P: Final = 0.05
STRONG_POWER: Final = 0.8


def homogeneity(test: pl.DataFrame) -> Statement:
    """Whether the boats of a type have equal curves: yes, no, or not to be told."""
    if test.is_empty() or test["p_value"][0] is None:
        return Statement("bends", say("Too few boats to tell whether they are equal."))
    p_value, power = test["p_value"][0], test["power_at_10pct"][0] or 0.0
    wording, verdict = (
        say(
            "Whether the bends of the curves of these {n} tows differ cannot be told: the "
            "test is too weak."
        ),
        "cannot be told",
    )
    if p_value < CLEAR_P:
        wording, verdict = (
            say(
                "The bends of the curves of these {n} tows differ by more than noise explains "
                "(p = {p})."
            ),
            "differ",
        )
    elif power >= STRONG_POWER:
        wording, verdict = (
            say("No sign that the bends of the curves of these {n} tows differ (p = {p})."),
            "equal",
        )
    values = {"n": test["n"][0], "p": Number(p_value, unit="")}
    return Statement("bends", wording, values, verdict, ("homogeneity",))
