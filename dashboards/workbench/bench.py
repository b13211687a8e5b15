"""What an address asks: a method made from another by changing options, and what is compared.

Knows nothing of HTTP or pages. The history is read once; drafts of the methods asked for last are
kept, so that going back to one costs nothing.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Final
from urllib.parse import urlencode

from pydantic import BaseModel, ConfigDict, StringConstraints, ValidationError

from dashboards import words
from dashboards.queries.pages import name_ends, sum_up_repeats
from dashboards.queries.results import Data
from dashboards.workbench.form import CONTROLS, Control
from pipeline.errors import HerijkError
from pipeline.method.definition import Method, SeasonSteps
from pipeline.method.options import Steps
from pipeline.method.reading import list_shipped_methods
from pipeline.method.variant import (
    Difference,
    cut_at,
    list_differences,
    variant,
    write_variant_text,
)
from warehouse.queries.history import Draft, History
from warehouse.queries.scenario import Scenario
from warehouse.store.editions import list_edition_names, read_edition, read_edition_method
from warehouse.store.files import write_new
from warehouse.store.methods import KnownMethods
from warehouse.store.store import Store

SCENARIO: Final = "werkbank"
"""The method that is made here."""
DEFAULT_BASE: Final = "rebased"
DRAFTS_KEPT: Final = 8


@dataclass(frozen=True)
class Asked:
    """What an address asks.

    Attributes:
        base: the method to start from.
        against: the method or edition to compare with: the base, unless said otherwise.
        boat: its number.
        at: the first season of the range whose options are shown; "" for all seasons.
        changes: options as they are written in an address, by `step.option`, and of one range of
            seasons alone by `step.option.first`.
    """

    base: str
    against: str
    boat: str
    at: str
    changes: Mapping[str, str]

    def address(self, **instead: object) -> str:
        """Return the address that asks this, with some values replaced; the boat comes last."""
        asked = vars(self) | instead
        names = ("base", "against", "at")
        own = {name: asked[name] for name in names if asked[name]}
        return f"?{urlencode({**own, **asked['changes'], 'boat': asked['boat']})}"


class Saving(BaseModel):
    """A method to be saved: the address that made it, and what a method file says about it."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    address: Mapping[str, str]
    name: Annotated[str, StringConstraints(pattern=r"^[a-z0-9][a-z0-9-]{0,59}$")]
    title: Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=120)]
    reason: Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=2000)]


class Bench:
    """All of history, ready to be recomputed.

    Args:
        store: where editions are read and method files are saved.
        history: all tows.
    """

    def __init__(self, store: Store, history: History) -> None:
        self.store, self.history = store, history
        self.known = KnownMethods.from_store(store)
        self.seasons: Sequence[int] = history.tows["season"].unique().sort().to_list()
        self.boats = history.boats.join(history.tows, on="fsn_no", how="semi").sort(
            "name", "fsn_no"
        )
        self._draft = lru_cache(DRAFTS_KEPT)(history.recompute_under)

    def read_address(self, query: Mapping[str, str]) -> Asked:
        """Return the question in an address; missing parts and unknown boats take defaults."""
        base, boats = query.get("base") or DEFAULT_BASE, self.boats["fsn_no"].to_list()
        boat = query.get("boat", "")
        return Asked(
            base=base,
            against=query.get("against") or base,
            boat=boat if boat in boats else boats[0],
            at=query.get("at", ""),
            changes={name: value for name, value in query.items() if "." in name},
        )

    def list_ranges(self, asked: Asked) -> tuple[SeasonSteps, ...]:
        """Return the steps of the base, cut where a season of the archive begins."""
        return cut_at(self.known.get(asked.base), self.seasons)

    def make_method(
        self, asked: Asked, name: str = SCENARIO, title: str = SCENARIO, reason: str = ""
    ) -> Method:
        """Return the method that is asked for.

        Raises:
            HerijkError: an option cannot have such a value, or there is no such method.
        """
        steps = tuple(
            SeasonSteps(first=r.first, last=r.last, steps=_add_changes(r, asked.changes))
            for r in self.list_ranges(asked)
        )
        return variant(self.known.get(asked.base), name, title, reason, steps)

    def list_changes(self, asked: Asked) -> list[Difference]:
        """Return the options that are not those of the base."""
        return list_differences(self.make_method(asked), self.known.get(asked.base))

    def compute_results(self, asked: Asked) -> Data:
        """Return the results of the chosen method beside those it is compared with.

        Raises:
            HerijkError: the method does not cover a season, or cannot be.
        """
        scenario = self.compare_drafts(asked)
        curves = scenario.boat_curves(asked.boat)
        spread = name_ends(scenario.concat_both(lambda draft: draft.reproducibility))
        return {
            "lines": scenario.register_lines,
            "summary": scenario.summary(),
            "season_changes": scenario.season_change(),
            "log_factors": scenario.concat_both(lambda draft: draft.made.log_factors),
            "consistency": scenario.concat_both(lambda draft: draft.type_consistency),
            "repeats": spread,
            **sum_up_repeats(spread, SCENARIO),
            "curves": curves,
            "figure": scenario.boat_figure(asked.boat),
            "tows": curves["tow_id"].unique().sort(descending=True).to_list(),
        }

    def compare_drafts(self, asked: Asked) -> Scenario:
        """Return the draft that is asked for beside the one that it is compared with."""
        return Scenario(self._draft(self._get_compared(asked.against)), self.make_draft(asked))

    def make_draft(self, asked: Asked) -> Draft:
        """Return the results of the chosen method."""
        return self._draft(self.make_method(asked))

    def list_editions(self) -> list[str]:
        """Return the published editions that were made with a method."""
        names = list_edition_names(self.store)
        return [name for name in names if read_edition(self.store, name).method is not None]

    def save(self, wanted: Saving) -> Path:
        """Write the file of a method into the data folder; never over another.

        Raises:
            HerijkError: the name is taken, or the method cannot be.
        """
        if wanted.name in (*list_shipped_methods(), SCENARIO):
            raise HerijkError("{} is the name of another method; choose another", wanted.name)
        asked = self.read_address(wanted.address)
        method = self.make_method(asked, wanted.name, wanted.title, wanted.reason)
        path = self.known.folder / f"{wanted.name}.toml"
        try:
            write_new(path, write_variant_text(method))
        except FileExistsError as error:
            raise HerijkError("{} is there already; choose another name", path) from error
        return path

    def _get_compared(self, name: str) -> Method:
        if name in list_edition_names(self.store):
            return read_edition_method(self.store, name)
        return self.known.get(name)


def _add_changes(block: SeasonSteps, changes: Mapping[str, str]) -> Steps:
    """Return the steps of a range of seasons, changed for all seasons and then for these."""
    for_all = [name for name in changes if name.count(".") == 1]
    here = [name for name in changes if name.endswith(f".{block.first}")]
    steps = block.steps
    for key in (*for_all, *here):
        step, option = key.split(".")[:2]
        control = CONTROLS.get((step, option))
        if control is None:
            raise HerijkError("there is no option {}", key)
        held = steps.model_dump()
        try:
            held[step][option] = control.read(changes[key])
            steps = Steps.model_validate(held)
        except ValidationError as error:
            raise _refusal(control, changes[key]) from error
    return steps


def _refusal(control: Control, value: str) -> HerijkError:
    """Return an error that says why an option cannot have a value."""
    called = words.name_option(f"{control.step}.{control.option}")
    if control.kind == "number":
        return HerijkError(
            "{} has to lie between {} and {}, and is {}", called, control.least, control.most, value
        )
    return HerijkError("{} cannot be {}", called, value)
