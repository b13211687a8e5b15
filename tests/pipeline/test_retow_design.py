"""Which boats to tow again: against estimating anew with the tows made, and by hand."""

import dataclasses

import numpy as np
import polars as pl
import pytest

from pipeline.season_log import estimate_season_factors, retow_choice
from pipeline.season_log.archive import sort_tows
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
    tows = sort_tows(found.tows)
    seasons = tows.filter(~pl.col("anchored"))["season"].unique().sort().to_list()
    boats = tows.select(*LINE, "state").unique(maintain_order=True).rows()
    design = np.zeros((tows.height + 1, len(seasons) + len(boats)))
    variance = np.full(tows.height + 1, found.tow_sd**2 + tows["ln_cw_sd"].median() ** 2)
    for row, tow in enumerate(tows.iter_rows(named=True)):
        design[row, len(seasons) + boats.index(tuple(tow[n] for n in (*LINE, "state")))] = 1.0
        variance[row] = tow["ln_cw_sd"] ** 2 + found.tow_sd**2
        if not tow["anchored"]:
            design[row, seasons.index(tow["season"])] = tow["kappa"]
            wander = found.tow_log_sd[2009 if tow["season"] < 2012 else 2012]
            variance[row] += (tow["kappa"] * wander) ** 2
    if new is not None:
        design[-1, len(seasons) + max(i for i, b in enumerate(boats) if b[:3] == new)] = 1.0
    information = design.T @ (design / variance[:, None])
    return np.linalg.inv(information)[: len(seasons), : len(seasons)]


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


def test_with_dgps_in_every_season_nothing_needs_tying(tows):
    found = estimate_season_factors(tows.filter("anchored"))
    assert retow_choice(found).is_empty()
