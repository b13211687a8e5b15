"""Whether archive and code of today give a published edition again: every line, table and file.

What comes out otherwise does not say whether the code changed or the edition did: whoever kept the
head of the chain knows (see `verify`).
"""

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final, NamedTuple

import polars as pl
from pydantic import ValidationError

from pipeline.errors import HerijkError, MissingKnowledgeError
from pipeline.register.register import LINE
from pipeline.tables.row import Row
from pipeline.tables.schemas import TABLES
from pipeline.words import say
from warehouse.archive.files.names import BOATS_FILE
from warehouse.editions import sheets
from warehouse.editions.contents import contents_of
from warehouse.editions.finding import Finding, line_name
from warehouse.editions.inputs import SAMPLES, input_files, inputs_digest, unchanged_tows
from warehouse.editions.lines import BOAT_FACTS, SAME_NUMBER, Again, made_again
from warehouse.editions.printed import AS_PRINTED
from warehouse.store.editions import (
    ABOUT,
    CHANGES,
    METHOD,
    XLSX,
    Edition,
    edition_path,
    read_edition,
)
from warehouse.store.store import Store

CANNOT: Final = (HerijkError, ValidationError, OSError, pl.exceptions.PolarsError)
PARQUET: Final = ".parquet"


class Counts(NamedTuple):
    """Lines of an edition, those made again and those of them that came out equal."""

    lines: int | None = None
    made_again: int | None = None
    equal: int | None = None


def remade(store: Store, name: str) -> tuple[Counts, list[Finding]]:
    """Makes an edition again: how many lines it has and come out equal, and what does not.

    Args:
        store: the editions, and the archive as tables of today.
        name: the edition.
    """
    try:
        edition = read_edition(store, name)
    except MissingKnowledgeError as error:
        message = say("it was made by other code: {}", str(error).splitlines()[0])
        return Counts(), [Finding(name, "differs", METHOD, message)]
    except CANNOT as error:
        return Counts(), [_not_made(name, error)]
    if edition.method is not None and edition.method.content_hash != edition.about.method_hash:
        gone = say("its method has options that there are no longer")
        message = say("it was made by other code: {}", gone)
        return Counts(), [Finding(name, "differs", METHOD, message)]
    lines = edition.register.height
    try:
        again = made_again(store, edition)
        findings = list(_lines(edition, again, _Reasons.of(store, edition)))
        counts = Counts(lines, lines, lines - len({finding.where for finding in findings}))
        if not findings:
            findings = [*_tables(edition, again), *_files(store, edition)]
    except CANNOT as error:
        return Counts(lines, 0, 0), [_not_made(name, error)]
    return counts, findings


def _not_made(name: str, error: Exception) -> Finding:
    reason = str(error).splitlines()[0]
    return Finding(name, "unchecked", "register", say("it cannot be made again: {}", reason))


def _lines(edition: Edition, again: Again, reasons: "_Reasons") -> Iterator[Finding]:
    name, was, now = edition.about.edition, edition.register, again.lines
    for row in now.join(was, on=LINE, how="anti").iter_rows(named=True):
        why = reasons.why(row | {"basis": None}, ())
        message = say("made again, there is a line that the edition has not: {}", why)
        yield Finding(name, "differs", line_name(row), message)
    made = now.with_columns(pl.lit(None).alias(n) for n in was.columns if n not in now.columns)
    pairs = was.join(made, on=LINE, how="left", suffix="_now", maintain_order="left")
    for row in pairs.sort(LINE).iter_rows(named=True):
        facts = [n for n in was.columns if n not in LINE]
        unequal = [n for n in facts if not _same(row[n], row[f"{n}_now"])]
        if unequal:
            what = ", ".join(f"{n} {_text(row[n])} > {_text(row[f'{n}_now'])}" for n in unequal)
            message = say("made again, {}: {}", what, reasons.why(row, unequal))
            yield Finding(name, "differs", line_name(row), message)


def _tables(edition: Edition, again: Again) -> Iterator[Finding]:
    """The tables behind the lines, where they come out otherwise though the lines do not."""
    for name in sorted(again.tables):
        yield from _table(edition, name, again.tables[name])


def _table(edition: Edition, name: str, now: pl.DataFrame) -> Iterator[Finding]:
    was = edition.tables.get(name, now.clear())
    unequal = _unequal_columns(was, now, TABLES[name].primary_key())
    if unequal:
        message = say("made again, it comes out otherwise in {}", ", ".join(unequal))
        yield Finding(edition.about.edition, "differs", name + PARQUET, message)


def _files(store: Store, edition: Edition) -> Iterator[Finding]:
    """Sheets, texts and lists that do not say what the tables of the edition say."""
    about, path = edition.about, edition_path(store, edition.about.edition)
    bare = {name: frame for name, frame in edition.tables.items() if name != CHANGES}
    files = _inputs(sheets.read_inputs(path), bare.get("tows"))
    expected = contents_of(store, Edition(about, bare, edition.method), files)
    if "tows" in bare and about.inputs_digest != inputs_digest(bare["tows"]):
        message = say("{} does not say what the tables of the edition say", ABOUT)
        yield Finding(about.edition, "differs", ABOUT, message)
    for file in sorted({*expected, *about.files} - {ABOUT}):
        if file == CHANGES + PARQUET and file in expected:
            yield from _table(edition, CHANGES, pl.read_parquet(expected[file]))
        elif not file.endswith(PARQUET) and not _says(path / file, expected.get(file)):
            message = say("{} does not say what the tables of the edition say", file)
            yield Finding(about.edition, "differs", file, message)


def _inputs(stated: list[tuple[str, str, str]], tows: pl.DataFrame | None) -> pl.DataFrame:
    """What the edition was made from, by its tows; lists as stated: `verify` looks at them."""
    schema = dict.fromkeys(("path", "kind", "sha256"), pl.String())
    files = pl.DataFrame(stated, schema, orient="row").select("path", "sha256", "kind")
    return files if tows is None else input_files(tows, files.filter(pl.col("kind") != SAMPLES))


def _says(path: Path, content: bytes | None) -> bool:
    """Whether a file says what it should; of a workbook its cells are compared."""
    if content is None or not path.exists():
        return False
    found = path.read_bytes()
    if found != content and path.name == XLSX:
        return sheets.read_xlsx_cells(found) == sheets.read_xlsx_cells(content)
    return found == content


def _unequal_columns(was: pl.DataFrame, now: pl.DataFrame, key: list[str]) -> list[str]:
    """Columns of which a value differs, or that one of the two has not."""
    alone = sorted(set(was.columns) ^ set(now.columns))
    shared = [name for name in was.columns if name in now.columns]
    if was.height != now.height:
        return shared
    one, other = (frame.select(shared).sort(key, nulls_last=True) for frame in (was, now))
    return [*(name for name in shared if not _equal(one[name], other[name])), *alone]


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
    """What is known to make a line of an edition come out otherwise."""

    present: frozenset[str]
    boats_changed: bool
    unchanged: frozenset[str]
    same_inputs: bool

    @classmethod
    def of(cls, store: Store, edition: Edition) -> "_Reasons":
        boats_changed = _boats_changed(store, edition)
        if edition.method is None:
            return cls(frozenset(), boats_changed, frozenset(), same_inputs=True)
        unchanged = unchanged_tows(store, edition)
        present = frozenset(store.read("tows")["tow_id"])
        same_inputs = len(unchanged) == edition.tables["tows"].height
        return cls(present, boats_changed, unchanged, same_inputs)

    def why(self, row: Row, unequal: Collection[str]) -> str:
        """Why a line comes out otherwise."""
        tow = row.get("tow_id")
        if (
            self.boats_changed
            and unequal
            and set(unequal) <= {*BOAT_FACTS, sheets.CODE_FIELD.column}
        ):
            return say("the boat list changed")
        if row["basis"] == AS_PRINTED and not self.present:
            return say("the printed register in the archive says so now")
        if tow is not None and tow not in self.present:
            return say("tow {} is no longer in the warehouse", tow)
        if tow is not None and tow not in self.unchanged:
            return say("the files or the list row of tow {} changed", tow)
        if not self.same_inputs:
            return say("other tows that went into it changed")
        return say("either the code changed since, or the edition did")


def _boats_changed(store: Store, edition: Edition) -> bool:
    """Whether the list of boats is another than when the edition was published."""
    inputs = sheets.read_inputs(edition_path(store, edition.about.edition))
    was = {file: sha256 for file, _, sha256 in inputs}
    now = dict(store.read("listed_files").select("path", "sha256").rows())
    return BOATS_FILE not in was or was[BOATS_FILE] != now.get(BOATS_FILE)


def _same(was: object, now: object) -> bool:
    if isinstance(was, float) and isinstance(now, float):
        return abs(now - was) <= SAME_NUMBER * abs(was)
    return was == now


def _text(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value or "nothing")
