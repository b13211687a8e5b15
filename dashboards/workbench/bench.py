"""The bench itself: questions about a method in, answers as plain data out.

Knows nothing of HTTP. The history is read once, when the bench is made; drafts of the methods asked
for last are kept, so that going back to one costs nothing.
"""

from functools import lru_cache
from pathlib import Path
from typing import Annotated, Final

import polars as pl
import polars.selectors as cs
from pydantic import BaseModel, ConfigDict, StringConstraints

from dashboards.figures.style import SCENARIO
from dashboards.site.cells import DIGITS, LONG
from dashboards.workbench.form import controls
from pipeline.errors import HerijkError
from pipeline.method.definition import (
    Method,
    SeasonSteps,
    Steps,
    parse_method,
    shipped_methods,
)
from pipeline.method.variant import cut_at, differences, variant, variant_text
from warehouse.queries.chosen_tows import ALL, choices_of
from warehouse.queries.history import History
from warehouse.queries.scenario import CURVE_COLUMNS, Scenario
from warehouse.store.editions import edition_names, method_of_edition, read_edition
from warehouse.store.files import write_new
from warehouse.store.methods import KnownMethods
from warehouse.store.store import Store

Answer = dict[str, object]

DEFAULT_BASE: Final = "rebased"
DEFAULT_AGAINST: Final = "as-published"
DRAFTS_KEPT: Final = 8
KEPT: Final = 7
"""Significant digits in an answer; the database holds all."""

REGISTER_COLUMNS: Final = (
    *("name", "fsn_no", "boat_type", "rowers", "crew_class", "change", "old_cw_kg_m"),
    *("new_cw_kg_m", "cw_ratio", "gain_in_two_hours_s", "old_rank", "new_rank"),
    *("exceeds_interval", "time_ratio", "to_edition"),
)
HOMOGENEITY_COLUMNS: Final = (
    *("method", "boat_type", "n_boats", "p_value", "power_at_10pct", "noise_share"),
    "shared_b_m_s",
)


REPEATS_COLUMNS: Final = (
    *("method", "scope", "n_pairs", "sd_ratio", "lo", "hi", "share_within_1pct"),
    "share_within_2pct",
)


class _Question(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Base(_Question):
    """Where a method starts from.

    Attributes:
        name: of a method that ships or was saved here.
        text: of a method file that was opened; its own name then counts.
    """

    name: str
    text: str | None = None


class Wish(_Question):
    """A base with other steps.

    Attributes:
        base: where it starts.
        steps: one for each range of seasons that `Bench.base` gave, in that order.
    """

    base: Base
    steps: tuple[Steps, ...]


class Question(Wish):
    """What a wish does to all boats, compared with a method or edition, and to one boat.

    Attributes:
        against: the method or edition.
        boat: its number.
        tows: which tows types are judged by; see `chosen_tows`.
    """

    against: str
    boat: str
    tows: str = ALL


class Named(Wish):
    """A wish with what a method file says about it."""

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
        self.history = history
        self._store = store
        self.known = KnownMethods.of(store)
        self._seasons = history.tows["season"].unique().sort().to_list()
        self._draft = lru_cache(DRAFTS_KEPT)(history.under)

    def start(self) -> Answer:
        """What the page needs before the first question."""
        boats = self.history.boats.join(self.history.tows, on="fsn_no", how="semi")
        return {
            "simulated": self.history.simulated,
            "tows": self.history.tows.height,
            "controls": controls(),
            "methods": list(shipped_methods()),
            "saved": list(self.known.own),
            "editions": self._editions(),
            "boats": _rows(boats.select("fsn_no", "name").sort("name", "fsn_no")),
            "types": boats["boat_type"].drop_nulls().unique().sort().to_list(),
            "choices": choices_of(self._seasons),
            "seasons": self._seasons,
            "digits": DIGITS,
            "long": sorted(LONG),
            "base": DEFAULT_BASE,
            "against": DEFAULT_AGAINST,
            "scenario": SCENARIO,
            "columns": {
                "register": REGISTER_COLUMNS[:-2],
                "homogeneity": HOMOGENEITY_COLUMNS,
                "reproducibility": REPEATS_COLUMNS,
                "boat_curves": CURVE_COLUMNS,
            },
        }

    def base(self, wanted: Base) -> Answer:
        """A method's steps per range of seasons, cut where a season of the archive begins."""
        method = self._method(wanted)
        return {
            "name": method.name,
            "title": method.title,
            "ranges": [
                block.model_dump(mode="json")
                | {"seasons": [s for s in self._seasons if block.first <= s <= block.last]}
                for block in cut_at(method, self._seasons)
            ],
        }

    def answer(self, question: Question) -> Answer:
        """Everything that follows from a question.

        Raises:
            HerijkError: the method does not cover a season, or cannot be.
        """
        base = self._method(question.base)
        method = self._wished(question, SCENARIO, base.title, "")
        scenario = Scenario(self._draft(self._against(question.against)), self._draft(method))
        lines = scenario.register_lines
        return {
            "before": scenario.before.method.name,
            "summary": scenario.summary(),
            "changed_options": [vars(d) for d in differences(method, base)],
            "register": _rows(lines.select(REGISTER_COLUMNS)),
            "season_change": _rows(scenario.season_change()),
            "log_factors": _rows(scenario.log_factors()),
            "types": _rows(scenario.type_tows(question.tows)),
            "homogeneity": _rows(
                scenario.type_homogeneity(question.tows).select(HOMOGENEITY_COLUMNS)
            ),
            "reproducibility": _rows(scenario.reproducibility()),
            "boat_curves": _rows(scenario.boat_curves(question.boat)),
            "boat_figure": _rows(scenario.boat_figure(question.boat)),
        }

    def register(self, question: Question) -> pl.DataFrame:
        """The register that a question's answer shows."""
        return self._draft(self._wished(question, SCENARIO, "", "")).register

    def method_file(self, wish: Named) -> str:
        """The text of the method file of a wish.

        Raises:
            HerijkError: another method has that name.
        """
        if wish.name in (*shipped_methods(), SCENARIO):
            raise HerijkError("{} is the name of another method; choose another", wish.name)
        return variant_text(self._wished(wish, wish.name, wish.title, wish.reason))

    def save(self, wish: Named) -> Path:
        """Writes the method file of a wish into the data folder; never over another.

        Raises:
            HerijkError: the name is taken.
        """
        text = self.method_file(wish)
        path = self.known.folder / f"{wish.name}.toml"
        try:
            write_new(path, text)
        except FileExistsError as error:
            raise HerijkError("{} is there already; choose another name", path) from error
        return path

    def _wished(self, wish: Wish, name: str, title: str, reason: str) -> Method:
        base = self._method(wish.base)
        ranges = cut_at(base, self._seasons)
        if len(ranges) != len(wish.steps):
            raise HerijkError("{} has {} ranges, not {}", base.name, len(ranges), len(wish.steps))
        steps = (
            SeasonSteps(first=block.first, last=block.last, steps=steps)
            for block, steps in zip(ranges, wish.steps, strict=True)
        )
        return variant(base, name, title, reason, tuple(steps))

    def _method(self, wanted: Base) -> Method:
        if wanted.text is not None:
            return parse_method(wanted.text, wanted.name, self.known.text)
        return self.known.get(wanted.name)

    def _editions(self) -> list[str]:
        """Published editions that were made with a method."""
        names = edition_names(self._store)
        return [name for name in names if read_edition(self._store, name).method is not None]

    def _against(self, name: str) -> Method:
        if name in edition_names(self._store):
            return method_of_edition(self._store, name)
        return self.known.get(name)


def _rows(frame: pl.DataFrame) -> list[Answer]:
    """Rows for JSON: a number that is not finite is no number."""
    finite = [
        pl.when(pl.col(c).is_finite()).then(pl.col(c).round_sig_figs(KEPT)).alias(c)
        for c in cs.expand_selector(frame, cs.float())
    ]
    return frame.with_columns(finite).to_dicts()
