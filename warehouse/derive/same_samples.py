"""Samples that were measured once and are in the archive twice.

A file that was packed again, or saved with other line ends or in another format, has another hash
and the same content: runs whose sums are equal but for rounding are one measurement. A file written
with fewer decimals or in another unit has nearly the same sums. One such run may be chance; two
runs of a tow that are both like runs of one other tow are not. Nobody can know whose samples they
are, so tows of different boats or crews all lose them; of one boat and crew the first tow keeps
them. Files equal byte by byte are told earlier, in `warehouse.archive.index`.
"""

from collections.abc import Iterator
from typing import Final

import numpy as np
import polars as pl
import scipy

from pipeline.channels import SECOND_FILE_OFFSET
from pipeline.messages import say
from pipeline.tables.keys import LINE
from pipeline.tables.lake import Faults
from warehouse.archive.faults import Fault, make_fault_frame

CONTENT: Final = ("n", "force", "log1_v", "log2_v", "log1_cw", "log1_cw2", "wind_v")
"""Sums of a run that tell it from others."""

ROUNDING: Final = 2e-4
"""Relative: what rounding to two decimals leaves of a mean over a thousand samples, and more."""

SMALLEST: Final = 1e-9
"""Stands for a mean of 0, which has no logarithm."""


def find_same_samples(tows: pl.DataFrame, blocks: pl.DataFrame) -> pl.DataFrame:
    """Return a fault for each tow with a run that is another tow's.

    Args:
        tows: rows of `tows`.
        blocks: their blocks: `tow_id`, `run` and `CONTENT`.
    """
    if tows.is_empty():
        return Faults.create_empty()
    facts = tows.select("tow_id", "tow_date", pl.col(LINE), "samples_path")
    runs = (
        blocks.join(facts, on="tow_id", how="semi")
        .group_by("tow_id", "run", maintain_order=True)
        .agg(pl.col(CONTENT).sum())
        .pipe(_add_content)
        .filter(pl.col("content").is_duplicated())
        .join(facts, on="tow_id", maintain_order="left")
        .sort("tow_date", "tow_id", "run")
    )
    faults: list[Fault] = []
    for _, same in runs.group_by("content", maintain_order=True):
        faults += _find_faults(same)
    rows = make_fault_frame(faults)
    return rows.unique("tow_id", keep="first", maintain_order=True)


def _add_content(runs: pl.DataFrame) -> pl.DataFrame:
    """Return the runs with `content`, a number that runs of one measurement have in common."""
    sums = runs.select(CONTENT).to_numpy()
    means = np.nan_to_num(sums[:, 1:] / np.maximum(sums[:, :1], 1.0))
    near = scipy.spatial.cKDTree(np.log(np.maximum(np.abs(means), SMALLEST)))
    one, other = near.query_pairs(ROUNDING, p=np.inf, output_type="ndarray").T
    tow = runs["tow_id"].rank("dense").to_numpy().astype(np.int64)
    between = np.sort(np.column_stack([tow[one], tow[other]]), axis=1)
    _, pair, often = np.unique(between, axis=0, return_inverse=True, return_counts=True)
    same = np.isclose(sums[one], sums[other], 1e-12, 0.0).all(1) | (often[pair.reshape(-1)] > 1)
    links = scipy.sparse.coo_array(
        (np.ones(same.sum()), (one[same], other[same])), shape=(runs.height, runs.height)
    )
    _, content = scipy.sparse.csgraph.connected_components(links, directed=False)
    return runs.with_columns(pl.Series("content", content))


def _find_faults(same: pl.DataFrame) -> Iterator[Fault]:
    """Yield faults of tows with one content: of all of them, or of all but the first."""
    first = same.row(0, named=True)
    of_one = same.select(LINE).n_unique() == 1
    for row in same.iter_rows(named=True):
        others = same.filter(pl.col("tow_id") != row["tow_id"])
        may_have_it = row["tow_id"] == first["tow_id"] or row["run"] > SECOND_FILE_OFFSET
        if others.is_empty() or (of_one and may_have_it):
            continue
        other = others.row(0, named=True)
        yield Fault(
            path=row["samples_path"],
            tow_id=row["tow_id"],
            reason_code="duplicate_tow" if of_one else "samples_listed_twice",
            message=say(
                "Run {} holds exactly the samples of tow {} ({}) of {} {}{}, packed or "
                "written otherwise.",
                row["run"] % SECOND_FILE_OFFSET,
                other["tow_id"],
                other["samples_path"],
                other["fsn_no"],
                other["rowers"],
                other["crew_class"],
            ),
            lost="tow",
        )
