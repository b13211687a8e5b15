"""Members of a register: as uncertain as the budget says, and together where tows share errors."""

import numpy as np
import polars as pl
import pytest

from pipeline.errors import MissingKnowledgeError
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
    return found, lines, held, ensemble.register_ensemble(lines, held, found)


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
    members = ensemble.register_ensemble(lines, held, found, MANY)
    total = lines.join(uncertainty.combine(held), on="tow_id", maintain_order="left")
    of_both = uncertainty.combine(held.filter(pl.col("shared") != "single"))
    shared = lines.join(of_both, on="tow_id", maintain_order="left")["u_ratio"]
    expected = shared.product() / total["u_ratio"].product()
    correlation = np.corrcoef(np.log(members).T)[0, 1]
    assert expected > 0.05
    assert correlation == pytest.approx(expected, abs=4 / np.sqrt(MANY))


def test_a_line_keeps_its_members_when_others_go(drawn):
    found, lines, held, members = drawn
    kept = lines.head(3)
    mine = held.filter(pl.col("tow_id").is_in(kept["tow_id"].implode()))
    assert (ensemble.register_ensemble(kept, mine, found) == members[:, :3]).all()


def test_who_is_heavier_is_told_apart_by_what_is_not_shared():
    """Two tows that share a large error: as good as certain which is heavier."""
    tows = pl.DataFrame({"tow_id": ["a", "b"], "cw_kg_m": [40.0, 40.4]})
    held = pl.DataFrame(
        {
            "tow_id": ["a", "b", "a", "b"],
            "key": ["season/2010", "season/2010", "random/a", "random/b"],
            "effect_ratio": [0.05, 0.05, 0.002, 0.002],
        }
    )
    a, b = ensemble.register_ensemble(tows, held, None).T
    # ln(40.4 / 40) is 3.5 standard deviations of the difference.
    assert (b > a).mean() > 0.99
    apart = held.with_columns((pl.col("key") + "/" + pl.col("tow_id")).alias("key"))
    a, b = ensemble.register_ensemble(tows, apart, None).T
    # ln(40.4 / 40) is 0.14 standard deviations, so 0.56 of the members, four errors either way.
    assert (b > a).mean() == pytest.approx(0.56, abs=0.14)


def test_the_winner_of_a_race_is_counted_over_the_members(world):
    found, lines, held = register(world)
    members = ensemble.as_frame(lines, ensemble.register_ensemble(lines, held, found))
    crews = lines.head(3).with_columns(
        pl.Series("power_w", [80.0, 80.0, 50.0]), penalty_w=pl.lit(0.0)
    )
    share = ensemble.share_first(members, crews)
    assert share["power_w"].to_list() == [80.0, 80.0, 50.0]
    assert share["share"].sum() == pytest.approx(1.0)
    assert share["share"][:2].to_list() == pytest.approx([0.5, 0.5], abs=4 * 0.5 / np.sqrt(200))
    assert share["share"][2] == 0.0


def test_a_tow_without_members_is_refused(world):
    _, lines, _ = register(world)
    members = ensemble.as_frame(lines.head(1), np.ones((3, 1)))
    crews = lines.head(1).with_columns(
        pl.lit("no-such-tow").alias("tow_id"), power_w=pl.lit(80.0), penalty_w=None
    )
    with pytest.raises(MissingKnowledgeError, match="no-such-tow has no members"):
        ensemble.share_first(members, crews)


def test_a_penalty_does_not_follow_cw():
    """All lose 20 W, whatever Cw is: 100 W by twice the Cw is 200 W less 20."""
    crews = pl.DataFrame(
        {
            "tow_id": ["a", "b"],
            "cw_kg_m": [40.0, 40.0],
            "power_w": [80.0, 90.0],
            "penalty_w": [20.0, None],
        }
    )
    members = ensemble.as_frame(crews.select("tow_id", "cw_kg_m"), np.array([[44.0, 44.0]]))
    # 100 x 1.1 - 20 is 90 and 90 x 1.1 is 99; with Cw 48 and 44 100 W beat 99.
    assert ensemble.share_first(members, crews).sort("tow_id")["share"].to_list() == [0.0, 1.0]
    members = ensemble.as_frame(crews.select("tow_id", "cw_kg_m"), np.array([[48.0, 44.0]]))
    assert ensemble.share_first(members, crews).sort("tow_id")["share"].to_list() == [1.0, 0.0]


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
