"""What the instruments of every run said: means of each second, and figures of the whole run."""

from typing import TYPE_CHECKING

import polars as pl

from herijk.pipeline.blocks.run_blocks import PLACE
from herijk.pipeline.studies.claims import CHANNELS, run_statistics
from herijk.pipeline.studies.summaries import SUMS, second_means

if TYPE_CHECKING:
    from herijk.warehouse.build.inputs import Inputs


def recording_tables(inputs: "Inputs") -> dict[str, pl.DataFrame]:
    """The traces of all runs of sound tows, and the tool's figures of each of their channels."""
    of_all = inputs.blocks(*dict.fromkeys(("tow_id", *PLACE, *SUMS, *CHANNELS.values())))
    blocks = of_all.join(inputs["tows"], on="tow_id", how="semi", maintain_order="left")
    return {"trace_seconds": second_means(blocks), "run_statistics": run_statistics(blocks)}
