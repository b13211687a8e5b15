"""Looking through an archive before a rebuild: every fault, by cause, with what would mend it.

What a profile can settle is tried on the way: a proposed word or column is taken as given, so that
the faults behind it come out in the same round. Nothing is written. Judging every sample is the
rebuild's; here every header is read, and one tow of each season whole.
"""

import hashlib
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Final

from herijk.pipeline.errors import DefectiveInputError
from herijk.warehouse.archive.faults import Fault, fault_from
from herijk.warehouse.archive.files import PARTS, kind_of, path_inside
from herijk.warehouse.archive.index import ArchiveIndex, index_archive
from herijk.warehouse.archive.messages import Sentence, innermost, say, spoken
from herijk.warehouse.archive.plausibility import judge_samples
from herijk.warehouse.archive.profile import Profiles, parse_profiles, profile_text
from herijk.warehouse.archive.proposals import Proposal, merged, propose
from herijk.warehouse.archive.published import read_published_registers, read_races
from herijk.warehouse.archive.samples import check_header, read_tow_samples

ROUNDS: Final = 8
"""So often what was proposed is tried, at most."""

SHOWN: Final = 3
_PIECE: Final = 1 << 16

Report = dict[str, Any]


@dataclass(frozen=True)
class Cause:
    """One thing that is wrong, wherever it is.

    Attributes:
        reason_code: a key of `REASONS`.
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
        tows: tows that would be read as the archive is, or with the proposals.
        causes: what is wrong, the most frequent first.
        profile: `archief.toml` with the proposals; None where there are none.
    """

    tows: int
    causes: tuple[Cause, ...]
    profile: str | None


def check_archive(root: Path) -> Checked:
    """Look through an archive.

    Raises:
        MissingKnowledgeError: there is no archive, or `archief.toml` cannot be understood.
    """
    written = profile_text(root)
    text = written
    seen: dict[tuple[object, ...], tuple[Fault, tuple[Proposal, ...]]] = {}
    proposals: dict[Proposal, None] = {}
    for _ in range(ROUNDS):
        profiles = parse_profiles(text)
        index, faults = _faults(root, profiles)
        new: dict[Proposal, None] = {}
        for fault in faults:
            offered = propose(fault)
            key = (fault.path, fault.line, fault.tow_id, fault.reason_code, fault.message)
            seen.setdefault(key, (fault, offered))
            new |= dict.fromkeys(p for p in offered if p not in proposals)
        if not new:
            break
        proposals |= new
        text = merged(written, (replace(p, is_active=True) for p in proposals))
    profile = merged(written, _doubted(proposals, seen.values(), index)) if proposals else None
    return Checked(index.tows.height, _grouped(seen.values()), profile)


def _doubted(
    proposals: Iterable[Proposal],
    seen: Iterable[tuple[Fault, Sequence[Proposal]]],
    index: ArchiveIndex,
) -> Iterator[Proposal]:
    """Give the proposals; what only some files of a season lack is not to be declared absent."""
    lacking = Counter(p for _, offered in seen for p in offered if p.section == "absent")
    for proposal in proposals:
        tows = index.tows.filter(season=proposal.season).height
        is_sure = proposal.section != "absent" or lacking[proposal] >= tows
        yield replace(proposal, is_active=proposal.is_active and is_sure)


def _faults(root: Path, profiles: Profiles) -> tuple[ArchiveIndex, list[Fault]]:
    """Return the lists, and what is wrong in them, in headers and in a tow of each season."""
    index = index_archive(root, quick_hash, profiles)
    _, in_races = read_races(root, profiles.wording)
    _, in_registers = read_published_registers(root, profiles.wording)
    in_headers = list(_in_headers(root, index))
    wrong = {fault.path for fault in in_headers}
    in_samples = list(_in_samples(root, index, wrong))
    return index, [*index.faults, *in_races, *in_registers, *in_headers, *in_samples]


def quick_hash(path: Path) -> str:
    """Return a hash of a file's size and ends: enough to find copies, and read in no time."""
    with path.open("rb") as file:
        start = file.read(_PIECE)
        size = path.stat().st_size
        file.seek(max(_PIECE, size - _PIECE))
        return hashlib.sha256(start + file.read(_PIECE) + str(size).encode()).hexdigest()


def _in_headers(root: Path, index: ArchiveIndex) -> Iterator[Fault]:
    paths = index.tows.select("season", "samples_path").rows()
    paths += index.tows.select("season", "second_path").drop_nulls().rows()
    for season, several in paths:
        for path in several.split(PARTS):
            try:
                check_header(path_inside(root, path), index.profiles.for_season(season))
            except DefectiveInputError as error:
                yield fault_from(error, path)


def _in_samples(root: Path, index: ArchiveIndex, wrong: set[str]) -> Iterator[Fault]:
    """Read the first tow of each season and kind of file whose header is good."""
    done = set()
    for tow in index.tows.iter_rows(named=True):
        paths = tow["samples_path"].split(PARTS)
        key = (tow["season"], kind_of(Path(paths[0])))
        if key in done or wrong.intersection(paths):
            continue
        done.add(key)
        try:
            samples = read_tow_samples(root, tow, index.profiles.for_season(tow["season"]))
            yield from judge_samples(samples, tow, index.runs).faults
            yield from _not_planned(samples["run"].unique().to_list(), tow, index)
        except DefectiveInputError as error:
            yield fault_from(error, tow["samples_path"], tow["tow_id"])


def _not_planned(
    present: Sequence[int], tow: Mapping[str, Any], index: ArchiveIndex
) -> Iterator[Fault]:
    planned = index.runs.filter(tow_id=tow["tow_id"])["run"].to_list()
    beyond = sorted(set(present) - set(planned))
    if beyond:
        said = say(
            "Runs {runs} are in the file but not in the plan, so they are not used; give their "
            "targets and directions under [[plan]] in archief.toml.",
            runs=", ".join(map(str, beyond)),
        )
        yield Fault(tow["samples_path"], None, None, "run_not_planned", said)


def _grouped(seen: Iterable[tuple[Fault, Sequence[Proposal]]]) -> tuple[Cause, ...]:
    """Return the faults by cause, those with most first."""
    groups: dict[tuple[object, ...], list[tuple[Fault, Sequence[Proposal]]]] = {}
    for fault, offered in seen:
        groups.setdefault(_cause_of(fault), []).append((fault, offered))
    causes = [
        Cause(
            found[0][0].reason_code,
            tuple(fault for fault, _ in found),
            tuple(dict.fromkeys(p for _, offered in found for p in offered)),
        )
        for found in groups.values()
    ]
    return tuple(sorted(causes, key=lambda cause: -len(cause.faults)))


def _cause_of(fault: Fault) -> tuple[object, ...]:
    """Return what faults of one cause share: the kind of sentence, and the column it is about."""
    what = innermost(fault.message)
    if not isinstance(what, Sentence):
        return (fault.reason_code,)
    same = (what.values.get(name) for name in ("column", "names", "unit"))
    return (fault.reason_code, what.template, *same)


def as_report(checked: Checked, language: str) -> Report:
    """Return a check as plain data, its sentences in `en` or `nl`."""
    return {
        "tows": checked.tows,
        "causes": [_cause_report(cause, language) for cause in checked.causes],
        "profile": checked.profile,
    }


def _cause_report(cause: Cause, language: str) -> Report:
    first = innermost(cause.faults[0].message)
    cells = [getattr(innermost(f.message), "values", {}).get("cell") for f in cause.faults]
    return {
        "reason_code": cause.reason_code,
        "number": len(cause.faults),
        "sentence": spoken(first, language),
        "cells": [str(cell) for cell in dict.fromkeys(cells) if cell is not None],
        "places": [
            {"path": f.path, "line": f.line, "tow_id": f.tow_id} for f in cause.faults[:SHOWN]
        ],
        "proposals": [asdict(p) | {"line": p.line} for p in cause.proposals],
    }
