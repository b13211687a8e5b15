"""The register of every year, as published and as a method would have had it."""

from dataclasses import dataclass

import polars as pl

from pipeline.errors import MissingKnowledgeError
from pipeline.register.register import LINE, default_method, draft_name
from pipeline.register.years import compare_years, registers_of_years, winners_of_years
from pipeline.tables.row import Row
from warehouse.editions.compare import causes_of
from warehouse.queries.views import DRAFT, Views
from warehouse.store.store import Store


@dataclass(frozen=True)
class YearsReport:
    """What a method would have changed in the register of every year.

    Attributes:
        method: the method.
        simulated: whether the archive is.
        years: per year the `lines` that counted at its end, how many `changed`, the median, lowest
            and highest new / old Cw, how many changed beyond their intervals and in speed rank;
            where that year's register was printed, how many lines, and the median and largest
            difference from the register as published.
        causes: per year and cause the rows of `causes_of`.
        lines: every line of every year, with the boat's `name`.
        winners: who won each race by the register of its time, and who would have.
    """

    method: str
    simulated: bool
    years: list[Row]
    causes: list[Row]
    lines: list[Row]
    winners: list[Row]


def years_report(store: Store, method: str | None = None) -> YearsReport:
    """Compare the register of every year as published with that of a method.

    Args:
        store: the data folder.
        method: the method; the best that was applied when left out.

    Raises:
        MissingKnowledgeError: the method was not applied by the last rebuild.
    """
    with Views(store) as views:
        history = views.table("register_history")
        history = history.filter(pl.col("edition").str.starts_with(DRAFT))
        seasons = views.table("tows")["season"].unique().sort().to_list()
        steps = views.table("correction_steps")
        names = views.table("boats").select("fsn_no", "name")
        method = method or default_method(views.table("methods")["method"].to_list())
        simulated = views.simulated(draft_name(method))
    if history.filter(method=method).is_empty():
        raise MissingKnowledgeError("method {} was not applied by the last rebuild", method)
    registers = registers_of_years(history, seasons)
    lines = compare_years(registers, steps, method)
    members = store.read("ensemble", method)
    winners = winners_of_years(history, store.read("listed_races"), members, method)
    causes = [
        {"year": year} | cause
        for (year,), of_year in lines.group_by("year", maintain_order=True)
        for cause in causes_of(of_year.drop_nulls("cw_ratio"))
    ]
    printed = _printed_beside_published(store.read("printed_registers"), lines)
    is_changed = pl.col("change") == "changed"
    years = lines.group_by("year", maintain_order=True).agg(
        lines=pl.len(),
        changed=is_changed.sum(),
        median_ratio=pl.col("cw_ratio").median(),
        lowest_ratio=pl.col("cw_ratio").min(),
        highest_ratio=pl.col("cw_ratio").max(),
        exceeds_interval=pl.col("exceeds_interval").fill_null(False).sum(),
        rank_changed=(pl.col("old_rank") != pl.col("new_rank")).sum(),
    )
    years = years.join(printed, on="year", how="left", maintain_order="left")
    named = lines.join(names, on="fsn_no", how="left", maintain_order="left")
    return YearsReport(
        method, simulated, years.to_dicts(), causes, named.to_dicts(), winners.to_dicts()
    )


def _printed_beside_published(printed: pl.DataFrame, lines: pl.DataFrame) -> pl.DataFrame:
    """How far the printed register of a year is from the one that the method in force gives."""
    pairs = (
        printed.filter("has_valid_curve")
        .select(*LINE, year="season", printed_cw="cw_kg_m")
        .join(lines.select("year", *LINE, "old_cw_kg_m"), on=["year", *LINE], maintain_order="left")
    )
    ratio = pl.col("printed_cw") / pl.col("old_cw_kg_m")
    return pairs.group_by("year", maintain_order=True).agg(
        printed_lines=pl.len(),
        printed_median_ratio=ratio.median(),
        printed_largest_ratio=(ratio - 1.0).abs().max() + 1.0,
    )
