"""A tow on the quay: what it shows, before a rebuild has seen it and without storing anything.

The data folder is copied as links into a folder that is thrown away. There the archive is read as
it lies there now, and the steps of a build are made as far as the curves of one method. So the
number is that of the next rebuild, unless the archive or the method changes before it.
"""

import os
import shutil
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
import polars as pl

from pipeline import curve
from pipeline.assessment.first_assessment import (
    QuayTow,
    assess_first,
    get_runs_to_redo,
    get_verdict,
)
from pipeline.assessment.run_measures import measure_runs
from pipeline.blocks.run_blocks import stack_blocks
from pipeline.channels import OUT, RUN_SECONDS, SECOND_FILE_OFFSET
from pipeline.errors import MissingKnowledgeError
from pipeline.messages import LANGUAGE
from pipeline.method.definition import Method
from pipeline.recompute.facts import add_boats
from pipeline.recompute.recompute import recompute
from pipeline.tables.keys import LINE
from pipeline.tables.row import Row, pick_columns
from pipeline.tables.schemas import TABLES, conform
from warehouse.derive.archive_tables import read_archive
from warehouse.intake import seasons as intake
from warehouse.store.store import Store

SIZES_OF_DAY: Final = ("weight_kg", "crew_weight_kg", "waterline_length_m")
"""What of an earlier tow can explain that its curve was another."""

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
        verdict: the worst of the first assessment: `good`, `look` or `tow_again`.
        redo: runs to tow again; None where it is not said which.
        first_assessment: rows of `FirstAssessment`.
        ways_to_use: how `runs` that no plan knows can be used, `instead_of` others: `use_runs`,
            what the list would say, and `plan`, what `archief.toml` would say. Several ways where
            a person must tell which is meant.
        planned_runs: the numbers of the runs that its plan knows.
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
    verdict: str
    redo: list[int] | None
    first_assessment: list[Row]
    ways_to_use: list[Row]
    planned_runs: list[int]
    lost: list[Row]
    own_before: Row | None
    of_type: Row


def assess(store: Store, archive: Path, tow_id: str, method: Method) -> Assessment:
    """Read a tow that lies in the archive, compute it among all others, and assess it.

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
            raise _make_unusable_error(tow_id, copy.read("list_faults"))
        runs = stack_blocks(intake.read_all_blocks(copy), intake.read_runs_with_windows(copy))
        tows = add_boats(copy.read("tows"), copy.read("boats"))
        made = recompute(method, tows, runs, crew_classes=copy.read("crew_classes"))
        for name, frame in vars(made).items():
            if name in TABLES:
                copy.write(name, conform(name, frame))
        return _assess_tow(copy, tow_id, method.name)


def _make_unusable_error(tow_id: str, faults: pl.DataFrame) -> MissingKnowledgeError:
    """Return why a tow cannot be used: what was set aside of it, or that no list names it."""
    in_language = "message_nl" if LANGUAGE.get() == "nl" else "message"
    own = faults.filter(tow_id=tow_id)[in_language].to_list()
    if own:
        return MissingKnowledgeError("tow {} cannot be used: {}", tow_id, "; ".join(own))
    return MissingKnowledgeError(
        "the tow lists of the archive name no tow {}; add its line to the list, and its file to "
        "the folder of the season",
        tow_id,
    )


def _assess_tow(store: Store, tow_id: str, method: str) -> Assessment:
    tows, curves = intake.read_typed_tows(store), store.read("curves", method)
    set_aside = store.read("quarantine").filter(tow_id=tow_id)
    own = tows.filter(tow_id=tow_id).join(
        store.read("boats").select("fsn_no", "name"), on="fsn_no", how="left", maintain_order="left"
    )
    if own.is_empty():
        raise _make_unusable_error(tow_id, set_aside)
    tow = own.row(0, named=True)
    dated = tows.filter(pl.col("tow_id") != tow_id, pl.col("tow_date") <= tow["tow_date"])
    is_earlier = (pl.col("tow_date") < tow["tow_date"]) | (pl.col("tow_id") < tow_id)
    of_tows = dated.select("tow_id", "tow_date", "boat_type", pl.col(SIZES_OF_DAY))
    others = _find_cw_at_speed(
        curves.join(of_tows, on="tow_id", maintain_order="left"), tow["declared_speed_m_s"]
    ).sort("tow_date", "tow_id")
    own_before = _get_newest(others.filter(is_earlier, **pick_columns(tow, LINE)))
    boat_before = _get_newest(
        dated.filter(is_earlier, fsn_no=tow["fsn_no"]).sort("tow_date", "tow_id")
    )
    every_run = store.read("run_points", method)
    measured = measure_runs(curves, every_run)
    run_points = every_run.filter(tow_id=tow_id).sort("run")
    every = store.read("assessments", method)
    assessments = every.filter(tow_id=tow_id)
    in_season = tows.filter(season=tow["season"])
    of_season = every.join(in_season, on="tow_id", how="semi", maintain_order="left")
    curve_row = curves.filter(tow_id=tow_id).row(0, named=True)
    found = assess_first(
        QuayTow(
            tow=tow,
            curve=curve_row,
            run_points=measured.filter(tow_id=tow_id).sort("run"),
            assessments=assessments,
            others_of_season=of_season.filter(pl.col("tow_id") != tow_id),
            set_aside=set_aside,
            not_planned=_find_unplanned_runs(store, tow_id),
            boat_before=boat_before,
            line_before=own_before,
        )
    )
    planned = store.read("listed_runs").filter(tow_id=tow_id)
    like = others.filter(
        pl.col("fsn_no") != tow["fsn_no"],
        pl.col("boat_type") == pl.lit(tow["boat_type"], pl.String),
        crew_class=tow["crew_class"],
    )
    return Assessment(
        method=method,
        simulated=bool(store.read("about_archive")["simulated"][0]),
        tow=tow,
        curve=curve_row,
        runs=run_points.to_dicts(),
        checks=assessments.filter("flagged").to_dicts(),
        verdict=get_verdict(found),
        redo=get_runs_to_redo(found),
        first_assessment=found.to_dicts(),
        ways_to_use=propose_use_of_runs(found, planned),
        planned_runs=planned["run"].to_list(),
        lost=set_aside.to_dicts(),
        own_before=own_before,
        of_type=like.unique(LINE, keep="last")
        .select(
            n=pl.len(),
            median=pl.col("cw_kg_m").median(),
            lowest=pl.col("cw_kg_m").min(),
            highest=pl.col("cw_kg_m").max(),
        )
        .row(0, named=True),
    )


def _get_newest(rows: pl.DataFrame) -> Row | None:
    """Return the last of rows that are sorted by day."""
    return rows.row(-1, named=True) if rows.height else None


def _find_unplanned_runs(store: Store, tow_id: str) -> pl.DataFrame:
    """Return the runs in the samples of a tow that its plan does not know, with their log speed."""
    planned = store.read("listed_runs").filter(tow_id=tow_id)["run"]
    blocks = intake.read_all_blocks(store, ["tow_id", "run", "n", "log1_v"]).filter(tow_id=tow_id)
    runs = blocks.group_by("run", maintain_order=True).agg(
        log_m_s=pl.col("log1_v").sum() / pl.col("n").sum()
    )
    is_measured = pl.col("log_m_s").is_finite()
    return runs.filter(~pl.col("run").is_in(planned.implode()), is_measured).sort("run")


def propose_use_of_runs(assessment: pl.DataFrame, planned: pl.DataFrame) -> list[Row]:
    """Return how runs that no plan knows can be used, in the words of the archive.

    One such run can take the place of each run of its speed; only of the one that is to be towed
    again, where that is one. Several take the places of the runs of their speeds in order.

    Args:
        assessment: first assessment of a tow.
        planned: its rows of `listed_runs`.
    """
    extra = assessment.filter(
        pl.col("finding") == "run_not_planned", pl.col("runs").list.first() <= SECOND_FILE_OFFSET
    )
    known = planned.filter(pl.col("run") <= SECOND_FILE_OFFSET).sort("run")
    if extra.is_empty():
        return []
    redo = get_runs_to_redo(assessment) or []
    first_runs = extra["runs"].list.first()
    candidates = dict(zip(first_runs, extra["instead_of"].to_list(), strict=True))
    if len(candidates) == 1:
        run, alike = next(iter(candidates.items()))
        wrong = [one for one in alike if one in redo]
        replaceable = wrong if len(wrong) == 1 else alike
        return [_write_use_of_runs(known, {one: run}) for one in replaceable]
    way: dict[int, int] = {}
    for run, alike in candidates.items():
        free = [one for one in alike if one not in way]
        if free:
            way[free[0]] = run
    return [_write_use_of_runs(known, way)]


def _write_use_of_runs(known: pl.DataFrame, replaced_by: Mapping[int, int]) -> Row:
    """Return the line of the list and the plan with which runs take the places of others."""
    targets = dict(known.select("run", "target_speed_ratio").iter_rows())
    directions = dict(known.select("run", "direction").iter_rows())
    selected = [replaced_by.get(run, run) for run in known.filter("selected")["run"]]
    for run, other in replaced_by.items():
        targets[other], directions[other] = targets[run], directions[run]
    speeds, ways = [], []
    for run in range(1, max(targets) + 1):
        speeds.append(f"{targets.get(run, 1.0):g}")
        ways.append('"out"' if directions.get(run, OUT) == OUT else '"back"')
    plan = [
        "[[plan]]",
        f'tows = ["{known["tow_id"][0]}"]',
        f"targets = [{', '.join(speeds)}]",
        f"directions = [{', '.join(ways)}]",
    ]
    seconds = known["planned_s"][0]
    if seconds is not None and seconds != RUN_SECONDS:
        plan.append(f"seconds = {seconds:g}")
    return {
        "runs": list(replaced_by.values()),
        "instead_of": list(replaced_by),
        "use_runs": ",".join(map(str, selected)),
        "plan": "\n".join(plan),
    }


def _find_cw_at_speed(curves: pl.DataFrame, speed_m_s: float) -> pl.DataFrame:
    """Return curves with Cw and its interval at a speed, without those that end below it.

    The interval keeps its width in per cent.
    """
    sound = curves.filter(pl.col("status") != "rejected").drop_nulls("a_kg_m")
    b = sound["b_m_s"].fill_null(np.inf)
    cw = pl.lit(pl.Series(curve.cw(sound["a_kg_m"], curve.s_of_b(b), speed_m_s)))
    ends = pl.col("cw_lo_kg_m", "cw_hi_kg_m") * cw / pl.col("cw_kg_m")
    return sound.with_columns(ends, cw_kg_m=cw).filter(pl.col("cw_kg_m").is_finite())
