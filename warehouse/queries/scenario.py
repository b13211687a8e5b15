"""What a method does, against another, to register, types, repeats, seasons and a boat.

Two drafts side by side as frames for a page. Every number comes from `pipeline`; here rows are
joined with names, put in order and counted. Nothing is stored.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
import polars as pl

from pipeline import curve
from pipeline.curve import VALID_RATIO, s_of_height
from pipeline.register.changes import compare_lines, sort_largest_first
from pipeline.studies.summaries import season_changes
from warehouse.queries.history import Draft
from warehouse.queries.views import prepare_curve_figure

LINE_RATIOS: Final = pl.DataFrame({"ratio": np.linspace(VALID_RATIO[0], VALID_RATIO[1], 13)})
"""Speeds at which a curve is drawn / declared speed."""


@dataclass(frozen=True)
class Scenario:
    """Two drafts of one history, compared."""

    before: Draft
    after: Draft

    @cached_property
    def register_lines(self) -> pl.DataFrame:
        """Every line of either register, with name and type; the largest change first.

        Returns:
            Columns of `compare_lines` without causes, with `name` and `boat_type`. A line that
            appears or disappears comes before all that change.
        """
        lines = compare_lines(self.before.register, self.after.register).drop("causes")
        names = self._names
        return sort_largest_first(lines).join(names, on="fsn_no", how="left", maintain_order="left")

    def summary(self) -> dict[str, object]:
        """Return how many lines change, who gains and loses, and by how much."""
        lines = self.register_lines
        changed = lines.filter(change="changed")
        gain = changed["gain_in_two_hours_s"]
        return {
            "lines": lines.height,
            "same": lines.filter(change="same").height,
            "changed": changed.height,
            "added": lines.filter(change="added").height,
            "removed": lines.filter(change="removed").height,
            "gains": int((gain > 0).sum()),
            "loses": int((gain < 0).sum()),
            "median_ratio": lines["cw_ratio"].median(),
            "lowest_ratio": lines["cw_ratio"].min(),
            "highest_ratio": lines["cw_ratio"].max(),
        }

    def season_change(self) -> pl.DataFrame:
        """Return median and range per season of Cw after over Cw before, of all tows."""
        curves = self.concat_both(lambda draft: draft.made.curves)
        return season_changes(curves, self.before.method).sort("season")

    def boat_figure(self, fsn_no: str) -> pl.DataFrame:
        """Return what `prepare_curve_figure` draws of a boat's curves, at 13 speeds."""
        curves = self.boat_curves(fsn_no).drop_nulls("cw_kg_m")
        runs = self.concat_both(lambda draft: draft.made.run_points)
        return pl.concat(
            prepare_curve_figure(_draw_curves(curves), runs, curves).values(), how="diagonal"
        )

    def boat_curves(self, fsn_no: str) -> pl.DataFrame:
        """Return every curve of a boat under both methods, with the `interval` of the method."""
        intervals = {d.method.name: d.method.interval for d in (self.before, self.after)}
        mine = self.concat_both(lambda draft: draft.made.curves).filter(fsn_no=fsn_no)
        return mine.sort("season", "tow_id", maintain_order=True).with_columns(
            interval=pl.col("method").replace_strict(intervals, return_dtype=pl.String)
        )

    def concat_both(self, of: Callable[[Draft], pl.DataFrame]) -> pl.DataFrame:
        """Return the rows of a table of both drafts."""
        return pl.concat([of(self.before), of(self.after)])

    @property
    def _names(self) -> pl.DataFrame:
        return self.after.history.boats.select("fsn_no", "name", "boat_type")


def _draw_curves(curves: pl.DataFrame) -> pl.DataFrame:
    """Return Cw of each curve at `LINE_RATIOS` of its declared speed."""
    rows = LINE_RATIOS.join(curves, how="cross")
    a = rows["a_kg_m"].to_numpy()
    cw = rows["cw_kg_m"].to_numpy()
    declared = rows["declared_speed_m_s"].to_numpy()
    ratio = rows["ratio"].to_numpy()
    speed = ratio * declared
    drawn = curve.cw(a, s_of_height(a, cw, declared), speed)
    nothing = pl.lit(None, pl.Float64)
    lines = rows.select(
        "method", "tow_id",
        speed_m_s=pl.Series(speed),
        cw_kg_m=pl.Series(drawn),
        cw_lo_kg_m=nothing,
        cw_hi_kg_m=nothing,
    )  # fmt: skip
    return lines.filter(pl.col("cw_kg_m").is_finite())
