"""Re-base: all of history under a method that may not have been used before, against another.

Reads the lake, writes nothing: a committee looks at the result before anyone publishes. What the
steps compute is in `pipeline`.
"""

from dataclasses import dataclass

import polars as pl

from pipeline.method.definition import Method
from pipeline.register.changes import compare_lines, largest_first
from pipeline.register.register import LINE
from pipeline.studies.ladder import START, ladder
from pipeline.tables.row import Row
from warehouse.editions.compare import NO_STEPS
from warehouse.queries.history import Draft, History
from warehouse.store.editions import Edition
from warehouse.store.store import Store

MOST_AFFECTED = 15


@dataclass(frozen=True)
class RebaseReport:
    """What a method changes against another.

    Attributes:
        method, method_hash, against: the methods.
        simulated: whether the archive is.
        by_season: median factor on Cw of each step, per season, with `total`.
        changes: number of lines by kind of change.
        boats: the register lines most affected, with their factors.
    """

    method: str
    method_hash: str
    against: str
    simulated: bool
    by_season: list[Row]
    changes: list[Row]
    boats: list[Row]


def rebase(store: Store, method: Method, against: Method) -> RebaseReport:
    """Recomputes everything under a method and says what changes against another, and why.

    Raises:
        MissingKnowledgeError: there is no sound tow, or a method does not cover a season.
    """
    history = History.of(store)
    old, new = (history.under(m) for m in (against, method))
    links = old.made.tow_instruments, new.made.tow_instruments
    rungs = ladder(against, method, history.tows, history.blocks, links, history.cache)
    rungs = rungs.filter(pl.col("step") != START)
    return _report(new, old.register, against.name, rungs)


def against_print(store: Store, method: Method, printed: Edition) -> RebaseReport:
    """What a method changes against an edition taken over from print: by which steps is unknown.

    Raises:
        MissingKnowledgeError: there is no sound tow, or the method does not cover a season.
    """
    history = History.of(store)
    return _report(history.under(method), printed.register, printed.manifest.edition, NO_STEPS)


def _report(new: Draft, old: pl.DataFrame, against: str, rungs: pl.DataFrame) -> RebaseReport:
    history, method = new.history, new.method
    lines = largest_first(compare_lines(old, new.register).drop("causes"))
    most = (
        lines.drop_nulls("cw_ratio")
        .head(MOST_AFFECTED)
        .join(new.register.select(*LINE, "tow_id"), on=LINE, maintain_order="left")
        .join(
            history.boats.select("fsn_no", "name"), on="fsn_no", how="left", maintain_order="left"
        )
        .join(
            rungs.pivot("step", index="tow_id", values="factor"),
            on="tow_id",
            how="left",
            maintain_order="left",
        )
    )
    return RebaseReport(
        method=method.name,
        method_hash=method.content_hash,
        against=against,
        simulated=history.simulated,
        by_season=_by_season(rungs, history.tows).to_dicts(),
        changes=lines["change"].value_counts(sort=True).to_dicts(),
        boats=most.drop("from_edition", "to_edition").to_dicts(),
    )


def _by_season(rungs: pl.DataFrame, tows: pl.DataFrame) -> pl.DataFrame:
    """Median factor of each step, and of all together, per season."""
    seasoned = rungs.join(tows.select("tow_id", "season"), on="tow_id", maintain_order="left")
    steps = rungs.sort("position")["step"].unique(maintain_order=True).to_list()
    totals = seasoned.group_by("season", "tow_id", maintain_order=True).agg(
        pl.col("factor").product()
    )
    total = totals.group_by("season", maintain_order=True).agg(
        pl.len().alias("tows"), pl.col("factor").median().alias("total")
    )
    medians = seasoned.group_by("season", "step", maintain_order=True).agg(
        pl.col("factor").median()
    )
    wide = medians.pivot("step", index="season", values="factor").select("season", *steps)
    return wide.join(total, on="season", maintain_order="left").sort("season")
