"""How the samples files of one season are written, and the runs that a tow is meant to have."""

from dataclasses import dataclass
from typing import Final

from pipeline.channels import BACK, OUT, RUN_SECONDS, TARGET_SPEED_RATIOS
from warehouse.archive.spelling.columns import Column

SAMPLE_COLUMNS: Final = (
    Column("run", "run", required=False),
    Column("log1", "log1", "speed", "m/s"),
    Column("log2", "log2", "speed", "m/s"),
    Column("gps", "gps", "speed", "m/s", required=False),
    Column("force", "kracht", "force", "N"),
    Column("wind_speed", "wind", "speed", "m/s"),
    Column("wind_angle", "wind", "angle", "gra"),
    Column("time", "tijd", "time", "s", required=False),
)
"""The columns of a samples file unless a profile names them differently.

Where there is no `run` every file, sheet or segment is a run.
"""
MAY_BE_ABSENT: Final = {
    "log2": ("log2",),
    "gps": ("gps",),
    "wind": ("wind_speed", "wind_angle"),
}
"""What a season can declare absent, with the channels that go with it."""


@dataclass(frozen=True)
class SeasonProfile:
    """How the samples files of one season are written.

    Attributes:
        season: the year.
        columns: the columns to look for, with name and default unit of that season.
        sample_rate_hz: samples per second where the tow list does not say.
        absent: what was not on board, or is not to be used: `wind`, `log2`, `gps`.
        wind_zero_deg: what the vane reads when the wind comes from straight ahead.
        header: the names of the columns of files that have none.
        header_lines: the first and the last line of the header; found when None.
        ignore: names of columns that are known and not used.
    """

    season: int
    columns: tuple[Column, ...] = SAMPLE_COLUMNS
    sample_rate_hz: int = 1000
    absent: tuple[str, ...] = ()
    wind_zero_deg: float = 0.0
    header: str | None = None
    header_lines: tuple[int, int] | None = None
    ignore: tuple[str, ...] = ()


@dataclass(frozen=True)
class Plan:
    """The runs that a tow is meant to have.

    Attributes:
        targets: intended speed / declared speed of each run.
        directions: `OUT` or `BACK`, of each run.
        seconds: how long a run is meant to last.
        second_directions: of the runs of a second file, where these belong to the tow; empty where
            a second file is another tow, of which the list names the runs to use.
    """

    targets: tuple[float, ...] = TARGET_SPEED_RATIOS * 2
    directions: tuple[int, ...] = (OUT, OUT, OUT, BACK, BACK, BACK)
    seconds: float = RUN_SECONDS
    second_directions: tuple[int, ...] = ()

    @property
    def runs(self) -> range:
        """Numbers of the runs."""
        return range(1, len(self.targets) + 1)


STANDARD: Final = Plan()
