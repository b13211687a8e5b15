"""What the instruments of every run said: means of each second, and figures of the whole run."""

import polars as pl

from pipeline.blocks.run_blocks import PLACE
from pipeline.studies.claims import CHANNELS, run_statistics
from pipeline.studies.summaries import SUMS, second_means
from warehouse.derive.inputs import Blocks


def recording_tables(tows: pl.DataFrame, blocks: Blocks) -> dict[str, pl.DataFrame]:
    """The traces of all runs of sound tows, and the tool's figures of each of their channels."""
    of_all = blocks.columns(*dict.fromkeys(("tow_id", *PLACE, *SUMS, *CHANNELS.values())))
    sound = of_all.join(tows, on="tow_id", how="semi", maintain_order="left")
    return {"trace_seconds": second_means(sound), "run_statistics": run_statistics(sound)}
