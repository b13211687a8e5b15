"""Which boats to tow again: against estimating anew with the tows made, and by hand."""

import dataclasses

import numpy as np
import polars as pl
import pytest

from pipeline.season_log import estimate_season_factors, retow_choice
from pipeline.season_log.archive_tows import with_state
from pipeline.season_log.retow_design import RETOW_SCHEMA
from tests.pipeline.season_worlds import CLEAN, simulate

LINE = ["fsn_no", "rowers", "crew_class"]


@pytest.fixture(scope="module")
def tows():
    """A sparse archive: nine tows per season of forty boats."""
    return simulate(dataclasses.replace(CLEAN, tows_a_season=9, boats=40), 7).tows


@pytest.fixture(scope="module")
def found(tows):
    return estimate_season_factors(tows)


def typical_sd(covariance):
    return float(np.sqrt(np.mean(np.diag(covariance))))


def with_boats_as_unknowns(found, new=None):
    """Covariance of the ln factors by plain least squares, every boat an unknown of its own.

    `new` is a line that is towed once more.
    """
    tows = with_state(found.tows)
    groups = tows.filter(~pl.col("anchored"))["season"].unique().sort().to_list()
    boats = tows.select(*LINE, "state").unique(maintain_order=True).rows()
    rows, weights = [], []
    for tow in tows.iter_rows(named=True):
        design = np.zeros(len(groups) + len(boats))
        design[len(groups) + boats.index(tuple(tow[n] for n in (*LINE, "state")))] = 1.0
        wander = 0.0
        if not tow["anchored"]:
            design[groups.index(tow["season"])] = tow["kappa"]
            wander = found.tow_log_sd[2009 if tow["season"] < 2012 else 2012]
        rows.append(design)
        own = tow["ln_cw_sd"] ** 2 + found.tow_sd**2 + (tow["kappa"] * wander) ** 2
        weights.append(1.0 / own)
    if new is not None:
        design = np.zeros(len(groups) + len(boats))
        design[len(groups) + max(i for i, boat in enumerate(boats) if boat[:3] == new)] = 1.0
        rows.append(design)
        weights.append(1.0 / (found.tow_sd**2 + tows["ln_cw_sd"].median() ** 2))
    matrix = np.array(rows)
    information = matrix.T @ (np.array(weights)[:, None] * matrix)
    return np.linalg.inv(information)[: len(groups), : len(groups)]


def test_each_boat_is_chosen_once_and_tells_less_than_the_one_before(found):
    choice = retow_choice(found)
    assert choice.schema == RETOW_SCHEMA
    assert choice["position"].to_list() == list(range(1, 11))
    assert choice.select(LINE).n_unique() == 10
    before, after = (choice[f"factor_sd_{when}_ratio"].to_numpy() for when in ("before", "after"))
    assert before[0] == pytest.approx(typical_sd(found.covariance))
    assert before[1:] == pytest.approx(after[:-1])
    gain = before**2 - after**2
    assert (np.diff(gain) <= 1e-12).all()


def test_the_first_choice_is_the_best_of_all_by_brute_force(tows):
    """Without GPS, ageing and drift the covariance is that of plain least squares."""
    bare = tows.with_columns(pl.lit(None).cast(pl.Float64).alias("gps_ln_ratio"))
    found = dataclasses.replace(estimate_season_factors(bare), ageing_sd=0.0, drift_sd=0.0)
    found = dataclasses.replace(found, covariance=with_boats_as_unknowns(found))
    choice = retow_choice(found).head(1)
    lines = tows.select(LINE).unique().rows()
    after = {line: typical_sd(with_boats_as_unknowns(found, line)) for line in lines}
    best = min(after, key=after.__getitem__)
    assert choice.select(LINE).row(0) == best
    assert choice["factor_sd_after_ratio"][0] == pytest.approx(after[best], rel=1e-9)


def test_a_season_that_nothing_ties_is_tied_first(tows):
    alone = tows.head(2).with_columns(
        pl.Series("fsn_no", ["FSN900", "FSN901"]),
        pl.Series("tow_id", ["2008-1", "2008-2"]),
        pl.lit(2008).cast(tows.schema["season"]).alias("season"),
        pl.lit(False).alias("altered"),
    )
    choice = retow_choice(estimate_season_factors(pl.concat([tows, alone])))
    assert choice["seasons"][0] == "2008"
    assert choice["factor_sd_before_ratio"][0] > 2 * choice["factor_sd_after_ratio"][0]


def test_an_altered_boat_ties_no_season_before_its_alteration(tows):
    first = retow_choice(estimate_season_factors(tows)).head(1)
    mine = pl.all_horizontal(pl.col(name) == first[name][0] for name in LINE)
    last = tows.filter(mine)["season"].max()
    altered = tows.with_columns(pl.col("altered") | (mine & (pl.col("season") == last)))
    again = retow_choice(estimate_season_factors(altered))
    seasons = again.join(first.select(LINE), on=LINE, how="semi")["seasons"].to_list()
    assert seasons in ([], [str(last)])


def test_with_dgps_in_every_season_nothing_needs_tying(tows):
    found = estimate_season_factors(tows.filter("anchored"))
    assert retow_choice(found).is_empty()
