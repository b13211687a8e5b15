"""Are equal boats equal: what `pipeline.consistency` says of every method."""

from typing import TYPE_CHECKING

import polars as pl

from herijk.pipeline.consistency import tables
from herijk.pipeline.consistency.observed import observe, of_trusted

if TYPE_CHECKING:
    from herijk.warehouse.build.inputs import Inputs


def line_tables(inputs: "Inputs") -> dict[str, pl.DataFrame]:
    """Lines through the boats of every type under every method."""
    curves, run_points = _of_trusted_tows(inputs)
    return tables.line_tables(observe(curves, inputs["tows"], inputs["boats"], run_points))


def consistency_tables(inputs: "Inputs") -> dict[str, pl.DataFrame]:
    """Are equal boats equal: the other statistics of every boat type under every method."""
    curves, run_points = _of_trusted_tows(inputs)
    return tables.consistency_tables(
        curves,
        inputs["tows"],
        inputs["boats"],
        run_points,
        inputs["listed_races"],
    )


def _of_trusted_tows(inputs: "Inputs") -> list[pl.DataFrame]:
    return [of_trusted(inputs[name], inputs["tows"]) for name in ("curves", "run_points")]
