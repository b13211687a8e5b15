"""What the steps of a method change, one after the other, and how much its options matter."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

import polars as pl

from herijk.pipeline.method.definition import Method
from herijk.pipeline.studies.ladder import ladder
from herijk.pipeline.studies.options import beside_uncertainty, option_effects
from herijk.pipeline.studies.tool_options import option_curves, tick_effects
from herijk.tables.studies import CorrectionSteps, OptionCurves, OptionEffects
from herijk.warehouse.build.method_tables import blocks_of, run_cache

if TYPE_CHECKING:
    from herijk.warehouse.build.inputs import Inputs

FIRST_PUBLISHED: Final = "as-published-2014"
"""Numbers of 2014 before they were recomputed: a ladder leads from them to the first method."""

STUDIED_METHOD: Final = "rebased"
"""The method of today, which is shown first."""

JUDGED: Final = ("corrected-2013", "rebased-2015", STUDIED_METHOD)
"""Methods whose options of judgement are studied; the historical ones multiply or divide."""

TICKED: Final = ("corrected-2013", "rebased-2015")
"""Methods under which the ticks of the tool of 2015 are crossed: before its proposals, and after.
Without a speed correction the first is `as-published`."""

JUDGEMENT, TOOL = "judgement", "tool"

MOST_APART: Final = 1e-10
"""Rounding may make the factors of a ladder and its total so different."""


def study_tables(inputs: "Inputs") -> dict[str, pl.DataFrame]:
    """The ladder from the first method to each other, and the studies of options."""
    blocks, tows, (first, *others) = blocks_of(inputs), inputs["tows"], inputs.methods
    links = {m.name: _of(m, inputs["tow_instruments"]) for m in inputs.methods}
    with run_cache(inputs) as cache:
        ladders = [
            ladder(old, new, tows, blocks, (links[old.name], links[new.name]), cache).with_columns(
                pl.lit(old.name).alias("from_method"), pl.lit(new.name).alias("to_method")
            )
            for old, new in (_in_order(first, other) for other in others)
        ]
        ticked = {
            m: option_curves(m, tows, blocks, links[m.name], cache)
            for m in inputs.methods
            if m.name in TICKED
        }
        effects = [
            *((m, TOOL, tick_effects(curves)) for m, curves in ticked.items()),
            *(
                (m, JUDGEMENT, option_effects(m, tows, blocks, links[m.name], cache))
                for m in inputs.methods
                if m.name in JUDGED
            ),
        ]
        cache.clear()  # no later step applies a method
    all_effects = [
        beside_uncertainty(frame, _of(m, inputs["curves"])).with_columns(
            pl.lit(m.name).alias("method"), pl.lit(study).alias("study")
        )
        for m, study, frame in effects
    ]
    curves = [frame.with_columns(pl.lit(m.name).alias("method")) for m, frame in ticked.items()]
    return {
        "correction_steps": pl.concat(ladders) if ladders else CorrectionSteps.create_empty(),
        "option_effects": (
            pl.concat(all_effects, how="diagonal") if all_effects else OptionEffects.create_empty()
        ),
        "option_curves": pl.concat(curves) if curves else OptionCurves.create_empty(),
    }


def _in_order(first: Method, other: Method) -> tuple[Method, Method]:
    """The two ends of a ladder: what came first in history is its beginning."""
    return (other, first) if other.name == FIRST_PUBLISHED else (first, other)


def _of(method: Method, frame: pl.DataFrame) -> pl.DataFrame:
    return frame.filter(pl.col("method") == method.name)


def ladders_that_do_not_multiply(_: "Inputs", made: Mapping[str, pl.DataFrame]) -> list[str]:
    """Tows of which the factors of a ladder do not multiply to its total, within 1e-10."""
    ends = (
        made["correction_steps"]
        .sort("position")
        .group_by("from_method", "to_method", "tow_id", maintain_order=True)
        .agg(
            pl.col("factor").product(),
            (pl.col("cw_kg_m").last() / pl.col("cw_kg_m").first()).alias("total"),
        )
    )
    apart = (pl.col("factor") / pl.col("total") - 1.0).abs() > MOST_APART
    return list(ends.filter(apart)["tow_id"].unique().sort())
