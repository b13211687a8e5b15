"""The ensemble of a method lies in the lake, and is read back whole."""

import numpy as np
import polars as pl

from pipeline.uncertainty.ensemble import MEMBERS
from tests.conftest import Workbench

METHOD = "rebased-2015"


def test_every_curve_has_its_members_about_its_cw(built: Workbench):
    members = built.store.read("ensemble", METHOD)
    curves = built.table("curves").filter(pl.col("method") == METHOD).drop_nulls("cw_kg_m")
    found = members.group_by("tow_id").agg(pl.len(), pl.col("cw_kg_m").log().alias("ln").mean())
    both = curves.join(found, on="tow_id")
    assert both.height == curves.height > 0
    assert set(both["len"]) == {MEMBERS}
    # The interval is 4 to 6 standard deviations wide, the mean of the members has 1 / sqrt(200).
    width = (both["cw_hi_kg_m"] / both["cw_lo_kg_m"]).log()
    assert ((both["ln"] - both["cw_kg_m"].log()).abs() / width).max() < 1 / np.sqrt(MEMBERS)


def test_a_rebuild_after_a_loss_draws_the_same_members(bench: Workbench):
    before = bench.store.read("ensemble", METHOD)
    bench.store.table_path("ensemble", METHOD).unlink()
    assert bench.rebuild().done.methods == [METHOD]
    assert bench.store.read("ensemble", METHOD).equals(before)
