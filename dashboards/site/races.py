"""The races computed again: a page for each."""

from collections.abc import Iterator, Sequence

import polars as pl

from dashboards.addresses import race_path
from dashboards.site.parts import Page, Section, Table, draft_of, editions_select
from dashboards.statements.race import Chances, winners
from pipeline.messages import say
from warehouse.queries.answers import newest_edition, race_chances
from warehouse.queries.views import Views

COLUMNS = (
    *("name", "fsn_no", "crew_class", "rowers", "rowing_time_s", "old_power_w", "new_power_w"),
    *("old_rank", "new_rank", "podium_changed", "old_remark", "new_remark"),
)
CARDS = ("name", "fsn_no", "new_power_w", "old_rank", "new_rank")


def race_pages(views: Views, methods: Sequence[str]) -> Iterator[Page]:
    """A page for each race."""
    races = views.ask("races") if views.has("race_changes") else pl.DataFrame()
    if races.is_empty():
        return
    editions = races["to_edition"].unique().sort().to_list()
    chosen = newest_edition(editions, draft_of(methods))
    chances = race_chances(views, races.filter(to_edition=chosen)["from_edition"][0], chosen)
    for race, day in views.race_days():
        own = races.filter(race=race, race_date=day)
        yield _race(race_path(race, day), f"{race} {day}", own, editions, chosen, chances)


def _race(
    path: str, name: str, rows: pl.DataFrame, editions: Sequence[str], chosen: str, chances: Chances
) -> Page:
    now = rows.filter(to_edition=chosen)
    follows = ["to_edition"]
    table = Table("race_changes", rows, COLUMNS, follows=follows, search=True, cards=CARDS)
    return Page(
        path,
        say("Races"),
        [
            Section(
                "race_results",
                say("Results by both editions"),
                say(
                    "Power per rower in this race, and the place by it, by class: among the crews "
                    "that have a valid line on that day in both editions."
                ),
                tables=[table],
                headline=winners(now, chances),
            )
        ],
        name=name,
        selects=[editions_select("to_edition", editions, chosen)],
    )
