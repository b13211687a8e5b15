"""What differs from season to season in this archive: `archief.toml`.

Column names and units of the samples, sampling rate, direction of the runs, days to set aside.
Reading the samples with it belongs to `samples`.
"""

import datetime as dt
import tomllib
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Final, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator

from herijk.pipeline.channels import BACK, OUT, RUNS_PER_FILE
from herijk.pipeline.errors import DefectiveInputError, MissingKnowledgeError
from herijk.warehouse.archive.files import path_inside
from herijk.warehouse.archive.text import UNITS, Column, fold

PROFILE_FILE: Final = "archief.toml"

SAMPLE_COLUMNS: Final = (
    Column("run", "run"),
    Column("log1", "log1", "speed", "m/s"),
    Column("log2", "log2", "speed", "m/s"),
    Column("gps", "gps", "speed", "m/s", required=False),
    Column("force", "kracht", "force", "N"),
    Column("wind_speed", "wind", "speed", "m/s"),
    Column("wind_angle", "wind", "angle", "gra"),
    Column("time", "tijd", "time", "s", required=False),
)
"""The columns of a samples file unless a profile names them differently."""

Channel = Literal["run", "log1", "log2", "gps", "force", "wind_speed", "wind_angle", "time"]
_DIMENSIONS: Final = {column.key: column.dimension for column in SAMPLE_COLUMNS}


def _season_range(value: object) -> object:
    """Read `"2009:2011"` or `"2009"` as (first, last)."""
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


class _ProfileTable(_Strict):
    """One `[[profile]]` of `archief.toml`."""

    seasons: Annotated[tuple[int, int], BeforeValidator(_season_range)]
    columns: dict[Channel, Annotated[str, Field(min_length=1)]] = {}
    units: dict[Channel, str] = {}
    sample_rate_hz: Annotated[int, Field(gt=0, le=100_000)] = 1000
    directions: Annotated[
        list[Literal["out", "back"]],
        Field(min_length=RUNS_PER_FILE, max_length=RUNS_PER_FILE),
    ] = ["out", "out", "out", "back", "back", "back"]

    @model_validator(mode="after")
    def _names_and_units_are_known(self) -> "_ProfileTable":
        for channel, name in self.columns.items():
            if "[" in name:
                raise ValueError(f"columns.{channel}: '{name}' has a unit; put it under units")
        for channel, unit in self.units.items():
            known = UNITS[_DIMENSIONS[channel]]
            if fold(unit) not in known:
                raise ValueError(f"units.{channel}: [{unit}] is not one of {sorted(known)}")
        return self


class _File(_Strict):
    simulated: bool = False
    profile: list[_ProfileTable] = []
    set_aside: list[SetAside] = []
    log_replaced: list[LogReplaced] = []

    @model_validator(mode="after")
    def _one_profile_per_season(self) -> "_File":
        ranges = sorted(table.seasons for table in self.profile)
        for (_, last), (first, _) in pairwise(ranges):
            if first <= last:
                raise ValueError(f"season {first} has two profiles")
        return self


@dataclass(frozen=True)
class SeasonProfile:
    """How the samples files of one season are written.

    Attributes:
        season: the year.
        columns: the columns to look for, with name and default unit of that season.
        sample_rate_hz: samples a second where the tow list does not say.
        directions: direction of runs 1-6, `OUT` or `BACK`.
    """

    season: int
    columns: tuple[Column, ...] = SAMPLE_COLUMNS
    sample_rate_hz: int = 1000
    directions: tuple[int, ...] = (OUT, OUT, OUT, BACK, BACK, BACK)


@dataclass(frozen=True)
class Profiles:
    """`archief.toml`, read and checked; all defaults when there is none.

    Attributes:
        simulated: the archive says of itself that it was made by a simulator.
        tables: the season ranges that differ.
        set_aside: days whose tows are not used.
        log_replaced: days from which another log was on board.
    """

    simulated: bool = False
    tables: tuple[_ProfileTable, ...] = ()
    set_aside: tuple[SetAside, ...] = ()
    log_replaced: tuple[LogReplaced, ...] = ()

    def for_season(self, season: int) -> SeasonProfile:
        """Return the profile of a season; the project's default where none is given."""
        for table in self.tables:
            if table.seasons[0] <= season <= table.seasons[1]:
                return SeasonProfile(
                    season=season,
                    columns=_renamed(table),
                    sample_rate_hz=table.sample_rate_hz,
                    directions=tuple(OUT if way == "out" else BACK for way in table.directions),
                )
        return SeasonProfile(season=season)

    def reason_set_aside(self, day: dt.date) -> str | None:
        """Return why a day is set aside, None when it is not."""
        return next((entry.reason for entry in self.set_aside if entry.date == day), None)

    def part_of_log(self, log: str, day: dt.date) -> int:
        """Return how often a log had been replaced since its season began: 0 with the first."""
        since = dt.date(day.year, 1, 1)
        replaced = (entry.date for entry in self.log_replaced if entry.log == log)
        return sum(since <= date <= day for date in replaced)


def _renamed(table: _ProfileTable) -> tuple[Column, ...]:
    names: dict[str, str] = {str(key): name for key, name in table.columns.items()}
    units: dict[str, str] = {str(key): unit for key, unit in table.units.items()}
    return tuple(
        Column(
            column.key,
            names.get(column.key, column.header),
            column.dimension,
            units.get(column.key, column.unit),
            column.required,
        )
        for column in SAMPLE_COLUMNS
    )


def read_profiles(root: Path) -> Profiles:
    """Read `archief.toml` of an archive; defaults when it is absent.

    Raises:
        MissingKnowledgeError: the file cannot be understood; it names the file and the key.
    """
    try:
        path = path_inside(root, PROFILE_FILE)
        if not path.is_file():
            return Profiles()
        content: dict[str, Any] = tomllib.loads(path.read_bytes().decode("utf-8-sig"))
        parsed = _File.model_validate(content)
    except ValidationError as error:
        raise MissingKnowledgeError(f"{PROFILE_FILE}: {_explain(error)}") from error
    except DefectiveInputError as error:
        raise MissingKnowledgeError(error.message) from error
    except (ValueError, RecursionError) as error:
        raise MissingKnowledgeError(f"{PROFILE_FILE} is not valid TOML: {error}") from error
    return Profiles(
        simulated=parsed.simulated,
        tables=tuple(parsed.profile),
        set_aside=tuple(parsed.set_aside),
        log_replaced=tuple(parsed.log_replaced),
    )


def _explain(error: ValidationError) -> str:
    """Return one clause per problem, each with its key."""
    return "; ".join(
        f"{'.'.join(str(part) for part in problem['loc']) or 'file'}: "
        + ("unknown key" if problem["type"] == "extra_forbidden" else problem["msg"])
        for problem in error.errors()
    )
