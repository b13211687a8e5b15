"""How the lists of one archive are worded, beside the synonyms that all archives share."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

from warehouse.archive.spelling.columns import Column
from warehouse.archive.spelling.synonyms import HEADERS
from warehouse.archive.spelling.text import fold


@dataclass(frozen=True)
class Wording:
    """How the lists of an archive are worded, beside what `synonyms` knows: from `archief.toml`.

    Attributes:
        words: the value that a folded word stands for; empty text for nothing.
        headers: the project's name of a column by a folded other one.
        ignore: folded names of columns that are known and not used.
        dates: `dmy` or `mdy` by the path of a list, or `*` for all: how 1/3/2015 is meant.
        decimals: the mark before decimals, `.` or `,`, by the path of a list, or `*` for all.
        header_lines: the first and the last line of the header, by the path of a list.
        files: what a file or folder stands for, by its path in the archive: `sleeplijst_2014`.
    """

    words: Mapping[str, str] = field(default_factory=dict)
    headers: Mapping[str, str] = field(default_factory=dict)
    ignore: tuple[str, ...] = ()
    dates: Mapping[str, str] = field(default_factory=dict)
    decimals: Mapping[str, str] = field(default_factory=dict)
    header_lines: Mapping[str, tuple[int, int]] = field(default_factory=dict)
    files: Mapping[str, str] = field(default_factory=dict)

    def with_names(self, columns: Iterable[Column]) -> tuple[Column, ...]:
        """The columns with the other names that they answer to."""
        return tuple(replace(c, also=(*c.also, *self._names(c))) for c in columns)

    def _names(self, column: Column) -> tuple[str, ...]:
        named = {fold(column.header), column.key}
        own = (n for n, meant in self.headers.items() if fold(meant) in named or meant in named)
        return (*HEADERS.get(column.key, ()), *own)
