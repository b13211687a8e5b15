"""Whether everything still is what it was: editions, the archive behind them, and the numbers.

Integrity: is every file what its seal says, and every seal what the next edition says, up to the
head, which people keep? Reproduction: are the archive's files those an edition was made from, and
do they give it again, every line, table and file, read anew by the code of today? Where they do
not, the code changed or the edition did; the head decides. Nothing is ever mended here.
"""

import shutil
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import polars as pl
from pydantic import ValidationError

from pipeline.errors import BrokenPromiseError, HerijkError, MissingKnowledgeError
from pipeline.messages import say
from pipeline.register.register import LINE
from pipeline.tables.schemas import TABLES
from warehouse.archive import FileHashes
from warehouse.derive.archive_tables import read_archive
from warehouse.editions import sheets
from warehouse.editions.compare import parts_of
from warehouse.editions.inputs import LIST, NOT_INPUT, SAMPLES, input_files, same_tows
from warehouse.editions.making import made_again, sheets_and_texts
from warehouse.store.decisions import FILE_NAME as DECISIONS
from warehouse.store.editions import (
    METHOD,
    NOTICE,
    PARQUET,
    XLSX,
    Edition,
    Manifest,
    edition_names,
    edition_path,
    manifest_path,
    read_edition,
    read_manifest,
)
from warehouse.store.files import file_sha256
from warehouse.store.store import Store, archive_root

SAME_NUMBER: Final = 1e-9
"""Difference up to which a number made again is the same, as a part of the largest of its column.

Other processors leave other last bits, which come to no more in any table (docs/decisions.md)."""

INPUT_TABLES: Final = ("tows", "tow_runs")
ROWS: Final = {
    "tows": "tow {tow_id}",
    "tow_runs": "tow {tow_id}, run {run}",
    "register": "{fsn_no} {rowers}{crew_class}",
}
"""Tables of which every row that differs is named, and how."""
CANNOT: Final = (HerijkError, ValidationError, OSError, ValueError, pl.exceptions.PolarsError)


@dataclass(frozen=True)
class Finding:
    """Something that is not as it was.

    Attributes:
        edition: the edition.
        kind: `altered` (the edition), `missing` or `swapped` (what it was made from), `differs`
            (made again, another number), `unchecked` or `notice`.
        where: file, tow or line.
        message: what is seen, what it was, what to do.
        wrong: whether a promise is broken; a notice breaks none.
    """

    edition: str
    kind: str
    where: str
    message: str
    wrong: bool = True


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


@dataclass(frozen=True)
class Verification:
    """What `verify` found.

    Attributes:
        editions: those checked.
        head: the seal of the last edition published.
        findings: what is not as it was.
        wrong: whether any finding is more than a notice.
    """

    editions: list[CheckedEdition]
    head: str | None
    findings: list[Finding]
    wrong: bool


def verify(store: Store, afresh: bool = True, head: str | None = None) -> Verification:
    """Checks every published edition.

    Args:
        store: the data folder.
        afresh: read every file of the archive again, instead of trusting its size and time, and
            the lake.
        head: the seal of the last edition as it was written down. Where it is still that, no
            edition was altered, and what comes out otherwise is the work of other code.
    """
    manifests, unreadable = _manifests(store)
    last = _last(manifests)
    found = None if last is None else last.seal
    findings = [*unreadable, *_missing(store), *_chain_findings(manifests)]
    if head is not None and head != found:
        message = say("the head is {}, and should be {}", found, head)
        findings.append(Finding("", "altered", "chain", message))
    hashes = FileHashes() if afresh else FileHashes.load(store.file_hashes)
    archive = archive_root(store)
    for name, manifest in manifests.items():
        path = store.editions / name
        findings += [*_altered(path, manifest), *_swapped(path, archive, hashes)]
    checked, reproduced = _made_again(store, archive if afresh else None, manifests)
    by_head = head is not None and head == found
    findings += [
        replace(f, wrong=f.wrong and not (f.kind == "differs" and by_head)) for f in reproduced
    ]
    return Verification(checked, found, findings, any(f.wrong for f in findings))


# Integrity


def _altered(path: Path, manifest: Manifest) -> Iterator[Finding]:
    """Files that were changed, added or are gone, links, and a manifest that does not fit."""
    name, own = path.name, manifest_path(path).name
    if manifest.edition != name:
        message = say("the folder was renamed; it is {}", manifest.edition)
        yield Finding(name, "altered", own, message)
    if manifest.seal != manifest.expected_seal:
        yield Finding(name, "altered", own, say("{} was changed: its seal does not fit", own))
    for link in sorted(f.name for f in (path, *path.iterdir()) if f.is_symlink()):
        message = say("{} is a link to somewhere else; an edition holds its files itself", link)
        yield Finding(name, "altered", link, message)
    present = {f.name for f in path.iterdir()}
    for file in sorted(present - {*manifest.files, own}):
        message = say("{} was added after publication", file)
        yield Finding(name, "notice", file, message, wrong=False)
    for file, sha256 in sorted(manifest.files.items()):
        if file not in present:
            yield Finding(name, "altered", file, say("{} is gone; put it back from a copy", file))
        elif file_sha256(path / file) != sha256:
            yield Finding(name, "altered", file, say("{} was changed after publication", file))


def chain_head(store: Store) -> Manifest | None:
    """The edition published last; None before the first that is chained."""
    return _last(_manifests(store)[0])


def _last(manifests: Mapping[str, Manifest]) -> Manifest | None:
    chained = (manifest for manifest in manifests.values() if manifest.number is not None)
    return max(chained, key=lambda manifest: manifest.number or 0, default=None)


def _manifests(store: Store) -> tuple[dict[str, Manifest], list[Finding]]:
    """The manifests of all editions by the name of their folders, and those that cannot be read."""
    manifests, unreadable = {}, []
    for name in edition_names(store):
        path = store.editions / name
        try:
            manifests[name] = read_manifest(path)
        except BrokenPromiseError as error:
            unreadable.append(Finding(name, "altered", manifest_path(path).name, str(error)))
    return manifests, unreadable


def _missing(store: Store) -> Iterator[Finding]:
    """Editions that the last rebuild put into the tables, and that are gone."""
    known = set(store.read("editions")["edition"]) if store.made_from("editions") else set[str]()
    for name in sorted(known - {*edition_names(store)}):
        yield Finding(name, "altered", name, say("edition {} was published and is gone", name))


def _chain_findings(manifests: Mapping[str, Manifest]) -> Iterator[Finding]:
    """Editions that have no place in the chain, or were made anew."""
    seal: str | None = None
    number = 0
    for manifest in sorted(manifests.values(), key=lambda m: (m.number or 0, m.edition)):
        if manifest.number is None:
            message = say("it has no number in the chain of editions")
            yield Finding(manifest.edition, "altered", "chain", message)
            continue
        number += 1
        if manifest.number != number:
            message = say(
                "it is number {} of the editions, and {} is expected here: another was taken out, "
                "or put in",
                manifest.number,
                number,
            )
            yield Finding(manifest.edition, "altered", "chain", message)
            return
        if manifest.after_seal != seal:
            message = say("the edition before it has another seal than when this one was published")
            yield Finding(manifest.edition, "altered", "chain", message)
        seal = manifest.seal


# Reproduction


def _swapped(path: Path, archive: Path | None, hashes: FileHashes) -> Iterator[Finding]:
    """Files of the archive that are gone or are not those that an edition was made from."""
    if archive is None:
        message = say(
            "the archive is not where the last rebuild found it; run herijk rebuild --archive DIR"
        )
        yield Finding(path.name, "unchecked", "archive", message)
        return
    for file, kind, sha256 in sheets.read_inputs(path).rows():
        if not (archive / file).is_file():
            message = say("{} is gone from the archive; put it back", file)
            yield Finding(path.name, "missing", file, message)
        elif hashes.hash_samples(archive, file) != sha256:
            message = say("{} is not the file that the edition was made from", file)
            listed = kind == LIST  # a list grows, and each of its rows is compared below
            yield Finding(
                path.name, "notice" if listed else "swapped", file, message, wrong=not listed
            )


def _made_again(
    store: Store, archive: Path | None, manifests: Mapping[str, Manifest]
) -> tuple[list[CheckedEdition], list[Finding]]:
    """The editions made again: from the files of an archive, or else from the lake as it lies."""
    unread = [CheckedEdition(name, m.kind, None, None, None) for name, m in manifests.items()]
    checked: list[CheckedEdition] = []
    findings: list[Finding] = []
    try:
        with _read_again(store, archive) as again:
            for edition in unread:
                counted, differ = differing(again, edition)
                checked.append(counted)
                findings += differ
    except HerijkError as error:
        return unread, [Finding("", "unchecked", "archive", str(error))]
    return checked, findings


@contextmanager
def _read_again(store: Store, archive: Path | None) -> Iterator[Store]:
    """A data folder with the same editions and decisions, made of the archive's files alone."""
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


def differing(store: Store, checked: CheckedEdition) -> tuple[CheckedEdition, list[Finding]]:
    """Makes an edition again: how many lines it has and come out equal, and what does not.

    Args:
        store: the editions, and the archive as tables of today.
        checked: which, not counted yet.
    """
    name = checked.edition
    try:
        edition = read_edition(store, name)
        method = edition.method
        if method is not None and method.content_hash != edition.manifest.method_hash:
            raise MissingKnowledgeError("its method has options that there are no longer")
    except MissingKnowledgeError as error:
        return checked, [_of_other_code(name, METHOD, error)]
    except CANNOT as error:
        return checked, [_not_made(name, error)]
    height = edition.register.height
    try:
        again = made_again(store, edition)
        of = {t: list(_table(edition, again, t)) for t in ROWS if t in again.tables}
        found = [finding for findings in of.values() for finding in findings]
        if not found:  # else the rest follows from it
            found += [f for t in sorted(again.tables) for f in _table(edition, again, t)]
            found += _files(store, edition, again)
    except CANNOT as error:
        return replace(checked, lines=height, made_again=0, equal=0), [_not_made(name, error)]
    equal = height - len(of["register"])
    return replace(checked, lines=height, made_again=height, equal=equal), found


def _of_other_code(edition: str, file: str, reason: object) -> Finding:
    message = say("it was made by other code: {}", _first_line(reason))
    return Finding(edition, "differs", file, message)


def _not_made(name: str, reason: object) -> Finding:
    message = say("it cannot be made again: {}", _first_line(reason))
    return Finding(name, "unchecked", "register", message)


def _first_line(reason: object) -> str:
    return str(reason).splitlines()[0]


def _table(edition: Edition, again: Edition, table: str) -> Iterator[Finding]:
    """What comes out otherwise in a table: of those in `ROWS` each row, with what it was and is."""
    name, now = edition.manifest.edition, again.tables[table]
    was = edition.tables.get(table, now.clear())
    kind, why = "differs", say("either the code changed since, or the edition did")
    if table in INPUT_TABLES:
        facts = [
            fact
            for fact in was.columns
            if fact in now.columns and fact not in NOT_INPUT and not fact.endswith("_sha256")
        ]
        was, now = was.select(facts), now.select(facts)
        kind, why = "swapped", say("the lists of the archive say so now")
    elif table == "register" and _has_other_tows(edition, again):
        why = say("tows that went into it changed")
    bare = was.drop("causes", strict=False), now.drop("causes", strict=False)
    rows = differences(*bare, TABLES[table].primary_key())
    if table in ROWS:
        for row in rows.iter_rows(named=True):
            changed = (f"{n} {_text(row[n])} > {_text(row[f'{n} now'])}" for n in row["columns"])
            message = say("made again, {}: {}", ", ".join(changed), why)
            yield Finding(name, kind, ROWS[table].format(**row), message)
        return
    columns = {*rows["columns"].explode()}
    if "causes" in now.columns and differences(parts_of(was), parts_of(now), LINE).height:
        columns.add("causes")  # a text with numbers, which are compared as such
    if columns:
        message = say("made again, it differs in {}", ", ".join(sorted(columns)))
        yield Finding(name, "differs", table + PARQUET, message)


def _has_other_tows(edition: Edition, again: Edition) -> bool:
    tows = edition.tables.get("tows")
    return tows is not None and len(same_tows(edition.tables, again.tables)) < tows.height


def _files(store: Store, edition: Edition, again: Edition) -> Iterator[Finding]:
    """Sheets, texts and lists that do not say what the tables of the edition say."""
    name, path = edition.manifest.edition, edition_path(store, edition.manifest.edition)
    # Lists are taken as stated: `_swapped` looks at them.
    files = sheets.read_inputs(path).select("path", "sha256", "kind")
    if "tows" in edition.tables:
        files = input_files(edition.tables["tows"], files.filter(pl.col("kind") != SAMPLES))
    try:
        expected = sheets_and_texts(store, edition, files)
    except MissingKnowledgeError as error:
        yield _of_other_code(name, NOTICE, error)
        return
    tables = {table + PARQUET for table in again.tables}
    for file in sorted(edition.manifest.files.keys() - expected.keys() - tables):
        message = say("{} is no longer made; only its seal can show that it is intact", file)
        yield Finding(name, "notice", file, message, wrong=False)
    for file, content in sorted(expected.items()):
        found = (path / file).read_bytes() if (path / file).exists() else b""
        if _is_unlike(file, content, found):
            message = say("{} does not say what the tables of the edition say", file)
            yield Finding(name, "differs", file, message)


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
