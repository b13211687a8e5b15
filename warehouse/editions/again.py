"""Whether archive and code of today give a published edition again: every line, table and file.

What comes out otherwise does not say whether the code changed or the edition did: whoever kept the
head of the chain knows (see `verify`).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

import polars as pl
from pydantic import ValidationError

from pipeline.errors import HerijkError, MissingKnowledgeError
from pipeline.messages import say
from pipeline.register.register import LINE
from pipeline.tables.schemas import TABLES
from warehouse.editions import sheets
from warehouse.editions.chain import Finding
from warehouse.editions.compare import parts_of
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
"""Difference up to which a number made again is the same, as a part of the largest of its column.

Other processors leave other last bits, which come to no more in any table (docs/decisions/0017)."""

INPUT_TABLES: Final = ("tows", "tow_runs")
ROWS: Final = {
    "tows": "tow {tow_id}",
    "tow_runs": "tow {tow_id}, run {run}",
    "register": "{fsn_no} {rowers}{crew_class}",
}
"""Tables of which every row that differs is named, and how."""
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
    why = say("the lists of the archive say so now")
    yield from _rows(edition, table, was.select(facts), now.select(facts), "swapped", why)


def _lines(edition: Edition, again: Edition) -> Iterator[Finding]:
    """Lines of the register that come out otherwise."""
    why = say("either the code changed since, or the edition did")
    was, now = edition.tables, again.tables
    if "tows" in was and len(same_tows(was, now)) < was["tows"].height:
        why = say("tows that went into it changed")
    yield from _rows(edition, "register", edition.register, again.register, "differs", why)


def _rows(
    edition: Edition, table: str, was: pl.DataFrame, now: pl.DataFrame, kind: str, why: str
) -> Iterator[Finding]:
    """Rows that come out otherwise, each with what it was and is, and why."""
    for row in differences(was, now, TABLES[table].primary_key()).iter_rows(named=True):
        what = ", ".join(f"{n} {_text(row[n])} > {_text(row[f'{n} now'])}" for n in row["columns"])
        message = say("made again, {}: {}", what, why)
        yield Finding(edition.manifest.edition, kind, ROWS[table].format(**row), message)


def _tables(edition: Edition, again: Edition) -> Iterator[Finding]:
    """The tables behind the lines, where they come out otherwise though the lines do not."""
    for table in sorted(again.tables):
        yield from _table(edition, table, again.tables[table])


def _table(edition: Edition, table: str, now: pl.DataFrame) -> Iterator[Finding]:
    was = edition.tables.get(table, now.clear())
    both = was.drop("causes", strict=False), now.drop("causes", strict=False)
    names = {*differences(*both, TABLES[table].primary_key())["columns"].explode()}
    if "causes" in now.columns and differences(parts_of(was), parts_of(now), LINE).height:
        names.add("causes")  # a text with numbers, which are compared as such
    if names:
        message = say("made again, it comes out otherwise in {}", ", ".join(sorted(names)))
        yield Finding(edition.manifest.edition, "differs", table + PARQUET, message)


def _files(store: Store, edition: Edition) -> Iterator[Finding]:
    """Sheets, texts and lists that do not say what the tables of the edition say."""
    manifest, path = edition.manifest, edition_path(store, edition.manifest.edition)
    bare = {name: frame for name, frame in edition.tables.items() if name != CHANGES}
    # Lists are taken as stated: `verify` looks at them.
    files = sheets.read_inputs(path).select("path", "sha256", "kind")

    if "tows" in bare:
        files = input_files(bare["tows"], files.filter(pl.col("kind") != SAMPLES))
    expected = contents_of(store, Edition(manifest, bare, edition.method), files)
    if CHANGES + PARQUET in expected:
        yield from _table(edition, CHANGES, pl.read_parquet(expected[CHANGES + PARQUET]))
    for file in sorted({*expected, *manifest.files} - {MANIFEST}):
        if file.endswith(PARQUET) and file in expected:
            continue
        found = (path / file).read_bytes() if (path / file).exists() else b""
        if _is_unlike(file, expected.get(file, b""), found):
            message = say("{} does not say what the tables of the edition say", file)
            yield Finding(manifest.edition, "differs", file, message)


def _is_unlike(file: str, was: bytes, now: bytes) -> bool:
    """Whether a file says something else; a workbook packed otherwise says the same."""
    if was == now or file != XLSX:
        return was != now
    return not now or sheets.read_xlsx_cells(was) != sheets.read_xlsx_cells(now)


def differences(was: pl.DataFrame, now: pl.DataFrame, key: Sequence[str]) -> pl.DataFrame:
    """Rows that differ by more than `SAME_NUMBER`; one that is there twice stands beside the first.

    Returns:
        The columns of both (`name` and `name now`), `there` and `there now`: null where there is no
        such row; and `columns`: those that differ.
    """
    names = list(dict.fromkeys([*was.columns, *now.columns]))
    before, after = (
        frame.with_columns(
            *(pl.lit(None).alias(name) for name in names if name not in frame.columns),
            pl.int_range(pl.len()).over(key).alias("row"),
            pl.lit(value=True).alias("there"),
        )
        for frame in (was, now)
    )
    pairs = before.join(
        after,
        on=[*key, "row"],
        how="full",
        coalesce=True,
        suffix=" now",
        nulls_equal=True,
        maintain_order="left_right",
    )
    unequal = {name: _unequal(pairs, name) for name in ("there", *names) if name not in key}
    columns = (pl.when(differs).then(pl.lit(name)) for name, differs in unequal.items())
    return pairs.filter(pl.any_horizontal(unequal.values())).with_columns(
        columns=pl.concat_list(columns).list.drop_nulls()
    )


def _unequal(pairs: pl.DataFrame, name: str) -> pl.Expr:
    """Where a column of pairs of rows differs."""
    one, other = pl.col(name), pl.col(f"{name} now")
    if not (pairs.schema[name].is_float() and pairs.schema[f"{name} now"].is_float()):
        return one.ne_missing(other)
    largest = pairs[name].abs().max()
    limit = SAME_NUMBER * (largest if isinstance(largest, float) else 0.0)
    far = ~((one - other).abs() <= limit)
    return (one.is_null() != other.is_null()) | far.fill_null(value=False)


def _text(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value or "nothing")
