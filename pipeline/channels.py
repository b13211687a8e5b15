"""The channels of a samples frame and the run numbers of a tow: names, dtypes and meaning.

A samples frame has one row per sample, in the order measured, with the columns of
`SAMPLE_SCHEMA`. `gps_m_s` is null throughout where no GPS was on board. The wind is apparent
(felt on the moving boom), 0 degrees from straight ahead, clockwise, in [0, 360).
"""

from typing import Final

import polars as pl

SAMPLE_SCHEMA: Final[dict[str, pl.DataType]] = {
    "run": pl.Int8(),
    "log1_m_s": pl.Float32(),
    "log2_m_s": pl.Float32(),
    "gps_m_s": pl.Float32(),
    "force_n": pl.Float32(),
    "wind_speed_m_s": pl.Float32(),
    "wind_angle_deg": pl.Float32(),
}

RUNS_PER_FILE: Final = 6
"""Runs of a tow by the standard plan."""

FEWEST_RUNS: Final = 3
MOST_RUNS: Final = 20
"""Runs that a plan may have."""

SECOND_FILE_OFFSET: Final = 20
"""Run 1 of `meetfile2` is numbered 21, so that run numbers stay unique within a tow."""

OUT: Final = 1
BACK: Final = -1

RUN_SECONDS: Final = 50.0
"""Length of a run as prescribed (Sleepproef, R. Pot 2017, "6 Runs")."""

TARGET_SPEED_RATIOS: Final = (0.9, 1.0, 1.1)
"""Intended speeds of runs 1-3 and again 4-6, relative to the declared speed (same source)."""
