"""Whether editions are as they were published: every file, every manifest, the chain, the sources.

Nothing is computed here, and nothing is ever mended.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import polars as pl

from pipeline.messages import Sentence, say
from pipeline.recompute.facts import list_samples_files
from pipeline.tables.row import Row
from warehouse.archive import FileHashes
from warehouse.editions.inputs import list_sources
from warehouse.store.editions import (
    CHANGES,
    CSV,
    MANIFEST,
    METHOD,
    PARQUET,
    Manifest,
    find_manifest,
    has_doubled_key,
    is_edition_name,
    is_plain_file,
    list_edition_names,
    list_stray_names,
    read_table,
)
from warehouse.store.files import file_sha256
from warehouse.store.store import Store

READING_ERRORS: Final = (Exception, pl.exceptions.PanicException)
"""What reading or making again a forged edition can end with: almost anything."""


@dataclass(frozen=True)
class Finding:
    """Something that is not as it was.

    Attributes:
        edition: the edition.
        kind: `altered` (the edition), `missing` or `swapped` (what it was made from), `differs`
            (made again, another number), `report_unchecked` or `notice`.
        where: file, tow or line.
        message: what is seen, what it was, what to do.
        wrong: whether a promise is broken; a notice breaks none.
    """

    edition: str
    kind: str
    where: str
    message: str
    wrong: bool = True


def check_chain(
    store: Store, manifests: Mapping[str, Manifest], seal: str | None, head: str | None
) -> Iterator[Finding]:
    """Find editions that are gone, have no place in the chain, or were made anew."""
    if head is not None and head != seal:
        message = say("the head is {}, and should be {}", seal, head)
        yield Finding("", "altered", "chain", message)
    for name in list_stray_names(store):
        message = say("{} lies among the editions and is none", name)
        yield Finding("", "notice", name, message, wrong=False)
    for name in sorted(_known_editions(store).keys() - set(list_edition_names(store))):
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
    """Return the facts that the last rebuild noted of each edition, by its name."""
    if store.read_fingerprint("editions") is None:
        return {}
    editions = store.read("editions")
    return editions.rows_by_key("edition", named=True, unique=True, include_key=True)


def check_manifest(
    store: Store, manifest: Manifest, manifests: Mapping[str, Manifest]
) -> Iterator[Finding]:
    """Find what a manifest cannot say.

    Whoever changes a manifest can seal it again, and behind the last edition there is none that
    knows its seal. So it is also held against the other editions, the archive and what was known
    of it at the last rebuild.
    """
    own = find_manifest(store.editions / manifest.edition).name
    found = list(_find_impossible_fields(manifest, is_older=own != MANIFEST))
    found += _find_wrong_relations(manifest, manifests)
    found += _find_changed_facts(store, manifest)
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
    if store.read_fingerprint("about_archive") is not None:
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
    name, own = path.name, find_manifest(path).name
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
    for file in sorted(present - manifest.files.keys() - {own}):
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
            sources = sources | dict(list_samples_files(tows).select("path", "sha256").rows())
        except READING_ERRORS as error:
            yield report_unchecked(path.name, error)
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


def report_unchecked(name: str, error: BaseException) -> Finding:
    """Return the finding that an edition cannot be made again, and why."""
    reason = (str(error) or type(error).__name__).splitlines()[0]
    return Finding(name, "unchecked", "register", say("it cannot be made again: {}", reason))
