"""From a window to a run point: which log counts, estimators, and corrections without weights."""

import numpy as np
import polars as pl
import pytest

from herijk.simulate import Defects, WorldSettings
from pipeline.blocks.batch import Batch
from pipeline.steps.resistance import (
    OverWindow,
    run_means,
    temperature_change_kg_m,
)
from tests.pipeline.methods import method
from tests.worlds import measure


def batch_of(defects: Defects, **columns: pl.Expr) -> Batch:
    measured = measure(WorldSettings((2015,), 6, 20, 5, defects=lambda season: defects))
    return Batch.of(measured.tows.with_columns(**columns), measured.blocks)


def means(batch: Batch, **steps: str):
    sums = OverWindow.of(batch.blocks, batch.blocks.n > 0)
    return run_means(batch, sums, method(**steps).for_season(2015))


def test_an_empty_window_gives_zero_not_nan():
    batch = batch_of(Defects(wind_m_s=4.0))
    nothing = np.zeros(batch.blocks.n.shape, dtype=bool)
    for estimator in ("mean_of_ratios", "ratio_of_means"):
        steps = method(
            run_point=f'{{ estimator = "{estimator}", inertia = "end_speeds" }}',
            wind='{ model = "oblique", averaging_s = 5 }',
        ).for_season(2015)
        found = run_means(batch, OverWindow.of(batch.blocks, nothing), steps)
        for values in (found.speed_m_s, found.gross_kg_m, found.inertia_kg_m, found.air.ahead):
            assert np.array_equal(values, np.zeros(36))


@pytest.mark.parametrize("missing", ["weight_kg", "crew_weight_kg", "water_temperature_c"])
def test_what_is_not_known_is_not_corrected_and_said(missing):
    cold = Defects(water_temperature_c=(4.0, 4.0))
    unknown = pl.when(pl.col("tow_id") == "2015-002").then(None).otherwise(missing)
    batch = batch_of(cold, **{missing: unknown})
    rule = method(temperature='{ rule = "ittc57" }').for_season(2015)
    change, known = temperature_change_kg_m(batch, rule, np.full(36, 2.5))
    assert known.tolist() == [True, False, True, True, True, True]
    assert (change[batch.tow == 1] == 0.0).all()
    assert (change[batch.tow != 1] < 0.0).all()  # warmer water has less friction
