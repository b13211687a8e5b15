"""The proposal part by part: what every combination of its parts gives each crew and each race.

Whatever a row shows under the combinations is a list, in the order of `list_combinations`: the page
chooses the place in it by the switches that are on.
"""

import math
from collections.abc import Sequence
from typing import Final

import polars as pl

from dashboards.addresses import race_path
from dashboards.queries.boats import find_changed_options
from dashboards.queries.methods import describe_option
from dashboards.queries.pages import sum_up_gains
from dashboards.queries.results import Data, Results
from pipeline.method.options import STEP_GROUPS
from pipeline.register.register import LINE, name_draft
from pipeline.register.replay import PODIUM
from pipeline.studies.combinations import list_combinations, name_combination
from pipeline.tables.row import Row

PAGE: Final = "parts.html"
RACE: Final = ("race", "race_date")


def read_parts(results: Results) -> Data:
    """Return the switches, and what each combination of them gives crews and races.

    Returns:
        `from_method` and `to_method`; the `switches`, with the options that each changes; the
        `gains` of each combination, as `sum_up_gains` gives them; the `crews`, by name, with the
        `seconds` that each combination gives over two hours; `scale_s`, the largest of these; the
        `races` of the last season, the last one first, each class with who comes on its `podium`,
        the number of places that it has.
    """
    lines = results.views.table("vote_lines")
    combinations = [name_combination(on) for on in list_combinations(results.vote_switches)]
    ends = lines.select("from_method", "to_method").row(0)
    changed = find_changed_options(results, *map(name_draft, ends))
    switches = []
    for switch in results.vote_switches:
        own = [describe_option(one) for one in changed if one.step in STEP_GROUPS[switch]]
        switches.append({"name": switch, "changed": own})
    gains_s = lines["gain_in_two_hours_s"].drop_nulls().abs().to_list()
    races = _read_races(results, combinations)
    return {
        "from_method": ends[0],
        "to_method": ends[1],
        "switches": switches,
        "gains": [sum_up_gains(lines.filter(combination=one)) for one in combinations],
        "crews": _list_crews(results, lines, combinations),
        "scale_s": math.ceil(max([1.0, *gains_s])),
        "races": races,
        "podium": PODIUM,
        "chosen": {"race": races[0]["path"] if races else ""},
    }


def _list_crews(results: Results, lines: pl.DataFrame, combinations: Sequence[str]) -> list[Row]:
    """Return every crew that has a number under some combination, by the name of its boat."""
    rounded = lines.drop_nulls("gain_in_two_hours_s").with_columns(
        pl.col("gain_in_two_hours_s").round().cast(pl.Int64)
    )
    crews = []
    for key, own in rounded.group_by(LINE, maintain_order=True):
        seconds = _list_values(own, "gain_in_two_hours_s", combinations)
        crews.append(_name_crew(results, key) | {"seconds": seconds})
    return sorted(crews, key=lambda crew: (crew["name"].casefold(), crew["fsn_no"], crew["crew"]))


def _read_races(results: Results, combinations: Sequence[str]) -> list[Row]:
    """Return the races of the last season, and in each class who comes on its podium at all."""
    places = results.views.table("vote_races")
    is_on_podium = pl.any_horizontal(pl.col("old_rank", "new_rank") <= PODIUM)
    key = [*RACE, *LINE]
    on_podium = places.filter(is_on_podium).select(key).unique()
    placed = places.join(on_podium, on=key, how="semi").sort(
        "race_date", "race", "crew_class", descending=[True, False, True]
    )
    races = []
    for (race, day), of_race in placed.group_by(RACE, maintain_order=True):
        classes = []
        for (crew_class,), of_class in of_race.group_by("crew_class", maintain_order=True):
            rows = []
            for crew, own in of_class.group_by(LINE, maintain_order=True):
                ranks = {
                    "old": _list_values(own, "old_rank", combinations),
                    "new": _list_values(own, "new_rank", combinations),
                }
                rows.append(_name_crew(results, crew) | ranks)
            rows.sort(key=lambda row: (row["new"][-1] or math.inf, row["fsn_no"]))
            classes.append({"crew_class": crew_class, "rows": rows})
        races.append({"race": race, "on": day, "path": race_path(race, day), "classes": classes})
    return races


def _list_values(own: pl.DataFrame, column: str, combinations: Sequence[str]) -> list[int | None]:
    """Return what a crew has under each combination; None where it has nothing."""
    values = dict(own.select("combination", column).iter_rows())
    return [values.get(combination) for combination in combinations]


def _name_crew(results: Results, key: Sequence[object]) -> Row:
    """Return the boat and crew of a line, its thwart left free included."""
    fsn_no, rowers, crew_class, thwart = key
    crew = f"{rowers}{crew_class}" + f" ({thwart})" * bool(thwart)
    return {"fsn_no": fsn_no, "name": results.boat_names.get(str(fsn_no), fsn_no), "crew": crew}
