"""From blocks to the last table, nothing makes more of the last bits than they are.

Processors differ in them (`tests/warehouse/test_other_processors.py`); here they are moved by hand.
"""

from dataclasses import fields, replace

import numpy as np
import polars as pl
import pytest

from herijk.simulate import WorldSettings, simulate_world
from pipeline.method.reading import read_shipped_method
from pipeline.recompute.recompute import recompute
from tests.numbers import unequal
from tests.pipeline.consistency_fleet import consistency_tables
from tests.worlds import measure

SETTINGS = WorldSettings((2009, 2012, 2014), 12, 10, 3)
"""The search for the log factors crosses a plateau here."""
METHODS = ("as-published", "rebased")


def everything(tows, blocks, boats):
    """All tables of the methods, and the consistency analysis of them."""
    made = [recompute(read_shipped_method(name), tows, blocks) for name in METHODS]
    names = [field.name for field in fields(made[0]) if field.name != "factors"]
    tables = {name: pl.concat([getattr(one, name) for one in made]) for name in names}
    curves, points = tables["curves"], tables["run_points"]
    return tables | consistency_tables(curves, tows, boats, points)


@pytest.fixture(scope="module")
def world():
    boats = [(b.fsn_no, b.boat_type.name) for b in simulate_world(SETTINGS).boats]
    types = pl.DataFrame(boats, schema=["fsn_no", "boat_type"], orient="row")
    measured = measure(SETTINGS)
    return measured.tows.join(types, on="fsn_no", how="left"), measured.blocks, types


def test_the_last_bits_of_the_blocks_stay_the_last_bits_of_the_tables(world):
    tows, blocks, boats = world
    rng = np.random.default_rng(1)
    moved = {
        name: values * (1.0 + 4e-16 * rng.standard_normal(values.shape))
        for name, values in blocks.sums.items()
        if name != "gps_n"
    }
    other = replace(blocks, sums={**blocks.sums, **moved})
    found, again = (everything(tows, b, boats) for b in (blocks, other))
    assert unequal(found, again) == []
    assert any(not found[name].equals(again[name]) for name in found)
