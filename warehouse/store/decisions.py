"""Decisions of people about tows: a dated file that only a person writes.

`besluiten.toml` is in the data folder. It says which tow does not count, or counts although there
is a newer one, with the reason, who decided and when. A published edition keeps its own copy. What
a verdict does to a register is in `pipeline.register.register`.
"""

import datetime as dt
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Final, Literal

import polars as pl
from pydantic import BaseModel, ConfigDict, Field

from pipeline.errors import MissingKnowledgeError
from pipeline.messages import say
from pipeline.register.register import DECISION_SCHEMA, EXCLUDE, PREFER
from warehouse.store.settings_file import read_settings_file

FILE_NAME: Final = "besluiten.toml"
VERDICTS: Final = {"uitsluiten": EXCLUDE, "voorkeur": PREFER}
_MAY_HOLD: Final = say(
    "[[besluit]], each with sleep_id, oordeel (uitsluiten or voorkeur), reden, wie and datum"
)


class Decision(BaseModel):
    """One decision, as it is in the file."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    sleep_id: str = Field(min_length=1)
    oordeel: Literal["uitsluiten", "voorkeur"]
    reden: str = Field(min_length=1)
    wie: str = Field(min_length=1)
    datum: dt.date


class _File(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")

    besluit: tuple[Decision, ...] = ()


def read_decisions(path: Path) -> tuple[Decision, ...]:
    """Read the decisions in a file, oldest first; none where there is no file.

    Raises:
        MissingKnowledgeError: the file cannot be understood, or decides twice about one tow.
    """
    decisions = read_settings_file(path, _File, _MAY_HOLD).besluit
    tows = Counter(decision.sleep_id for decision in decisions)
    twice = sorted(tow for tow, number in tows.items() if number > 1)
    if twice:
        raise MissingKnowledgeError("{}: more than one decision about {}", path, ", ".join(twice))
    return tuple(sorted(decisions, key=lambda decision: (decision.datum, decision.sleep_id)))


def tabulate_decisions(decisions: Sequence[Decision]) -> pl.DataFrame:
    """Return the verdicts as `pipeline.register.register.draft_register` takes them."""
    rows = [{"tow_id": d.sleep_id, "verdict": VERDICTS[d.oordeel]} for d in decisions]
    return pl.DataFrame(rows, schema=DECISION_SCHEMA)
