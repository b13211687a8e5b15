"""The register of every year, as published and as a method would have had it."""

from dataclasses import dataclass

import polars as pl

from pipeline.errors import MissingKnowledgeError
from pipeline.register.register import LINE, default_method, draft_name
from pipeline.tables.row import Row
from warehouse.editions.compare import causes_of
from warehouse.queries.views import Views
from warehouse.store.store import Store


@dataclass(frozen=True)
class YearsReport:
    """What a method would have changed in the register of every year.

    Attributes:
        method: the method.
        simulated: whether the archive is.
        years: rows of `summarise_years`.
        causes: per year and cause the rows of `causes_of`.
        lines: rows of `register_years`, with the boat's `name`.
        winners: rows of `year_winners`.
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
        chosen = method or default_method(views.table("methods")["method"].to_list())
        lines = views.ask("register_years").filter(method=chosen)
        winners = views.ask("year_winners").filter(method=chosen)
        printed = views.store.read("printed_registers")
        simulated = views.simulated(draft_name(chosen))
    if lines.is_empty():
        raise MissingKnowledgeError("method {} was not applied by the last rebuild", chosen)
    causes = []
    for (year,), of_year in lines.group_by("year", maintain_order=True):
        causes += [{"year": year} | cause for cause in causes_of(of_year.drop_nulls("cw_ratio"))]
    return YearsReport(
        method=chosen,
        simulated=simulated,
        years=summarise_years(lines, printed).to_dicts(),
        causes=causes,
        lines=lines.to_dicts(),
        winners=winners.to_dicts(),
    )


def summarise_years(lines: pl.DataFrame, printed: pl.DataFrame) -> pl.DataFrame:
    """Count what a method changes in the register of each year.

    Args:
        lines: rows of `register_years`.
        printed: rows of `printed_registers`.

    Returns:
        Per `year` and `method`: how many `lines` counted at its end, how many `changed`, the
        median, lowest and highest Cw / Cw as published, how many changed beyond their intervals and
        in rank; and of that year's printed register how many lines, and the median and largest
        ratio to the register as published.
    """
    summary = lines.group_by("year", "method", maintain_order=True).agg(
        lines=pl.len(),
        changed=(pl.col("change") == "changed").sum(),
        median_ratio=pl.col("cw_ratio").median(),
        lowest_ratio=pl.col("cw_ratio").min(),
        highest_ratio=pl.col("cw_ratio").max(),
        exceeds_interval=pl.col("exceeds_interval").fill_null(value=False).sum(),
        rank_changed=(pl.col("published_rank") != pl.col("rank")).sum(),
    )
    in_print = printed.filter("has_valid_curve").select(*LINE, year="season", printed_cw="cw_kg_m")
    pairs = lines.join(in_print, on=["year", *LINE], maintain_order="left")
    ratio = pl.col("printed_cw") / pl.col("published_cw_kg_m")
    beside_print = pairs.group_by("year", "method", maintain_order=True).agg(
        printed_lines=pl.len(),
        printed_median_ratio=ratio.median(),
        printed_largest_ratio=(ratio - 1.0).abs().max() + 1.0,
    )
    return summary.join(beside_print, on=["year", "method"], how="left", maintain_order="left")
