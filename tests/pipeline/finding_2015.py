"""The finding of 2015 on a simulated history: its figures, for tests and for the spread over seeds.

Among like boats B and A say little of weight while Cw at one speed says much; tows of 2009-2011
stand apart until their logs are corrected.
"""

from dataclasses import dataclass

import polars as pl

from herijk.simulate import World, WorldSettings, simulate_world
from pipeline.consistency.eras import era_shifts
from pipeline.consistency.lines import type_lines
from pipeline.consistency.observed import observe
from pipeline.consistency.repeats import repeat_pairs
from pipeline.method.definition import shipped_method
from pipeline.recompute.recompute import recompute
from tests.worlds import measure

PAIR = ("Kromhoutwhaler", "Kuikensloep")
BEFORE, AFTER = "as-published", "rebased"
EARLY = "2009-2011"
LETTERS = {"B": "b_m_s", "A": "a_kg_m", "Cw": "cw_standard_kg_m"}


@dataclass(frozen=True)
class Found:
    """A world of the whole fleet, 2009-2018, and what the tables say of it."""

    world: World
    log_factors: pl.DataFrame
    lines: pl.DataFrame
    shifts: pl.DataFrame

    def line(self, boat_type, quantity, explaining, tows="newest", method=AFTER):
        """The straight line of a quantity."""
        row = self.lines.filter(
            method=method,
            boat_type=boat_type,
            quantity=quantity,
            explaining=explaining,
            tows=tows,
        )
        return row.row(0, named=True)

    def explained(self, letter, tows="newest", method=AFTER):
        """R2 of B, A or Cw on weight, the mean of both types."""
        lines = [self.line(t, LETTERS[letter], "weight_kg", tows, method) for t in PAIR]
        return sum(line["r2"] for line in lines) / len(lines)

    def shift(self, boat_type, method):
        """Next tow of the same boats against 2009-2011."""
        row = self.shifts.filter(method=method, boat_type=boat_type, era=EARLY)
        return row.row(0, named=True)


def find(seed):
    """Simulates ten seasons of 24 tows and recomputes them before and after correction."""
    settings = WorldSettings(rate_hz=10, seed=seed)
    world, measured = simulate_world(settings), measure(settings)
    made = [recompute(shipped_method(m), measured.tows, measured.blocks) for m in (BEFORE, AFTER)]
    curves, run_points, log_factors = (
        pl.concat([getattr(one, name) for one in made])
        for name in ("curves", "run_points", "log_factors")
    )
    types = [{"fsn_no": b.fsn_no, "boat_type": b.boat_type.name or None} for b in world.boats]
    boats = pl.DataFrame(types, infer_schema_length=None)
    observed = observe(curves, measured.tows, boats, run_points)
    lines, _ = type_lines(observed)
    shifts = era_shifts(repeat_pairs(curves, measured.tows), boats)
    return Found(world, log_factors, lines, shifts)
