"""Members of a register: as uncertain as the budget says, and together where tows share errors."""

import numpy as np
import polars as pl
import pytest

from herijk.simulate import WorldSettings
from pipeline.method.reading import read_shipped_method
from pipeline.recompute.recompute import recompute
from pipeline.uncertainty import ensemble
from tests.worlds import measure

MANY = 20_000


@pytest.fixture(scope="module")
def made():
    world = measure(WorldSettings((2010, 2012, 2015), 12, 10, 3))
    return recompute(read_shipped_method("rebased"), world.tows, world.blocks, with_bands=False)


@pytest.fixture(scope="module")
def lines(made):
    """The newest tow of each boat, with its standard uncertainty."""
    square = pl.col("u_ratio") ** 2
    total = made.uncertainty_budget.group_by("tow_id").agg(u_ratio=square.sum().sqrt())
    newest = made.curves.drop_nulls("cw_kg_m").sort("tow_id").unique("fsn_no", keep="last")
    return newest.sort("tow_id").join(total, on="tow_id", maintain_order="left")


def errors(made, tows, members=ensemble.MEMBERS):
    held = made.uncertainty_budget.join(tows, on="tow_id", how="semi", maintain_order="left")
    return ensemble.draw_ln_errors(tows["tow_id"], held, made.factors, members)


def test_members_spread_as_the_budget_says(made, lines):
    drawn = errors(made, lines).T / lines["u_ratio"].to_numpy()
    # Four standard errors of a deviation and of a mean, from 200 members.
    assert drawn.shape == (200, lines.height)
    assert np.abs(drawn.std(axis=0, ddof=1) - 1).max() < 4 / np.sqrt(2 * 199)
    assert np.abs(drawn.mean(axis=0)).max() < 4 / np.sqrt(200)


def test_tows_of_one_season_err_together_as_far_as_they_share(made, lines):
    two = lines.filter(season=2010).head(2)
    one, other = (made.uncertainty_budget.filter(tow_id=tow_id) for tow_id in two["tow_id"])
    shared = one.join(other, on="key")
    together = (shared["effect_ratio"] * shared["effect_ratio_right"]).sum()
    expected = together / two["u_ratio"].product()
    assert expected > 0.05
    correlation = np.corrcoef(errors(made, two, MANY))[0, 1]
    assert correlation == pytest.approx(expected, abs=4 / np.sqrt(MANY))


def test_a_line_keeps_its_members_when_others_go(made, lines):
    assert errors(made, lines.head(3)) == pytest.approx(errors(made, lines)[:3])


def test_members_lie_around_the_number_of_the_register(made, lines):
    """As wide as its interval: half as wide for a best estimate with half the interval."""
    cw = pl.col("cw_kg_m")
    measured, ruled = (
        lines.with_columns(level, cw_lo_kg_m=level * np.exp(-half), cw_hi_kg_m=level * np.exp(half))
        for level, half in ((cw, 0.04), (cw * 0.97, 0.02))
    )
    of_own, of_best = (
        ensemble.draw_ensemble("rebased", measured, used, made.uncertainty_budget, made.factors)
        .group_by("tow_id", maintain_order=True)
        .agg(middle=cw.log().mean(), sd=cw.log().std())
        .join(measured, on="tow_id", maintain_order="left")
        .with_columns(pl.col("middle") - cw.log())
        for used in (measured, ruled)
    )
    assert (of_best["sd"] / of_own["sd"]).to_list() == pytest.approx([0.5] * lines.height)
    expected = 0.5 * of_own["middle"] + np.log(0.97)
    assert of_best["middle"].to_list() == pytest.approx(expected.to_list())
