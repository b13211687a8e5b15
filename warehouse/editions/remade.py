"""Whether archive and code of today give a published edition again: lines, tables and texts."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, NamedTuple

import polars as pl
from pydantic import ValidationError

from pipeline.errors import HerijkError
from pipeline.register.register import LINE
from pipeline.tables.row import Row
from pipeline.tables.schemas import TABLES
from pipeline.words import say
from warehouse.archive.files.names import BOATS_FILE
from warehouse.derive.version import code_version
from warehouse.editions import sheets
from warehouse.editions.finding import Finding, line_name
from warehouse.editions.inputs import unchanged_tows
from warehouse.editions.lines import BOAT_FACTS, SAME_NUMBER, Again, made_again
from warehouse.editions.printed import AS_PRINTED
from warehouse.store.editions import About, Edition, read_edition
from warehouse.store.store import Store

NEVER_TOWED: Final = "never_towed"

FLAGS: Final = "flags"
"""They follow from what is known of other tows, which grows."""

_OWN: Final = ("edition", "method", "verification_code", "inputs_sha256")
"""Columns of a line that are checked elsewhere."""


class Counts(NamedTuple):
    """Lines of an edition, those made again and those of them that came out equal."""

    lines: int | None = None
    made_again: int | None = None
    equal: int | None = None


def remade(store: Store, name: str) -> tuple[Counts, list[Finding]]:
    """Makes an edition again: how many lines it has and come out equal, and what does not."""
    try:
        edition = read_edition(store, name)
    except (HerijkError, ValidationError, OSError) as error:
        return Counts(), [_not_made(name, error)]
    to_make = edition.register.filter(pl.col("status") != NEVER_TOWED)
    lines = edition.register.height
    try:
        again = made_again(store, edition)
    except (HerijkError, ValidationError, OSError, pl.exceptions.PolarsError) as error:
        return Counts(lines, 0, 0), [_not_made(name, error)]
    reasons = _Reasons.of(store, edition)
    findings = list(_differing(store, edition, to_make, again, reasons))
    counts = Counts(lines, to_make.height, to_make.height - len(findings))
    if not findings and reasons.same_inputs:
        findings += _other_tables(edition, again)
    return counts, findings


def _not_made(name: str, error: Exception) -> Finding:
    reason = str(error).splitlines()[0]
    return Finding(name, "unchecked", "register", say("it cannot be made again: {}", reason))


def _differing(
    store: Store, edition: Edition, lines: pl.DataFrame, again: Again, reasons: "_Reasons"
) -> Iterator[Finding]:
    now = again.lines.drop(FLAGS, strict=False).join(
        store.read("listed_boats").select("fsn_no", *BOAT_FACTS),
        on="fsn_no",
        how="left",
        maintain_order="left",
    )
    said = [name for name in lines.columns if name in now.columns]
    known = [name for name in said if name not in (*LINE, "basis", *_OWN)]
    pairs = lines.select(*LINE, "basis", *known).join(
        now.select(*LINE, *known), on=LINE, how="left", suffix="_now", maintain_order="left"
    )
    for row in now.join(edition.register, on=LINE, how="anti").iter_rows(named=True):
        why, wrong = reasons.why(row | {"basis": None})
        message = say("made again, there is a line that the edition has not: {}", why)
        yield Finding(edition.about.edition, "differs", line_name(row), message, wrong)
    for row in pairs.sort(LINE).iter_rows(named=True):
        unequal = [n for n in known if not _same(row[n], row[f"{n}_now"])]
        if not unequal:
            continue
        why, wrong = reasons.why(row)
        if set(unequal) <= set(BOAT_FACTS) and reasons.boats_changed:
            why, wrong = say("the boat list changed"), False
        what = ", ".join(f"{n} {_text(row[n])} > {_text(row[f'{n}_now'])}" for n in unequal)
        message = say("made again, {}: {}", what, why)
        yield Finding(edition.about.edition, "differs", line_name(row), message, wrong)


def _other_tables(edition: Edition, again: Again) -> Iterator[Finding]:
    """The tables behind the lines, where they come out otherwise though the lines do not."""
    new_code = edition.about.code_version != code_version()
    why = say("the code changed") if new_code else say("this should not happen")
    for name, now in again.tables.items():
        unequal = _unequal_columns(edition.tables[name], now, TABLES[name].primary_key())
        if unequal:
            message = say("made again, it comes out otherwise in {}: {}", ", ".join(unequal), why)
            file = f"{name}.parquet"
            yield Finding(edition.about.edition, "differs", file, message, not new_code)


def _unequal_columns(was: pl.DataFrame, now: pl.DataFrame, key: list[str]) -> list[str]:
    """Columns of which a value differs."""
    shared = [name for name in was.columns if name in now.columns and name != FLAGS]
    if was.height != now.height:
        return shared
    one, other = (frame.select(shared).sort(key, nulls_last=True) for frame in (was, now))
    return [name for name in shared if not _equal(one[name], other[name])]


def _equal(was: pl.Series, now: pl.Series) -> bool:
    """Equal values; numbers to their last digits, as a share of the largest."""
    if not was.dtype.is_float():
        return was.equals(now)
    if not was.is_null().equals(now.is_null()):
        return False
    largest = was.abs().max()
    limit = SAME_NUMBER * float(largest) if isinstance(largest, float) else 0.0
    return bool(((was - now).abs() <= limit).all())


@dataclass(frozen=True)
class _Reasons:
    """What can make a line of an edition come out otherwise."""

    about: About
    present: frozenset[str]
    boats_changed: bool
    unchanged: frozenset[str]
    same_inputs: bool

    @classmethod
    def of(cls, store: Store, edition: Edition) -> "_Reasons":
        boats_changed = _boats_changed(store, edition)
        if edition.method is None:
            return cls(edition.about, frozenset(), boats_changed, frozenset(), same_inputs=True)
        unchanged = unchanged_tows(store, edition)
        present = frozenset(store.read("tows")["tow_id"])
        same_inputs = len(unchanged) == edition.tables["tows"].height
        return cls(edition.about, present, boats_changed, unchanged, same_inputs)

    def why(self, row: Row) -> tuple[str, bool]:
        """Why a line comes out otherwise, and whether that breaks a promise."""
        if row["basis"] == AS_PRINTED and self.about.kind == "as_printed":
            return say("the printed register in the archive says so now"), True
        tow = row.get("tow_id")
        if tow is not None and tow not in self.present:
            return say("tow {} is no longer in the warehouse", tow), True
        if tow is not None and tow not in self.unchanged:
            return say("the files or the list row of tow {} changed", tow), True
        if not self.same_inputs:
            return say("other tows that went into it changed"), True
        if self.about.code_version != code_version():
            was, now = self.about.code_version, code_version()
            return say("the code changed, from {} to {}", was, now), False
        return say("inputs, method and code are the same; this should not happen"), True


def _boats_changed(store: Store, edition: Edition) -> bool:
    """Whether the list of boats is another than when the edition was published."""
    inputs = sheets.read_inputs(store.editions / edition.about.edition)
    was = {file: sha256 for file, _, sha256 in inputs}
    now = dict(store.read("listed_files").select("path", "sha256").rows())
    return BOATS_FILE not in was or was[BOATS_FILE] != now.get(BOATS_FILE)


def _same(was: float | str | None, now: float | str | None) -> bool:
    if isinstance(was, float) and isinstance(now, float):
        return abs(now - was) <= SAME_NUMBER * abs(was)
    return was == now


def _text(value: float | str | None) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value or "nothing")
