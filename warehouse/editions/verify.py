"""Whether everything still is what it was: editions, the archive behind them, and the numbers.

Integrity: is every file what its manifest says, and every seal what the next edition says, up to
the head, which people keep? Sources: are the archive's files those that an edition was made from?
Reproduction: do they give its tables and sheets again, read anew by the code of today? Where they
do not, the code changed or the edition did; the head decides. The words of a notice are not made
again: seal and head cover them. Nothing is ever mended here.
"""

import shutil
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import polars as pl

from pipeline.errors import HerijkError, MissingKnowledgeError
from pipeline.messages import Sentence, say
from pipeline.recompute.facts import samples_files
from pipeline.register.register import LINE
from pipeline.tables.row import Row
from pipeline.tables.schemas import TABLES
from warehouse.archive import FileHashes
from warehouse.derive.archive_tables import read_archive
from warehouse.editions import sheets
from warehouse.editions.compare import parts_of
from warehouse.editions.inputs import JUDGED, list_sources, same_tows
from warehouse.editions.publish import make_again, sheet_files
from warehouse.store.decisions import FILE_NAME as DECISIONS
from warehouse.store.editions import (
    CHANGES,
    CSV,
    MANIFEST,
    METHOD,
    PARQUET,
    XLSX,
    Edition,
    Manifest,
    chain_head,
    edition_names,
    edition_path,
    has_doubled_key,
    is_edition_name,
    is_plain_file,
    manifest_path,
    read_edition,
    read_table,
    readable_manifests,
    stray_names,
)
from warehouse.store.files import file_sha256
from warehouse.store.store import Store, archive_root

SAME_NUMBER: Final = 1e-9
"""Difference up to which a number made again is the same, as a part of the largest of its column.
Other processors leave other last bits, which come to no more in any table (docs/decisions.md)."""

ROW_NAMES: Final = {
    "tows": "tow {tow_id}",
    "tow_runs": "tow {tow_id}, run {run}",
    "register": "{fsn_no} {rowers}{crew_class}",
}
"""Tables of which every row that differs is named, and how; inputs first."""

READING_ERRORS: Final = (Exception, pl.exceptions.PanicException)
"""What reading or making again a forged edition can end with: almost anything."""

FOLLOWING: Final = ("inputs_sha256", *JUDGED)
"""What the tables of an edition say of a tow that follows from the rest, or from other tows."""


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
    manifests, damaged = readable_manifests(store)
    last = chain_head(store)
    seal = None if last is None else last.seal
    findings = [*check_chain(store, manifests, seal, head)]
    for name, error in damaged.items():
        where = manifest_path(store.editions / name).name
        findings.append(Finding(name, "altered", where, str(error)))
    archive = archive_root(store)
    hashes = FileHashes() if afresh else FileHashes.load(store.file_hashes)
    can_be_read = []
    for name, manifest in manifests.items():
        path = store.editions / name
        of_files = [*check_files(path, manifest)]
        findings += of_files
        findings += check_manifest(store, manifest, manifests)
        if all(is_plain_file(path / file) for file in manifest.files):
            can_be_read.append(name)
            findings += check_sources(path, manifest, archive, hashes)
    checked = [CheckedEdition(name, manifest.kind) for name, manifest in manifests.items()]
    by_other_code = head is not None and head == seal
    try:
        with _archive_tables(store, archive if afresh else None) as again:
            for place, edition in enumerate(checked):
                if edition.edition not in can_be_read:
                    continue
                checked[place], differing = check_reproduction(again, edition)
                for finding in differing:
                    is_wrong = finding.wrong and not (finding.kind == "differs" and by_other_code)
                    findings.append(replace(finding, wrong=is_wrong))
    except HerijkError as error:
        findings += [_unchecked(name, error) for name in can_be_read]
    is_wrong = any(finding.wrong for finding in findings)
    return Verification(checked, seal, findings, is_wrong, is_without_head=head is None)


# Integrity


def check_chain(
    store: Store, manifests: Mapping[str, Manifest], seal: str | None, head: str | None
) -> Iterator[Finding]:
    """Find editions that are gone, have no place in the chain, or were made anew."""
    if head is not None and head != seal:
        message = say("the head is {}, and should be {}", seal, head)
        yield Finding("", "altered", "chain", message)
    for name in stray_names(store):
        message = say("{} lies among the editions and is none", name)
        yield Finding("", "notice", name, message, wrong=False)
    for name in sorted(_known_editions(store).keys() - {*edition_names(store)}):
        yield Finding(name, "altered", name, say("edition {} was published and is gone", name))
    in_order = sorted(manifests.values(), key=lambda m: (m.number or 0, m.edition))
    chained = [manifest for manifest in in_order if manifest.number is not None]
    for manifest in in_order:
        if manifest.number is None:
            message = say("it has no number in the chain of editions")
            yield Finding(manifest.edition, "altered", "chain", message)
    before: str | None = None
    for place, manifest in enumerate(chained, start=1):
        if manifest.number != place:
            message = say(
                "it is number {} of the editions, and {} is expected here: another was taken out, "
                "or put in",
                manifest.number,
                place,
            )
            yield Finding(manifest.edition, "altered", "chain", message)
            return
        if manifest.after_seal != before:
            message = say("the edition before it has another seal than when this one was published")
            yield Finding(manifest.edition, "altered", "chain", message)
        before = manifest.seal


def _known_editions(store: Store) -> dict[str, Row]:
    """Return what the last rebuild noted of each edition, by its name."""
    if store.made_from("editions") is None:
        return {}
    return {row["edition"]: row for row in store.read("editions").iter_rows(named=True)}


def check_manifest(
    store: Store, manifest: Manifest, manifests: Mapping[str, Manifest]
) -> Iterator[Finding]:
    """Find what a manifest cannot say.

    Whoever changes a manifest can seal it again, and behind the last edition there is none that
    knows its seal. So it is also held against the other editions, the archive and what was known
    of it at the last rebuild.
    """
    own = manifest_path(store.editions / manifest.edition).name
    found = [
        *_find_impossible_fields(manifest, is_older=own != MANIFEST),
        *_find_wrong_relations(manifest, manifests),
        *_find_changed_facts(store, manifest),
    ]
    for field, message in found:
        yield Finding(manifest.edition, "altered", f"{own}: {field}", message)


def _find_impossible_fields(
    manifest: Manifest, *, is_older: bool
) -> Iterator[tuple[str, Sentence]]:
    """Find fields of a manifest that do not fit each other, with what is wrong."""
    if not is_edition_name(manifest.edition):
        yield "edition", say("{!r} cannot be the name of an edition", manifest.edition)
    if manifest.model_extra and not is_older:
        unknown = ", ".join(manifest.model_extra)
        yield unknown, say("it says {}, which no edition says", unknown)
    is_printed = manifest.kind == "as_printed"
    if is_printed != (manifest.method is None):
        yield "kind", say("it is {}, with the method {}", manifest.kind, manifest.method)
    needed = {CSV, f"register{PARQUET}"}
    if not is_printed:
        needed |= {METHOD, f"tows{PARQUET}"}
    for file in sorted(needed - manifest.files.keys()):
        yield "files", say("it does not list {}, which every edition has", file)
    if (f"{CHANGES}{PARQUET}" in manifest.files) != (manifest.previous is not None):
        yield "previous", say("it names {} as the edition before it", manifest.previous)


def _find_wrong_relations(
    manifest: Manifest, manifests: Mapping[str, Manifest]
) -> Iterator[tuple[str, Sentence]]:
    """Find editions that a manifest names and that cannot come before it."""
    for field, name in (("previous", manifest.previous), ("carried_from", manifest.carried_from)):
        if name is None or manifest.number is None:
            continue
        other = manifests.get(name)
        if other is None or (other.number or 0) >= manifest.number:
            yield field, say("{} is no edition from before it", name)


def _find_changed_facts(store: Store, manifest: Manifest) -> Iterator[tuple[str, Sentence]]:
    """Find fields of a manifest that the archive or the last rebuild says otherwise."""
    if store.made_from("about_archive") is not None:
        is_simulated = bool(store.read("about_archive")["simulated"][0])
        if is_simulated != manifest.simulated:
            yield "simulated", say("the archive says otherwise than the edition")
    known = _known_editions(store).get(manifest.edition, {})
    fields = manifest.model_dump()
    for field in sorted(known.keys() & fields.keys() - {"seal"}):
        if known[field] != fields[field]:
            then, now = str(known[field]), str(fields[field])
            yield field, say("it was {} at the last rebuild, and is {} now", then, now)


def check_files(path: Path, manifest: Manifest) -> Iterator[Finding]:
    """Find files that were changed, added or are gone, links, and a manifest that does not fit."""
    name, own = path.name, manifest_path(path).name
    if manifest.edition != name:
        message = say("the folder was renamed; it is {}", manifest.edition)
        yield Finding(name, "altered", own, message)
    if path.is_symlink():
        message = say("{} is a link to somewhere else; an edition holds its files itself", name)
        yield Finding(name, "altered", name, message)
    is_sealed = manifest.seal == manifest.expected_seal
    if not is_sealed or has_doubled_key((path / own).read_bytes()):
        yield Finding(name, "altered", own, say("{} was changed: its seal does not fit", own))
    present = {file.name for file in path.iterdir()}
    for file in sorted(present - {*manifest.files, own}):
        yield Finding(name, "altered", file, say("{} was added after publication", file))
    for file, sha256 in sorted(manifest.files.items()):
        if file not in present:
            yield Finding(name, "altered", file, say("{} is gone; put it back from a copy", file))
        elif not is_plain_file(path / file):
            message = say("{} is no file of its own: a folder, a link or a pipe", file)
            yield Finding(name, "altered", file, message)
        elif file_sha256(path / file) != sha256:
            yield Finding(name, "altered", file, say("{} was changed after publication", file))


def check_sources(
    path: Path, manifest: Manifest, archive: Path | None, hashes: FileHashes
) -> Iterator[Finding]:
    """Find files of the archive that are gone or are not those that an edition was made from."""
    if archive is None:
        message = say(
            "the archive is not where the last rebuild found it; run herijk rebuild --archive DIR"
        )
        yield Finding(path.name, "unchecked", "archive", message)
        return
    sources = list_sources(path, manifest)
    can_grow = {} if manifest.kind == "as_printed" else dict(sources)
    if f"tows{PARQUET}" in manifest.files:
        try:
            tows = read_table(path, "tows")
            sources = sources | dict(samples_files(tows).select("path", "sha256").rows())
        except READING_ERRORS as error:
            yield _unchecked(path.name, error)
    for file, sha256 in sorted(sources.items()):
        if not (archive / file).is_file():
            message = say("{} is gone from the archive; put it back", file)
            yield Finding(path.name, "missing", file, message)
        elif hashes.hash_samples(archive, file) != sha256:
            message = say("{} is not the file that the edition was made from", file)
            if file in can_grow:  # each of its rows is compared when the edition is made again
                yield Finding(path.name, "notice", file, message, wrong=False)
            else:
                yield Finding(path.name, "swapped", file, message)


# Reproduction


@contextmanager
def _archive_tables(store: Store, archive: Path | None) -> Iterator[Store]:
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
        return checked, [_unchecked(name, error)]
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
        other = differences(edition.register, again.register, key).drop_nulls("there").height
    except READING_ERRORS as error:
        return checked, [_unchecked(name, error)]
    return replace(checked, equal=edition.register.height - other), findings


def _unchecked(name: str, error: BaseException) -> Finding:
    reason = (str(error) or type(error).__name__).splitlines()[0]
    return Finding(name, "unchecked", "register", say("it cannot be made again: {}", reason))


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
    elif _has_other_tows(edition, again):
        why = say("tows that went into it changed")
    for row in differences(was, now, TABLES[table].primary_key()).iter_rows(named=True):
        changed = (f"{n} {_text(row[n])} > {_text(row[f'{n} now'])}" for n in row["columns"])
        message = say("made again, {}: {}", ", ".join(changed), why)
        yield Finding(edition.manifest.edition, kind, ROW_NAMES[table].format(**row), message)
    yield from _find_added_columns(edition, table, was, now)


def _find_added_columns(
    edition: Edition, table: str, was: pl.DataFrame, now: pl.DataFrame
) -> Iterator[Finding]:
    """Find columns that an edition has and no edition that is made now."""
    for column in (name for name in was.columns if name not in now.columns):
        message = say("it has a column {}, which comes from nothing", column)
        yield Finding(edition.manifest.edition, "differs", table + PARQUET, message)


def _has_other_tows(edition: Edition, again: Edition) -> bool:
    tows = edition.tables.get("tows")
    return tows is not None and len(same_tows(edition.tables, again.tables)) < tows.height


def _compare_table(edition: Edition, again: Edition, table: str) -> Iterator[Finding]:
    """Find the columns of a table that come out otherwise."""
    was, now = edition.tables.get(table, again.tables[table].clear()), again.tables[table]
    numbers = was.drop("causes", strict=False), now.drop("causes", strict=False)
    rows = differences(*numbers, TABLES[table].primary_key())
    columns = {*rows["columns"].explode()}
    if table == CHANGES and differences(parts_of(was), parts_of(now), LINE).height:
        columns.add("causes")  # a text with numbers, which are compared as such
    if columns:
        message = say("made again, it differs in {}", ", ".join(sorted(columns)))
        yield Finding(edition.manifest.edition, "differs", table + PARQUET, message)


def _compare_sheets(store: Store, edition: Edition) -> Iterator[Finding]:
    """Find sheets and lists that do not say what the tables of the edition say."""
    name, path = edition.manifest.edition, edition_path(store, edition.manifest.edition)
    for file, content in sorted(sheet_files(store, edition).items()):
        found = (path / file).read_bytes() if (path / file).exists() else b""
        if file == XLSX:
            is_same = sheets.shows_the_same(found, edition.register, sheets.SHEET_FIELDS)
        else:
            is_same = found == content
        if not is_same:
            message = say("{} does not say what the tables of the edition say", file)
            yield Finding(name, "differs", file, message)


def differences(was: pl.DataFrame, now: pl.DataFrame, key: Sequence[str]) -> pl.DataFrame:
    """Return rows that differ by more than `SAME_NUMBER`; of equal keys the first pair up.

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
    unequal = {name: _is_unequal(pairs, name) for name in ("there", *names) if name not in key}
    columns = (pl.when(differs).then(pl.lit(name)) for name, differs in unequal.items())
    return pairs.filter(pl.any_horizontal(unequal.values())).with_columns(
        columns=pl.concat_list(columns).list.drop_nulls()
    )


def _is_unequal(pairs: pl.DataFrame, name: str) -> pl.Expr:
    one, other = pl.col(name), pl.col(f"{name} now")
    if not (pairs.schema[name].is_float() and pairs.schema[f"{name} now"].is_float()):
        return one.ne_missing(other)
    largest = pairs[name].abs().max()
    limit = SAME_NUMBER * (largest if isinstance(largest, float) else 0.0)
    is_far = ~((one - other).abs() <= limit)
    return (one.is_null() != other.is_null()) | is_far.fill_null(value=False)


def _text(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value or "nothing")
