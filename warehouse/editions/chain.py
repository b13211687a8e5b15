"""The chain of editions: each holds the number and the seal of the one published before it.

So an edition cannot be taken out or made anew without all later ones giving it away. Who keeps the
seal of the last one, the head, can tell whether the chain as a whole was made anew.
"""

from contextlib import suppress

import duckdb

from pipeline.errors import BrokenPromiseError, HerijkError
from pipeline.words import say
from warehouse.editions.finding import Finding
from warehouse.store.database import open_database
from warehouse.store.editions import About, edition_names, read_about
from warehouse.store.store import Store


def chain_head(store: Store) -> About | None:
    """The edition published last; None before the first that is chained."""
    return max(_chained(store), key=lambda about: about.number or 0, default=None)


def chain_findings(store: Store) -> tuple[list[Finding], str | None]:
    """Editions that are gone or were made anew, and the seal of the last."""
    chained = sorted(_chained(store), key=lambda about: (about.number or 0, about.edition))
    findings = [
        Finding(name, "missing", name, say("edition {} was published and is gone", name))
        for name in sorted(_known(store) - set(edition_names(store)))
    ]
    findings += [
        Finding(about.edition, "altered", "chain", say("it has no number in the chain of editions"))
        for about in _readable(store)
        if about.number is None
    ]
    seal: str | None = None
    for number, about in enumerate(chained, 1):
        if about.number != number:
            findings.append(
                Finding(
                    about.edition,
                    "missing",
                    "chain",
                    say(
                        "it is number {} of the editions, and {} is expected here: another was "
                        "taken out, or put in",
                        about.number,
                        number,
                    ),
                )
            )
            break
        if about.after_seal != seal:
            findings.append(
                Finding(
                    about.edition,
                    "altered",
                    "chain",
                    say("the edition before it has another seal than when this one was published"),
                )
            )
        seal = about.seal
    return findings, chained[-1].seal if chained else None


def _chained(store: Store) -> list[About]:
    return [about for about in _readable(store) if about.number is not None]


def _readable(store: Store) -> list[About]:
    editions = []
    for name in edition_names(store):
        with suppress(BrokenPromiseError):  # told where its own files are looked at
            editions.append(read_about(store.editions / name))
    return editions


def _known(store: Store) -> set[str]:
    """Editions that the last rebuild put into the database."""
    try:
        with open_database(store.database) as db:
            return {name for (name,) in db.sql("SELECT edition FROM editions").fetchall()}
    except (HerijkError, duckdb.Error):  # not made yet, or damaged
        return set()
