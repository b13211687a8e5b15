"""The finding of 2015, from simulated samples to the figures of the tables, on two histories.

Among like boats Cw at one speed follows weight and B does not; tows of 2009-2011 stand apart until
their logs are corrected.
"""

import numpy as np
import polars as pl
import pytest

from herijk.simulate import WorldSettings, simulate_world
from pipeline.consistency.observed import observe
from pipeline.consistency.repeats import era_shifts, repeat_pairs
from pipeline.consistency.types import compare_types
from pipeline.method.reading import read_shipped_method
from pipeline.recompute.recompute import recompute
from tests.worlds import measure

pytestmark = pytest.mark.slow

SEEDS = (1, 2)
PAIR = ("Kromhoutwhaler", "Kuikensloep")
BEFORE, AFTER = "as-published", "rebased"


@pytest.fixture(scope="module")
def histories():
    """Verdicts and shifts of ten seasons of 24 tows, with the season log factors that are true."""
    found = []
    for seed in SEEDS:
        settings = WorldSettings(rate_hz=10, seed=seed)
        world, measured = simulate_world(settings), measure(settings)
        made = [
            recompute(read_shipped_method(m), measured.tows, measured.blocks)
            for m in (BEFORE, AFTER)
        ]
        curves, points = (pl.concat(getattr(m, n) for m in made) for n in ("curves", "run_points"))
        types = [{"fsn_no": b.fsn_no, "boat_type": b.boat_type.name or None} for b in world.boats]
        boats = pl.DataFrame(types, infer_schema_length=None)
        pairs = repeat_pairs(curves, measured.tows)
        verdicts = compare_types(observe(curves, measured.tows, boats, points), pairs).consistency
        shifts = era_shifts(pairs, boats).filter(era="2009-2011")
        found.append((verdicts, shifts, world.season_log_factors))
    return found


def test_cw_at_one_speed_follows_weight_and_b_does_not(histories):
    for verdicts, *_ in histories:
        rows = verdicts.filter(pl.col("boat_type").is_in(PAIR), method=AFTER)
        cw, b = (rows.filter(quantity=name) for name in ("cw_standard_kg_m", "b_m_s"))
        assert set(cw["weight_verdict"]) == {"rises"}
        assert "rises" not in b["weight_verdict"]
        assert (b["weight_slope"].abs() < cw["weight_slope"]).all()
        assert "differ" not in b["verdict"]


@pytest.mark.parametrize("boat_type", [*PAIR, "all"])
def test_seasons_2009_to_2011_stand_apart_until_they_are_corrected(histories, boat_type):
    for _, shifts, _ in histories:
        before, after = (
            shifts.filter(method=method, boat_type=boat_type).row(0, named=True)
            for method in (BEFORE, AFTER)
        )
        assert before["apart"]
        assert not after["apart"]
        assert before["hi"] < min(0.95, after["lo"])


def test_the_shift_before_correction_is_that_of_the_true_factors(histories):
    # A speed error e changes Cw by (2 + 2 q) e, q from 0.3 to 0.6 (docs/simulator.md); logs of the
    # later seasons are right within 1 %.
    for _, shifts, factors in histories:
        true = np.log([factors[season] for season in (2009, 2010, 2011)])
        row = shifts.filter(method=BEFORE, boat_type="all").row(0, named=True)
        assert np.log(row["lo"]) < -2.6 * (true.min() - 0.01)
        assert np.log(row["hi"]) > -3.2 * (true.max() + 0.01)
