"""In which steps a channel is written."""

import numpy as np
import polars as pl
import pytest

from warehouse.archive.samples import measure_steps

RNG = np.random.default_rng(1)
SPEED = 2.5 + 0.2 * RNG.standard_normal(5_000)
FORCE = 250.0 + 20.0 * RNG.standard_normal(5_000)


def samples(gps: np.ndarray | None, force: np.ndarray) -> pl.DataFrame:
    columns = {"gps_m_s": gps, "force_n": force}
    return pl.DataFrame(
        [
            pl.Series(name, [None] * len(force) if values is None else values, pl.Float32)
            for name, values in columns.items()
        ]
    )


@pytest.mark.parametrize("step", [0.01, 0.1])
@pytest.mark.parametrize("spell", [np.floor, np.round])
def test_the_step_is_seen_whether_rounded_or_cut_off(step, spell):
    gps = spell(SPEED / step) * step
    assert measure_steps(samples(gps, FORCE))["gps_step_m_s"] == pytest.approx(step, rel=1e-4)


def test_samples_left_out_and_a_channel_that_is_not_there_tell_nothing():
    gaps = np.where(np.arange(len(FORCE)) % 3 == 0, np.nan, np.floor(FORCE / 5) * 5)
    found = measure_steps(samples(None, gaps))
    assert found == {"gps_step_m_s": None, "force_step_n": 5.0}
    assert measure_steps(samples(np.full(len(FORCE), 2.5), FORCE))["gps_step_m_s"] is None
