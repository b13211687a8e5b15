"""The samples of a tow as the lake keeps them. A changed byte here reads all samples again."""

from pathlib import Path

import polars as pl

from pipeline.tables.row import Row
from warehouse.archive import SeasonProfile, judge_samples, read_tow_samples
from warehouse.archive.samples import measure_steps


def read_samples(
    root: Path, tow: Row, runs: pl.DataFrame, profile: SeasonProfile
) -> tuple[pl.DataFrame, Row]:
    """Return the samples of a tow, and the facts about them that the table `samples` holds.

    Args:
        root: the archive.
        tow: row of `listed_tows`.
        runs: its rows of `listed_runs`.
        profile: how files of its season are written.

    Raises:
        DefectiveInputError: no run of the tow can be used.
    """
    whole, place, defects = read_tow_samples(root, tow, profile)
    samples, faults = judge_samples(whole, place, tow, runs, defects)
    facts = {
        "losses": [fault.to_row() for fault in faults],
        "wind_read": samples["wind_speed_m_s"].null_count() == 0,
        **measure_steps(samples),
    }
    return samples.select(pl.lit(tow["tow_id"]).alias("tow_id"), pl.all()), facts
