"""Whether everything still is what it was: editions, the archive behind them, and the numbers.

Integrity: is every file what its seal says, and every seal what the next edition says, up to the
head, which people keep? Reproduction: are the archive's files those an edition was made from, and
do they give it again, read anew by the code of today? Where they do not, the code changed or the
edition did; the head decides. Nothing is ever mended here.
"""

import shutil
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from pipeline.errors import BrokenPromiseError, HerijkError
from pipeline.messages import say
from warehouse.archive import FileHashes
from warehouse.archive.files.names import PARTS
from warehouse.derive.graph import ARCHIVE
from warehouse.derive.inputs import Scope
from warehouse.editions import sheets
from warehouse.editions.again import CheckedEdition, differing
from warehouse.editions.chain import Finding, chain_findings, chain_head
from warehouse.editions.inputs import LIST
from warehouse.intake import seasons as intake
from warehouse.store.decisions import FILE_NAME as DECISIONS
from warehouse.store.editions import (
    Manifest,
    edition_names,
    manifest_path,
    read_manifest,
)
from warehouse.store.files import file_sha256
from warehouse.store.store import Store, archive_root


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
    last = chain_head(store)
    found = None if last is None else last.seal
    findings = list(chain_findings(store))
    if head is not None and head != found:
        message = say("the head is {}, and should be {}", found, head)
        findings.append(Finding("", "altered", "chain", message))
    manifests = {}
    for name in edition_names(store):
        try:
            manifests[name] = read_manifest(store.editions / name)
        except BrokenPromiseError as error:
            where = manifest_path(store.editions / name).name
            findings.append(Finding(name, "altered", where, str(error)))
    hashes = FileHashes() if afresh else FileHashes.load(store.file_hashes)
    archive = None if store.made_from("about_archive") is None else archive_root(store)
    for name, manifest in manifests.items():
        path = store.editions / name
        findings += [*_altered(path, manifest), *_swapped(path, archive, hashes)]
    checked, reproduced = _made_again(store, archive if afresh else None, manifests)
    findings += [replace(f, wrong=f.kind != "differs" or head != found) for f in reproduced]
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
        gone = PARTS.join(part for part in file.split(PARTS) if not (archive / part).is_file())
        if gone:
            message = say("{} is gone from the archive; put it back", gone)
            yield Finding(path.name, "missing", gone, message)
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
        again = Store(Path(folder), store.editions)
        if (store.root / DECISIONS).exists():
            shutil.copy(store.root / DECISIONS, again.root)
        intake.index(again, archive)
        for season in intake.listed_seasons(again):
            intake.read_season(again, archive, season)
            intake.collect_blocks(again, season)
        ARCHIVE.make(Scope(again, ()))
        yield again
