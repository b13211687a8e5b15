"""A method is data: the named option of every step, for every season.

`Method` is what a method file (`pipeline/methods/`) says once it is read and checked by
`pipeline.method.reading`; the options are declared in `pipeline.method.options`. Nothing here
computes with them.
"""

import hashlib
import json
from collections.abc import Iterable
from typing import Any, Final, Literal

from pydantic import Field, field_validator

from pipeline.errors import MissingKnowledgeError
from pipeline.messages import say
from pipeline.method.constants import FORMER_OPTIONS
from pipeline.method.options import Declared, Steps

LAST_SEASON: Final = 9999
"""End of a range written as `2015:`, which holds until a later method says otherwise."""


class RegisterRule(Declared):
    """How long a tow counts, and which of its estimates. It changes no curve.

    A tow counts until the end of its last calendar year; five years: FSN notice, January 2013.
    Elsewhere it may count to the day.

    Attributes:
        six_years_from: the first season whose tows count six years; `"never"` for none.
        counts_until: `same_day` for a tow that counts to the day, years later.
    """

    estimate: Literal["as_measured", "best_estimate"] = "as_measured"
    valid_years: int = Field(default=5, ge=1, le=20)
    six_years_from: int | None = Field(default=None, ge=1990, le=2100)
    counts_until: Literal["same_day"] | None = None

    @field_validator("six_years_from", mode="before")
    @classmethod
    def _read_never(cls, value: object) -> object:
        return None if value == "never" else value


class SeasonSteps(Declared):
    """The steps of the seasons `first` to `last`, both included."""

    first: int
    last: int
    steps: Steps


COMPLETE: Final = "complete"
RUNS_ALONE: Final = "runs_alone"


class Method(Declared):
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

    def get_title(self, language: str) -> str:
        """Return the title in `nl` or `en`."""
        return self.title if language == "nl" else self.title_en

    def get_description(self, language: str) -> str:
        """Return the description in `nl` or `en`."""
        return self.description if language == "nl" else self.description_en

    def get_steps(self, season: int) -> Steps:
        """Return the steps of a season.

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
        """Whether the log factor of any season is estimated."""
        return any(block.steps.estimates_logs for block in self.ranges)

    @property
    def interval(self) -> str:
        """What its intervals hold: `COMPLETE`, or `RUNS_ALONE` if no log factor is estimated."""
        return COMPLETE if self.estimates_logs else RUNS_ALONE

    @property
    def definition(self) -> str:
        """Everything that can change a curve, as canonical JSON; the register's rule cannot."""
        blocks = []
        for block in self.ranges:
            dumped = block.model_dump(mode="json")
            dumped["steps"] = _add_former_options(dumped["steps"])
            blocks.append(dumped)
        return json.dumps(blocks, sort_keys=True, separators=(",", ":"))

    @property
    def content_hash(self) -> str:
        """SHA-256 of `definition`, in hex: equal for methods that give equal curves."""
        return hashlib.sha256(self.definition.encode()).hexdigest()


def _add_former_options(steps: dict[str, Any]) -> dict[str, Any]:
    """Add to the options of a season the constants that once were options.

    Editions name their methods by the hash of both, which must not change with what is an option.
    """
    complete = {}
    for step, options in steps.items():
        with_former = options | FORMER_OPTIONS.get(step, {})
        if with_former:
            complete[step] = with_former
    return complete


def join_equal_ranges(ranges: Iterable[SeasonSteps]) -> tuple[SeasonSteps, ...]:
    """Join neighbouring ranges with equal steps, so that equal methods have equal hashes."""
    merged: list[SeasonSteps] = []
    for block in ranges:
        if merged and merged[-1].steps == block.steps:
            merged[-1] = SeasonSteps(first=merged[-1].first, last=block.last, steps=block.steps)
        else:
            merged.append(block)
    return tuple(merged)


def find_method_in_force(season: int, methods: Iterable[Method]) -> Method | None:
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
