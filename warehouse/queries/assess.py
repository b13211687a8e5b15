"""A tow on the quay: what it shows, before a rebuild has seen it and without storing anything.

The data folder is copied as links into a folder that is thrown away. There the archive is read as
it lies there now, and the steps of a build are made as far as the curves of one method. So the
number is that of the next rebuild, unless the archive or the method changes before it.
"""

import os
import shutil
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
import polars as pl

from pipeline import curve
from pipeline.blocks.run_blocks import stack_blocks
from pipeline.errors import MissingKnowledgeError
from pipeline.method.definition import Method
from pipeline.recompute.facts import with_boats
from pipeline.recompute.recompute import recompute
from pipeline.tables.keys import LINE
from pipeline.tables.row import Row
from pipeline.tables.schemas import TABLES, conform
from warehouse.derive.archive_tables import read_archive
from warehouse.intake import seasons as intake
from warehouse.store.store import Store

LEFT_BEHIND: Final = shutil.ignore_patterns("site", "report", "dagster", "*.duckdb*", "*.lock")
"""What a build does not read."""


@dataclass(frozen=True)
class Assessment:
    """What a tow shows under one method; nothing of it is stored.

    Attributes:
        method: its name.
        simulated: the archive says that it is simulated.
        tow: its row of `tows`, with `name` and `boat_type`.
        curve: its row of `curves`.
        runs: its rows of `run_points`.
        checks: its rows of `assessments` that are beyond their limit.
        lost: what is set aside of it: rows of `quarantine`.
        own_before: the newest earlier curve of this boat and crew, with `tow_date`; its `cw_kg_m`
            and interval are at the declared speed of this tow. None where there is none.
        of_type: `n`, and `median`, `lowest` and `highest` Cw [kg/m] at that speed, of the other
            boats of its type and class, each by its newest tow.
    """

    method: str
    simulated: bool
    tow: Row
    curve: Row
    runs: list[Row]
    checks: list[Row]
    lost: list[Row]
    own_before: Row | None
    of_type: Row


def assess(store: Store, archive: Path, tow_id: str, method: Method) -> Assessment:
    """Reads a tow that lies in the archive, and computes it among all others.

    Raises:
        MissingKnowledgeError: the archive lists no such tow, or it cannot be used; the message says
            why.
    """
    with tempfile.TemporaryDirectory(prefix="herijk-assess-") as folder:
        copy = Store(Path(folder, "data"))
        if store.root.exists():
            shutil.copytree(
                store.root.resolve(), copy.root, copy_function=os.symlink, ignore=LEFT_BEHIND
            )
        read_archive(copy, archive)
        if copy.read("listed_tows").filter(tow_id=tow_id).is_empty():
            raise _not_usable(tow_id, copy.read("list_faults"))
        runs = stack_blocks(intake.all_blocks(copy), intake.runs_with_windows(copy))
        made = recompute(method, with_boats(copy.read("tows"), copy.read("boats")), runs)
        for name, frame in vars(made).items():
            if name in TABLES:
                copy.write(name, conform(name, frame))
        return _assessment(copy, tow_id, method.name)


def _not_usable(tow_id: str, faults: pl.DataFrame) -> MissingKnowledgeError:
    """Why a tow is not there: what was set aside of it, or that nothing names it."""
    own = faults.filter(tow_id=tow_id)["message"].to_list()
    if own:
        return MissingKnowledgeError("tow {} cannot be used: {}", tow_id, "; ".join(own))
    return MissingKnowledgeError(
        "the tow lists of the archive name no tow {}; add its line to the list, and its file to "
        "the folder of the season",
        tow_id,
    )


def _assessment(store: Store, tow_id: str, method: str) -> Assessment:
    tows, curves = intake.typed_tows(store), store.read("curves", method)
    set_aside = store.read("quarantine").filter(tow_id=tow_id)
    own = tows.filter(tow_id=tow_id).join(
        store.read("boats").select("fsn_no", "name"), on="fsn_no", how="left", maintain_order="left"
    )
    if own.is_empty():
        raise _not_usable(tow_id, set_aside)
    tow = own.row(0, named=True)
    dated = tows.select("tow_id", "tow_date", "boat_type").filter(
        pl.col("tow_id") != tow_id, pl.col("tow_date") <= tow["tow_date"]
    )
    others = _at_speed(
        curves.join(dated, on="tow_id", maintain_order="left"), tow["declared_speed_m_s"]
    ).sort("tow_date", "tow_id")
    like = others.filter(
        pl.col("fsn_no") != tow["fsn_no"], crew_class=tow["crew_class"], boat_type=tow["boat_type"]
    )
    return Assessment(
        method=method,
        simulated=bool(store.read("about_archive")["simulated"][0]),
        tow=tow,
        curve=curves.filter(tow_id=tow_id).row(0, named=True),
        runs=store.read("run_points", method).filter(tow_id=tow_id).sort("run").to_dicts(),
        checks=store.read("assessments", method).filter("flagged", tow_id=tow_id).to_dicts(),
        lost=set_aside.to_dicts(),
        own_before=next(
            others.filter(**{name: tow[name] for name in LINE}).reverse().iter_rows(named=True),
            None,
        ),
        of_type=like.unique(LINE, keep="last")
        .select(
            n=pl.len(),
            median=pl.col("cw_kg_m").median(),
            lowest=pl.col("cw_kg_m").min(),
            highest=pl.col("cw_kg_m").max(),
        )
        .row(0, named=True),
    )


def _at_speed(curves: pl.DataFrame, speed_m_s: float) -> pl.DataFrame:
    """Curves with Cw and its interval at a speed; those that end below it go.

    The interval keeps its width in per cent.
    """
    sound = curves.filter(pl.col("status") != "rejected").drop_nulls("a_kg_m")
    b = sound["b_m_s"].fill_null(np.inf)
    cw = pl.lit(pl.Series(curve.cw(sound["a_kg_m"], curve.s_of_b(b), speed_m_s)))
    ends = {name: cw * pl.col(name) / pl.col("cw_kg_m") for name in ("cw_lo_kg_m", "cw_hi_kg_m")}
    return sound.with_columns(**ends, cw_kg_m=cw).filter(pl.col("cw_kg_m").is_finite())
