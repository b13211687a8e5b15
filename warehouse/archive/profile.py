"""`archief.toml`: what differs in this archive, and the plan of its runs."""

import datetime as dt
import itertools
import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, Final, Literal, Self

import polars as pl
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationError,
    model_validator,
)

from pipeline.channels import (
    BACK,
    FEWEST_RUNS,
    MOST_RUNS,
    OUT,
    RUN_SECONDS,
    TARGET_SPEED_RATIOS,
)
from pipeline.crews import CREW_SCHEMA, POWER_PER_ROWER, STANDARD_CREWS
from pipeline.errors import MissingKnowledgeError
from pipeline.messages import say
from pipeline.tables.column import CREW_CLASS
from pipeline.toml_text import decode_toml, describe_problem, parse_toml
from warehouse.archive.columns import UNITS, Column, find_unit, fold, fold_word, split_header
from warehouse.archive.kinds import LIST_KINDS, SAMPLES_PLACE, FileKind, ListKind

PROFILE_FILE: Final = "archief.toml"
SAMPLE_COLUMNS: Final = (
    Column("run", "run"),
    Column("log1", "log1", "speed", "m/s"),
    Column("log2", "log2", "speed", "m/s"),
    Column("gps", "gps", "speed", "m/s", required=False),
    Column("force", "kracht", "force", "N"),
    Column("wind_speed", "wind", "speed", "m/s", also=("windsnelheid",)),
    Column("wind_angle", "wind", "angle", "gra", also=("windrichting",)),
    Column("time", "tijd", "time", "s", required=False),
)
"""The columns of a samples file unless a profile names them differently."""
MAY_BE_ABSENT: Final = {
    "log2": ("log2",),
    "gps": ("gps",),
    "wind": ("wind_speed", "wind_angle"),
    "time": ("time",),
}
"""What a season can declare absent, with the channels that go with it."""
_DIMENSIONS: Final = {column.key: column.dimension for column in SAMPLE_COLUMNS}
Channel = Literal["run", "log1", "log2", "gps", "force", "wind_speed", "wind_angle", "time"]
_WAYS: Final = {"out": OUT, "back": BACK}
OF_NO_SEASON: Final = ("boats", "acceptances")
"""Kinds of files of which an archive has one list for all seasons."""
RUN_FILES: Final = "{meetfile} run {run}"
RUN_PLACE: Final = r"\{run(?::0?([1-9]))?\}"
"""Where the number of a run stands in the name of its file; `{run:02}` is one of two digits."""
BLANK: Final = "?"
"""Stands for an answer that nobody gave yet."""


@dataclass(frozen=True)
class SeasonProfile:
    """How the samples files of one season are written.

    Attributes:
        season: the year.
        columns: the columns to look for, with name and unit of that season.
        sample_rate_hz: samples per second where the tow list does not say.
        absent: what was not on board, or is not to be used: `wind`, `log2`, `gps`, `time`.
        wind_zero_deg: what the vane reads when the wind comes from straight ahead.
        ignore: folded names of columns that are known and not used.
        hold: channels that are sampled at a slower rate, of which each value is held.
        runs: how the runs are told: by a `column`, a `file` for each, or `windows` in a recording.
        run_files: the name of the file of a run, from `{meetfile}` and `{run}`.
        groups: the groups of a TDMS file that are runs 1, 2 and on; empty for all, in their order.
        skip_below_header: lines below the header that are no samples.
    """

    season: int
    columns: tuple[Column, ...] = SAMPLE_COLUMNS
    sample_rate_hz: float = 1000.0
    absent: tuple[str, ...] = ()
    wind_zero_deg: float = 0.0
    ignore: tuple[str, ...] = ()
    hold: tuple[str, ...] = ()
    runs: Literal["column", "file", "windows"] = "column"
    run_files: str = RUN_FILES
    groups: tuple[str, ...] = ()
    skip_below_header: int = 0

    def find_header(self, key: str) -> str | None:
        """Return the header of a column without its unit; None for one that is not looked for."""
        return next((column.header for column in self.columns if column.key == key), None)

    def make_run_optional(self) -> "SeasonProfile":
        """Return the profile of files that need no column `run`."""
        columns = [
            replace(column, required=False) if column.key == "run" else column
            for column in self.columns
        ]
        return replace(self, columns=tuple(columns))

    def leave_out_run(self) -> "SeasonProfile":
        """Return the profile of files whose runs are told in another way than by a column."""
        return replace(self, columns=tuple(c for c in self.columns if c.key != "run"))

    def ask(self, key: str, blank: str = '"?"') -> str:
        """Return the lines of `archief.toml` that answer a question, with a blank."""
        return f'[[profile]]\nseasons = "{self.season}"\n{key} = {blank}'


def _parse_season_range(value: object) -> object:
    """Read `"2009:2011"` or `"2009"` as (first, last)."""
    if not isinstance(value, str):
        raise ValueError('a season range is text, e.g. "2009:2011" or "2013"')
    first, _, last = value.partition(":")
    if not (first.isascii() and first.isdigit() and (not last or last.isdigit())):
        raise ValueError(f"'{value}' is not a season range such as 2009:2011")
    if int(first) > int(last or first):
        raise ValueError(f"'{value}' ends before it begins")
    return int(first), int(last or first)


def _parse_directions(value: object) -> object:
    """Read `["out", "back"]` as `OUT` and `BACK`."""
    if not isinstance(value, list) or not set(map(str, value)) <= set(_WAYS):
        raise ValueError('directions are a list of "out" and "back"')
    return list(map(_WAYS.__getitem__, value))


def _refuse_descending_range(ends: tuple[float, float]) -> tuple[float, float]:
    if ends[0] >= ends[1]:
        raise ValueError("a range is its lower end, then its upper end")
    return ends


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


_Text = Annotated[str, Field(min_length=1)]
_Seasons = Annotated[tuple[int, int], BeforeValidator(_parse_season_range)]
_Directions = Annotated[
    list[int],
    BeforeValidator(_parse_directions),
    Field(min_length=FEWEST_RUNS, max_length=MOST_RUNS),
]
_Number = Annotated[float, Field(gt=0, strict=False)]
_Range = Annotated[
    tuple[_Number, _Number], Field(strict=False), AfterValidator(_refuse_descending_range)
]
_Folded = Annotated[list[str], AfterValidator(lambda names: list(map(fold, names)))]


def make_pattern(place: str) -> re.Pattern[str]:
    """Return the pattern of a folder or name; its group `year` is the season, where it has one."""
    text = re.escape(place).replace(r"\{name\}", ".+").replace(r"\{year\}", "(?P<year>[0-9]{4})", 1)
    return re.compile(text, re.IGNORECASE)


class SetAside(_Strict):
    """A day whose tows are not used, and why."""

    date: dt.date
    reason: _Text


class LogReplaced(SetAside):
    """The first day on which another log was on board than before, within a season."""

    log: Literal["log1", "log2"]


class _ProfileTable(_Strict):
    """One `[[profile]]`: how the samples of some seasons are written."""

    seasons: _Seasons
    columns: dict[Channel, _Text] = {}
    units: dict[Channel, str] = {}
    sample_rate_hz: Annotated[float, Field(ge=1, le=100_000, strict=False)] = 1000.0
    hold: list[Literal["log1", "log2", "gps", "force", "wind_speed", "wind_angle"]] = []
    runs: Literal["column", "file", "windows"] = "column"
    run_files: Annotated[str, Field(pattern=RUN_PLACE)] = RUN_FILES
    groups: Annotated[list[_Text], Field(max_length=MOST_RUNS)] = []
    skip_below_header: Annotated[int, Field(ge=0, le=100, strict=False)] = 0
    absent: list[Literal["log2", "gps", "wind", "time"]] = []
    reversed: list[Literal["force"]] = []
    wind_zero_deg: Annotated[float, Field(ge=-360, le=360, strict=False)] = 0.0
    ignore: _Folded = []

    @model_validator(mode="after")
    def _units_are_known(self) -> Self:
        for channel, unit in self.units.items():
            if find_unit(_DIMENSIONS[channel], unit) is None:
                known = ", ".join(UNITS[_DIMENSIONS[channel]])
                raise ValueError(f"units.{channel}: [{unit}] is not one of {known}")
        return self

    def merge(self, other: "_ProfileTable", season: int) -> "_ProfileTable":
        """Return the settings of two tables for one season.

        Raises:
            ValueError: they differ in a setting.
        """
        values = {name: getattr(self, name) for name in self.model_fields_set}
        for name in other.model_fields_set - {"seasons"}:
            theirs, mine = getattr(other, name), values.get(name)
            if mine is None:
                values[name] = theirs
            elif isinstance(mine, dict):
                twice = [key for key in mine.keys() & theirs.keys() if mine[key] != theirs[key]]
                if twice:
                    raise ValueError(f"season {season} has two values for {name}.{twice[0]}")
                values[name] = mine | theirs
            elif isinstance(mine, list) and name != "groups":
                values[name] = list(dict.fromkeys(mine + theirs))
            elif mine != theirs:
                raise ValueError(f"season {season} has two values for {name}")
        return _ProfileTable.model_construct(**values)

    def apply_to(self, column: Column) -> Column:
        """Return a column with the name and the unit that it has in these seasons."""
        key: Channel = column.key  # type: ignore[assignment]
        return replace(
            column,
            header=self.columns.get(key, column.header),
            also=column.also + (column.header,),
            unit=self.units.get(key, column.unit),
            reversed=key in self.reversed,
            is_unit_declared=key in self.units,
        )


class Plan(_Strict):
    """One `[[plan]]`: the runs that the tows of some seasons, or some tows, are meant to have.

    Attributes:
        targets: intended speed / declared speed of each run.
        directions: `OUT` or `BACK`, of each run.
        seconds: how long a run is meant to last.
        second_directions: of the runs of a second file, where these belong to the tow; empty where
            a second file is another tow, of which the list names the runs to use.
    """

    seasons: _Seasons | None = None
    tows: list[str] = []
    targets: Annotated[
        list[Annotated[float, Field(ge=0.3, le=2.0, strict=False)]],
        Field(min_length=FEWEST_RUNS, max_length=MOST_RUNS),
    ] = list(TARGET_SPEED_RATIOS + TARGET_SPEED_RATIOS)
    directions: _Directions = [OUT, OUT, OUT, BACK, BACK, BACK]
    seconds: Annotated[float, Field(ge=5, le=600)] = RUN_SECONDS
    second_directions: _Directions | None = None

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
    def runs(self) -> range:
        """Numbers of the runs."""
        return range(1, len(self.targets) + 1)


STANDARD: Final = Plan.model_construct()


class CrewClass(_Strict):
    """One `[[crew]]`: a class of crews, and what its power and weight are held to.

    Attributes:
        code: as lists have it.
        name: what its people are called.
        power_w: range of the power per rower at a realistic tow speed.
        slow_w: power under which a tow is too slow; without it no tow is.
        race_w: power that a race takes at least; without it none is looked for.
        rower_kg: range of the weight of a rower; without it no crew is too light or too heavy.
    """

    code: Annotated[str, Field(pattern=CREW_CLASS)]
    name: _Text
    power_w: _Range
    slow_w: _Number | None = None
    race_w: _Number | None = None
    rower_kg: _Range | None = None

    def to_row(self, handicap: str) -> dict[str, object]:
        """Return the class as a row of `crew_classes`."""
        lightest, heaviest = self.rower_kg or (None, None)
        return {
            "crew_class": self.code,
            "name": self.name,
            "lowest_power_w": self.power_w[0],
            "highest_power_w": self.power_w[1],
            "slow_power_w": self.slow_w,
            "raced_power_w": self.race_w,
            "lightest_rower_kg": lightest,
            "heaviest_rower_kg": heaviest,
            "handicap": handicap,
        }


class Publication(_Strict):
    """Who publishes what is made from the archive, and what others may do with it."""

    publisher: _Text | None = None
    licence: Annotated[str, Field(pattern=r"^([A-Za-z0-9.+-]+|https?://\S+)$")] | None = None


class Profiles(_Strict):
    """`archief.toml`, checked; all defaults when there is none.

    Attributes:
        simulated: the archive says of itself that it was made by a simulator.
        publication: publisher and licence of what is made from it.
        profile: the season ranges that differ.
        plan: the runs of seasons and tows that differ from the standard.
        words: the value that a word in a cell stands for; empty text for nothing.
        headers: the name of a column in `docs/archive.md`, by the name that lists have for it.
        ignore: names of columns of lists, and of files, that are known and not used.
        languages: of the site; the pages of the first lie at its root.
        number_prefix: stands before the number of a boat, also where a list leaves it out.
        crew: the classes of crews; without any, those of the Dutch federation.
        handicap: formula by which races are ranked.
        files: folder and name of each kind of file that has others than `docs/archive.md` says.
        set_aside: days whose tows are not used.
        log_replaced: days from which another log was on board.
    """

    simulated: bool = False
    publication: Publication = Publication()
    profile: list[_ProfileTable] = []
    plan: list[Plan] = []
    words: dict[str, str] = {}
    headers: dict[str, str] = {}
    ignore: _Folded = []
    languages: Annotated[list[Literal["nl", "en"]], Field(min_length=1)] = ["nl", "en"]
    number_prefix: Annotated[str, Field(pattern="^[A-Z]*$")] = "FSN"
    crew: list[CrewClass] = []
    handicap: Literal["power_per_rower", "time_on_time"] = POWER_PER_ROWER
    files: dict[FileKind, _Text] = {}
    set_aside: list[SetAside] = []
    log_replaced: list[LogReplaced] = []

    @model_validator(mode="after")
    def _settings_agree(self) -> Self:
        for place, one in enumerate(self.profile):
            for other in self.profile[:place]:
                season = max(one.seasons[0], other.seasons[0])
                if season <= min(one.seasons[1], other.seasons[1]):
                    one.merge(other, season)
        return self

    @model_validator(mode="after")
    def _files_can_be_told_apart(self) -> Self:
        for kind, place in self.files.items():
            parts = place.count("/") + 1
            if parts != (1 if kind == "samples" else 2):
                raise ValueError(
                    f"files.{kind}: '{place}' is not a folder" + (" and a name") * (parts == 1)
                )
            if ("{year}" in place) == (kind in OF_NO_SEASON):
                need = "must not" if kind in OF_NO_SEASON else "must"
                raise ValueError(f"files.{kind}: '{place}' {need} have {{year}} in it")
        for one, other in itertools.permutations(LIST_KINDS, 2):
            place = self.find_place(other)
            file = place.replace("{year}", "2000").replace("{name}", "name")
            if make_pattern(self.find_place(one)).fullmatch(file):
                raise ValueError(f"files: '{place}' can be {one.name} and {other.name}")
        return self

    @model_validator(mode="after")
    def _classes_differ(self) -> Self:
        codes = [crew.code for crew in self.crew]
        if len(codes) > len(set(codes)):
            raise ValueError("two [[crew]] have one code")
        return self

    def find_place(self, kind: ListKind) -> str:
        """Return folder and name of a kind of list, with `{year}` for the season."""
        return self.files.get(kind.name, kind.place)

    @property
    def samples_place(self) -> str:
        """Folder of the samples of a season, with `{year}` for it."""
        return self.files.get("samples", SAMPLES_PLACE)

    @cached_property
    def crew_classes(self) -> pl.DataFrame:
        """The table `crew_classes`."""
        if not self.crew:
            return STANDARD_CREWS.with_columns(handicap=pl.lit(self.handicap))
        return pl.DataFrame([crew.to_row(self.handicap) for crew in self.crew], CREW_SCHEMA)

    @cached_property
    def meaning(self) -> dict[str, str]:
        """What a folded word in a cell stands for."""
        return {fold_word(word): meant for word, meant in self.words.items()}

    @cached_property
    def whole_headers(self) -> dict[str, str]:
        """The name with its unit that stands for a folded header, where a unit is given."""
        return {fold(name): meant for name, meant in self.headers.items() if "[" in meant}

    def rename_columns(self, columns: Iterable[Column]) -> tuple[Column, ...]:
        """Return the columns of a list with the other names that they have in this archive."""
        names_of: dict[str, list[str]] = {}
        for name, meant in self.headers.items():
            header, _ = split_header(meant)
            names_of.setdefault(header, []).append(name)
        renamed = []
        for column in columns:
            own = names_of.get(fold(column.header), []) + names_of.get(fold(column.key), [])
            if not own:
                renamed.append(column)
                continue
            also = column.also + (column.header, column.key) + tuple(own)
            without_unit = [name for name in own if "[" not in self.headers[name]]
            header = without_unit[0] if without_unit else column.header
            renamed.append(replace(column, header=header, also=also))
        return tuple(renamed)

    @cached_property
    def _season_profiles(self) -> dict[int, SeasonProfile]:
        return {}

    def find(self, season: int) -> SeasonProfile:
        """Return the profile of a season; the project's default where none is given."""
        if season not in self._season_profiles:
            table = _ProfileTable(seasons=f"{season}")  # type: ignore[arg-type]
            for given in self.profile:
                if given.seasons[0] <= season <= given.seasons[1]:
                    table = table.merge(given, season)
            absent: set[str] = set()
            for name in table.absent:
                absent.update(MAY_BE_ABSENT[name])
            columns = [table.apply_to(one) for one in SAMPLE_COLUMNS if one.key not in absent]
            self._season_profiles[season] = SeasonProfile(
                season=season,
                columns=tuple(columns),
                sample_rate_hz=table.sample_rate_hz,
                absent=tuple(sorted(table.absent)),
                wind_zero_deg=table.wind_zero_deg,
                ignore=tuple(self.ignore + table.ignore),
                hold=tuple(table.hold),
                runs=table.runs,
                run_files=table.run_files,
                groups=tuple(table.groups),
                skip_below_header=table.skip_below_header,
            )
        return self._season_profiles[season]

    def find_plan(self, tow_id: str, season: int) -> Plan:
        """Return the plan of a tow: its own, that of its season, or the standard."""
        for plan in self.plan:
            if tow_id in plan.tows:
                return plan
        for plan in self.plan:
            if plan.seasons and plan.seasons[0] <= season <= plan.seasons[1]:
                return plan
        return STANDARD

    def find_reason_set_aside(self, day: dt.date) -> str | None:
        """Return why a day is set aside; None if it is not."""
        for entry in self.set_aside:
            if entry.date == day:
                return entry.reason
        return None

    def count_log_changes(self, log: str, day: dt.date) -> int:
        """Return how often a log had been replaced in its season up to a day."""
        first_day = dt.date(day.year, 1, 1)
        return sum(
            entry.log == log and first_day <= entry.date <= day for entry in self.log_replaced
        )


def read_profiles(root: Path) -> Profiles:
    """Read `archief.toml` of an archive; defaults when it is absent.

    Raises:
        MissingKnowledgeError: the file cannot be understood; it names the file and the key.
    """
    path = root / PROFILE_FILE
    if not path.exists() and not path.is_symlink():
        return Profiles()
    if not path.is_file():
        raise MissingKnowledgeError("{} is no file; remove it, or put the file there", path)
    try:
        return parse_profiles(decode_toml(path.read_bytes()))
    except ValueError as error:
        raise MissingKnowledgeError("{} is not valid TOML: {}", PROFILE_FILE, error) from error


def parse_profiles(text: str) -> Profiles:
    """Read the text of an `archief.toml`.

    Raises:
        MissingKnowledgeError: it cannot be understood; the message names the key.
    """
    try:
        table = parse_toml(text)
        blank = _find_blank(table)
        if blank is not None:
            raise MissingKnowledgeError("{}: '{}' has no answer yet: replace the ?.",
                                        PROFILE_FILE, blank)  # fmt: skip
        return Profiles.model_validate(table)
    except ValidationError as error:
        said = None
        for problem in error.errors(include_input=False):
            key = ".".join(map(str, problem["loc"])) or "file"
            clause = say("{}: {}", f"'{key}'", describe_problem(problem))
            said = clause if said is None else say("{}; {}", said, clause)
        raise MissingKnowledgeError("{}: {}", PROFILE_FILE, said) from error
    except ValueError as error:
        raise MissingKnowledgeError("{} is not valid TOML: {}", PROFILE_FILE, error) from error


def _find_blank(value: object, name: str = "") -> str | None:
    """Return the name of the first value that is still the blank of a question."""
    if value == BLANK:
        return name
    inner: Iterable[tuple[object, object]] = ()
    if isinstance(value, dict):
        inner = value.items()
    elif isinstance(value, list):
        inner = ((None, one) for one in value)
    for key, one in inner:
        found = _find_blank(one, name if key is None else f"{name}.{key}".lstrip("."))
        if found is not None:
            return found
    return None
