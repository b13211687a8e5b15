"""Read method files: TOML that a committee member can write, into a checked `Method`.

`[steps.<step>]` gives options for every season; each `[[overrides]]` block replaces some of them
for a range of seasons; a method may `extends` another. A file with an error gives no method: the
error names file, line, key and what is allowed.
"""

import itertools
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Annotated, Any, Final, NamedTuple, get_args

from pydantic import AfterValidator, BaseModel, Field, ValidationError

from pipeline.errors import HerijkError, MissingKnowledgeError
from pipeline.messages import Sentence, say
from pipeline.method.definition import (
    LAST_SEASON,
    Method,
    RegisterRule,
    SeasonSteps,
    join_equal_ranges,
)
from pipeline.method.options import Declared, Steps
from pipeline.toml_text import describe_problem, parse_toml

MAX_METHOD_LETTERS: Final = 100_000
"""More letters than any method has."""

StepOptions = dict[str, dict[str, object]]
"""Values of options, by step and option."""


class MethodFileError(HerijkError):
    """A method file that cannot be used; the text names file, line, key and what is allowed."""


def _refuse_bad_name(text: str) -> str:
    if not re.fullmatch(r"[a-z0-9][a-z0-9-]*", text):
        raise ValueError(say("must be of small letters, digits and hyphens"))
    return text


class _Head(Declared):
    """All that a method file says, before its steps are checked."""

    name: Annotated[str, AfterValidator(_refuse_bad_name)]
    title: str
    title_en: str = ""
    description: str = ""
    description_en: str = ""
    extends: str | None = None
    seasons: str = "2009:"
    published_in: str | None = None
    validity: dict[str, Any] = Field(default={}, alias="register")
    steps: dict[str, Any] = Field(default={})
    overrides: list[dict[str, Any]] = Field(default=[])


class _Layer(NamedTuple):
    """Options that a file gives for the seasons `first` to `last`, both included."""

    first: int
    last: int
    options: StepOptions


def list_shipped_methods() -> tuple[str, ...]:
    """Return the names of the methods that come with the package, in alphabetical order."""
    files = resources.files("pipeline.methods").iterdir()
    return tuple(sorted(f.name.removesuffix(".toml") for f in files if f.name.endswith(".toml")))


def read_shipped_text(name: str) -> str:
    """Return the TOML text of a method that comes with the package.

    Raises:
        MissingKnowledgeError: there is no such method.
    """
    if name not in list_shipped_methods():
        raise MissingKnowledgeError(
            "there is no method {!r}; the methods are {}", name, ", ".join(list_shipped_methods())
        )
    return (resources.files("pipeline.methods") / f"{name}.toml").read_text(encoding="utf-8")


@cache
def read_shipped_method(name: str) -> Method:
    """Return a method that comes with the package.

    Raises:
        MissingKnowledgeError: there is no such method.
    """
    return parse_method(read_shipped_text(name), f"{name}.toml")


def parse_method(
    text: str,
    file_name: str,
    text_of: Callable[[str], str] = read_shipped_text,
    published: bool = False,
) -> Method:
    """Read and check the text of a method file.

    Args:
        text: TOML.
        file_name: for error messages.
        text_of: gives the text of a method that this one extends.
        published: whether the text belongs to an edition. Options and values that no longer exist
            are then left out, so that the method can be shown; its hash says that it is another.

    Raises:
        MethodFileError: with file, line, key and what is allowed.
    """
    if len(text) > MAX_METHOD_LETTERS:
        raise MethodFileError(
            "{}: {} letters; a method has at most {}", file_name, len(text), MAX_METHOD_LETTERS
        )
    file = _MethodFile.read(text, file_name)
    ancestors = _read_ancestors(file, text_of)
    layers: list[_Layer] = []
    for ancestor in ancestors:
        layers += _read_layers(ancestor, leave_out_unknown=False)
    layers += _read_layers(file, leave_out_unknown=published)

    head = file.head
    published_in = None
    if head.published_in is not None:
        published_in = file.parse_seasons(head.published_in, "published_in")
    return Method(
        name=head.name,
        title=head.title,
        title_en=head.title_en or head.title,
        description=head.description,
        description_en=head.description_en or head.description,
        extends=head.extends,
        ranges=_build_ranges(file, layers),
        validity=_read_register_rule(ancestors + [file]),
        published_in=published_in,
    )


@dataclass(frozen=True)
class _Source:
    """The text of a method file and its name, to say where in it an error is."""

    text: str
    file_name: str

    def make_error(self, key: str, problem: Sentence, where: str | None = None) -> MethodFileError:
        """Make an error about `key`, on the line of `where`; by default that of the key."""
        line = self._find_line(key if where is None else where)
        place = self.file_name if line is None else say("{}, line {}", self.file_name, line)
        return MethodFileError("{}: {}: {}", place, f"'{key}'", problem)

    def explain_validation(
        self, error: ValidationError, declared: type[BaseModel], season: int | None = None
    ) -> MethodFileError:
        """Say the first problem that Pydantic found, in words and with its line.

        Args:
            error: what Pydantic found.
            declared: the model that was validated against, for the keys that are allowed.
            season: the season whose options these are, if the file does not name it itself.
        """
        # An unknown key first: a key with a typing error is missing as well.
        problem = min(error.errors(), key=lambda found: found["type"] != "extra_forbidden")
        path = [part for part in problem["loc"] if isinstance(part, str)]
        message = describe_problem(problem)
        if problem["type"] == "extra_forbidden":
            allowed = ", ".join(_list_keys(declared, path[:-1]))
            message = say("{}; allowed here: {}", message, allowed)
        if season is not None:
            message = say("{} (season {})", message, season)
        where = path[:-1] if problem["type"] == "missing" else path
        return self.make_error(".".join(path), message, where=".".join(where))

    def _find_line(self, key: str) -> int | None:
        """Find the last line that names a key and its step; else the key, else the step."""
        step_and_key = key.split(".")[-2:]
        for wanted in (step_and_key, step_and_key[-1:], step_and_key[:-1]):
            lines = [number for number, names in self._names_by_line() if set(wanted) <= names]
            if wanted and lines:
                return lines[-1]
        return None

    def _names_by_line(self) -> list[tuple[int, set[str]]]:
        """List the keys on each line, with the names of the table that the line is in."""
        table: set[str] = set()
        lines = []
        for number, line in enumerate(self.text.splitlines(), 1):
            header = re.match(r"\s*\[+([\w.-]+)\]+", line)
            if header:
                table = set(header[1].split("."))
            keys = re.findall(r"(?<![\w-])([\w-]+)\s*=", line)
            lines.append((number, table.union(keys)))
        return lines


@dataclass(frozen=True)
class _MethodFile(_Source):
    """A method file whose head was read."""

    head: _Head

    @classmethod
    def read(cls, text: str, file_name: str) -> "_MethodFile":
        source = _Source(text, file_name)
        try:
            head = _Head.model_validate(parse_toml(text))
        except ValidationError as error:
            raise source.explain_validation(error, _Head) from error
        except ValueError as error:
            raise MethodFileError("{}: not valid TOML: {}", file_name, error) from error
        return cls(text, file_name, head)

    def parse_seasons(self, text: object, key: str) -> tuple[int, int]:
        """Return the first and last season of a range such as 2009:2011, 2015: or 2014."""
        match = re.fullmatch(r"(\d{4})(:(\d{4})?)?", text) if isinstance(text, str) else None
        if match is None:
            problem = say("{!r} is not a range of seasons; write 2009:2011, 2015: or 2014", text)
            raise self.make_error(key, problem)
        first = int(match[1])
        last = LAST_SEASON if match[2] else first
        if match[3]:
            last = int(match[3])
        if last < first:
            raise self.make_error(key, say("range {!r} ends before it begins", text))
        return first, last


def _list_keys(model: type[BaseModel], path: list[str]) -> list[str]:
    """List the keys that a model allows in the table at `path`."""
    for name in path:
        inner = model.model_fields[name].annotation if name in model.model_fields else None
        if not (isinstance(inner, type) and issubclass(inner, BaseModel)):
            return []
        model = inner
    return sorted(field.alias or name for name, field in model.model_fields.items())


def _read_ancestors(file: _MethodFile, text_of: Callable[[str], str]) -> list[_MethodFile]:
    """Read the methods that a file extends, the oldest first."""
    ancestors: list[_MethodFile] = []
    names = [file.head.name]
    child = file
    while (parent := child.head.extends) is not None:
        if parent in names:
            circle = " > ".join(names + [parent])
            problem = say(
                "a method cannot build on itself: {}; change its name or this one", circle
            )
            raise child.make_error("extends", problem)
        try:
            text = text_of(parent)
        except MissingKnowledgeError as error:
            raise child.make_error("extends", say("{}", error)) from error
        child = _MethodFile.read(text, f"{parent}.toml")
        ancestors.insert(0, child)
        names.append(parent)
    return ancestors


def _read_layers(file: _MethodFile, leave_out_unknown: bool) -> list[_Layer]:
    """Read the options of one file: those for all seasons, then those of each override.

    Args:
        file: the file.
        leave_out_unknown: leave out options and values that do not exist, in place of an error.
    """
    steps = _read_step_options(file, file.head.steps, "steps")
    overrides = []
    for block in file.head.overrides:
        first, last = file.parse_seasons(block.get("range"), "overrides.range")
        given = {key: value for key, value in block.items() if key not in ("range", "why")}
        overrides.append(_Layer(first, last, _read_step_options(file, given, "overrides")))
    _refuse_overlap(file, overrides)
    layers = [_Layer(0, LAST_SEASON, steps)] + overrides
    if leave_out_unknown:
        layers = [layer._replace(options=_leave_out_unknown(layer.options)) for layer in layers]
    return layers


def _read_step_options(file: _MethodFile, given: Mapping[str, Any], where: str) -> StepOptions:
    """Check that each key is a step and each value a table; the options are checked later."""
    for step, options in given.items():
        if step not in Steps.model_fields:
            problem = say("unknown step; allowed here: {}", ", ".join(Steps.model_fields))
            raise file.make_error(f"{where}.{step}", problem)
        if not isinstance(options, dict):
            problem = say("a table of options is needed, not {!r}", options)
            raise file.make_error(f"{where}.{step}", problem)
    return dict(given)


def _leave_out_unknown(given: StepOptions) -> StepOptions:
    """Return the options that exist today, set to a value that they can have today."""
    known: StepOptions = {}
    for step, options in given.items():
        model = Steps.model_fields[step].annotation
        fields = {} if model is None else model.model_fields
        known[step] = {}
        for name, value in options.items():
            choices = get_args(fields[name].annotation) if name in fields else ()
            if name in fields and (not choices or value in choices):
                known[step][name] = value
    return known


def _refuse_overlap(file: _MethodFile, overrides: list[_Layer]) -> None:
    """Raise an error if two overrides of one file give one option for the same season."""
    for one, other in itertools.combinations(overrides, 2):
        first_shared = max(one.first, other.first)
        if first_shared > min(one.last, other.last):
            continue
        for step in one.options.keys() & other.options.keys():
            for option in one.options[step].keys() & other.options[step].keys():
                problem = say("given twice for season {}; ranges overlap", first_shared)
                raise file.make_error(f"overrides.{step}.{option}", problem)


def _build_ranges(file: _MethodFile, layers: list[_Layer]) -> tuple[SeasonSteps, ...]:
    """Build the complete steps of every season; a later layer goes before an earlier one."""
    first, last = file.parse_seasons(file.head.seasons, "seasons")
    begins = {first}
    for layer in layers:
        begins |= {edge for edge in (layer.first, layer.last + 1) if first < edge <= last}
    edges = sorted(begins) + [last + 1]
    ranges = []
    for begin, end in itertools.pairwise(edges):
        steps = _merge_steps(file, layers, begin)
        ranges.append(SeasonSteps(first=begin, last=end - 1, steps=steps))
    return join_equal_ranges(ranges)


def _merge_steps(file: _MethodFile, layers: list[_Layer], season: int) -> Steps:
    """Merge the layers that hold for a season, and check the outcome."""
    merged: StepOptions = {step: {} for step in Steps.model_fields}
    for layer in layers:
        if layer.first <= season <= layer.last:
            for step, options in layer.options.items():
                merged[step] |= options
    try:
        return Steps.model_validate(merged)
    except ValidationError as error:
        raise file.explain_validation(error, Steps, season) from error


def _read_register_rule(files: Sequence[_MethodFile]) -> RegisterRule:
    """Read the rule of validity; what a file does not say, it has from the one it extends."""
    rule: dict[str, Any] = {}
    for file in files:
        rule |= file.head.validity
    try:
        return RegisterRule.model_validate(rule)
    except ValidationError as error:
        raise files[-1].explain_validation(error, RegisterRule) from error
