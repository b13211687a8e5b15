"""Members of a register: as uncertain as the budget says, and together where tows share errors."""

import numpy as np
import polars as pl
import pytest

from pipeline.uncertainty import ensemble
from pipeline.uncertainty import propagation as uncertainty
from tests.pipeline.season_worlds import HARD, register, simulate

MANY = 20_000


@pytest.fixture(scope="module")
def world():
    return simulate(HARD, 1)


@pytest.fixture(scope="module")
def drawn(world):
    found, lines, held = register(world)
    errors = ensemble.ln_errors(lines["tow_id"], held, found)
    return found, lines, held, lines["cw_kg_m"].to_numpy() * np.exp(errors.T)


def of_tows(world, tow_ids):
    return pl.DataFrame({"tow_id": tow_ids, "cw_kg_m": np.linspace(30, 50, len(tow_ids))})


def test_members_spread_as_the_budget_says(drawn):
    _, lines, held, members = drawn
    u = lines.join(uncertainty.combine(held), on="tow_id", maintain_order="left")["u_ratio"]
    ratio = np.log(members).std(axis=0, ddof=1) / u.to_numpy()
    assert members.shape == (200, lines.height)
    # Four standard errors of a deviation from 200 members.
    assert np.abs(ratio - 1).max() < 4 / np.sqrt(2 * 199)
    centre = np.log(members).mean(axis=0) - np.log(lines["cw_kg_m"].to_numpy())
    assert np.abs(centre / u.to_numpy()).max() < 4 / np.sqrt(200)


def test_tows_of_one_season_err_together_as_far_as_they_share(world):
    found, _, held = register(world)
    lines = of_tows(world, world.tows.filter(pl.col("season") == 2010)["tow_id"][:2].to_list())
    errors = ensemble.ln_errors(lines["tow_id"], held, found, MANY)
    total = lines.join(uncertainty.combine(held), on="tow_id", maintain_order="left")
    of_both = uncertainty.combine(held.filter(pl.col("shared") != "single"))
    shared = lines.join(of_both, on="tow_id", maintain_order="left")["u_ratio"]
    expected = shared.product() / total["u_ratio"].product()
    correlation = np.corrcoef(errors)[0, 1]
    assert expected > 0.05
    assert correlation == pytest.approx(expected, abs=4 / np.sqrt(MANY))


def test_a_line_keeps_its_members_when_others_go(drawn):
    found, lines, held, members = drawn
    kept = lines.head(3)
    mine = held.filter(pl.col("tow_id").is_in(kept["tow_id"].implode()))
    again = ensemble.ln_errors(kept["tow_id"], mine, found)
    assert pytest.approx(np.log(members[:, :3] / kept["cw_kg_m"].to_numpy())) == again.T


def test_who_is_heavier_is_told_apart_by_what_is_not_shared():
    """Two tows that share a large error: as good as certain which is heavier."""
    tows, ln_cw = pl.Series(["a", "b"]), np.log([[40.0], [40.4]])
    held = pl.DataFrame(
        {
            "tow_id": ["a", "b", "a", "b"],
            "key": ["season/2010", "season/2010", "random/a", "random/b"],
            "effect_ratio": [0.05, 0.05, 0.002, 0.002],
        }
    )
    a, b = ln_cw + ensemble.ln_errors(tows, held, None)
    # ln(40.4 / 40) is 3.5 standard deviations of the difference.
    assert (b > a).mean() > 0.99
    apart = held.with_columns((pl.col("key") + "/" + pl.col("tow_id")).alias("key"))
    a, b = ln_cw + ensemble.ln_errors(tows, apart, None)
    # ln(40.4 / 40) is 0.14 standard deviations, so 0.56 of the members, four errors either way.
    assert (b > a).mean() == pytest.approx(0.56, abs=0.14)


def test_members_lie_around_the_number_of_the_register(world):
    """As wide as its interval: half as wide for a best estimate with half the interval."""
    found, lines, held = register(world)
    measured = lines.with_columns(
        cw_lo_kg_m=pl.col("cw_kg_m") * np.exp(-0.04), cw_hi_kg_m=pl.col("cw_kg_m") * np.exp(0.04)
    )
    best = pl.col("cw_kg_m") * 0.97
    ruled = measured.with_columns(
        best, cw_lo_kg_m=best * np.exp(-0.02), cw_hi_kg_m=best * np.exp(0.02)
    )
    by_own, by_best = (
        ensemble.tow_ensemble("rebased", measured, used, held, found)
        .group_by("tow_id", maintain_order=True)
        .agg(middle=pl.col("cw_kg_m").log().mean(), sd=pl.col("cw_kg_m").log().std())
        for used in (measured, ruled)
    )
    assert (by_best["sd"] / by_own["sd"]).to_list() == pytest.approx([0.5] * by_own.height)
    ln_cw = measured.join(by_own, on="tow_id", maintain_order="right")["cw_kg_m"].log()
    own, moved = by_own["middle"] - ln_cw, by_best["middle"] - ln_cw - np.log(0.97)
    assert moved.to_list() == pytest.approx((0.5 * own).to_list())
