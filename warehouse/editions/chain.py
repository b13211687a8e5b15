"""The chain of editions: each holds the number and the seal of the one published before it.

So an edition cannot be taken out or made anew without all later ones giving it away. Who keeps the
seal of the last one, the head, can tell whether the chain as a whole was made anew.
"""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass

import duckdb

from pipeline.errors import BrokenPromiseError, HerijkError
from pipeline.messages import say
from warehouse.store.database import open_database
from warehouse.store.editions import Manifest, edition_names, read_manifest
from warehouse.store.store import Store


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


def chain_head(store: Store) -> Manifest | None:
    """The edition published last; None before the first that is chained."""
    chained = (manifest for manifest in _readable(store) if manifest.number is not None)
    return max(chained, key=lambda manifest: manifest.number or 0, default=None)


def chain_findings(store: Store) -> Iterator[Finding]:
    """Editions that are gone, have no place in the chain, or were made anew."""
    for name in sorted(_known(store) - set(edition_names(store))):
        yield Finding(name, "altered", name, say("edition {} was published and is gone", name))
    seal: str | None = None
    number = 0
    for manifest in sorted(_readable(store), key=lambda m: (m.number or 0, m.edition)):
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


def _readable(store: Store) -> list[Manifest]:
    editions = []
    for name in edition_names(store):
        with suppress(BrokenPromiseError):  # said where its own files are looked at
            editions.append(read_manifest(store.editions / name))
    return editions


def _known(store: Store) -> set[str]:
    """Editions that the last rebuild put into the database."""
    try:
        with open_database(store.database) as db:
            return {name for (name,) in db.sql("SELECT edition FROM editions").fetchall()}
    except (HerijkError, duckdb.Error):  # not made yet, or damaged
        return set()
