"""What is wrong with the archive: the record of one fault.

A reason code is stable: it is in the table `quarantine`, and `remedies` says what to do about it.
Detecting a fault belongs to the module that reads the thing.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields
from typing import Final, Literal

from pipeline.errors import DefectiveInputError
from pipeline.messages import Sentence, find_cause, say, write_in_language
from pipeline.tables.declare import dy
from pipeline.tables.frames import make_frame
from pipeline.tables.lake import Faults
from pipeline.tables.row import Row
from warehouse.archive.columns import DefectiveHeaderError
from warehouse.store.unforeseen import UNFORESEEN, format_traceback, is_unforeseen, shorten_error

Lost = Literal["seconds", "run", "tow", "file", "row", "cell"]
"""What a fault costs: seconds of one channel of a run, a run, a tow, or a file; or a row of a list
that costs no tow, as one of a race, or one of its cells."""

OF_A_HEADER: Final = ("missing_column", "unknown_column", "duplicate_column", "unknown_unit")
"""Reason codes of a header: of a list, they cost all of it."""


@dataclass(frozen=True, kw_only=True)
class Fault:
    """Something that is set aside: seconds, a run, a tow, a file or a row of a list.

    Attributes:
        path: posix path relative to the archive.
        tow_id: the tow it costs, None where the fault belongs to a file or a boat.
        line: line in `path` (the header is line 1), where there is one.
        reason_code: short stable code.
        message: a sentence a volunteer understands.
        lost: what it costs; None for a tow, a row or a file, as it has a tow, a line or neither.
        run: the run that it costs, or seconds of which.
        lost_s: how many seconds.
        ask: lines of `archief.toml` that would settle it, with `?` for the answer.
    """

    path: str
    tow_id: str | None = None
    line: int | None = None
    reason_code: str
    message: str
    lost: Lost | None = None
    run: int | None = None
    lost_s: float | None = None
    ask: tuple[str, ...] = ()

    @property
    def cause(self) -> str:
        """What faults of one cause share."""
        return find_cause(self.message)

    def to_row(self) -> Row:
        """Return the fault as a row of `Faults`: only here it is worded in Dutch too."""
        words = {"cause": self.cause, "message_nl": write_in_language(self.message, "nl")}
        facts = [fact.name for fact in fields(Fault) if fact.name != "ask"]
        return {name: getattr(self, name) for name in facts} | words


@dataclass(frozen=True, kw_only=True)
class Failure(Fault):
    """A list on which Herijk itself failed, with the traceback."""

    trace: str = ""


class DefectiveFileError(DefectiveHeaderError):
    """A `DefectiveInputError` that knows which of a tow's files it is about."""

    def __init__(
        self,
        reason_code: str,
        message: str,
        line: int | None,
        path: str,
        ask: Sequence[str] = (),
    ) -> None:
        super().__init__(reason_code, message, line, ask)
        self.path = path


def make_fault_frame(faults: Iterable[Fault]) -> dy.DataFrame[Faults]:
    """Return faults as the table that is stored."""
    return make_frame(Faults, [fault.to_row() for fault in faults])


def say_at_line(line: int, what: str) -> Sentence:
    """Return a sentence with the line that it is about."""
    return say("Line {line}: {what}", line=line, what=what)


def make_fault(error: BaseException, path: str, tow_id: str | None = None) -> Fault:
    """Return the fault an error stands for; `path` serves where the error knows none itself.

    Raises:
        BaseException: the error, where it is neither about the input nor a fault of Herijk.
    """
    if isinstance(error, DefectiveInputError):
        return Fault(
            path=error.path if isinstance(error, DefectiveFileError) else path,
            tow_id=tow_id,
            line=error.line,
            reason_code=error.reason_code,
            message=error.message,
            ask=error.ask if isinstance(error, DefectiveHeaderError) else (),
        )
    if not is_unforeseen(error):
        raise error
    message = say(
        "Herijk itself failed on this list ({}). It may be sound. Please report this to the "
        "maintainer of Herijk, with the folder unforeseen of the data folder.",
        shorten_error(error),
    )
    return Failure(
        path=path,
        tow_id=tow_id,
        reason_code=UNFORESEEN,
        message=message,
        trace=format_traceback(error),
    )
