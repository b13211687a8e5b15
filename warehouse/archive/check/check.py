"""Looking through an archive before a rebuild: every fault, by cause, with what would mend it.

What a profile can settle is tried on the way: a proposed word or column is taken as given, so that
the faults behind it come out in the same round. Nothing is written. Judging every sample is the
rebuild's; here every header is read, and one tow of each season whole.
"""

import hashlib
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import polars as pl

from pipeline.errors import MissingKnowledgeError
from pipeline.tables.frames import frame_of
from pipeline.tables.lake import ListedTows
from warehouse.archive.check.headers_and_samples import faults_in_headers, faults_in_samples
from warehouse.archive.check.merged_profile import merged
from warehouse.archive.check.proposals import Proposal, propose
from warehouse.archive.faults import Fault
from warehouse.archive.files.names import PARTS
from warehouse.archive.index.index import ArchiveIndex, index_archive
from warehouse.archive.index.unread_files import missing_lists, strangers
from warehouse.archive.lists.races import read_races
from warehouse.archive.lists.registers import read_published_registers
from warehouse.archive.profile.definition import Profiles
from warehouse.archive.profile.reading import parse_profiles, profile_text
from warehouse.archive.spelling.headers import split_header

ROUNDS: Final = 8
"""How often what was proposed is tried, at most."""
_PIECE: Final = 1 << 16


@dataclass(frozen=True)
class Cause:
    """One thing that is wrong, wherever it is.

    Attributes:
        reason_code: short stable code.
        faults: where, in order.
        proposals: what in `archief.toml` would settle it; empty where only a person can.
    """

    reason_code: str
    faults: tuple[Fault, ...]
    proposals: tuple[Proposal, ...]


@dataclass(frozen=True)
class Checked:
    """What a check found.

    Attributes:
        tows: tows in which nothing was found that would cost them, as the archive is or with the
            proposals; most samples are judged by the rebuild only.
        causes: what is wrong, the most frequent first.
        profile: `archief.toml` with the proposals; None where there are none.
    """

    tows: int
    causes: tuple[Cause, ...]
    profile: str | None


def check_archive(root: Path) -> Checked:
    """Looks through an archive.

    Raises:
        MissingKnowledgeError: there is no archive, or `archief.toml` cannot be understood.
    """
    written = profile_text(root)
    text = written
    seen: dict[Fault, tuple[Proposal, ...]] = {}
    tried: set[Proposal] = set()
    for _ in range(ROUNDS):
        profiles = parse_profiles(text)
        index, faults = _faults(root, profiles)
        new: dict[Proposal, None] = {}
        for fault in faults:
            offered = propose(fault, profiles.wording.files, index.seasons if index else {})
            seen[fault] = tuple(p for p in offered if p not in tried)  # else it settled nothing
            new |= dict.fromkeys(seen[fault])
        if not new:
            break
        tried |= new.keys()
        text, valid = _applied(text, tuple(new))
        seen |= {fault: tuple(p for p in seen[fault] if p in valid) for fault in faults}
    tows = index.tows if index else frame_of(ListedTows, [])
    proposals = dict.fromkeys(p for offered in seen.values() for p in offered)
    profile = merged(written, _doubted(proposals, seen.values(), tows)) if proposals else None
    return Checked(_readable(tows, faults), _grouped(seen), profile)


def _applied(text: str, proposals: Sequence[Proposal]) -> tuple[str, Sequence[Proposal]]:
    """A profile with those of some proposals that leave it valid, and these."""
    together = merged(text, (replace(p, is_active=True) for p in proposals))
    try:
        parse_profiles(together)
    except MissingKnowledgeError:
        half = len(proposals) // 2
        if not half:
            return text, ()
        text, first = _applied(text, proposals[:half])
        text, second = _applied(text, proposals[half:])
        return text, (*first, *second)
    return together, proposals


def _readable(tows: pl.DataFrame, faults: Iterable[Fault]) -> int:
    """How many listed tows have no fault that costs the tow."""
    costly = [fault for fault in faults if fault.lost is None]
    lost = {f.tow_id for f in costly} | {f.path for f in costly}
    files = tows.select("tow_id", "samples_path", "second_path").iter_rows()
    return sum(
        lost.isdisjoint(f"{tow}{PARTS}{one}{PARTS}{two}".split(PARTS)) for tow, one, two in files
    )


def _doubted(
    proposals: Mapping[Proposal, None],
    seen: Iterable[Sequence[Proposal]],
    listed: pl.DataFrame,
) -> Iterator[Proposal]:
    """Gives the proposals; what only some files of a season lack is not to be declared absent.

    A rate that the files say themselves leaves no question about it.
    """
    lacking = Counter(p for offered in seen for p in offered if p.section == "absent")
    named = {split_header(p.key)[0] for p in proposals if p.section == "headers"}
    known = {p.season for p in proposals if p.section == "sample_rate_hz" and p.is_active}
    for proposal in proposals:
        is_rate = proposal.section == "sample_rate_hz"
        if is_rate and not proposal.is_active and proposal.season in known:
            continue
        if proposal.section == "ignore" and split_header(proposal.value)[0] in named:
            continue  # another list has it
        tows = listed.filter(season=proposal.season).height
        is_sure = proposal.section != "absent" or lacking[proposal] >= tows
        yield replace(proposal, is_active=proposal.is_active and is_sure)


def _faults(root: Path, profiles: Profiles) -> tuple[ArchiveIndex | None, list[Fault]]:
    """The lists, and what is wrong in them, in headers and in a tow of each season.

    Files that nobody reads come first, and alone: they can be the lists.
    """
    unread = strangers(root, profiles)
    if any(propose(fault, profiles.wording.files, {}) for fault in unread):
        return None, unread
    lacking = missing_lists(root, profiles)
    if lacking:
        return None, lacking
    index = index_archive(root, quick_hash, profiles)
    _, in_races = read_races(root, profiles.wording)
    _, in_registers = read_published_registers(root, profiles.wording)
    unused = {fault.path for fault in index.faults if fault.reason_code == "samples_not_listed"}
    in_headers = list(faults_in_headers(root, index, unused))
    wrong = {fault.path for fault in in_headers}
    in_samples = list(faults_in_samples(root, index, wrong | unused))
    in_lists = [*index.faults, *index.more]
    return index, [*in_lists, *in_races, *in_registers, *in_headers, *in_samples]


def quick_hash(path: Path) -> str:
    """A hash of a file's size and ends: enough to find copies, and read in no time."""
    with path.open("rb") as file:
        start = file.read(_PIECE)
        size = path.stat().st_size
        file.seek(max(_PIECE, size - _PIECE))
        return hashlib.sha256(start + file.read(_PIECE) + str(size).encode()).hexdigest()


def _grouped(seen: Mapping[Fault, Sequence[Proposal]]) -> tuple[Cause, ...]:
    """The faults by cause, those with most first."""
    by_cause: dict[tuple[str, str], list[Fault]] = {}
    for fault in seen:
        by_cause.setdefault((fault.reason_code, fault.cause), []).append(fault)
    causes = (
        Cause(code, tuple(faults), tuple(dict.fromkeys(p for f in faults for p in seen[f])))
        for (code, _), faults in by_cause.items()
    )
    return tuple(sorted(causes, key=lambda cause: -len(cause.faults)))
