"""What the steps of a method change: one after the other, and in groups that are on or off."""

from collections.abc import Sequence

import polars as pl

from pipeline.blocks.run_blocks import RunBlocks
from pipeline.method.definition import Method
from pipeline.recompute.run_cache import RunCache
from pipeline.register.register import FIRST_PUBLISHED
from pipeline.studies.combinations import choose_ends, compute_combinations
from pipeline.studies.ladder import ladder
from pipeline.tables.studies import CorrectionSteps, VoteCurves


def study_methods(
    methods: Sequence[Method],
    tows: pl.DataFrame,
    runs: RunBlocks,
    tow_instruments: pl.DataFrame,
) -> dict[str, pl.DataFrame]:
    """Return the ladder from the first method to each other, and the parts of the vote."""
    cache = RunCache()
    links = {one.name: tow_instruments.filter(method=one.name) for one in methods}
    ladders: list[pl.DataFrame] = [CorrectionSteps.create_empty()]
    for method in methods[1:]:
        old, new = methods[0], method
        if method.name == FIRST_PUBLISHED:  # what came first in history begins the ladder
            old, new = method, methods[0]
        steps = ladder(old, new, tows, runs, (links[old.name], links[new.name]), cache)
        ladders.append(_add_ends(steps, old, new).select(CorrectionSteps.column_names()))
    vote_curves: pl.DataFrame = VoteCurves.create_empty()
    ends = choose_ends(methods)
    if ends is not None:
        found = compute_combinations(*ends, tows, runs, links, cache)
        vote_curves = _add_ends(found, *ends).select(VoteCurves.column_names())
    return {"correction_steps": pl.concat(ladders), "vote_curves": vote_curves}


def _add_ends(rows: pl.DataFrame, old: Method, new: Method) -> pl.DataFrame:
    return rows.with_columns(from_method=pl.lit(old.name), to_method=pl.lit(new.name))
