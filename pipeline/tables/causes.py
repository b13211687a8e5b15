"""What made a line change, in words: the same in the notice, on pages and in the terminal."""

from typing import Final

from pipeline.messages import Sentence, say

CAUSES: Final[dict[str, Sentence]] = {
    "tow": say("another tow counts"),
    "input": say("data of the tow changed"),
    "other_input": say("data of other tows changed"),
    "code": say("the code changed"),
    "input_and_code": say("data and code changed, not to be separated"),
    "code_or_other_input": say("the code or data of other tows changed"),
    "method": say("method"),
    "reproduction": say("from print to the same tow, by the method then in force"),
    "printed": say("printed register: its method is not recorded"),
    "printed_and_tow": say("printed register with another tow: its method is not recorded"),
    "closed_form": say("printed A and B re-based with the log factor"),
    "unseparated": say("method with data or code, not to be separated"),
    "unexplained": say("unexplained"),
}
"""Causes of a change, by their code in `register_changes`."""

STEPS: Final[dict[str, Sentence]] = {
    "speed": say("speed correction"),
    "force": say("load cell"),
    "window": say("window"),
    "runs": say("runs that count"),
    "calibration": say("calibration"),
    "run_point": say("averaging of each run"),
    "wind": say("wind"),
    "temperature": say("water temperature"),
    "unrecorded": say("what nobody recorded"),
    "curve": say("curve"),
}
"""Steps of a method, where the method is the cause; by their code."""


def name_cause(cause: str, step: str | None) -> Sentence:
    """Return the source of a change: a step of the method by its name, or another cause."""
    if step is not None and step in STEPS:
        return STEPS[step]
    return CAUSES[cause]
