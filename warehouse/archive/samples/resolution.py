"""In which steps the readings of a channel are written: 0.01 m/s, 5 N.

Coarse steps do no harm where readings are rounded, as the unrest of a run is larger. Nothing in the
samples tells whether they were rounded or cut off, which makes all of them half a step too small.
"""

from typing import Final

import numpy as np
import polars as pl

_LOOKED_AT: Final = 10_000
"""Samples that are enough to see the steps of a channel."""
_FEWEST_VALUES: Final = 3


def steps_of(samples: pl.DataFrame) -> dict[str, float | None]:
    """The least difference between two readings of the GPS and of the force.

    Args:
        samples: frame of `SAMPLE_SCHEMA`.

    Returns:
        `gps_step_m_s` and `force_step_n`; None where a channel has too few values to tell.
    """
    names = {"gps_step_m_s": "gps_m_s", "force_step_n": "force_n"}
    return {step: _least_step(samples[name]) for step, name in names.items()}


def _least_step(channel: pl.Series) -> float | None:
    values = channel.drop_nulls().to_numpy()[:: max(len(channel) // _LOOKED_AT, 1)]
    distinct = np.unique(values[np.isfinite(values)].astype(np.float64))
    if len(distinct) < _FEWEST_VALUES:
        return None
    return float(np.diff(distinct).min())
