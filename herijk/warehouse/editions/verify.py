"""Whether everything still is what it was: editions, the archive behind them, and the numbers.

Three questions, in this order: was a file of an edition changed by hand, and where in it; are the
archive's files those it was made from; and do archive and code of today give the same register?
Nothing is ever mended here.
"""

import hashlib
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final

import polars as pl
from pydantic import ValidationError

from herijk.pipeline.errors import BrokenPromiseError, HerijkError
from herijk.pipeline.recompute.facts import with_hand_windows
from herijk.pipeline.register.register import LINE
from herijk.warehouse.archive import FileHashes, index_archive
from herijk.warehouse.archive.files import BOATS_FILE
from herijk.warehouse.build.version import code_version
from herijk.warehouse.editions import sheets
from herijk.warehouse.editions.chain import chain_findings
from herijk.warehouse.editions.finding import Finding
from herijk.warehouse.editions.inputs import LIST, NOT_INPUT, unchanged_tows
from herijk.warehouse.editions.lines import BOAT_FACTS, SAME_NUMBER, Again, made_again
from herijk.warehouse.editions.printed import AS_PRINTED
from herijk.warehouse.intake import seasons as intake
from herijk.warehouse.store.editions import (
    ABOUT,
    CSV,
    INPUTS,
    XLSX,
    About,
    Edition,
    edition_names,
    read_about,
    read_edition,
    read_table,
)
from herijk.warehouse.store.storage import Place
from herijk.warehouse.store.store import Store, table_digest
from herijk.words import say

NEVER_TOWED: Final = "never_towed"

_OWN: Final = ("edition", "method", "verification_code", "inputs_sha256")
"""Columns of a line that others check."""

MOST_CELLS: Final = 20
"""Altered cells of a file that are named one by one."""

Report = dict[str, Any]


def verify(store: Store, afresh: bool = True) -> Report:
    """Checks every published edition.

    Args:
        store: the data folder.
        afresh: read every file of the archive again, instead of trusting its size and time.

    Returns:
        `editions` (name, kind, `lines`, how many of them were `made_again` and how many came out
        `equal`), `head` (the seal of the last edition published), `findings`, and `wrong`: whether
        any finding is more than a notice.
    """
    names = edition_names(store)
    hashes = FileHashes() if afresh else FileHashes.load(store.file_hashes)
    findings, head = chain_findings(store)
    checked = []
    for name in names:
        path = store.editions / name
        try:
            about = read_about(path)
        except BrokenPromiseError as error:
            findings.append(Finding(name, "altered", ABOUT, str(error)))
            continue
        findings += [*_altered(path, about), *_archive(store, path, about, hashes)]
        counts, differing = _made_again(store, name)
        findings += differing
        checked.append({"edition": name, "kind": about.kind} | counts)
    return {
        "editions": checked,
        "head": head,
        "findings": [asdict(f) for f in findings],
        "wrong": any(f.wrong for f in findings),
    }


# Was a file of the edition changed by hand?


def _altered(path: Place, about: About) -> Iterator[Finding]:
    name = path.name
    if about.edition != name:
        yield Finding(
            name, "altered", ABOUT, say("the folder was renamed; it is {}", about.edition)
        )
    if about.seal != about.expected_seal:
        yield Finding(name, "altered", ABOUT, say("{} was changed: its seal does not fit", ABOUT))
    if isinstance(path, Path):
        for link in sorted(f.name for f in (path, *path.iterdir()) if f.is_symlink()):
            message = say("{} is a link to somewhere else; an edition holds its files itself", link)
            yield Finding(name, "altered", link, message)
    present = {f.name for f in path.iterdir()}
    for file in sorted(present - {*about.files, ABOUT}):
        yield Finding(
            name, "notice", file, say("{} was added after publication", file), wrong=False
        )
    for file in sorted(about.files.keys() - present):
        yield Finding(name, "missing", file, say("{} is gone; put it back from a copy", file))
    changed = [
        f for f in sorted(about.files.keys() & present) if _sha256(path / f) != about.files[f]
    ]
    intact = (about.files.keys() & present) - set(changed)
    for file in changed:
        yield Finding(name, "altered", file, say("{} was changed after publication", file))
        for where, said in _where(path, about, file, intact):
            yield Finding(name, "altered", where, said)
    if "register.parquet" in present:
        yield from _codes(path, about)
        yield from _sheets(path, about, intact)


def _sha256(file: Place) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()


def _codes(path: Place, about: About) -> Iterator[Finding]:
    """Lines whose verification code does not fit their inputs, method and numbers."""
    try:
        register = read_table(path, "register")
        expected = sheets.verification_codes(register, about.method_hash)
    except (HerijkError, pl.exceptions.PolarsError):
        return
    stated = register[sheets.CODE_FIELD.column].to_list()
    for row, code, right in zip(register.iter_rows(named=True), stated, expected, strict=True):
        if code != right:
            yield Finding(
                path.name,
                "altered",
                f"register.parquet, {_line_name(row)}",
                say(
                    "verification code {} does not fit the line: inputs or numbers were changed",
                    code,
                ),
            )


def _sheets(path: Place, about: About, intact: set[str]) -> Iterator[Finding]:
    """Sheets that do not say what the register says, though their hashes were made to fit.

    Those of an earlier form, with other columns, cannot be compared cell by cell.
    """
    if "register.parquet" not in intact or about.seal != about.expected_seal:
        return
    for file in sorted(intact & {CSV, XLSX}):
        try:
            stated = sheets.read_csv_cells((path / CSV).read_bytes()) if CSV in intact else [[]]
            if stated[0] != _expected_csv(path)[0]:
                continue
        except (HerijkError, OSError, ValueError, pl.exceptions.PolarsError):
            continue  # told by `_codes` or when the edition is made again
        for where, message in _where(path, about, file, intact):
            yield Finding(path.name, "altered", where, message)


def _where(path: Place, about: About, file: str, intact: set[str]) -> list[tuple[str, str]]:
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


def _expected_csv(path: Place) -> sheets.Cells:
    fields = [*sheets.REGISTER_FIELDS, sheets.CODE_FIELD]
    rows = sheets.printed_cells(read_table(path, "register"), fields)
    return [[field.header for field in fields], *rows]


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


def _xlsx_cells(path: Place, about: About) -> list[tuple[str, str]]:
    fields = [*sheets.REGISTER_FIELDS, sheets.CODE_FIELD]
    register = read_table(path, "register")
    was = sheets.read_xlsx_cells(sheets.xlsx_bytes(register, fields, about))
    now = sheets.read_xlsx_cells((path / XLSX).read_bytes())
    places = sorted(p for p in was.keys() | now.keys() if was.get(p) != now.get(p))
    problems: list[tuple[str, str]] = [
        (f"{XLSX}, cell {place}", say("it says {!r}; it was {!r}", now.get(place), was.get(place)))
        for place in places
    ]
    return _not_too_many(XLSX, problems)


def _not_too_many(file: str, found: list[tuple[str, str]]) -> list[tuple[str, str]]:
    if len(found) <= MOST_CELLS:
        return found
    more = len(found) - MOST_CELLS
    return [*found[:MOST_CELLS], (file, say("and {} more places differ", more))]


def _line_name(row: dict[str, Any]) -> str:
    return f"{row['fsn_no']} {row['rowers']}{row['crew_class']}"


# Are the archive's files those it was made from?


def _archive(store: Store, path: Place, about: About, hashes: FileHashes) -> Iterator[Finding]:
    name = path.name
    root = intake.archive_root(store) if store.made_from("about_archive") is not None else None
    if root is None:
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
    for row in sheets.read_csv_cells((path / INPUTS).read_bytes())[1:]:
        if len(row) != len(sheets.INPUT_FIELDS):
            continue  # the file was changed, which is found elsewhere
        file, kind, sha256 = row
        at = root / file
        if not at.is_file():
            yield Finding(
                name, "missing", file, say("{} is gone from the archive; put it back", file)
            )
        elif hashes.hash_file(at) != sha256:
            yield Finding(
                name,
                "notice" if kind == LIST else "swapped",
                file,
                say("{} is not the file that the edition was made from", file),
                wrong=kind != LIST,
            )
    if about.kind == "recomputed" and (path / "tows.parquet").exists():
        yield from _list_rows(path, root, hashes)


def _list_rows(path: Place, root: Path, hashes: FileHashes) -> Iterator[Finding]:
    """Tows of the edition whose rows in the lists are no longer what they were."""
    try:
        index = index_archive(root, hashes.hash_file)
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
    pairs = was.select(*key, *facts).join(now.select(*key, *facts), on=key, suffix="_now")
    for row in pairs.sort(key).iter_rows(named=True):
        name = "tow " + ", run ".join(str(row[k]) for k in key)
        for fact in facts:
            if row[f"{fact}_now"] != row[fact]:
                message = say("{}: {} is {}; it was {}", name, fact, row[f"{fact}_now"], row[fact])
                yield Finding(edition, "swapped", name, message)


# Do archive and code of today give the same register?


def _made_again(store: Store, name: str) -> tuple[dict[str, int | None], list[Finding]]:
    """How many lines there are and come out equal, and a finding for each that does not."""
    try:
        edition = read_edition(store, name)
    except (HerijkError, ValidationError, OSError) as error:
        return dict.fromkeys(("lines", "made_again", "equal")), [_not_made(name, error)]
    to_make = edition.register.filter(pl.col("status") != NEVER_TOWED)
    counts: dict[str, int | None] = {"lines": edition.register.height, "made_again": 0, "equal": 0}
    try:
        again = made_again(store, edition)
    except (HerijkError, ValidationError, OSError, pl.exceptions.PolarsError) as error:
        return counts, [_not_made(name, error)]
    findings = list(_differing(store, edition, to_make, again))
    counts |= {"made_again": to_make.height, "equal": to_make.height - len(findings)}
    return counts, [*findings, *_other_members(edition, again, bool(findings))]


def _not_made(name: str, error: Exception) -> Finding:
    reason = str(error).splitlines()[0]
    return Finding(name, "unchecked", "register", say("it cannot be made again: {}", reason))


def _differing(
    store: Store, edition: Edition, lines: pl.DataFrame, again: Again
) -> Iterator[Finding]:
    now = again.lines.drop("flags", strict=False).join(
        store.read("listed_boats").select("fsn_no", *BOAT_FACTS), on="fsn_no", how="left"
    )
    known = [n for n in lines.columns if n in now.columns and n not in (*LINE, "basis", *_OWN)]
    pairs = lines.select(*LINE, "basis", *known).join(
        now.select(*LINE, *known), on=LINE, how="left", suffix="_now"
    )
    reasons = _Reasons.of(store, edition)
    for row in now.join(edition.register, on=LINE, how="anti").iter_rows(named=True):
        why, wrong = reasons.why(row | {"basis": None})
        message = say("made again, there is a line that the edition has not: {}", why)
        yield Finding(edition.about.edition, "differs", _line_name(row), message, wrong)
    for row in pairs.sort(LINE).iter_rows(named=True):
        unequal = [n for n in known if not _same(row[n], row[f"{n}_now"])]
        if not unequal:
            continue
        why, wrong = reasons.why(row)
        if set(unequal) <= set(BOAT_FACTS) and reasons.boats_changed:
            why, wrong = say("the boat list changed"), False
        what = ", ".join(f"{n} {_text(row[n])} > {_text(row[f'{n}_now'])}" for n in unequal)
        message = say("made again, {}: {}", what, why)
        yield Finding(edition.about.edition, "differs", _line_name(row), message, wrong)


def _other_members(edition: Edition, again: Again, explained: bool) -> Iterator[Finding]:
    """The ensemble, if it alone comes out otherwise."""
    if again.ensemble is None or explained:
        return
    key = ["tow_id", "member"]
    pairs = edition.tables["ensemble"].join(again.ensemble, on=key, how="full", suffix="_now")
    differ = (pairs["cw_kg_m"] / pairs["cw_kg_m_now"] - 1.0).abs() > SAME_NUMBER
    if differ.fill_null(True).any():
        new_code = edition.about.code_version != code_version()
        why = say("the code changed") if new_code else say("this should not happen")
        message = say("made again, its members come out otherwise: {}", why)
        yield Finding(edition.about.edition, "differs", "ensemble.parquet", message, not new_code)


@dataclass(frozen=True)
class _Reasons:
    """What can make a line of an edition come out otherwise."""

    about: About
    present: frozenset[str]
    boats_changed: bool
    unchanged: frozenset[str]
    same_inputs: bool

    @classmethod
    def of(cls, store: Store, edition: Edition) -> "_Reasons":
        boats_changed = _boats_changed(store, edition)
        if edition.method is None:
            return cls(edition.about, frozenset(), boats_changed, frozenset(), same_inputs=True)
        unchanged = unchanged_tows(store, edition)
        present = frozenset(store.read("tows")["tow_id"])
        same_inputs = len(unchanged) == edition.tables["tows"].height
        return cls(edition.about, present, boats_changed, unchanged, same_inputs)

    def why(self, row: dict[str, Any]) -> tuple[str, bool]:
        """Why a line comes out otherwise, and whether that breaks a promise."""
        if row["basis"] == AS_PRINTED and self.about.kind == "as_printed":
            return say("the printed register in the archive says so now"), True
        tow = row.get("tow_id")
        if tow is not None and tow not in self.present:
            return say("tow {} is no longer in the warehouse", tow), True
        if tow is not None and tow not in self.unchanged:
            return say("the files or the list row of tow {} changed", tow), True
        if not self.same_inputs:
            return say("other tows that went into it changed"), True
        if self.about.code_version != code_version():
            was, now = self.about.code_version, code_version()
            return say("the code changed, from {} to {}", was, now), False
        return say("inputs, method and code are the same; this should not happen"), True


def _boats_changed(store: Store, edition: Edition) -> bool:
    """Whether the list of boats is another than when the edition was published."""
    listed = (store.editions / edition.about.edition / INPUTS).read_bytes()
    rows = sheets.read_csv_cells(listed)[1:]
    was = {row[0]: row[2] for row in rows if len(row) == len(sheets.INPUT_FIELDS)}
    now = dict(store.read("listed_files").select("path", "sha256").rows())
    return BOATS_FILE not in was or was[BOATS_FILE] != now.get(BOATS_FILE)


def _same(was: float | str | None, now: float | str | None) -> bool:
    if isinstance(was, float) and isinstance(now, float):
        return abs(now - was) <= SAME_NUMBER * abs(was)
    return was == now


def _text(value: float | str | None) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value or "nothing")
