"""History at hand: all sound tows with their blocks, to try methods on without storing anything.

Used by everything that asks "what if": a re-base, the workbench. What a method makes of the tows
is `pipeline.recompute.recompute`'s.
"""

import datetime as dt
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Self

import polars as pl

from pipeline.blocks.run_blocks import RunBlocks
from pipeline.consistency.observed import observe_trusted, select_trusted
from pipeline.consistency.repeats import repeat_pairs, reproducibility
from pipeline.consistency.types import DIFFERENCES_THAT_MATTER, compare_types
from pipeline.crews import STANDARD_CREWS
from pipeline.method.definition import Method
from pipeline.recompute.recompute import recompute
from pipeline.recompute.results import Recomputed
from pipeline.recompute.run_cache import RunCache
from pipeline.register.register import draft_register, find_reference_day, name_draft
from warehouse.intake.seasons import read_typed_tows, run_blocks
from warehouse.store.crew_classes import read_crew_classes
from warehouse.store.store import Store, make_no_warehouse_error


@dataclass(frozen=True)
class History:
    """What is known of all sound tows.

    Attributes:
        tows: rows of the table `tows`, with `boat_type`.
        boats: the table `boats`.
        crews: listed boats with their crews, also those never towed.
        blocks: the runs of `tows`.
        last_day: the day of the last tow or race, on which drafts judge what is valid.
        crew_classes: the table of that name.
        differences: spread between boats of a type that matters, as a ratio by quantity.
        cache: what was found of the runs so far.
    """

    tows: pl.DataFrame
    boats: pl.DataFrame
    crews: pl.DataFrame
    blocks: RunBlocks
    last_day: dt.date
    crew_classes: pl.DataFrame = field(default_factory=lambda: STANDARD_CREWS)
    differences: Mapping[str, float] = field(default_factory=lambda: DIFFERENCES_THAT_MATTER)
    cache: RunCache = field(default_factory=RunCache)

    @classmethod
    def from_store(cls, store: Store) -> Self:
        """Read the histories from the lake.

        Raises:
            MissingKnowledgeError: nothing was rebuilt in this data folder.
        """
        if store.read_fingerprint("tows") is None:
            raise make_no_warehouse_error(store)
        tows = read_typed_tows(store)
        known = store.read("type_consistency").select("quantity", "difference_that_matters")
        return cls(
            tows=tows,
            last_day=find_reference_day(tows, store.read("listed_races")),
            boats=store.read("boats"),
            differences=dict(DIFFERENCES_THAT_MATTER) | dict(known.unique().rows()),
            crews=store.read("listed_boats"),
            blocks=run_blocks(store),
            crew_classes=read_crew_classes(store),
        )

    def recompute_under(self, method: Method) -> "Draft":
        """Recompute all tows under a method, without bands, and draft its register.

        Raises:
            MissingKnowledgeError: the method says nothing about a season.
        """
        made = recompute(
            method,
            self.tows,
            self.blocks,
            self.cache,
            with_bands=False,
            crew_classes=self.crew_classes,
        )
        lines = draft_register(made.curves, self.tows, self.crews, self.last_day, method.validity)
        edition = pl.lit(name_draft(method.name)).alias("edition")
        return Draft(self, method, made, lines.with_columns(edition))


@dataclass(frozen=True)
class Draft:
    """All of history under one method; statistics are made when they are asked for.

    Attributes:
        history: what it was made from.
        method: the method.
        made: run points, curves, log factors.
        register: rows of the table `register`, of the draft edition.
    """

    history: History
    method: Method
    made: Recomputed
    register: pl.DataFrame

    @cached_property
    def observed(self) -> pl.DataFrame:
        """Tows with their curves, boats and measuring errors."""
        known, made = self.history, self.made
        return observe_trusted(made.curves, known.tows, known.boats, made.run_points)

    @cached_property
    def repeat_pairs(self) -> pl.DataFrame:
        """Rows of the table `repeat_pairs`."""
        return repeat_pairs(select_trusted(self.made.curves, self.history.tows), self.history.tows)

    @cached_property
    def reproducibility(self) -> pl.DataFrame:
        """Rows of the table `reproducibility`."""
        return reproducibility(self.repeat_pairs, self.observed)

    @cached_property
    def type_consistency(self) -> pl.DataFrame:
        """Rows of the table `type_consistency`."""
        return compare_types(self.observed, self.repeat_pairs, self.history.differences).consistency
