"""The options of every step of a method, each with its limits and where it comes from.

A class per step, in the order of docs/method.md; `Steps` has them all. What a step computes with
its options is in the module of that name in `pipeline.steps`. Sources: P2015 is the presentation of
R. Pot, 24 January 2015; S2017 is his "Sleepproef" of 2017.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Annotated, Any, Final, Literal, NamedTuple

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, JsonValue, WithJsonSchema

from pipeline.assessment.checks import CODES
from pipeline.messages import Sentence, say


class Declared(BaseModel):
    """Settings as a method file writes them: frozen, and a key that is not declared is an error."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


Status = Literal["decided", "proposed", "inferred"]
"""In a text of the federation; put forward by somebody; our reading where the texts are silent."""


class Basis(NamedTuple):
    """Where an option comes from."""

    status: Status
    source: Sentence


def _option(
    status: Status,
    source: Sentence,
    default: object = ...,
    ge: float | None = None,
    le: float | None = None,
    but: Mapping[str, Basis] = MappingProxyType({}),
    added: bool = False,
) -> Any:
    """Declare an option of a step.

    Args:
        status, source: where the option comes from; `find_basis` returns it.
        default: its value where a method names none; without one every method has to.
        ge, le: lowest and highest value allowed.
        but: basis of the values that come from elsewhere than the option.
        added: whether editions had been published before there was this option. At its default it
            is then left out of a method's definition, so that methods keep their hash.
    """
    basis: dict[str, JsonValue] = {
        "status": status,
        "source": source,
        "but": {value: [other.status, other.source] for value, other in but.items()},
    }
    is_left_out = (lambda value: bool(value == default)) if added else None
    return Field(default=default, ge=ge, le=le, json_schema_extra=basis, exclude_if=is_left_out)


class Speed(Declared):
    """What is known to be wrong with the speed through the water, which is that of log 1."""

    correction: Literal["none", "prescribed", "estimated"] = _option(
        "proposed",
        say('P2015, "Meten van de sleepsnelheid"'),
        but={"estimated": Basis("proposed", say("this project; method-details, section 4"))},
    )
    factor: float = _option(
        "proposed",
        say("P2015: up to 6 %; to multiply, not to divide by 0.94, is inferred"),
        1.0,
        0.85,
        1.2,
    )

    @property
    def prescribed(self) -> float:
        """True speed / log speed where nothing else is known."""
        return 1.0 if self.correction == "none" else self.factor


class Force(Declared):
    """What is known to be wrong with the tow force of a season."""

    ratio: float = _option(
        "proposed",
        say("this project: a fault that was found, applied knowingly; method-details, section 4"),
        1.0,
        0.8,
        1.25,
        added=True,
    )
    """Load cell reading / true force."""


class Calibration(Declared):
    """The factor that brings the log to ground speed."""

    rule: Literal["none", "gps_per_tow"] = _option("decided", say('S2017, "IJking snelheid"'))


class Window(Declared):
    """Which part of a run counts; a window that a person gave goes before the steady part."""

    rule: Literal["all", "steady"] = _option("decided", say('S2017, "Knippen"'))


class Wind(Declared):
    """How the resistance in air is taken off."""

    model: Literal["head", "oblique"] = _option("proposed", say('P2015, "Dwarse tegenwind"'))
    coefficients: Literal["fixed", "per_run"] = _option(
        "proposed", say('P2015, "Windweerstand"'), "fixed"
    )
    ahead: float = _option("proposed", say('P2015, "Windweerstand"'), 0.5, 0.0, 2.0)
    behind: float = _option("proposed", say('P2015, "Windweerstand"'), 0.5, 0.0, 2.0)
    side: float = _option("proposed", say('P2015, "Dwarse tegenwind"'), 0.2, 0.0, 2.0)
    averaging_s: int = _option(
        "proposed", say("this project: the vane swings; method-details, section 5"), 0, 0, 15
    )
    anemometer: Literal["as_read", "estimated"] = _option(
        "proposed", say("this project: runs out and back; method-details, section 5"), "as_read"
    )


class RunPoint(Declared):
    """How the samples of a window become one point."""

    estimator: Literal["mean_of_ratios", "ratio_of_means", "ratio_of_robust_means"] = _option(
        "decided",
        say("S2017"),
        but={
            "ratio_of_means": Basis(
                "proposed", say("this project: a noisy log; method-details, section 3")
            ),
            "ratio_of_robust_means": Basis(
                "proposed", say("this project: a noisy log, steering; method-details, section 3")
            ),
        },
    )
    inertia: Literal["none", "end_speeds"] = _option(
        "proposed", say("this project; method-details, section 6"), "none"
    )


class Temperature(Declared):
    """Whether resistance is brought to one water temperature."""

    rule: Literal["none", "ittc57"] = _option(
        "decided", say("correction of 9 May 2018; the formula is inferred")
    )


class Unrecorded(Declared):
    """What is taken for a wind, a water temperature or a GPS that nobody recorded.

    As it is: still air, no change to the reference temperature, no curve where GPS is asked for.
    Expected: the wind and water of other tows, and the log's factor by other tows.
    """

    rule: Literal["as_is", "expected"] = _option(
        "inferred", say("this project; method-details, sections 4 to 6"), "as_is", added=True
    )


class Runs(Declared):
    """Which runs count."""

    highest_target_ratio: float = _option(
        "proposed", say('P2015: "Geen v = +20% runs meer uitvoeren"'), 1.15, 1.0, 1.5
    )


class Curve(Declared):
    """How the hyperbola is fitted: with B free, or at most `constants.CAP_HULL_SPEEDS`."""

    b: Literal["free", "capped"] = _option(
        "proposed", say('P2015: "B-waarden maximeren aan 3x rompsnelheid"')
    )


def _refuse_unknown_check(code: str) -> str:
    if code not in CODES:
        raise ValueError(say("must be one of {}", ", ".join(CODES)))
    return code


class Assessment(Declared):
    """Which checks of the assessment reject a tow, by their code (`pipeline.assessment.checks`)."""

    reject: tuple[
        Annotated[
            str,
            AfterValidator(_refuse_unknown_check),
            WithJsonSchema({"type": "string", "enum": sorted(CODES)}),
        ],
        ...,
    ] = _option("decided", say("S2017; which checks is the method's choice"), ())


STEP_ORDER: Final = (
    "speed",
    "force",
    "window",
    "runs",
    "calibration",
    "run_point",
    "wind",
    "temperature",
    "unrecorded",
    "curve",
)
"""The order in which steps are exchanged: that of the computation, and of the history."""

STEP_GROUPS: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {
        "instruments": ("speed", "force", "calibration"),
        "selection": ("window", "runs"),
        "surroundings": ("wind", "temperature", "unrecorded"),
        "fit": ("run_point", "curve"),
    }
)
"""What a meeting may put to the vote by itself: each step of `STEP_ORDER` is in one group."""

START: Final = "start"
"""What a ladder has as step where it begins."""


class Steps(Declared):
    """The option of every step, for one season."""

    speed: Speed
    force: Force
    calibration: Calibration
    window: Window
    wind: Wind
    run_point: RunPoint
    temperature: Temperature
    unrecorded: Unrecorded
    runs: Runs
    curve: Curve
    assessment: Assessment

    @property
    def expects_unrecorded(self) -> bool:
        """Whether other tows say what nobody recorded."""
        return self.unrecorded.rule == "expected"

    @property
    def estimates_without_gps(self) -> bool:
        """Whether a tow that lacks the GPS to calibrate it gets its log's estimated factor."""
        return self.expects_unrecorded and self.calibration.rule == "gps_per_tow"

    @property
    def estimates_logs(self) -> bool:
        """Whether the factor of any tow's log is estimated from other tows."""
        return self.speed.correction == "estimated" or self.estimates_without_gps


def find_basis(step: str, option: str, value: object) -> Basis:
    """Return where an option comes from, given the value it is set to."""
    options: Any = Steps.model_fields[step].annotation
    declared = options.model_fields[option].json_schema_extra
    status, source = declared["but"].get(value, (declared["status"], declared["source"]))
    return Basis(status, source)
