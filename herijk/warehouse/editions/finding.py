"""What `verify` finds."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Finding:
    """Something that is not as it was.

    Attributes:
        edition: the edition.
        kind: `altered`, `missing`, `swapped`, `differs` (made again, another number), `unchecked`
            or `notice`.
        where: file, tow or line.
        message: what is seen, what it was, what to do.
        wrong: whether a promise is broken; a notice is none.
    """

    edition: str
    kind: str
    where: str
    message: str
    wrong: bool = True
