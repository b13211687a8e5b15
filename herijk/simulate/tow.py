"""The samples of one tow: motion and instruments put together as a samples frame.

What holds for a whole tow is decided in `world`, what happens in its runs in `motion`, what is
read in `instruments`.
"""

from dataclasses import replace

import numpy as np
import polars as pl

from herijk.simulate.defects import FIRST_GPS_SEASON
from herijk.simulate.instruments import (
    Samples,
    damage,
    read_anemometer,
    read_gps,
    read_load_cell,
    read_logs,
)
from herijk.simulate.motion import RunTruth, simulate_runs
from herijk.simulate.random_streams import Component, Subject, TowStreams
from herijk.simulate.world import Tow, World
from pipeline.channels import RUN_SECONDS, SAMPLE_SCHEMA, SECOND_FILE_OFFSET


def simulate_tow(world: World, tow: Tow) -> tuple[pl.DataFrame, tuple[RunTruth, ...]]:
    """Tow a boat and read the instruments.

    Returns:
        A samples frame with exactly the columns of `SAMPLE_SCHEMA`, six runs of 50 s at the
        world's rate, and the truth of the six runs. Of a tow with a second file, six runs more,
        numbered from `SECOND_FILE_OFFSET` on.
    """
    if tow.truth.second_log_factor is None:
        return _simulate_file(world, tow, Subject.TOW)
    first, runs = _simulate_file(world, tow, Subject.TOW)
    other_log = replace(tow.truth, log_factor=tow.truth.second_log_factor)
    second, more = _simulate_file(world, replace(tow, truth=other_log), Subject.SECOND_FILE)
    later = pl.col("run") + pl.lit(SECOND_FILE_OFFSET, pl.Int8)
    renumbered = (replace(run, run=run.run + SECOND_FILE_OFFSET) for run in more)
    return pl.concat([first, second.with_columns(later)]), (*runs, *renumbered)


def _simulate_file(
    world: World, tow: Tow, subject: Subject
) -> tuple[pl.DataFrame, tuple[RunTruth, ...]]:
    defects = world.settings.defects(tow.season)
    streams = TowStreams(world.settings.seed, tow.season, tow.number, subject)
    runs = simulate_runs(tow, defects, streams)
    count = round(RUN_SECONDS * world.settings.rate_hz)
    time_s = np.arange(count) / world.settings.rate_hz
    channels: dict[str, list[Samples]] = {name: [] for name in SAMPLE_SCHEMA}
    for run in runs:
        log1, log2 = read_logs(time_s, run, tow, defects, streams)
        force = read_load_cell(
            time_s, run, tow, defects=defects, air=world.settings.air, streams=streams
        )
        damage(force, log1, defects, streams[Component.DAMAGE])
        channels["run"].append(np.full(count, run.truth.run, dtype=np.float32))
        channels["log1_m_s"].append(log1)
        channels["log2_m_s"].append(log2)
        if tow.season >= FIRST_GPS_SEASON:
            channels["gps_m_s"].append(read_gps(time_s, run, defects, streams))
        channels["force_n"].append(force)
        wind_speed, wind_angle = read_anemometer(time_s, run, defects, streams)
        channels["wind_speed_m_s"].append(wind_speed)
        channels["wind_angle_deg"].append(wind_angle)
    columns = [
        pl.Series(name, np.concatenate(parts)).cast(SAMPLE_SCHEMA[name])
        if parts
        else pl.Series(name, [None]).cast(SAMPLE_SCHEMA[name]).new_from_index(0, count * len(runs))
        for name, parts in channels.items()
    ]
    return pl.DataFrame(columns), tuple(run.truth for run in runs)
