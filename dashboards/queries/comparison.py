"""Two editions, drafts or methods side by side: `herijk compare`."""

import datetime as dt
import json

import polars as pl

from dashboards.queries.pages import pick_cause, sum_up_changes
from dashboards.queries.results import Data
from pipeline.method.variant import list_differences
from pipeline.register.register import name_draft
from pipeline.register.replay import RaceRules
from pipeline.tables.row import Row, pick_columns
from warehouse.editions.compare import DiffReport, report_with_races
from warehouse.store.editions import Edition, list_edition_names, read_edition
from warehouse.store.methods import KnownMethods
from warehouse.store.store import Store


def compare(
    store: Store, old: str, new: str, rules: RaceRules, as_of: dt.date | None = None
) -> Data:
    """Compare editions as they are, and drafts, methods and method files as their drafts are.

    Two drafts are compared over all of history: also lines whose tow has expired; as of a day, the
    lines that counted on it.

    Returns:
        `old`, `new`, the `options` that differ, and the `effect` on all boats: a `DiffReport`, None
        where a draft is to be made and the data folder has no tows. Where there is one, also what
        is read from it.

    Raises:
        HerijkError: there is no such method or edition, or it cannot be computed.
    """
    known, published = KnownMethods.from_store(store), list_edition_names(store)
    sides = []
    for name in (old, new):
        is_published = name in published
        method_name = name.removeprefix(name_draft(""))
        sides.append(read_edition(store, name) if is_published else known.find(method_name))
    old_side, new_side = sides
    before = old_side.method if isinstance(old_side, Edition) else old_side
    after = new_side.method if isinstance(new_side, Edition) else new_side
    options = [] if before is None or after is None else list_differences(after, before)
    data: Data = {"old": old, "new": new, "options": options, "effect": None}
    if not {old, new} <= {*published} and store.read_fingerprint("tows") is None:
        return data
    is_of_a_day = as_of is not None or {old, new} & {*published}
    counting = ("valid",) if is_of_a_day else ("valid", "expired")
    editions = []
    for side in sides:
        if isinstance(side, Edition):
            editions.append(side)
            continue
        from warehouse.editions.publish import draft_edition  # noqa: PLC0415 - it recomputes tows

        editions.append(draft_edition(store, side, as_of, counting))
    first, second = editions
    effect = report_with_races(store, first, second, rules)
    return data | {"effect": effect, "simulated": effect.simulated} | _sum_up(effect)


def _sum_up(effect: DiffReport) -> Data:
    """Return the data of the document about a comparison."""
    ranked = [race for race in effect.races or () if race["new_rank"] is not None]
    moved = [race for race in ranked if race["old_rank"] != race["new_rank"]]
    return {
        "changed": sum_up_changes(_list_lines(effect)),
        "lines": list(map(_describe_line, effect.rows)),
        "causes": [one | {"main_cause": pick_cause(one)} for one in effect.causes],
        "n_ranked": len(ranked),
        "moved": moved,
        "is_timed": any(race["new_corrected_time_s"] is not None for race in ranked),
        "n_podium": sum(race["podium_changed"] for race in ranked),
    }


def _list_lines(effect: DiffReport) -> pl.DataFrame:
    """Return the lines as `sum_up_changes` reads them."""
    texts = ("from_edition", "to_edition", "change")
    schema = dict.fromkeys((*texts, "causes"), pl.String) | {"exceeds_interval": pl.Boolean}
    rows = [
        pick_columns(row, schema) | {"causes": json.dumps(row["causes"])} for row in effect.rows
    ]
    return pl.DataFrame(rows, schema=schema).with_columns(
        old_log_known=effect.from_edition not in effect.runs_alone,
        new_log_known=effect.to_edition not in effect.runs_alone,
    )


def _describe_line(row: Row) -> Row:
    """Return a line whose change says why it was removed, with ranks named after speed."""
    codes = [row["change"]]
    if row["change"] == "removed":
        codes.append(row["new_status"] or "gone")
    ranks = {"old_speed_rank": row["old_rank"], "new_speed_rank": row["new_rank"]}
    return row | ranks | {"change": codes}
