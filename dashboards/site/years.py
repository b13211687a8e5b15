"""The page of the register of every past year, with a year to choose."""

from collections.abc import Sequence

import polars as pl

from dashboards.site.parts import Page, Section, Select, Table, methods_select
from dashboards.site.start import YEARS
from dashboards.statements import years as statements
from pipeline.messages import say
from pipeline.register.register import default_method
from warehouse.queries.views import Views
from warehouse.queries.years import summarise_years


def years_page(views: Views, methods: Sequence[str]) -> Page:
    """Return the page of what each method would have made of every year's register and races."""
    lines = views.ask("register_years").filter(pl.col("method").is_in(methods))
    summary = summarise_years(lines, views.store.read("printed_registers"))
    winners = views.ask("year_winners").filter(pl.col("method").is_in(methods))
    shown_first = summary.filter(method=default_method(methods))
    year = statements.most_changed_year(shown_first)
    title, _ = YEARS
    years = Section(
        "years",
        title,
        say(
            "The lines that were valid at the end of each season, by the rule of validity of "
            "today on both sides. Ratio: Cw by the method / Cw by the method of that time. Print: "
            "that year's printed register / the same."
        ),
        tables=[
            Table(
                "years",
                summary,
                "year lines changed median_ratio lowest_ratio highest_ratio exceeds_interval "
                "rank_changed printed_lines printed_median_ratio printed_largest_ratio",
                follows=["method"],
                cards="year lines changed median_ratio exceeds_interval",
            )
        ],
        headline=statements.register_then(shown_first, year),
    )
    boats = Section(
        "register_years",
        say("The boats of a year"),
        say(
            "In 2 h: seconds that the crew may take longer (+) or has to be faster (-) for the "
            "same power. The causes multiply to the ratio of Cw."
        ),
        tables=[
            Table(
                "register_years",
                lines.filter(pl.col("change") != "same"),
                "name fsn_no boat_type rowers crew_class tow_date published_cw_kg_m cw_kg_m "
                "cw_ratio gain_in_two_hours_s exceeds_interval published_rank rank causes",
                follows=["method", "year"],
                search=True,
                cards="name fsn_no rowers crew_class published_cw_kg_m cw_kg_m gain_in_two_hours_s",
            )
        ],
    )
    races = Section(
        "year_winners",
        say("Who would have won"),
        say("Every race by the register of its time, and by the method."),
        tables=[
            Table(
                "year_winners",
                winners,
                "race race_date crew_class published_winner winner winner_changed "
                "change_probability",
                follows=["method"],
                cards="race race_date crew_class published_winner winner",
            )
        ],
        empty=None if winners.height else say("The archive holds no races to compute again."),
    )
    seasons = summary["year"].unique().sort().cast(pl.String)
    select_year = Select("year", say("Year"), {one: one for one in seasons}, str(year))
    selects = [methods_select(methods), select_year]
    return Page("years.html", title, [years, boats, races], selects=selects)
