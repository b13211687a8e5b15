"""What the workbench and `herijk methods` call the options of a method and their values.

An option or value without a text here is shown by its name in the method file.
"""

from typing import Final

from dashboards import labels
from dashboards.speech import Speech
from pipeline.messages import Sentence, pgettext, say
from pipeline.method.definition import LAST_SEASON

_PLAIN: Final = {
    "step": (
        say("Speed"), say("Window"), say("Wind"), say("Run point"), say("Curve"), say("Assessment"),
    ),
    "status": (say("decided"), say("proposed"), say("inferred")),
    "choice": (
        say("prescribed"), say("estimated"), say("fixed"), say("mean of ratios"),
        say("ratio of means"), say("ratio of robust means"), say("free"), say("capped"),
    ),
}  # fmt: skip
"""Texts whose key is the same words: steps, where an option comes from, and values."""

TEXTS: Final[dict[str, Sentence]] = {
    **{
        f"{kind}.{text.lower().replace(' ', '_')}": text
        for kind, texts in _PLAIN.items()
        for text in texts
    },
    "workbench": say("Workbench"),
    "step.force": say("Tow force"),
    "step.calibration": say("Calibration on GPS"),
    "step.temperature": say("Water temperature"),
    "step.unrecorded": say("What nobody recorded"),
    "step.runs": say("Runs that count"),
    "speed.correction": say("Error of the log"),
    "speed.factor": say("Prescribed factor"),
    "force.ratio": say("Load cell reading / true force"),
    "calibration.rule": say("GPS factor"),
    "window.rule": say("Which part of a run"),
    "wind.model": say("Wind model"),
    "wind.coefficients": say("Drag coefficients"),
    "wind.ahead": say("Coefficient from ahead"),
    "wind.behind": say("Coefficient behind"),
    "wind.side": say("Coefficient from the side"),
    "wind.averaging_s": say("Wind averaged over"),
    "wind.anemometer": say("Anemometer"),
    "run_point.estimator": say("Mean of a run"),
    "run_point.inertia": say("Correct for acceleration"),
    "temperature.rule": say("Correct for water temperature"),
    "unrecorded.rule": say("Wind, temperature or GPS that is missing"),
    "runs.highest_target_ratio": say("Fastest run / declared speed"),
    "curve.b": say("B of the curve"),
    "assessment.reject": say("Rejects a tow"),
    "choice.none": pgettext("option", "none"),
    "choice.gps_per_tow": say("per tow"),
    "choice.all": pgettext("option", "all"),
    "choice.steady": say("the steady part"),
    "choice.head": say("head wind"),
    "choice.oblique": say("oblique wind"),
    "choice.per_run": say("searched per run"),
    "choice.archive": say("one from all tows"),
    "choice.as_is": say("left as it is"),
    "choice.expected": say("as in other tows"),
    "choice.as_read": say("as it reads"),
    "choice.end_speeds": say("from the end speeds"),
    "choice.ittc57": say("ITTC-57"),
}
"""Steps, options of a step, where an option comes from, and its values."""


def text(key: str) -> Sentence:
    """The text of a key; one without a text is called as it is."""
    return TEXTS.get(key) or say("{}", key.rpartition(".")[2])


def value_in_words(value: object, speech: Speech) -> str:
    """The value of an option as people read it."""
    if isinstance(value, (list, tuple)):
        codes = [speech.say(labels.code(code)) for code in value]
        return "; ".join(codes) or speech.say("nothing")
    if isinstance(value, (int, float)):
        return f"{value:.10g}".replace(".", speech.decimal)
    known = TEXTS.get(f"choice.{value}")
    return speech.say(labels.code(str(value)) if known is None else known)


def range_in_words(first: int, last: int) -> Sentence:
    """Seasons from one to another; those of the last range go on."""
    if last >= LAST_SEASON:
        return say("{} and later", first)
    return say("{}", str(first) if first == last else f"{first}\u2013{last}")
