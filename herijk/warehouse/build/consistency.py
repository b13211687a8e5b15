"""Are equal boats equal: what `pipeline.consistency` says of every method."""

from typing import TYPE_CHECKING

import polars as pl

from herijk.pipeline import consistency
from herijk.pipeline.consistency.observed import of_trusted

if TYPE_CHECKING:
    from herijk.warehouse.build.inputs import Inputs


def consistency_tables(inputs: "Inputs") -> dict[str, pl.DataFrame]:
    """Are equal boats equal: the statistics of every boat type under every method."""
    curves, run_points = (
        of_trusted(inputs[name], inputs["tows"]) for name in ("curves", "run_points")
    )
    return consistency.consistency_tables(
        curves,
        inputs["tows"],
        inputs["boats"],
        run_points,
        inputs["listed_races"],
    )
