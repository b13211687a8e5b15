"""What `archief.toml` may say.

Words and columns of the lists, names and units of the samples, what was not measured, the plan of
the runs, days to set aside.
"""

import datetime as dt
import re
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import cached_property
from itertools import pairwise
from typing import Annotated, Final, Literal, Self

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from pipeline.channels import (
    BACK,
    FEWEST_RUNS,
    MOST_RUNS,
    OUT,
    RUN_SECONDS,
    TARGET_SPEED_RATIOS,
)
from warehouse.archive.files.names import STANDS_FOR
from warehouse.archive.profile.season import (
    MAY_BE_ABSENT,
    SAMPLE_COLUMNS,
    STANDARD,
    Plan,
    SeasonProfile,
)
from warehouse.archive.spelling.columns import Column
from warehouse.archive.spelling.headers import split_header
from warehouse.archive.spelling.synonyms import HEADERS
from warehouse.archive.spelling.text import fold, fold_word
from warehouse.archive.spelling.units import UNITS, find_scale

Channel = Literal["run", "log1", "log2", "gps", "force", "wind_speed", "wind_angle", "time"]
Absent = Literal["log2", "gps", "wind"]
_DIMENSIONS: Final = {column.key: column.dimension for column in SAMPLE_COLUMNS}


def _lines(value: object) -> object:
    """Reads `"3:5"` or `"3"` as (first, last)."""
    if not isinstance(value, str) or not re.fullmatch(r"[1-9][0-9]?(:[1-9][0-9]?)?", value):
        raise ValueError('lines are text, e.g. "3:5" or "3", up to 99')
    first, _, last = value.partition(":")
    return int(first), max(int(first), int(last or first))


def _season_range(value: object) -> object:
    """Reads `"2009:2011"` or `"2009"` as (first, last)."""
    if not isinstance(value, str):
        raise ValueError('a season range is text, e.g. "2009:2011" or "2013"')
    first, _, last = value.partition(":")
    if not (first.isascii() and first.isdigit() and (not last or last.isdigit())):
        raise ValueError(f"'{value}' is not a season range such as 2009:2011")
    seasons = (int(first), int(last or first))
    if seasons[0] > seasons[1]:
        raise ValueError(f"'{value}' ends before it begins")
    return seasons


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class SetAside(_Strict):
    """A day whose tows are not used, and why."""

    date: dt.date
    reason: Annotated[str, Field(min_length=1)]


class LogReplaced(_Strict):
    """The first day on which another log was on board than before, within a season."""

    date: dt.date
    log: Literal["log1", "log2"]
    reason: Annotated[str, Field(min_length=1)]


_Directions = Annotated[
    list[Literal["out", "back"]], Field(min_length=FEWEST_RUNS, max_length=MOST_RUNS)
]
_Targets = Annotated[
    list[Annotated[float, Field(ge=0.3, le=2.0)]],
    Field(min_length=FEWEST_RUNS, max_length=MOST_RUNS),
]


def _ways(directions: list[Literal["out", "back"]]) -> tuple[int, ...]:
    return tuple(OUT if way == "out" else BACK for way in directions)


def _by(fold_key: Callable[[str], str]) -> Callable[[dict[str, str]], dict[str, str]]:
    return lambda given: {fold_key(name): value for name, value in given.items()}


def _name(header: str) -> str:
    return split_header(header)[0]


def _folded(names: list[str]) -> list[str]:
    return [fold(name) for name in names]


_Ignored = Annotated[list[str], AfterValidator(_folded)]
_HeaderLines = Annotated[tuple[int, int], BeforeValidator(_lines)]


class _ProfileTable(_Strict):
    """One `[[profile]]` of `archief.toml`."""

    seasons: Annotated[tuple[int, int], BeforeValidator(_season_range)]
    columns: dict[Channel, Annotated[str, Field(min_length=1)]] = {}
    units: dict[Channel, str] = {}
    sample_rate_hz: Annotated[int, Field(gt=0, le=100_000)] = 1000
    absent: list[Absent] = []
    reversed: list[Literal["force"]] = []
    wind_zero_deg: Annotated[float, Field(ge=-360, le=360, strict=False)] = 0.0
    header: Annotated[str, Field(min_length=1)] | None = None
    header_lines: _HeaderLines | None = None
    ignore: _Ignored = []
    directions: _Directions | None = None

    @model_validator(mode="after")
    def _names_and_units_are_known(self) -> Self:
        for channel, name in self.columns.items():
            unit = self.units.get(channel) or split_header(name)[1]
            if unit is not None:
                self.units[channel] = unit
        for channel, unit in self.units.items():
            known = UNITS[_DIMENSIONS[channel]]
            if find_scale(_DIMENSIONS[channel], unit) is None:
                raise ValueError(f"units.{channel}: [{unit}] is not one of {sorted(known)}")
        return self


_NO_PROFILE: Final = _ProfileTable.model_validate({"seasons": "0"})


class _PlanTable(_Strict):
    """One `[[plan]]`: the runs of a season's tows, or of some tows."""

    seasons: Annotated[tuple[int, int], BeforeValidator(_season_range)] | None = None
    tows: list[str] = []
    targets: _Targets = list(STANDARD.targets)
    directions: _Directions = ["out", "out", "out", "back", "back", "back"]
    second_directions: _Directions | None = None
    seconds: Annotated[float, Field(ge=5, le=600)] = RUN_SECONDS

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        if (self.seasons is None) == (not self.tows):
            raise ValueError("a plan is for seasons or for tows: give one of the two")
        second = self.second_directions or self.directions
        if not len(self.targets) == len(self.directions) == len(second):
            raise ValueError(
                "targets and directions must have one entry per run, so as many of both"
            )
        return self

    @property
    def plan(self) -> "Plan":
        second = _ways(self.second_directions or [])
        return Plan(tuple(self.targets), _ways(self.directions), self.seconds, second)


class Publication(_Strict):
    """Who publishes what is made from the archive, and what others may do with it."""

    publisher: Annotated[str, Field(min_length=1)] | None = None
    licence: Annotated[str, Field(pattern=r"^([A-Za-z0-9.+-]+|https?://\S+)$")] | None = None


class Profiles(_Strict):
    """`archief.toml`, checked; all defaults when there is none.

    Attributes:
        simulated: the archive says of itself that it was made by a simulator.
        publication: publisher and licence of what is made from it.
        profile: the season ranges that differ.
        plan: the runs of seasons and tows that differ from the standard.
        words: the value that a folded word stands for; empty text for nothing.
        headers: the project's name of a column by a folded other one.
        ignore: folded names of columns of lists, and of files, that are known and not used.
        dates: `dmy` or `mdy` by the path of a list, or `*` for all: how 1/3/2015 is meant.
        decimals: the mark before decimals by the path of a list, or `*` for all.
        header_lines: the first and the last line of the header, by the path of a list.
        files: what a file or folder stands for, by its path in the archive: `sleeplijst_2014`.
        set_aside: days whose tows are not used.
        log_replaced: days from which another log was on board.
    """

    simulated: bool = False
    publication: Publication = Publication()
    profile: list[_ProfileTable] = []
    plan: list[_PlanTable] = []
    words: Annotated[dict[str, str], AfterValidator(_by(fold_word))] = {}
    headers: Annotated[dict[str, str], AfterValidator(_by(_name))] = {}
    ignore: _Ignored = []
    dates: dict[str, Literal["dmy", "mdy"]] = {}
    decimals: dict[str, Literal[".", ","]] = {}
    header_lines: dict[str, _HeaderLines] = {}
    files: dict[str, Annotated[str, Field(pattern=f"^{STANDS_FOR.pattern}$")]] = {}
    set_aside: list[SetAside] = []
    log_replaced: list[LogReplaced] = []

    @model_validator(mode="after")
    def _one_profile_per_season(self) -> Self:
        ranges = sorted(table.seasons for table in self.profile)
        for (_, last), (first, _) in pairwise(ranges):
            if first <= last:
                raise ValueError(f"season {first} has two profiles")
        return self

    def named(self, columns: Iterable[Column]) -> tuple[Column, ...]:
        """The columns with the other names that they answer to."""
        return tuple(
            replace(c, also=(*c.also, *HEADERS.get(c.key, ()), *self._own_names(c)))
            for c in columns
        )

    def _own_names(self, column: Column) -> Iterable[str]:
        own = {fold(column.header), column.key}
        return (name for name, meant in self.headers.items() if own & {fold(meant), meant})

    def ignoring(self, headers: Iterable[str]) -> "Profiles":
        """The same, with more columns that are not used."""
        more = {"ignore": [*self.ignore, *map(fold, headers)]}
        return Profiles.model_construct(**dict(self) | more)

    def for_season(self, season: int) -> SeasonProfile:
        """The profile of a season; the project's default where none is given."""
        if season not in self._made:  # asked for per row of a list
            self._made[season] = self._season_profile(season)
        return self._made[season]

    @cached_property
    def _made(self) -> dict[int, SeasonProfile]:
        return {}

    def _season_profile(self, season: int) -> SeasonProfile:
        table = self._table(season)
        return SeasonProfile(
            season=season,
            columns=self._columns(table),
            sample_rate_hz=table.sample_rate_hz,
            absent=tuple(sorted(table.absent)),
            wind_zero_deg=table.wind_zero_deg,
            header=table.header,
            header_lines=table.header_lines,
            ignore=(*self.ignore, *table.ignore),
        )

    def plan_of(self, tow_id: str, season: int) -> Plan:
        """The plan of a tow: its own, that of its season, or the standard."""
        for table in self.plan:
            if tow_id in table.tows:
                return table.plan
        for table in self.plan:
            if table.seasons and table.seasons[0] <= season <= table.seasons[1]:
                return table.plan
        directions = self._table(season).directions
        if directions is None:
            return STANDARD
        ways = _ways(directions)
        return Plan(tuple(TARGET_SPEED_RATIOS[i % 3] for i in range(len(ways))), ways)

    @property
    def season_ranges(self) -> list[tuple[str, tuple[int, int]]]:
        """The seasons of every profile and plan, by the name of their table."""
        plans = [("plan", plan.seasons) for plan in self.plan if plan.seasons is not None]
        return [("profile", table.seasons) for table in self.profile] + plans

    def _table(self, season: int) -> _ProfileTable:
        given = (t for t in self.profile if t.seasons[0] <= season <= t.seasons[1])
        return next(given, _NO_PROFILE)

    def _columns(self, table: _ProfileTable) -> tuple[Column, ...]:
        absent = {channel for name in table.absent for channel in MAY_BE_ABSENT[name]}
        return tuple(
            replace(
                column,
                header=table.columns.get(column.key, column.header),  # type: ignore[call-overload]
                also=(*column.also, column.header),
                unit=table.units.get(column.key, column.unit),  # type: ignore[call-overload]
                unit_given=column.key in table.units,
                reversed=column.key in table.reversed,
            )
            for column in self.named(SAMPLE_COLUMNS)
            if column.key not in absent
        )

    def reason_set_aside(self, day: dt.date) -> str | None:
        """Why a day is set aside, None when it is not."""
        return next((entry.reason for entry in self.set_aside if entry.date == day), None)

    def part_of_log(self, log: str, day: dt.date) -> int:
        """How often a log had been replaced since its season began: 0 with the first."""
        since = dt.date(day.year, 1, 1)
        replaced = (entry.date for entry in self.log_replaced if entry.log == log)
        return sum(since <= date <= day for date in replaced)
