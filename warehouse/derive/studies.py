"""What the steps of a method change, one after the other, and how much its options matter."""

from collections.abc import Sequence
from typing import Final

import polars as pl

from pipeline.blocks.run_blocks import RunBlocks
from pipeline.method.definition import Method
from pipeline.recompute.run_cache import RunCache
from pipeline.register.register import FIRST_PUBLISHED, STUDIED_METHOD
from pipeline.studies.ladder import ladder
from pipeline.studies.options import cross_ticks, option_curves, option_effects
from pipeline.tables.declare import dy
from pipeline.tables.studies import CorrectionSteps, OptionCurves, OptionEffects

JUDGED: Final = ("corrected-2013", "rebased-2015", STUDIED_METHOD)
"""Methods whose options of judgement are studied; the historical ones multiply or divide."""

TICKED: Final = ("corrected-2013", "rebased-2015")
"""Methods under which the ticks of the tool of 2015 are crossed: before its proposals, and after.
Without a speed correction the first is `as-published`."""

JUDGEMENT, TOOL = "judgement", "tool"


def study_tables(
    method: Method,
    first_method: Method,
    tows: pl.DataFrame,
    runs: RunBlocks,
    tow_instruments: pl.DataFrame,
    run_cache: RunCache,
) -> dict[str, pl.DataFrame]:
    """Return the ladder from the first method to this one, and the studies of its options."""
    own = pl.lit(method.name).alias("method")
    links = tow_instruments.filter(method=method.name)
    effects, ticked, ladders = [], [], []
    if method.name in TICKED:
        ticked = [option_curves(method, tows, runs, links, run_cache).with_columns(own)]
        effects = [cross_ticks(ticked[0]).with_columns(own, study=pl.lit(TOOL))]
    if method.name in JUDGED:
        judged = option_effects(method, tows, runs, links, run_cache)
        effects.append(judged.with_columns(own, study=pl.lit(JUDGEMENT)))
    if method != first_method:
        old, new = first_method, method
        if method.name == FIRST_PUBLISHED:  # what came first in history begins the ladder
            old, new = method, first_method
        before = tow_instruments.filter(method=old.name)
        after = tow_instruments.filter(method=new.name)
        steps = ladder(old, new, tows, runs, (before, after), run_cache)
        ladders = [steps.with_columns(from_method=pl.lit(old.name), to_method=pl.lit(new.name))]
    return {
        "correction_steps": _join_frames(CorrectionSteps, ladders),
        "option_effects": _join_frames(OptionEffects, effects),
        "option_curves": _join_frames(OptionCurves, ticked),
    }


def _join_frames(schema: type[dy.Schema], frames: Sequence[pl.DataFrame]) -> pl.DataFrame:
    return pl.concat(frames, how="diagonal") if frames else schema.create_empty()
