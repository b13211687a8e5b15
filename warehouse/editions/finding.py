"""What `verify` finds."""

from dataclasses import dataclass

from pipeline.tables.row import Row


@dataclass(frozen=True)
class Finding:
    """Something that is not as it was.

    Attributes:
        edition: the edition.
        kind: `altered`, `missing`, `swapped`, `differs` (made again, another number), `unchecked`
            or `notice`.
        where: file, tow or line.
        message: what is seen, what it was, what to do.
        wrong: whether a promise is broken; a notice breaks none.
    """

    edition: str
    kind: str
    where: str
    message: str
    wrong: bool = True


def line_name(row: Row) -> str:
    """A line of the register, as findings name it."""
    return f"{row['fsn_no']} {row['rowers']}{row['crew_class']}"
