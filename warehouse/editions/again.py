"""Whether archive and code of today give a published edition again: every line, table and file.

What comes out otherwise does not say whether the code changed or the edition did: whoever kept the
head of the chain knows (see `verify`).
"""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

import polars as pl
from pydantic import ValidationError

from pipeline.errors import HerijkError, MissingKnowledgeError
from pipeline.messages import say
from pipeline.register.register import LINE
from pipeline.tables.row import Row
from pipeline.tables.schemas import TABLES
from warehouse.editions import sheets
from warehouse.editions.chain import Finding
from warehouse.editions.contents import contents_of
from warehouse.editions.inputs import NOT_INPUT, SAMPLES, input_files, same_tows
from warehouse.editions.making import made_again
from warehouse.store.editions import (
    CHANGES,
    MANIFEST,
    METHOD,
    PARQUET,
    XLSX,
    Edition,
    edition_path,
    read_edition,
)
from warehouse.store.store import Store

SAME_NUMBER: Final = 1e-9
"""Relative difference up to which a number made again is the same.

Other processors leave other last bits, which come to no more in any table (docs/decisions/0017)."""

INPUT_TABLES: Final = ("tows", "tow_runs")
CANNOT: Final = (HerijkError, ValidationError, OSError, ValueError, pl.exceptions.PolarsError)


@dataclass(frozen=True)
class CheckedEdition:
    """An edition that was checked.

    Attributes:
        edition: its name.
        kind: `recomputed` or `as_printed`.
        lines: its lines; with the next two None where it cannot be read.
        made_again: how many of them were made again.
        equal: how many of those came out equal.
    """

    edition: str
    kind: str
    lines: int | None
    made_again: int | None
    equal: int | None


def differing(store: Store, checked: CheckedEdition) -> tuple[CheckedEdition, list[Finding]]:
    """Makes an edition again: how many lines it has and come out equal, and what does not.

    Args:
        store: the editions, and the archive as tables of today.
        checked: which, not counted yet.
    """
    name = checked.edition
    try:
        edition = read_edition(store, name)
    except MissingKnowledgeError as error:
        return checked, [_by_other_code(name, str(error).splitlines()[0])]
    except CANNOT as error:
        return checked, [_not_made(name, error)]
    if edition.method is not None and edition.method.content_hash != edition.manifest.method_hash:
        return checked, [
            _by_other_code(name, say("its method has options that there are no longer"))
        ]
    height = edition.register.height
    try:
        again = made_again(store, edition)
        inputs = [f for table in INPUT_TABLES for f in _inputs(edition, again, table)]
        lines = list(_lines(edition, again))
        others = [] if inputs or lines else [*_tables(edition, again), *_files(store, edition)]
    except CANNOT as error:
        return replace(checked, lines=height, made_again=0, equal=0), [_not_made(name, error)]
    counted = replace(checked, lines=height, made_again=height, equal=height - len(lines))
    return counted, [*inputs, *lines, *others]


def _by_other_code(name: str, reason: str) -> Finding:
    return Finding(name, "differs", METHOD, say("it was made by other code: {}", reason))


def _not_made(name: str, error: Exception) -> Finding:
    reason = str(error).splitlines()[0]
    return Finding(name, "unchecked", "register", say("it cannot be made again: {}", reason))


def _inputs(edition: Edition, again: Edition, table: str) -> Iterator[Finding]:
    """Tows and runs of which the lists say something else now."""
    if table not in edition.tables:
        return
    was, now = edition.tables[table], again.tables[table]
    facts = [
        name
        for name in was.columns
        if name in now.columns and name not in NOT_INPUT and not name.endswith("_sha256")
    ]
    key = TABLES[table].primary_key()
    for one, other, unequal in _differences(was.select(facts), now.select(facts), key):
        row = one or other or {}
        name = "tow " + ", run ".join(str(row[k]) for k in key)
        if other is None:
            message = say("{} is no longer in the warehouse", name)
            yield Finding(edition.manifest.edition, "missing", name, message)
            continue
        for fact in unequal:
            message = say("{}: {} is {}; it was {}", name, fact, other[fact], row[fact])
            yield Finding(edition.manifest.edition, "swapped", name, message)


def _lines(edition: Edition, again: Edition) -> Iterator[Finding]:
    """Lines of the register that come out otherwise."""
    why = say("either the code changed since, or the edition did")
    was, now = edition.tables, again.tables
    if "tows" in was and len(same_tows(was, now)) < was["tows"].height:
        why = say("tows that went into it changed")
    for one, other, unequal in _differences(edition.register, again.register, LINE):
        if one is None:
            message = say("made again, there is a line that the edition has not: {}", why)
        else:
            made = other or {}
            what = ", ".join(f"{n} {_text(one.get(n))} > {_text(made.get(n))}" for n in unequal)
            message = say("made again, {}: {}", what, why)
        row = one or other or {}
        where = f"{row['fsn_no']} {row['rowers']}{row['crew_class']}"
        yield Finding(edition.manifest.edition, "differs", where, message)


def _tables(edition: Edition, again: Edition) -> Iterator[Finding]:
    """The tables behind the lines, where they come out otherwise though the lines do not."""
    for table in sorted(again.tables):
        yield from _table(edition, table, again.tables[table])


def _table(edition: Edition, table: str, now: pl.DataFrame) -> Iterator[Finding]:
    was = edition.tables.get(table, now.clear())
    key = TABLES[table].primary_key()
    unequal = {name for *_, names in _differences(was, now, key) for name in names}
    if unequal:
        message = say("made again, it comes out otherwise in {}", ", ".join(sorted(unequal)))
        yield Finding(edition.manifest.edition, "differs", table + PARQUET, message)


def _files(store: Store, edition: Edition) -> Iterator[Finding]:
    """Sheets, texts and lists that do not say what the tables of the edition say."""
    manifest, path = edition.manifest, edition_path(store, edition.manifest.edition)
    bare = {name: frame for name, frame in edition.tables.items() if name != CHANGES}
    files = _made_from(sheets.read_inputs(path), bare.get("tows"))
    expected = contents_of(store, Edition(manifest, bare, edition.method), files)
    if CHANGES + PARQUET in expected:
        yield from _table(edition, CHANGES, pl.read_parquet(expected[CHANGES + PARQUET]))
    for file in sorted({*expected, *manifest.files} - {MANIFEST}):
        if file.endswith(PARQUET):
            continue
        found = (path / file).read_bytes() if (path / file).exists() else b""
        if _is_unlike(file, expected.get(file, b""), found):
            message = say("{} does not say what the tables of the edition say", file)
            yield Finding(manifest.edition, "differs", file, message)


def _made_from(stated: list[tuple[str, str, str]], tows: pl.DataFrame | None) -> pl.DataFrame:
    """What the edition was made from, by its tows; lists as stated: `verify` looks at them."""
    schema = dict.fromkeys(("path", "kind", "sha256"), pl.String())
    files = pl.DataFrame(stated, schema, orient="row").select("path", "sha256", "kind")
    return files if tows is None else input_files(tows, files.filter(pl.col("kind") != SAMPLES))


def _is_unlike(file: str, was: bytes, now: bytes) -> bool:
    """Whether a file says something else; a workbook packed otherwise says the same."""
    if was == now or file != XLSX:
        return was != now
    return not now or sheets.read_xlsx_cells(was) != sheets.read_xlsx_cells(now)


def _differences(
    was: pl.DataFrame, now: pl.DataFrame, key: Sequence[str]
) -> Iterator[tuple[Row | None, Row | None, list[str]]]:
    """Rows that differ, as they were and are, and in which columns; None where there is none.

    Numbers are the same up to `SAME_NUMBER` of the largest of their column.
    """
    names = list(dict.fromkeys([*was.columns, *now.columns]))
    limits = {c.name: SAME_NUMBER * _largest(c) for c in was if c.dtype.is_float()}
    before, after = (_by_key(frame, key) for frame in (was, now))
    for place in before | after:
        one, other = before.get(place), after.get(place)
        unequal = [
            name
            for name in names
            if not _same((one or {}).get(name), (other or {}).get(name), limits.get(name, 0.0))
        ]
        if unequal:
            yield one, other, unequal


def _by_key(frame: pl.DataFrame, key: Sequence[str]) -> dict[tuple[object, ...], Row]:
    """Rows by their key; one that is there twice stands beside the first."""
    count = pl.int_range(pl.len()).over(key)
    places = frame.select(*key, count.alias("count")).rows()
    return dict(zip(places, frame.iter_rows(named=True), strict=True))


def _largest(numbers: pl.Series) -> float:
    largest = numbers.abs().max()
    return largest if isinstance(largest, float) else 0.0


def _same(was: object, now: object, limit: float) -> bool:
    if isinstance(was, float) and isinstance(now, float):
        return abs(now - was) <= limit
    return was == now or _same_factors(was, now)


def _same_factors(was: object, now: object) -> bool:
    """Whether two texts list the same causes, with factors up to the last digits."""
    try:
        before, after = json.loads(str(was)), json.loads(str(now))
        return type(before) is type(after) is list and all(
            one.keys() == other.keys()
            and all(_same(one[name], other[name], SAME_NUMBER) for name in one)
            for one, other in zip(before, after, strict=True)
        )
    except (ValueError, TypeError, AttributeError):  # not a list of causes
        return False


def _text(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value or "nothing")
