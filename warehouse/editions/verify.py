"""Whether everything still is what it was: editions, the archive behind them, and the numbers.

Integrity: is every file what its manifest says, and every seal what the next edition says, up to
the head, which people keep? Sources: are the archive's files those that an edition was made from?
Reproduction: do they give its tables and sheets again, read anew by the code of today? Where they
do not, the code changed or the edition did; the head decides. The words of a notice are not made
again: seal and head cover them. Nothing is ever mended here.
"""

import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import polars as pl

from pipeline.errors import HerijkError, MissingKnowledgeError
from pipeline.messages import say
from pipeline.register.causes import explode_causes
from pipeline.register.register import LINE
from pipeline.tables.schemas import TABLES
from warehouse.archive import FileHashes
from warehouse.derive.archive_tables import read_archive
from warehouse.editions import sheets
from warehouse.editions.inputs import JUDGED, find_same_tows
from warehouse.editions.integrity import (
    READING_ERRORS,
    Finding,
    check_chain,
    check_files,
    check_manifest,
    check_sources,
    report_unchecked,
)
from warehouse.editions.making import make_again, make_sheet_files
from warehouse.store.decisions import FILE_NAME as DECISIONS
from warehouse.store.editions import (
    CHANGES,
    METHOD,
    PARQUET,
    XLSX,
    Edition,
    find_chain_head,
    find_manifest,
    get_edition_path,
    is_plain_file,
    read_edition,
    read_manifests,
)
from warehouse.store.store import Store, find_archive_root

SAME_NUMBER: Final = 1e-9
"""Difference up to which a number made again is the same, as a part of the largest of its column.
Other processors leave other last bits, which come to no more in any table (docs/decisions.md)."""

ROW_NAMES: Final = {
    "tows": "tow {tow_id}",
    "tow_runs": "tow {tow_id}, run {run}",
    "register": "{fsn_no} {rowers}{crew_class}",
}
"""Tables of which every row that differs is named, and how; inputs first."""

FOLLOWING: Final = ("inputs_sha256",) + JUDGED
"""What the tables of an edition say of a tow that follows from the rest, or from other tows."""


@dataclass(frozen=True)
class CheckedEdition:
    """An edition that was checked.

    Attributes:
        edition: its name.
        kind: `recomputed` or `as_printed`.
        lines: its lines; None where it cannot be read.
        equal: lines that come out equal when made again; None where it cannot be made again.
    """

    edition: str
    kind: str
    lines: int | None = None
    equal: int | None = None


@dataclass(frozen=True)
class Verification:
    """What `verify` found.

    Attributes:
        editions: those checked.
        head: the seal of the last edition published.
        findings: what is not as it was.
        wrong: whether any finding is more than a notice.
        is_without_head: whether no seal was given to compare the head with, so that nobody can see
            whether the last edition was removed.
    """

    editions: list[CheckedEdition]
    head: str | None
    findings: list[Finding]
    wrong: bool
    is_without_head: bool


def verify(store: Store, afresh: bool = True, head: str | None = None) -> Verification:
    """Check every published edition; each gets its findings, whatever the others are.

    Args:
        store: the data folder.
        afresh: read every file of the archive again, instead of trusting its size and time, and
            the lake.
        head: the seal of the last edition as it was written down. Where it is still that, no
            edition was altered, and what comes out otherwise is the work of other code.
    """
    manifests, damaged = read_manifests(store)
    last = find_chain_head(store)
    seal = None if last is None else last.seal
    findings = list(check_chain(store, manifests, seal, head))
    for name, error in damaged.items():
        where = find_manifest(store.editions / name).name
        findings.append(Finding(name, "altered", where, str(error)))
    archive = find_archive_root(store)
    hashes = FileHashes() if afresh else FileHashes.load(store.file_hashes)
    can_be_read = []
    for name, manifest in manifests.items():
        path = store.editions / name
        findings += check_files(path, manifest)
        findings += check_manifest(store, manifest, manifests)
        if all(is_plain_file(path / file) for file in manifest.files):
            can_be_read.append(name)
            findings += check_sources(path, manifest, archive, hashes)
    checked = [CheckedEdition(name, manifest.kind) for name, manifest in manifests.items()]
    by_other_code = head is not None and head == seal
    try:
        with _read_archive_again(store, archive if afresh else None) as again:
            for place, edition in enumerate(checked):
                if edition.edition not in can_be_read:
                    continue
                checked[place], differing = check_reproduction(again, edition)
                for finding in differing:
                    is_wrong = finding.wrong and not (finding.kind == "differs" and by_other_code)
                    findings.append(replace(finding, wrong=is_wrong))
    except HerijkError as error:
        findings += [report_unchecked(name, error) for name in can_be_read]
    is_wrong = any(finding.wrong for finding in findings)
    return Verification(checked, seal, findings, is_wrong, is_without_head=head is None)


@contextmanager
def _read_archive_again(store: Store, archive: Path | None) -> Iterator[Store]:
    """Yield a data folder with the same editions, made of the archive's files alone."""
    if archive is None:
        yield store
        return
    with tempfile.TemporaryDirectory() as folder:
        again = Store(Path(folder))
        again.editions.symlink_to(store.editions.resolve())
        if (store.root / DECISIONS).exists():
            shutil.copy(store.root / DECISIONS, again.root)
        read_archive(again, archive)
        yield again


def check_reproduction(
    store: Store, checked: CheckedEdition
) -> tuple[CheckedEdition, list[Finding]]:
    """Make an edition again and compare it: inputs, lines, other tables, then sheets.

    Args:
        store: the editions, and the archive as tables of today.
        checked: which edition, not counted yet.

    Returns:
        The edition with the number of its lines that come out equal, and what does not.
    """
    name = checked.edition
    try:
        edition = read_edition(store, name)
        method = edition.method
        if method is not None and method.content_hash != edition.manifest.method_hash:
            raise MissingKnowledgeError("its method has options that there are no longer")
    except MissingKnowledgeError as error:
        message = say("it was made by other code: {}", str(error).splitlines()[0])
        return checked, [Finding(name, "differs", METHOD, message)]
    except READING_ERRORS as error:
        return checked, [report_unchecked(name, error)]
    try:
        checked = replace(checked, lines=edition.register.height)
        again = make_again(store, edition)
        findings: list[Finding] = []
        for table in ROW_NAMES:
            findings += _compare_rows(edition, again, table)
        if not findings:  # else the rest follows from it
            for table in sorted(again.tables.keys() - ROW_NAMES.keys()):
                findings += _compare_table(edition, again, table)
            findings += _compare_sheets(store, edition)
        key = TABLES["register"].primary_key()
        other = find_differences(edition.register, again.register, key).drop_nulls("there").height
    except READING_ERRORS as error:
        return checked, [report_unchecked(name, error)]
    return replace(checked, equal=edition.register.height - other), findings


def _compare_rows(edition: Edition, again: Edition, table: str) -> Iterator[Finding]:
    """Find each row of the inputs or lines that comes out otherwise."""
    if table not in again.tables:
        return
    was, now = edition.tables.get(table, again.tables[table].clear()), again.tables[table]
    kind, why = "differs", say("either the code changed since, or the edition did")
    if table != "register":
        kind, why = "swapped", say("the lists of the archive say so now")
        known = [n for n in was.columns if n in now.columns and n not in FOLLOWING]
        facts = [name for name in known if not name.endswith("_sha256")]
        was, now = was.select(facts), now.select(facts)
    elif "tows" in edition.tables:
        n_same = len(find_same_tows(edition.tables, again.tables))
        if n_same < edition.tables["tows"].height:
            why = say("tows that went into it changed")
    for row in find_differences(was, now, TABLES[table].primary_key()).iter_rows(named=True):
        changed = [
            f"{n} {_format_value(row[n])} > {_format_value(row[f'{n} now'])}"
            for n in row["columns"]
        ]
        message = say("made again, {}: {}", ", ".join(changed), why)
        yield Finding(edition.manifest.edition, kind, ROW_NAMES[table].format(**row), message)
    for column in was.columns:
        if column not in now.columns:
            message = say("it has a column {}, which comes from nothing", column)
            yield Finding(edition.manifest.edition, "differs", table + PARQUET, message)


def _compare_table(edition: Edition, again: Edition, table: str) -> Iterator[Finding]:
    """Find the columns of a table that come out otherwise."""
    was, now = edition.tables.get(table, again.tables[table].clear()), again.tables[table]
    rows = find_differences(
        was.drop("causes", strict=False),
        now.drop("causes", strict=False),
        TABLES[table].primary_key(),
    )
    columns = set(rows["columns"].explode())
    if table == CHANGES and find_differences(explode_causes(was), explode_causes(now), LINE).height:
        columns.add("causes")  # a text with numbers, which are compared as such
    if columns:
        message = say("made again, it differs in {}", ", ".join(sorted(columns)))
        yield Finding(edition.manifest.edition, "differs", table + PARQUET, message)


def _compare_sheets(store: Store, edition: Edition) -> Iterator[Finding]:
    """Find sheets and lists that do not say what the tables of the edition say."""
    name, path = edition.manifest.edition, get_edition_path(store, edition.manifest.edition)
    for file, content in sorted(make_sheet_files(store, edition).items()):
        found = (path / file).read_bytes() if (path / file).exists() else b""
        if file == XLSX:
            is_same = sheets.shows_the_same(found, edition.register, sheets.SHEET_FIELDS)
        else:
            is_same = found == content
        if not is_same:
            message = say("{} does not say what the tables of the edition say", file)
            yield Finding(name, "differs", file, message)


def find_differences(was: pl.DataFrame, now: pl.DataFrame, key: Sequence[str]) -> pl.DataFrame:
    """Return rows that differ by more than `SAME_NUMBER`; of equal keys the first pair up.

    Returns:
        The columns of both (`name` and `name now`), `there` and `there now`: null where there is no
        such row; and `columns`: those that differ.
    """
    names = list(dict.fromkeys(was.columns + now.columns))
    numbered = []
    for frame in (was, now):
        lacking = {name: pl.lit(None) for name in names if name not in frame.columns}
        row = pl.int_range(pl.len()).over(key)
        numbered.append(frame.with_columns(**lacking, row=row, there=pl.lit(value=True)))
    pairs = numbered[0].join(
        numbered[1],
        on=list(key) + ["row"],
        how="full",
        coalesce=True,
        suffix=" now",
        nulls_equal=True,
        maintain_order="left_right",
    )
    unequal = []
    columns = []
    for name in ["there"] + names:
        if name not in key:
            is_unequal = _compare_columns(pairs, name)
            unequal.append(is_unequal)
            columns.append(pl.when(is_unequal).then(pl.lit(name)))
    return pairs.filter(pl.any_horizontal(unequal)).with_columns(
        columns=pl.concat_list(columns).list.drop_nulls()
    )


def _compare_columns(pairs: pl.DataFrame, name: str) -> pl.Expr:
    one, other = pl.col(name), pl.col(f"{name} now")
    if not (pairs.schema[name].is_float() and pairs.schema[f"{name} now"].is_float()):
        return one.ne_missing(other)
    largest = pairs[name].abs().max()
    limit = SAME_NUMBER * (largest if isinstance(largest, float) else 0.0)
    is_far = ~((one - other).abs() <= limit)
    return (one.is_null() != other.is_null()) | is_far.fill_null(value=False)


def _format_value(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value or "nothing")
