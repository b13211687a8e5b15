"""A check as it is told, in a language."""

from dataclasses import dataclass
from pathlib import Path
from typing import Final

from pipeline.messages import innermost, spoken
from warehouse.archive.check.check import Cause, Checked

SHOWN: Final = 3


@dataclass(frozen=True)
class Place:
    """Where a fault is."""

    path: str
    line: int | None
    tow_id: str | None


@dataclass(frozen=True)
class CauseReport:
    """One thing that is wrong, as it is told.

    Attributes:
        reason_code: short stable code.
        number: of places.
        sentence: of the first of them.
        cells: what the cells say that have it.
        places: the first of them.
        settings: lines of `archief.toml` to fill in, with the choices behind a `#`.
    """

    reason_code: str
    number: int
    sentence: str
    cells: list[str]
    places: list[Place]
    settings: list[str]


@dataclass(frozen=True)
class CheckReport:
    """A check in a language."""

    archive: str
    tows: int
    causes: list[CauseReport]


def check_report(root: Path, checked: Checked, language: str) -> CheckReport:
    """A check of an archive with its sentences in `en` or `nl`."""
    causes = [_cause_report(cause, language) for cause in checked.causes]
    return CheckReport(str(root), checked.tows, causes)


def _cause_report(cause: Cause, language: str) -> CauseReport:
    first = innermost(cause.faults[0].message)
    cells = [getattr(innermost(f.message), "values", {}).get("cell") for f in cause.faults]
    return CauseReport(
        reason_code=cause.reason_code,
        number=len(cause.faults),
        sentence=spoken(first, language),
        cells=[str(cell) for cell in dict.fromkeys(cells) if cell is not None],
        places=[Place(f.path, f.line, f.tow_id) for f in cause.faults[:SHOWN]],
        settings=list(cause.settings),
    )
