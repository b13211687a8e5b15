"""Whether everything still is what it was: editions, the archive behind them, and the numbers.

Integrity: is every file what its seal says, and every seal what the next edition says, up to the
head, which people keep? Reproduction: are the archive's files those an edition was made from, and
do they give it again, read anew by the code of today? Where they do not, the code changed or the
edition did; the head decides. Nothing is ever mended here.
"""

import datetime as dt
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Final

import polars as pl

from pipeline.errors import BrokenPromiseError, HerijkError
from pipeline.recompute.facts import with_hand_windows
from pipeline.words import say
from warehouse.archive import ArchiveIndex, FileHashes, index_archive
from warehouse.archive.files.names import PARTS
from warehouse.derive.graph import ARCHIVE
from warehouse.derive.inputs import Scope
from warehouse.editions import sheets
from warehouse.editions.chain import chain_findings
from warehouse.editions.finding import Finding
from warehouse.editions.inputs import LIST, NOT_INPUT
from warehouse.editions.remade import Counts, remade
from warehouse.intake import seasons as intake
from warehouse.store.decisions import FILE_NAME as DECISIONS
from warehouse.store.editions import (
    ABOUT,
    CSV,
    INPUTS,
    XLSX,
    About,
    edition_names,
    read_about,
    read_table,
)
from warehouse.store.files import file_sha256
from warehouse.store.store import Store, archive_root, table_digest

MOST_CELLS: Final = 20
"""Altered cells of a file that are named one by one."""


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
    hashes = FileHashes() if afresh else FileHashes.load(store.file_hashes)
    archive = _Archive.of(store, hashes)
    findings, found = chain_findings(store)
    if head is not None and head != found:
        message = say("the head is {}, and should be {}", found, head)
        findings.append(Finding("", "altered", "chain", message))
    abouts = {}
    for name in edition_names(store):
        try:
            abouts[name] = read_about(store.editions / name)
        except BrokenPromiseError as error:
            findings.append(Finding(name, "altered", ABOUT, str(error)))
    for name, about in abouts.items():
        path = store.editions / name
        findings += [*_altered(path, about), *_archive(archive, path, about)]
    made = _made_again(store, archive, afresh, list(abouts))
    for _, differing in made.values():
        findings += [replace(f, wrong=f.kind != "differs" or head != found) for f in differing]
    checked = [CheckedEdition(name, about.kind, *made[name][0]) for name, about in abouts.items()]
    return Verification(checked, found, findings, any(f.wrong for f in findings))


Made = tuple[Counts, list[Finding]]


def _made_again(
    store: Store, archive: "_Archive | None", afresh: bool, names: list[str]
) -> dict[str, Made]:
    """The editions made again: from the files of the archive, or else from the lake as it lies."""
    if archive is None or not afresh:
        return {name: remade(store, name) for name in names}
    try:
        with _read_again(store, archive.root) as again:
            return {name: remade(again, name) for name in names}
    except HerijkError as error:
        finding = Finding("", "unchecked", "archive", str(error))
        return dict.fromkeys(names, (Counts(), [finding]))


@contextmanager
def _read_again(store: Store, archive: Path) -> Iterator[Store]:
    """A data folder with the same editions and decisions, made of the archive's files alone."""
    with tempfile.TemporaryDirectory() as folder:
        again = Store(Path(folder), store.editions)
        if (store.root / DECISIONS).exists():
            shutil.copy(store.root / DECISIONS, again.root)
        intake.index(again, archive)
        for season in intake.listed_seasons(again):
            intake.read_season(again, archive, season)
            intake.collect_blocks(again, season)
        ARCHIVE.make(Scope(again, (), today=dt.date.today()))
        yield again


# Was a file of the edition changed by hand?


def _altered(path: Path, about: About) -> Iterator[Finding]:
    yield from _folder(path, about)
    known = about.files.keys() & {f.name for f in path.iterdir()}
    intact = {file for file in known if file_sha256(path / file) == about.files[file]}
    for file in sorted(known - intact):
        yield Finding(path.name, "altered", file, say("{} was changed after publication", file))
        for where, said in _where(path, about, file, intact):
            yield Finding(path.name, "altered", where, said)


def _folder(path: Path, about: About) -> Iterator[Finding]:
    """The folder's name and seal, and files that are links, were added or are gone."""
    name, present = path.name, {f.name for f in path.iterdir()}
    if about.edition != name:
        message = say("the folder was renamed; it is {}", about.edition)
        yield Finding(name, "altered", ABOUT, message)
    if about.seal != about.expected_seal:
        yield Finding(name, "altered", ABOUT, say("{} was changed: its seal does not fit", ABOUT))
    for link in sorted(f.name for f in (path, *path.iterdir()) if f.is_symlink()):
        message = say("{} is a link to somewhere else; an edition holds its files itself", link)
        yield Finding(name, "altered", link, message)
    for file in sorted(present - {*about.files, ABOUT}):
        message = say("{} was added after publication", file)
        yield Finding(name, "notice", file, message, wrong=False)
    for file in sorted(about.files.keys() - present):
        yield Finding(name, "missing", file, say("{} is gone; put it back from a copy", file))


def _where(path: Path, about: About, file: str, intact: set[str]) -> list[tuple[str, str]]:
    """Places within a changed file, as far as an intact copy of its content tells."""
    try:
        if file == CSV and "register.parquet" in intact:
            return _cells(
                file, _expected_csv(path), sheets.read_csv_cells((path / file).read_bytes())
            )
        if file == XLSX and "register.parquet" in intact:
            return _xlsx_cells(path, about)
        if file == "register.parquet" and CSV in intact:
            stated = sheets.read_csv_cells((path / CSV).read_bytes())
            return _cells(file, stated, _expected_csv(path))
        table = file.removesuffix(".parquet")
        if table in about.tables and table_digest(read_table(path, table)) == (
            about.tables[table].digest
        ):
            return [(file, say("it was written anew; its values are the same"))]
    except (HerijkError, OSError, ValueError, pl.exceptions.PolarsError) as error:
        return [(file, say("it cannot be read any more: {}", str(error).splitlines()[0]))]
    return []


def _expected_csv(path: Path) -> sheets.Cells:
    register, fields = _register(path)
    return [[field.header for field in fields], *sheets.printed_cells(register, fields)]


def _register(path: Path) -> tuple[pl.DataFrame, list[sheets.Field]]:
    """The register of an edition, and the columns of its sheets: older ones have one more."""
    register = read_table(path, "register")
    fields = [*sheets.REGISTER_FIELDS, sheets.WITHDRAWN_FIELD, sheets.CODE_FIELD]
    return register, [one for one in fields if one.column in register.columns]


def _cells(file: str, was: sheets.Cells, now: sheets.Cells) -> list[tuple[str, str]]:
    """The cells that differ, each with its line, boat and column."""
    problems: list[tuple[str, str]] = []
    if len(was) != len(now):
        problems.append((file, say("it has {} lines; there were {}", len(now) - 1, len(was) - 1)))
    for number, (before, after) in enumerate(zip(was, now, strict=False), 1):
        if len(before) != len(after):
            problems.append((f"{file}, line {number}", say("it has another number of cells")))
            continue
        problems += [
            (
                f"{file}, line {number} ({before[0]}), column {header}",
                say("it says {!r}; it was {!r}", b, a),
            )
            for header, a, b in zip(was[0], before, after, strict=True)
            if a != b
        ]
    return _not_too_many(file, problems)


def _xlsx_cells(path: Path, about: About) -> list[tuple[str, str]]:
    was = sheets.read_xlsx_cells(sheets.xlsx_bytes(*_register(path), about))
    now = sheets.read_xlsx_cells((path / XLSX).read_bytes())
    places = sorted(p for p in was.keys() | now.keys() if was.get(p) != now.get(p))
    problems: list[tuple[str, str]] = [
        (f"{XLSX}, cell {place}", say("it says {!r}; it was {!r}", now.get(place), was.get(place)))
        for place in places
    ]
    return _not_too_many(XLSX, problems)


def _not_too_many(file: str, places: list[tuple[str, str]]) -> list[tuple[str, str]]:
    more = len(places) - MOST_CELLS
    if more <= 0:
        return places
    return [*places[:MOST_CELLS], (file, say("and {} more places differ", more))]


# Are the archive's files those it was made from?


@dataclass(frozen=True)
class _Archive:
    """The archive behind all editions, of which lists and files are read once."""

    root: Path
    hashes: FileHashes

    @classmethod
    def of(cls, store: Store, hashes: FileHashes) -> "_Archive | None":
        """The archive where the last rebuild found it; None if it is no longer there."""
        known = store.made_from("about_archive") is not None
        root = archive_root(store) if known else None
        return None if root is None else cls(root, hashes)

    @cached_property
    def index(self) -> ArchiveIndex:
        """What its lists say; raises HerijkError where they cannot be read."""
        return index_archive(self.root, self.hashes.hash_file)


def _archive(archive: _Archive | None, path: Path, about: About) -> Iterator[Finding]:
    name = path.name
    if archive is None:
        yield Finding(
            name,
            "unchecked",
            "archive",
            say(
                "the archive is not where the last rebuild found it; run herijk rebuild --archive "
                "DIR"
            ),
        )
        return
    if not (path / INPUTS).exists():
        return
    for file, kind, sha256 in sheets.read_inputs(path):
        gone = PARTS.join(part for part in file.split(PARTS) if not (archive.root / part).is_file())
        if gone:
            yield Finding(
                name, "missing", gone, say("{} is gone from the archive; put it back", gone)
            )
        elif archive.hashes.hash_samples(archive.root, file) != sha256:
            yield Finding(
                name,
                "notice" if kind == LIST else "swapped",
                file,
                say("{} is not the file that the edition was made from", file),
                wrong=kind != LIST,
            )
    if about.kind == "recomputed" and (path / "tows.parquet").exists():
        yield from _list_rows(path, archive)


def _list_rows(path: Path, archive: _Archive) -> Iterator[Finding]:
    """Tows of the edition whose rows in the lists are no longer what they were."""
    try:
        index = archive.index
        was = {name: read_table(path, name) for name in ("tows", "tow_runs")}
    except HerijkError as error:
        yield Finding(path.name, "unchecked", "sleeplijsten", str(error))
        return
    runs = with_hand_windows(index.runs, index.windows)
    faulty = {fault.tow_id for fault in index.faults}  # listed, and told with its files
    for tow in sorted(set(was["tows"]["tow_id"]) - set(index.tows["tow_id"]) - faulty):
        yield Finding(path.name, "missing", tow, say("tow {} is no longer in the tow lists", tow))
    yield from _changed_facts(path.name, was["tows"], index.tows, ["tow_id"])
    yield from _changed_facts(path.name, was["tow_runs"], runs, ["tow_id", "run"])


def _changed_facts(
    edition: str, was: pl.DataFrame, now: pl.DataFrame, key: list[str]
) -> Iterator[Finding]:
    facts = [
        name
        for name in was.columns
        if name in now.columns and name not in (*key, *NOT_INPUT) and not name.endswith("_sha256")
    ]
    pairs = was.select(*key, *facts).join(
        now.select(*key, *facts), on=key, suffix="_now", maintain_order="left"
    )
    for row in pairs.sort(key).iter_rows(named=True):
        name = "tow " + ", run ".join(str(row[k]) for k in key)
        for fact in facts:
            if row[f"{fact}_now"] != row[fact]:
                message = say("{}: {} is {}; it was {}", name, fact, row[f"{fact}_now"], row[fact])
                yield Finding(edition, "swapped", name, message)
