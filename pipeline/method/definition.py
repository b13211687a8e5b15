"""A method is data: the named option of every step, with season ranges that override.

A method file is TOML that a committee member can read (`pipeline/methods/`).
`[steps.<step>]` gives options for every season; each `[[overrides]]` block replaces some of them
for a range; a method may `extend` another. Here such a text becomes a frozen, validated `Method`;
nothing is computed with a method that has an error. What a step does with its options is in the
step's own module.
"""

import hashlib
import itertools
import json
import re
from collections.abc import Callable, Iterable, Mapping
from functools import cache, cached_property
from importlib import resources
from types import MappingProxyType
from typing import Annotated, Any, Final, Literal, NamedTuple, get_args

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    JsonValue,
    ValidationError,
    WithJsonSchema,
)

from pipeline.assessment.checks import CODES
from pipeline.errors import HerijkError, MissingKnowledgeError
from pipeline.messages import Sentence, say
from pipeline.method.constants import ONCE_OPTIONS
from pipeline.toml_text import parse_toml, problem_in_words

LAST_SEASON: Final = 9999
"""End of a range written as `2015:`, which holds until a later method says otherwise."""


class MethodFileError(HerijkError):
    """A method file that cannot be used; the text names file, line, key and what is allowed."""


class _Options(BaseModel):
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
    """An option with its basis, and that of values that come from elsewhere.

    Without a default every method has to name it. One that was added after editions had been
    published is no part of a definition at its default: methods keep their hash.
    """
    of_values: dict[str, JsonValue] = {value: [*other] for value, other in but.items()}
    basis: dict[str, JsonValue] = {"status": status, "source": source, "but": of_values}
    left_out = (lambda value: bool(value == default)) if added else None
    return Field(default=default, ge=ge, le=le, json_schema_extra=basis, exclude_if=left_out)


class Speed(_Options):
    """What is known to be wrong with the speed through the water, which is that of log 1."""

    correction: Literal["none", "prescribed", "estimated"] = _option(
        "proposed",
        say('P2015, "Meten van de sleepsnelheid"'),
        but={"estimated": Basis("proposed", say("this project; appendix 4"))},
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


class Force(_Options):
    """What is known to be wrong with the tow force of a season."""

    ratio: float = _option(
        "proposed",
        say("this project: a fault that was found, applied knowingly; appendix 4"),
        1.0,
        0.8,
        1.25,
        added=True,
    )
    """Load cell reading / true force."""


class Calibration(_Options):
    """The factor that brings the log to ground speed."""

    rule: Literal["none", "gps_per_tow"] = _option("decided", say('S2017, "IJking snelheid"'))


class Window(_Options):
    """Which part of a run counts; a window that a person gave goes before the steady part."""

    rule: Literal["all", "steady"] = _option("decided", say('S2017, "Knippen"'))


class Wind(_Options):
    """How the resistance in air is taken off."""

    model: Literal["head", "oblique"] = _option("proposed", say('P2015, "Dwarse tegenwind"'))
    coefficients: Literal["fixed", "per_run"] = _option(
        "proposed", say('P2015, "Windweerstand"'), "fixed"
    )
    ahead: float = _option("proposed", say('P2015, "Windweerstand"'), 0.5, 0.0, 2.0)
    behind: float = _option("proposed", say('P2015, "Windweerstand"'), 0.5, 0.0, 2.0)
    side: float = _option("proposed", say('P2015, "Dwarse tegenwind"'), 0.2, 0.0, 2.0)
    averaging_s: int = _option(
        "proposed", say("this project: the vane swings; appendix 5"), 0, 0, 15
    )
    anemometer: Literal["as_read", "estimated"] = _option(
        "proposed", say("this project: runs out and back; appendix 5"), "as_read"
    )


class RunPoint(_Options):
    """How the samples of a window become one point."""

    estimator: Literal["mean_of_ratios", "ratio_of_means", "ratio_of_robust_means"] = _option(
        "decided",
        say("S2017"),
        but={
            "ratio_of_means": Basis("proposed", say("this project: a noisy log; appendix 3")),
            "ratio_of_robust_means": Basis(
                "proposed", say("this project: a noisy log, steering; appendix 3")
            ),
        },
    )
    inertia: Literal["none", "end_speeds"] = _option(
        "proposed", say("this project; appendix 6"), "none"
    )


class Temperature(_Options):
    """Whether resistance is brought to one water temperature."""

    rule: Literal["none", "ittc57"] = _option(
        "decided", say("correction of 9 May 2018; the formula is inferred")
    )


class Unrecorded(_Options):
    """What is taken for a wind, a water temperature or a GPS that nobody recorded.

    As it is: still air, no change to the reference temperature, no curve where GPS is asked for.
    Expected: the wind and water of other tows, and the log's factor by other tows.
    """

    rule: Literal["as_is", "expected"] = _option(
        "inferred", say("this project; appendix 4 to 6"), "as_is", added=True
    )


class Runs(_Options):
    """Which runs count."""

    highest_target_ratio: float = _option(
        "proposed", say('P2015: "Geen v = +20% runs meer uitvoeren"'), 1.15, 1.0, 1.5
    )


class Curve(_Options):
    """How the hyperbola is fitted: with B free, or at most `constants.CAP_HULL_SPEEDS`."""

    b: Literal["free", "capped"] = _option(
        "proposed", say('P2015: "B-waarden maximeren aan 3x rompsnelheid"')
    )


def _known_check(code: str) -> str:
    if code not in CODES:
        raise ValueError(say("must be one of {}", ", ".join(CODES)))
    return code


class Assessment(_Options):
    """Which checks of the assessment reject a tow, by their code (`pipeline.assessment.checks`)."""

    reject: tuple[
        Annotated[
            str,
            AfterValidator(_known_check),
            WithJsonSchema({"type": "string", "enum": sorted(CODES)}),
        ],
        ...,
    ] = _option("decided", say("S2017; which checks is the method's choice"), ())


class Steps(_Options):
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


def basis_of(step: str, option: str, value: object) -> Basis:
    """Where an option comes from, given what it is set to."""
    options: Any = Steps.model_fields[step].annotation
    given = options.model_fields[option].json_schema_extra
    return Basis(*given["but"].get(value, (given["status"], given["source"])))


class RegisterRule(_Options):
    """How long a tow counts, and which of its estimates. It changes no curve.

    A tow counts until the end of its last calendar year; five years: FSN notice, January 2013.
    """

    estimate: Literal["as_measured", "best_estimate"] = "as_measured"
    valid_years: int = Field(default=5, ge=1, le=20)
    six_years_from: int | None = Field(default=None, ge=1990, le=2100)


class SeasonSteps(_Options):
    """The steps of the seasons `first` to `last`, both included."""

    first: int
    last: int
    steps: Steps


COMPLETE: Final = "complete"
RUNS_ALONE: Final = "runs_alone"


class Method(_Options):
    """A complete method: for every season of its range the option of every step.

    Attributes:
        title_en, description_en: in English; in a file without them as `title`, `description`.
        published_in: the first and last season whose registers were published by it; None where
            none was.
    """

    name: str
    title: str
    title_en: str
    description: str
    description_en: str
    extends: str | None
    ranges: tuple[SeasonSteps, ...]
    validity: RegisterRule = RegisterRule()
    published_in: tuple[int, int] | None = None

    def titled(self, language: str) -> str:
        """The title in `nl` or `en`."""
        return self.title if language == "nl" else self.title_en

    def described(self, language: str) -> str:
        """The description in `nl` or `en`."""
        return self.description if language == "nl" else self.description_en

    def for_season(self, season: int) -> Steps:
        """The steps of a season.

        Raises:
            MissingKnowledgeError: the method does not cover that season.
        """
        for block in self.ranges:
            if block.first <= season <= block.last:
                return block.steps
        last = self.ranges[-1].last
        raise MissingKnowledgeError(
            "method {} says nothing about season {}; it covers {} to {}. Leave that "
            "season out with --seasons, or widen the method's `seasons`",
            self.name,
            season,
            self.ranges[0].first,
            say("the present") if last == LAST_SEASON else last,
        )

    @property
    def estimates_logs(self) -> bool:
        """Whether it estimates the log factor of any season."""
        return any(block.steps.estimates_logs for block in self.ranges)

    @property
    def interval(self) -> str:
        """What its intervals hold: `COMPLETE`, or `RUNS_ALONE` if no log factor is estimated."""
        return COMPLETE if self.estimates_logs else RUNS_ALONE

    @property
    def definition(self) -> str:
        """Everything that can change a curve, as canonical JSON; the register's rule cannot."""
        blocks = [r.model_dump(mode="json") for r in self.ranges]
        for block in blocks:
            block["steps"] = _with_constants(block["steps"])
        return json.dumps(blocks, sort_keys=True, separators=(",", ":"))

    @property
    def content_hash(self) -> str:
        """SHA-256 of `definition`, in hex: equal for methods that give equal curves."""
        return hashlib.sha256(self.definition.encode()).hexdigest()


def _with_constants(steps: dict[str, Any]) -> dict[str, Any]:
    """Options of a season with the constants that once were options of them.

    Editions name their methods by the hash of both, which does not change with what is an option.
    """
    once = {step: options | ONCE_OPTIONS.get(step, {}) for step, options in steps.items()}
    return {step: options for step, options in once.items() if options}


def method_in_force(season: int, methods: Iterable[Method]) -> Method | None:
    """Return the method by which the register of a season was published; None if none says so.

    Of several the one that came into force last.
    """
    begins = {}
    for method in methods:
        if method.published_in is not None:
            first, last = method.published_in
            if first <= season <= last:
                begins[first] = method
    return begins[max(begins)] if begins else None


def shipped_methods() -> tuple[str, ...]:
    """Names of the methods that come with the package, in alphabetical order."""
    files = resources.files("pipeline.methods").iterdir()
    return tuple(sorted(f.name.removesuffix(".toml") for f in files if f.name.endswith(".toml")))


def shipped_text(name: str) -> str:
    """The TOML text of a method that comes with the package.

    Raises:
        MissingKnowledgeError: there is no such method.
    """
    if name not in shipped_methods():
        raise MissingKnowledgeError(
            "there is no method {!r}; the methods are {}", name, ", ".join(shipped_methods())
        )
    return (resources.files("pipeline.methods") / f"{name}.toml").read_text(encoding="utf-8")


@cache
def shipped_method(name: str) -> Method:
    """A method that comes with the package."""
    return parse_method(shipped_text(name), f"{name}.toml")


LONGEST_TEXT: Final = 100_000
"""More than any method has."""


def parse_method(
    text: str,
    file_name: str,
    text_of: Callable[[str], str] = shipped_text,
    published: bool = False,
) -> Method:
    """Reads and checks the text of a method file.

    Args:
        text: TOML.
        file_name: for error messages.
        text_of: gives the text of a method that this one extends.
        published: of an edition; options and values that there are no longer are left out, so that
            it can be shown. Its hash says that it is another method.

    Raises:
        MethodFileError: with file, line, key and what is allowed.
    """
    if len(text) > LONGEST_TEXT:
        raise MethodFileError(
            "{}: {} letters; a method has at most {}", file_name, len(text), LONGEST_TEXT
        )
    lineage = _lineage(_Reader(text, file_name, published), text_of)
    reader = lineage[-1]
    head = reader.head
    published_in = None
    if head.published_in is not None:
        published_in = reader.seasons(head.published_in, "published_in")
    return Method(
        name=head.name,
        title=head.title,
        title_en=head.title_en or head.title,
        description=head.description,
        description_en=head.description_en or head.description,
        extends=head.extends,
        ranges=_ranges(reader, [layer for one in lineage for layer in _layers(one)]),
        validity=_register_rule(lineage),
        published_in=published_in,
    )


def _fit_for_a_name(text: str) -> str:
    if not re.fullmatch(r"[a-z0-9][a-z0-9-]*", text):
        raise ValueError(say("must be of small letters, digits and hyphens"))
    return text


class _Head(_Options):
    """The part of a method file outside the steps."""

    name: Annotated[str, AfterValidator(_fit_for_a_name)]
    title: str
    title_en: str = ""
    description: str = ""
    description_en: str = ""
    extends: str | None = None
    seasons: str = "2009:"
    published_in: str | None = None
    validity: dict[str, Any] = Field(default={}, alias="register")
    steps: dict[str, Any] = {}
    overrides: list[dict[str, Any]] = []


class _Layer(NamedTuple):
    """Options that hold for the seasons `first` to `last`, by step."""

    first: int
    last: int
    options: dict[str, dict[str, object]]


_KEYS: Final = re.compile(r"(?<![\w-])([\w-]++)\s*+=")
"""Tried at the beginning of a word only: a long word would otherwise be tried at each letter."""


class _Reader:
    """A method text with its file name, so that every error can say where it is."""

    def __init__(self, text: str, file_name: str, published: bool = False) -> None:
        self.text, self.file_name, self.published = text, file_name, published

    @cached_property
    def head(self) -> _Head:
        try:
            return _Head.model_validate(parse_toml(self.text))
        except ValidationError as error:
            raise self.from_validation(error, allowed=_Head) from error
        except ValueError as error:
            raise MethodFileError("{}: not valid TOML: {}", self.file_name, error) from error

    def seasons(self, text: object, key: str) -> tuple[int, int]:
        """First and last season of a range as the file writes it."""
        match = re.fullmatch(r"(\d{4})(:(\d{4})?)?", text) if isinstance(text, str) else None
        if match is None:
            wrong = say("{!r} is not a range of seasons; write 2009:2011, 2015: or 2014", text)
            raise self.error(key, wrong)
        first = int(match[1])
        last = int(match[3]) if match[3] else (LAST_SEASON if match[2] else first)
        if last < first:
            raise self.error(key, say("range {!r} ends before it begins", text))
        return first, last

    def error(self, key: str, message: Sentence, where: str | None = None) -> MethodFileError:
        """An error about `key`, on the line of `where`, which is the key unless it is missing."""
        line = self._line(key if where is None else where)
        file = self.file_name if line is None else say("{}, line {}", self.file_name, line)
        return MethodFileError("{}: {}: {}", file, f"'{key}'", message)

    def from_validation(
        self, error: ValidationError, allowed: type[BaseModel], season: int | None = None
    ) -> MethodFileError:
        # An unknown key first: a misspelt one is also missing.
        first = min(error.errors(), key=lambda problem: problem["type"] != "extra_forbidden")
        path = [part for part in first["loc"] if isinstance(part, str)]
        message = problem_in_words(first)
        if first["type"] == "extra_forbidden":
            message = say("{}; allowed here: {}", message, ", ".join(_keys_at(allowed, path[:-1])))
        if season is not None:
            message = say("{} (season {})", message, season)
        where = path[:-1] if first["type"] == "missing" else path
        return self.error(".".join(path), message, where=".".join(where))

    def _line(self, key: str) -> int | None:
        """Where the key is: the last line that holds it, or else the step it belongs to."""
        parts = key.split(".")
        for wanted in (parts[-2:], parts[-1:], parts[-2:-1]):
            lines = [number for number, keys in self._keys_of_lines() if set(wanted) <= keys]
            if wanted and lines:
                return lines[-1]
        return None

    def _keys_of_lines(self) -> list[tuple[int, set[str]]]:
        """The keys named on each line, with those of the table it is in."""
        table: set[str] = set()
        keys = []
        for number, line in enumerate(self.text.splitlines(), 1):
            header = re.match(r"\s*\[+([\w.-]+)\]+", line)
            if header:
                table = set(header[1].split("."))
            keys.append((number, table | set(_KEYS.findall(line))))
        return keys


def _keys_at(model: type[BaseModel], path: list[str]) -> list[str]:
    for part in path:
        inner = model.model_fields[part].annotation if part in model.model_fields else None
        if not (isinstance(inner, type) and issubclass(inner, BaseModel)):
            return []
        model = inner
    return sorted(field.alias or name for name, field in model.model_fields.items())


def _lineage(reader: _Reader, text_of: Callable[[str], str]) -> list[_Reader]:
    """A method file and those that it extends, the oldest first."""
    lineage, names = [reader], [reader.head.name]
    while (parent := reader.head.extends) is not None:
        if parent in names:
            circle = " > ".join((*names, parent))
            wrong = say("a method cannot build on itself: {}; change its name or this one", circle)
            raise reader.error("extends", wrong)
        try:
            text = text_of(parent)
        except MissingKnowledgeError as error:
            raise reader.error("extends", say("{}", error)) from error
        reader = _Reader(text, f"{parent}.toml")
        lineage.insert(0, reader)
        names.append(parent)
    return lineage


def _layers(reader: _Reader) -> list[_Layer]:
    """What one file says of the steps: for all seasons, then for some."""
    everywhere = _Layer(0, LAST_SEASON, _step_tables(reader, reader.head.steps, "steps"))
    overrides = []
    for block in reader.head.overrides:
        options = {key: value for key, value in block.items() if key not in ("range", "why")}
        seasons = reader.seasons(block.get("range"), "overrides.range")
        overrides.append(_Layer(*seasons, _step_tables(reader, options, "overrides")))
    _refuse_overlap(reader, overrides)
    return [everywhere, *overrides]


def _register_rule(lineage: list[_Reader]) -> RegisterRule:
    """The rule of validity; what a file does not say, it has from the file it extends."""
    table: dict[str, Any] = {}
    for reader in lineage:
        table |= reader.head.validity
    try:
        return RegisterRule.model_validate(table)
    except ValidationError as error:
        raise lineage[-1].from_validation(error, RegisterRule) from error


def _step_tables(
    reader: _Reader, options: Mapping[str, Any], where: str
) -> dict[str, dict[str, object]]:
    for step, table in options.items():
        if step not in Steps.model_fields:
            allowed = ", ".join(Steps.model_fields)
            wrong = say("unknown step; allowed here: {}", allowed)
            raise reader.error(f"{where}.{step}", wrong)
        if not isinstance(table, dict):
            wrong = say("a table of options is needed, not {!r}", table)
            raise reader.error(f"{where}.{step}", wrong)
    if reader.published:
        return {step: _still_there(step, table) for step, table in options.items()}
    return dict(options)


def _still_there(step: str, options: Mapping[str, object]) -> dict[str, object]:
    """Return the options of a step that there still are, with a value that they still have."""
    model = Steps.model_fields[step].annotation
    fields = {} if model is None else model.model_fields
    kept = {}
    for name, value in options.items():
        if name in fields:
            choices = get_args(fields[name].annotation)
            if not choices or value in choices:
                kept[name] = value
    return kept


def _refuse_overlap(reader: _Reader, layers: list[_Layer]) -> None:
    for one, other in itertools.combinations(layers, 2):
        first = max(one.first, other.first)
        if first > min(one.last, other.last):
            continue
        for step in one.options.keys() & other.options.keys():
            for key in one.options[step].keys() & other.options[step].keys():
                wrong = say("given twice for season {}; ranges overlap", first)
                raise reader.error(f"overrides.{step}.{key}", wrong)


def _ranges(reader: _Reader, layers: list[_Layer]) -> tuple[SeasonSteps, ...]:
    """The complete steps of every season, neighbouring seasons with equal steps together."""
    first, last = reader.seasons(reader.head.seasons, "seasons")
    edges = {first, last + 1, *(edge for one in layers for edge in (one.first, one.last + 1))}
    inside = sorted(edge for edge in edges if first <= edge <= last + 1)
    return joined(
        SeasonSteps(first=begin, last=end - 1, steps=_steps_of_season(reader, layers, begin))
        for begin, end in itertools.pairwise(inside)
    )


def joined(ranges: Iterable[SeasonSteps]) -> tuple[SeasonSteps, ...]:
    """Neighbouring ranges with equal steps together, so that equal methods have equal hashes."""
    merged: list[SeasonSteps] = []
    for block in ranges:
        if merged and merged[-1].steps == block.steps:
            merged[-1] = SeasonSteps(first=merged[-1].first, last=block.last, steps=block.steps)
        else:
            merged.append(block)
    return tuple(merged)


def _steps_of_season(reader: _Reader, layers: list[_Layer], season: int) -> Steps:
    merged: dict[str, dict[str, object]] = {step: {} for step in Steps.model_fields}
    for layer in layers:
        if layer.first <= season <= layer.last:
            for step, options in layer.options.items():
                merged[step] |= options
    try:
        return Steps.model_validate(merged)
    except ValidationError as error:
        raise reader.from_validation(error, Steps, season) from error
