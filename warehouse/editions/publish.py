"""Publishing: a register is frozen as an edition, by a person.

Only a person publishes, who gives the name, the day from which it counts, the decision and the day
of publication. What an edition holds is made in `warehouse.editions.making`.
"""

import datetime as dt
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import polars as pl

from pipeline.errors import MissingKnowledgeError
from pipeline.method.definition import Method
from pipeline.register.register import (
    DOUBTED,
    LINE,
    find_reference_day,
    name_draft,
)
from pipeline.tables.row import Row
from warehouse.editions import printed as prints
from warehouse.editions.inputs import (
    list_files,
)
from warehouse.editions.making import add_changes, make_edition, make_edition_files, make_printed
from warehouse.store.code import code_version
from warehouse.store.editions import (
    Edition,
    Manifest,
    check_new_name,
    find_chain_head,
    list_edition_names,
    read_edition,
    read_manifest,
    write_folder,
)
from warehouse.store.store import Store


@dataclass(frozen=True)
class Terms:
    """What a person decides about an edition.

    Attributes:
        edition: its name.
        valid_from: the day from which it counts; validity of tows is judged on it.
        decision: by whom and where it was decided.
        published_on: the day of publication.
    """

    edition: str
    valid_from: dt.date
    decision: str
    published_on: dt.date


def publish(store: Store, method: Method, terms: Terms, carry: str | None = None) -> Path:
    """Freeze the register of a method as an edition.

    Args:
        store: the data folder; its tables must be those of the archive and code of today.
        method: a method that the last rebuild applied.
        terms: what a person decided.
        carry: a printed edition of which lines are taken over, re-based in closed form, where the
            newest tow of a boat and crew has no samples in the archive.

    Returns:
        The folder.

    Raises:
        BrokenPromiseError: the name is taken, or the folder could not be written.
        MissingKnowledgeError: the tables are not up to date, a name or decision cannot be used.
    """
    _check_terms(store, terms)
    if not _is_of_today(store, method):
        raise MissingKnowledgeError(
            "the tables of method {} are not those of the archive and code of today; "
            "run: herijk rebuild --archive DIR --data {} --method {}",
            method.name,
            store.root,
            method.name,
        )
    manifest = _make_manifest(store, terms, list_files(store), method, carry)
    return _write(store, make_edition(store, manifest, method))


def _is_of_today(store: Store, method: Method) -> bool:
    """Return whether the tables are made with this method and with the code of today."""
    if store.read_fingerprint("tows") is None:
        return False
    with_code = (method.name, method.content_hash, code_version())
    return with_code in store.read("lineage").select("method", "method_hash", "code_version").rows()


def publish_printed(store: Store, season: int, terms: Terms) -> Path:
    """Freeze a register of the archive, as printed that year, as an edition.

    Raises:
        BrokenPromiseError: the name is taken, or the folder could not be written.
        MissingKnowledgeError: the archive holds no such register, it names a line twice, or a line
            of it cannot be read.
    """
    _check_terms(store, terms)
    path = prints.find_printed_path(store, season)
    listed = store.read("listed_files").filter(pl.col("path") == path)
    sources = dict(listed.select("path", "sha256").rows())
    manifest = _make_manifest(store, terms, sources, printed_in=season)
    return _write(store, make_printed(store, manifest, path))


def draft_edition(
    store: Store,
    method: Method,
    valid_from: dt.date | None = None,
    counting: Collection[str] = ("valid",),
) -> Edition:
    """Return the draft of a method as an edition: what publishing it would freeze.

    Args:
        store: the data folder.
        method: any method, also one that no rebuild applied.
        valid_from: the day on which it would begin to count; that on which drafts are judged when
            left out.
        counting: statuses of lines that have numbers; with `expired` all of history has.
    """
    day = valid_from or find_reference_day(store.read("tows"), store.read("listed_races"))
    terms = Terms(name_draft(method.name), day, "", dt.date.today())
    manifest = _make_manifest(store, terms, list_files(store), method)
    return make_edition(store, manifest, method, counting)


def find_latest_before(store: Store, valid_from: dt.date, published_on: dt.date) -> str | None:
    """Return the edition that counted last before a day; None if there is none."""
    known = [read_manifest(store.editions / name) for name in list_edition_names(store)]
    earlier = [m for m in known if (m.valid_from, m.published_on) <= (valid_from, published_on)]
    if not earlier:
        return None
    return max(earlier, key=lambda m: (m.valid_from, m.published_on, m.edition)).edition


@dataclass(frozen=True)
class Published:
    """An edition that was just published.

    Attributes:
        manifest: what it is.
        folder: where it is.
        statuses: how many lines have each.
        to_look_at: rows of the register to look at.
    """

    manifest: Manifest
    folder: str
    statuses: dict[str, int]
    to_look_at: list[Row]


def summarize_published(store: Store, folder: Path) -> Published:
    """Return the summary of an edition that was just published."""
    edition = read_edition(store, folder.name)
    counts = edition.register["status"].value_counts().sort("count", "status", descending=True)
    return Published(
        edition.manifest, str(folder), dict(counts.rows()), list_lines_to_look_at(edition)
    )


def list_lines_to_look_at(edition: Edition) -> list[Row]:
    """Return lines with flags, and those left without numbers because their tows are doubted."""
    to_look_at = (pl.col("flags").list.len() > 0) | (pl.col("status") == DOUBTED)
    lines = edition.register.filter(to_look_at)
    return lines.select(pl.col(LINE), "status", "tow_id", "flags").to_dicts()


def _check_terms(store: Store, terms: Terms) -> None:
    check_new_name(store, terms.edition)
    if not terms.decision.strip():
        raise MissingKnowledgeError(
            "an edition needs a decision: say who decided it and where, with --decision"
        )


def _make_manifest(
    store: Store,
    terms: Terms,
    sources: Mapping[str, str],
    method: Method | None = None,
    carry: str | None = None,
    printed_in: int | None = None,
) -> Manifest:
    return Manifest(
        edition=terms.edition,
        kind="as_printed" if method is None else "recomputed",
        method=None if method is None else method.name,
        method_hash=None if method is None else method.content_hash,
        code_version=code_version(),
        valid_from=terms.valid_from,
        published_on=terms.published_on,
        decision=terms.decision,
        simulated=bool(store.read("about_archive")["simulated"][0]),
        carried_from=carry,
        previous=find_latest_before(store, terms.valid_from, terms.published_on),
        printed_in=printed_in,
        sources=dict(sources),
    )


def _write(store: Store, edition: Edition) -> Path:
    """Write an edition's folder as the next of the chain."""
    compared = add_changes(store, edition)

    def contents() -> dict[str, bytes]:
        head = find_chain_head(store)
        number, seal = (0, None) if head is None else (head.number or 0, head.seal)
        place = {"number": number + 1, "after_seal": seal}
        manifest = edition.manifest.model_copy(update=place)
        return make_edition_files(store, replace(compared, manifest=manifest))

    return write_folder(store, edition.manifest.edition, contents)
