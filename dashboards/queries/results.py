"""The tables of a data folder, read once for all documents that are made of them."""

import datetime as dt
from collections.abc import Mapping
from functools import cache, cached_property
from typing import Any, Final, TypeAlias

import polars as pl

from dashboards.addresses import make_race_key
from pipeline.register.register import choose_default_method, list_shown_methods
from pipeline.studies.switches import find_switches
from pipeline.tables.row import Row
from warehouse.queries.answers import choose_current_edition, line_changes
from warehouse.queries.views import Views
from warehouse.store.database import make_unknown_edition_error

Data: TypeAlias = dict[str, Any]
"""What a query found, by the names that its template uses."""

_QUESTIONS: Final = ("curves", "run_points", "flagged")
"""What `Results.of_boat` asks by a question of `Views` rather than by a table."""


class Results:
    """The tables of a data folder.

    Args:
        views: the open database.

    Attributes:
        answers: what was read of editions so far, by edition and boat.
    """

    def __init__(self, views: Views) -> None:
        self.views = views
        self.answers: dict[str, dict[str, list[Row]]] = {}
        self._split_by_boat = cache(self._read_by_boat)

    @cached_property
    def methods(self) -> list[str]:
        """Names of the methods that are shown, in the order of the database."""
        return list_shown_methods(self.views.table("methods")["method"].to_list())

    @cached_property
    def method(self) -> str:
        """The method that is shown first."""
        return choose_default_method(self.methods)

    @cached_property
    def before_and_after(self) -> list[str]:
        """The first method and the one that is shown first; one name where they are the same."""
        return list(dict.fromkeys((self.methods[0], self.method)))

    @cached_property
    def compared_methods(self) -> list[str]:
        """What a boat is compared by: as published, as shown first, and as decided."""
        decided = self.views.table("editions")["method"].drop_nulls()
        return [name for name in self.methods if name in {*self.before_and_after, *decided}]

    @cached_property
    def edition(self) -> str:
        """The edition that counts, or the best draft."""
        return choose_current_edition(self.views)

    @cached_property
    def register(self) -> pl.DataFrame:
        """The lines of all editions and drafts."""
        return self.views.register()

    @cached_property
    def line_changes(self) -> pl.DataFrame:
        """Every pair of lines that is compared."""
        return line_changes(self.views)

    @cached_property
    def valid_lines(self) -> pl.DataFrame:
        """The valid lines of the edition that counts, or of the best draft."""
        return self.register.filter(edition=self.edition, status="valid")

    @cached_property
    def valid_boats(self) -> set[str]:
        """The boats that have a valid line."""
        return set(self.valid_lines["fsn_no"])

    @cached_property
    def last_races(self) -> pl.DataFrame:
        """Every boat of the last race of each name: `race`, `race_date`, its `key`, `fsn_no`."""
        races = self.views.store.read("listed_races").select("race", "race_date", "fsn_no")
        is_last = pl.col("race_date") == pl.col("race_date").max().over("race")
        last = races.filter(is_last).unique().sort("race", "race_date", "fsn_no")
        key = pl.struct("race", "race_date").map_elements(
            lambda one: make_race_key(one["race"], one["race_date"]), pl.String
        )
        return last.with_columns(key=key)

    @cached_property
    def boat_names(self) -> dict[str, str]:
        """The name of each boat that has one, by its number."""
        return dict(self.views.table("boats").select("fsn_no", "name").drop_nulls().rows())

    @cached_property
    def vote_switches(self) -> list[str]:
        """The parts of the proposal that can be switched on and off; none without a proposal."""
        return find_switches(self.views.table("vote_lines")["combination"].unique().to_list())

    @cached_property
    def objection(self) -> Row:
        """`to` whom a number can be objected to, `until` which day, and the `grounds`, if known."""
        about = self.views.about()
        until = about.get("objections_until")
        return {
            "to": about.get("objections_to", ""),
            "until": dt.date.fromisoformat(until) if until else None,
            "grounds": about.get("objection_grounds", ""),
        }

    def rows(self, table: str) -> pl.DataFrame:
        """Return the rows of a table of the methods that are shown."""
        return self.views.table(table).filter(pl.col("method").is_in(self.methods))

    def choose_edition(self, edition: str | None) -> str:
        """Return the edition that is asked for, or the one that counts.

        Raises:
            MissingKnowledgeError: there is no such edition.
        """
        names = self.register["edition"].unique()
        chosen = edition or self.edition
        if chosen not in names:
            raise make_unknown_edition_error(chosen, names)
        return chosen

    def select_boat(self, source: str, fsn_no: str) -> pl.DataFrame:
        """Return the rows of a table or question about a boat."""
        by_boat = self._split_by_boat(source)
        return by_boat.get(fsn_no, by_boat[""])

    def _read_by_boat(self, source: str) -> Mapping[str, pl.DataFrame]:
        """Return the rows of a table or question by boat, and none of them by ""."""
        if source == "register":
            rows = self.register
        elif source in _QUESTIONS:
            rows = self.views.ask(source)
        else:
            rows = self.views.table(source)
        if "fsn_no" not in rows.columns:
            boat_of_tow = self.views.table("tows").select("tow_id", "fsn_no")
            rows = rows.join(boat_of_tow, on="tow_id", maintain_order="left")
        parts = rows.partition_by("fsn_no", as_dict=True, maintain_order=True)
        return {"": rows.clear()} | {str(fsn_no): part for (fsn_no,), part in parts.items()}
