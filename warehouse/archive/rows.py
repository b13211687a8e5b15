"""The rows of lists in a frame: those that can be used stay, each other leaves a fault."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import polars as pl

from pipeline.messages import say
from pipeline.tables.declare import dy
from pipeline.tables.frames import get_declared_column, get_dtypes, limits
from pipeline.tables.lake import ListedTows
from warehouse.archive.columns import shorten
from warehouse.archive.faults import Fault, Lost, say_at_line
from warehouse.archive.kinds import REMARK, ListKind


@dataclass
class Rows:
    """The rows of all lists of one kind.

    Attributes:
        kind: the kind of list.
        frame: a row each: its `path`, `line` and `season`, the tow or boat that it is `about`, the
            declared columns, and what was written in them as the struct `cells`.
        faults: what is set aside.
        lost: the first fault of each tow or boat of which a row is set aside.
        listed: every row that was read, also those that are set aside.
        unread: the lists that cannot be read.
    """

    kind: ListKind
    frame: pl.DataFrame
    faults: list[Fault] = field(default_factory=list)
    lost: dict[str, Fault] = field(default_factory=dict)
    listed: pl.DataFrame = field(default_factory=pl.DataFrame)
    unread: set[str] = field(default_factory=set)

    def add(self, others: "Rows") -> None:
        """Add the rows of another list."""
        self.frame = pl.concat([self.frame, others.frame])
        self.listed = pl.concat([self.listed, others.listed])
        self.faults += others.faults
        self.lost = others.lost | self.lost

    def drop(
        self,
        is_wrong: pl.Expr,
        text: str,
        code: str | None = None,
        lost: Lost | None = None,
        ask: Sequence[str] = (),
        **facts: Any,
    ) -> None:
        """Set rows aside; the arguments are those of `note`."""
        if self.note(is_wrong, text, code, lost, ask=ask, **facts):
            self.frame = self.frame.filter(~is_wrong.fill_null(value=False))

    def empty(self, key: str, is_wrong: pl.Expr, text: str, **facts: Any) -> None:
        """Empty cells that a row can do without."""
        if self.note(is_wrong, text, None, "cell", **facts):
            sound = ~is_wrong.fill_null(value=False)
            self.frame = self.frame.with_columns(pl.when(sound).then(key).alias(key))

    def note(
        self,
        is_wrong: pl.Expr,
        text: str,
        code: str | None = None,
        lost: Lost | None = None,
        asks_word: bool = False,
        ask: Sequence[str] = (),
        **facts: Any,
    ) -> int:
        """Add a fault for rows; return for how many.

        Args:
            is_wrong: which rows; what is not known is not wrong.
            text: the sentence.
            code: its reason code; None for that of the list.
            lost: what it costs, if not the row.
            asks_word: whether a meaning can be given to the word that `cell` is.
            ask: lines of `archief.toml` that would settle it, in which facts are filled in.
            facts: what is filled in: a value, or an expression of the rows.
        """
        if self.frame.filter(is_wrong).is_empty():
            return 0
        of_rows = {f"_{name}": fact for name, fact in facts.items() if isinstance(fact, pl.Expr)}
        place = pl.col("path", "sheet", "line", "about")
        known = self.frame.lazy().select(place, _wrong=is_wrong, **of_rows)
        wrong_rows = known.filter("_wrong").collect()
        for row in wrong_rows.iter_rows(named=True):
            filled = {name[1:]: row[name] for name in of_rows}
            shown = dict(facts)
            for name, value in filled.items():
                is_cell = isinstance(value, str) and name != "other"
                shown[name] = shorten(value) if is_cell else value
            what = say(text, **shown)
            if row["sheet"]:
                what = say("sheet '{sheet}': {what}", sheet=row["sheet"], what=what)
            message = say_at_line(row["line"], what)
            if lost == "cell":
                message = say("{what} The cell counts as empty.", what=message)
            lines = [line.format(**filled) for line in ask]
            if asks_word:
                word = filled["cell"].replace("\\", "\\\\").replace('"', '\\"')
                lines.append(f'[words]\n"{word}" = "?"')
            fault = Fault(
                path=row["path"],
                tow_id=row["about"] if self.kind.about == "tow_id" else None,
                line=row["line"],
                reason_code=code or self.kind.reason_code,
                message=message,
                lost=lost,
                ask=tuple(lines),
            )
            self.faults.append(fault)
            if row["about"]:
                self.lost.setdefault(row["about"], fault)
        return wrong_rows.height

    def drop_copies(self, per_file: bool = False) -> None:
        """Keep the first of rows with equal values: a list can be there twice, as .csv and .xlsx.

        Args:
            per_file: rows of one file may repeat each other; only those of another are copies.
        """
        declared = get_dtypes(self.kind.table)
        floats = []
        others = ["season"]
        for key in self.kind.keys:
            if key in declared and declared[key].is_float():
                floats.append(key)
            elif key != REMARK:
                others.append(key)
        # 8.28 km/h and 2.3 m/s are one speed, though their last bits differ.
        value = pl.struct(pl.col(others), pl.col(floats).round_sig_figs(9))
        nth = pl.int_range(pl.len()).over(value, "path", "sheet") if per_file else pl.lit(0)
        self.frame = self.frame.with_columns(_value=value, _nth=nth)
        self.frame = self.frame.unique(["_value", "_nth"], keep="first", maintain_order=True)
        self.frame = self.frame.drop("_value", "_nth")

    def drop_repeated(self, about: Sequence[str], text: str, code: str | None = None) -> None:
        """Keep the rows of which there is one about a thing; equal rows count once.

        Args:
            about: the columns that name the thing.
            text: the sentence; `of` is the thing, `other` and `line` where another row stands.
            code: its reason code; None for that of the list.
        """
        self.drop_copies()
        of = pl.concat_str(about, separator=" ")
        key = pl.struct(about)
        is_first = pl.int_range(pl.len()).over(key) == 0
        in_sheet = pl.format("{}, sheet '{}'", "path", "sheet")
        where = pl.when(pl.col("sheet") == "").then("path").otherwise(in_sheet)
        self.frame = self.frame.with_columns(_line="line", _other=where)
        place = pl.col("_line", "_other")
        first, second = place.first().over(key), place.get(1, null_on_oob=True).over(key)
        self.frame = self.frame.with_columns(pl.when(is_first).then(second).otherwise(first))
        line, other = pl.col("_line"), pl.col("_other")
        self.drop(key.is_duplicated(), text, code, of=of, line=line, other=other)
        self.frame = self.frame.drop("_line", "_other")

    def drop_other_years(self, day: str, code: str | None = None) -> None:
        """Set aside the rows whose day is not in the year of their list."""
        text = say("the date {day} is not in {season}, the year of the list.")
        is_other = pl.col(day).dt.year() != pl.col("season")
        self.drop(is_other, text, code, day=pl.col(day), season=pl.col("season"))

    def to_table(self, table: type[dy.Schema]) -> pl.DataFrame:
        """Return the rows as a table; the year of a list was not held against its limits yet."""
        if self.frame.is_empty():
            return table.create_empty()
        low, high = limits(ListedTows, "season")
        text = say("the year is {cell}; {low:g} to {high:g} can be right.")
        season = pl.col("season")
        self.drop(~season.is_between(low, high), text, cell=season, low=low, high=high)
        return table.validate(self.frame.select(table.column_names()), cast=True)


def cell(key: str) -> pl.Expr:
    """Return the text of a column as it is written; null for nothing."""
    return pl.col("cells").struct.field(key)


def make_empty_rows(kind: ListKind) -> pl.DataFrame:
    """Return the frame of a list without any row."""
    declared = get_dtypes(kind.table)
    values = {key: declared.get(key, pl.String()) for key in kind.keys}
    cells = pl.Struct(dict.fromkeys(kind.keys, pl.String))
    place: dict[str, pl.DataType] = {
        "path": pl.String(),
        "sheet": pl.String(),
        "line": pl.Int64(),
        "season": pl.Int32(),
        "about": pl.String(),
    }
    return pl.DataFrame(schema=place | values | {"cells": cells})


def find_declared_column(kind: ListKind, key: str) -> dy.Column | None:
    """Return the column as its table declares it; None for one that is only used here."""
    return get_declared_column(kind.table, key) if key in kind.table.column_names() else None
