"""The one family of errors. Four kinds, because the right reaction to each differs.

Defective input is set aside and the rest goes on; missing knowledge stops a season; a broken
promise stops everything; where the machine is in the way, the same is tried again later. A message
says what, where, what was observed, what the limit is and the way out. Exit statuses belong to the
command, not here.
"""

from pipeline.messages import Sentence, say


class HerijkError(Exception):
    """Something a user can act on; the text says how.

    Args:
        message: what is wrong, with braces for the values.
        values: what is filled in.
    """

    def __init__(self, message: str, *values: object) -> None:
        super().__init__(message if isinstance(message, Sentence) else say(message, *values))


class DefectiveInputError(HerijkError):
    """One tow or file cannot be used. It is set aside, counted, and the others go on.

    Args:
        reason_code: short stable code, e.g. `bad_number`, as in the quarantine table.
        message: a sentence that a volunteer understands.
        line: line in the file (header is line 1), where there is one.
    """

    def __init__(self, reason_code: str, message: str, line: int | None = None) -> None:
        super().__init__(message)
        self.reason_code = reason_code
        self.message = message
        self.line = line


class MissingKnowledgeError(HerijkError):
    """No method, profile or parameter covers this case; nothing is guessed."""


class NoTowsYetError(MissingKnowledgeError):
    """The archive has no tow that can be used, and never had one: there is nothing to compute."""


class BrokenPromiseError(HerijkError):
    """A schema, hash or frozen edition is not what it was declared to be."""


class UnavailableError(HerijkError):
    """The machine is in the way: someone else writes, the disk is full. Nothing is lost."""


def describe_unforeseen(error: BaseException) -> str:
    """Return one sentence for an error that nobody foresaw."""
    what = " ".join(str(error).split())[:300]
    return say("an unexpected error: {}: {}", type(error).__name__, what)
