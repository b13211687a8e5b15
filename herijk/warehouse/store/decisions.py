"""Decisions of people about tows: a dated file that only a person writes.

`besluiten.toml` lies in the data folder. It says which tow is not to count, or counts although a
newer one exists, with reason, who decided and when. A published edition keeps its own copy. What a
verdict does to a register is in `pipeline.register.register`.
"""

import datetime as dt
from collections.abc import Sequence
from pathlib import Path
from typing import Final, Literal

import polars as pl
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from herijk.pipeline.errors import MissingKnowledgeError
from herijk.pipeline.register.register import DECISION_SCHEMA, EXCLUDE, PREFER
from herijk.pipeline.toml_text import decoded, parse_toml, problem_in_words

FILE_NAME: Final = "besluiten.toml"
VERDICTS: Final = {"uitsluiten": EXCLUDE, "voorkeur": PREFER}


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
    """The decisions in a file, oldest first; none when there is no file.

    Raises:
        MissingKnowledgeError: the file cannot be understood, or decides twice about one tow.
    """
    if not path.exists():
        return ()
    try:
        decisions = _File.model_validate(parse_toml(decoded(path.read_bytes()))).besluit
    except ValidationError as error:
        first = error.errors()[0]
        where = f"'{'.'.join(map(str, first['loc']))}'"  # quoted: a key is never translated
        raise MissingKnowledgeError(
            "{}: {}: {}; a decision has sleep_id, oordeel (uitsluiten or voorkeur), "
            "reden, wie and datum",
            path,
            where,
            problem_in_words(first),
        ) from error
    except ValueError as error:
        raise MissingKnowledgeError("{}: not valid TOML: {}", path, error) from error
    tows = [decision.sleep_id for decision in decisions]
    twice = sorted({tow for tow in tows if tows.count(tow) > 1})
    if twice:
        raise MissingKnowledgeError("{}: more than one decision about {}", path, ", ".join(twice))
    return tuple(sorted(decisions, key=lambda decision: (decision.datum, decision.sleep_id)))


def decision_table(decisions: Sequence[Decision]) -> pl.DataFrame:
    """The verdicts as `pipeline.register.register.draft_register` takes them."""
    rows = [{"tow_id": d.sleep_id, "verdict": VERDICTS[d.oordeel]} for d in decisions]
    return pl.DataFrame(rows, schema=DECISION_SCHEMA)
