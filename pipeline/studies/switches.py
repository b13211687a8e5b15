"""The switches of the vote, and the names of their combinations."""

from collections.abc import Collection, Sequence
from typing import Final

from pipeline.method.options import STEP_GROUPS

NOTHING_ON: Final = "none"
"""Name of the combination that is the first method."""


def list_combinations(switches: Sequence[str]) -> list[list[str]]:
    """Return what is on in every combination; switch i is where the place has bit i set."""
    combinations: list[list[str]] = [[]]
    for switch in switches:
        combinations += [on + [switch] for on in combinations]
    return combinations


def name_combination(on: Sequence[str]) -> str:
    """Return the name of a combination: what is on, joined by `+`, or `NOTHING_ON`."""
    return "+".join(on) or NOTHING_ON


def find_switches(combinations: Collection[str]) -> list[str]:
    """Return the switches that the names of combinations are made of, in the order of the steps."""
    return [group for group in STEP_GROUPS if group in combinations]
