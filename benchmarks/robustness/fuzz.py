"""Throws damaged files at every reader: no crash, no hang, no number that is not there.

    python benchmarks/robustness/fuzz.py [inputs] [seed]

Valid files are damaged at random: bytes changed, cut, doubled, replaced by what people and
programs really write wrong. A reader may refuse with a fault or accept. It may not raise anything
else or take more than two seconds. Where it accepts samples, an independent reading of the same
bytes (Python's own csv, gzip and float) must give the same numbers.
"""

import gzip
import io
import random
import re
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import numpy as np
import polars as pl
import pyarrow as pa
import xlsxwriter

from assets.settings import read_settings
from herijk.simulate import WorldSettings, simulate_world
from herijk.simulate.archive_writer import write_simulated_archive
from pipeline.channels import SAMPLE_SCHEMA
from pipeline.errors import DefectiveInputError, HerijkError
from pipeline.method.definition import parse_method, shipped_methods, shipped_text
from tests.reason_codes import REASON_CODES
from warehouse.archive import FileHashes, index_archive
from warehouse.archive.faults import Failure
from warehouse.archive.files import ArchiveFile
from warehouse.archive.kinds import TOWS
from warehouse.archive.lists import read_lists
from warehouse.archive.profile import Profiles, read_profiles
from warehouse.archive.samples import read_samples
from warehouse.store.decisions import FILE_NAME as DECISIONS
from warehouse.store.decisions import read_decisions
from warehouse.store.editions import MANIFEST, read_manifest

SLOW_S: Final = 2.0
HANG_S: Final = 20.0
"""Seconds of processor time: a reader that takes longer is told to stop."""
WORDS: Final = (
    *(b"NaN", b"inf", b"-inf", b"1e999", b"-1e-999", b"1.2.3", b"1,2,3", b"1e5", b"0x10"),
    *(b"1_000", b"--1", b"+", b"9" * 400, b"1" * 40, b"7", b"0", b"-1", b"1.5", b" " * 1000),
    *("\u0661\u0662".encode(), "\u2212".encode(), b"\x00", b"\xff\xfe", b"\xef\xbb\xbf"),
    *(b"", b";", b";;;;;;", b"\t", b",", b"\n", b"\r\n", b"\r", b'"', b'""', b'"\n"', b"'"),
    *(b"=1+1", b"@SUM(A1)", b"../../etc/passwd", b"/etc/passwd", b"..\\x", b"<script>"),
    *(b"[km/h]", b"[m]", b"[", b"]", b"run", b"log1 [m/s]", b"[[profile]]\n", b"seasons = "),
    *(b"[[set_aside]]\n", b"{}", b"[]", b"\x1a", b"\x80\x81\x8d"),
)
"""What people and programs really write wrong."""

_NUMBER: Final = re.compile(r"[+-]?([0-9]+([.,][0-9]*)?|[.,][0-9]+)([eE][+-]?[0-9]+)?", re.ASCII)
_COLUMNS: Final = {1: "log1_m_s", 2: "log2_m_s", 3: "force_n", 4: "wind_speed_m_s"}


@dataclass
class Findings:
    """What happened: outcomes counted, and the inputs on which a reader failed."""

    outcomes: Counter[str] = field(default_factory=Counter)
    failures: list[str] = field(default_factory=list)
    slowest_s: float = 0.0


@dataclass(frozen=True)
class Target:
    """A kind of file: what it is called, valid content, and what reads it."""

    name: str
    content: bytes
    read: Callable[[Path, bytes], None]


def damage(chosen: random.Random, content: bytes) -> bytes:
    """One to four changes at random places."""
    for _ in range(chosen.choice((1, 1, 1, 2, 3, 4))):
        content = chosen.choice(_CHANGES)(chosen, content)
    return content


def _place(chosen: random.Random, content: bytes) -> tuple[int, int]:
    """Begin and end of a piece, mostly short; often near the begin, where the header is."""
    begin = chosen.randrange(min(len(content), chosen.choice((80, len(content)))) + 1)
    return begin, min(len(content), begin + chosen.choice((1, 1, 2, 5, 20, 200)))


def _flip(chosen: random.Random, content: bytes) -> bytes:
    begin, end = _place(chosen, content)
    return content[:begin] + chosen.randbytes(end - begin) + content[end:]


def _cut(chosen: random.Random, content: bytes) -> bytes:
    begin, end = _place(chosen, content)
    return content[:begin] + content[end:]


def _end(chosen: random.Random, content: bytes) -> bytes:
    return content[: chosen.randrange(len(content) + 1)]


def _double(chosen: random.Random, content: bytes) -> bytes:
    begin, end = _place(chosen, content)
    return content[:end] + content[begin:end] * chosen.choice((1, 1, 3, 100)) + content[end:]


def _word(chosen: random.Random, content: bytes) -> bytes:
    begin, end = _place(chosen, content)
    return content[:begin] + chosen.choice(WORDS) + content[chosen.choice((begin, end)) :]


def _cell(chosen: random.Random, content: bytes) -> bytes:
    """Puts a word in place of one cell."""
    cells = re.split(rb"([;,\t\n])", content)
    cells[2 * chosen.randrange((len(cells) + 1) // 2)] = chosen.choice(WORDS)
    return b"".join(cells)


def _swap_lines(chosen: random.Random, content: bytes) -> bytes:
    lines = content.split(b"\n")
    one, other = (chosen.randrange(len(lines)) for _ in range(2))
    lines[one], lines[other] = lines[other], lines[one]
    return b"\n".join(lines)


def _giant_line(chosen: random.Random, content: bytes) -> bytes:
    begin, _ = _place(chosen, content)
    return content[:begin] + chosen.choice((b"1", b";", b"a", b'"')) * 200_000 + content[begin:]


_CHANGES: Final = (
    *(_flip, _cut, _end, _double, _word, _word, _cell, _cell, _cell, _swap_lines),
    *(_flip, _cut, _end, _double, _word, _word, _cell, _cell, _cell, _giant_line),
)


# What reads what


def independent(data: bytes) -> np.ndarray:
    """Numbers of the first five columns as Python reads them; NaN where it cannot."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("cp1252")
    lines = text.rstrip("\r\n").split("\n")
    rows = [line.rstrip("\r").split(";") for line in lines]
    width = len(rows[0])
    return np.array([_python_row(row, width) for row in rows[1:]])


def _python_row(row: list[str], width: int) -> list[float]:
    """A row with too few or too many fields, or without a run, says nothing."""
    numbers = [_python_number(cell) for cell in row[:5]]
    return numbers if len(row) == width and np.isfinite(numbers[0]) else [np.nan] * 5


def _python_number(cell: str) -> float:
    stripped = cell.strip(" \t")
    if len(stripped) > 1 and stripped[0] == stripped[-1] == '"':
        stripped = stripped[1:-1].strip(" \t")
    if not _NUMBER.fullmatch(stripped):
        return np.nan
    number = float(stripped.replace(",", "."))
    return number if abs(number) <= np.finfo(np.float32).max else np.nan


def samples_reader(profiles: Profiles, header: bytes) -> Callable[[Path, bytes], None]:
    """Reads samples, and compares them with an independent reading where the header is whole."""

    def read(path: Path, data: bytes) -> None:
        samples, _ = read_samples(path, profiles.for_season(2009), sample_rate_hz=20)
        assert samples.schema == pl.Schema(SAMPLE_SCHEMA)
        plain = _unpacked(path, data)
        if plain is None or plain.split(b"\n")[0].rstrip(b"\r") != header:
            return
        expected = independent(plain)
        assert expected.shape[0] == samples.height
        both_marks = b"," in plain and b"." in plain
        for column, name in _COLUMNS.items():
            there, values = expected[:, column].astype(np.float32), samples[name].to_numpy()
            if both_marks:  # 1.012 may then be a thousand and twelve, and is not read
                there = np.where(np.isnan(values), np.nan, there)
            _assert_as_they_stand(there, values)
        known = np.isfinite(expected[:, 0])
        assert np.array_equal(expected[known, 0], samples["run"].to_numpy()[known])

    return read


def _assert_as_they_stand(expected: np.ndarray, read: np.ndarray) -> None:
    """What is read is what is there; nothing is read where no number can be."""
    assert np.array_equal(expected, read, equal_nan=True)


def _unpacked(path: Path, data: bytes) -> bytes | None:
    """The text of a samples file by other means than the reader's; None for Parquet."""
    if path.suffix == ".csv":
        return data
    return gzip.decompress(data) if path.suffix == ".gz" else None


def archive_reader(root: Path) -> Callable[[Path, bytes], None]:
    """Indexes the archive in which the file lies."""

    def read(*_: object) -> None:
        found = index_archive(root, FileHashes().hash_file)
        if failures := [fault for fault in found.faults if isinstance(fault, Failure)]:
            raise RuntimeError(failures[0].trace)
        for tow in found.tows.iter_rows(named=True):
            for name in ("samples_path", "second_path"):
                inside = tow[name] is None or (root / tow[name]).resolve().is_relative_to(root)
                assert inside, tow[name]

    return read


def targets(folder: Path) -> list[Target]:
    """All kinds of files, valid."""
    root = folder / "archive"
    write_simulated_archive(root, simulate_world(WorldSettings((2009, 2014), 3, 20, 5)))
    profiles = read_profiles(root)
    whole = min((root / "meetdata_2009").iterdir()).read_bytes()
    lines = whole.split(b"\n")
    text = b"\n".join([lines[0], *lines[1:-1:100], b""])
    header = lines[0].rstrip(b"\r")
    frame = pl.read_csv(text.replace(b",", b"."), separator=";")
    parquet = io.BytesIO()
    frame.write_parquet(parquet)
    read = samples_reader(profiles, header)
    zstd = pa.compress(text, codec="zstd", asbytes=True)
    here = archive_reader(root.resolve())
    lists = [
        root / "sloepregister/sloependata.csv",
        root / "sleeplijsten/sleeplijst_2009.csv",
        root / "archief.toml",
    ]
    return [
        *(Target("samples.csv", text, read) for _ in range(4)),
        Target("samples.csv.gz", gzip.compress(text, mtime=0), read),
        Target("samples.csv.zst", zstd, read),
        Target("samples.parquet", parquet.getvalue(), read),
        Target("list.xlsx", _xlsx(lists[1]), _read_list),
        Target("list.csv", lists[1].read_bytes(), _read_list),
        *(Target(str(path), path.read_bytes(), here) for path in lists),
        Target(DECISIONS, _DECISION, lambda path, _: read_decisions(path) and None),
        Target("beheer.toml", _SETTINGS, lambda path, _: read_settings(path.parent) and None),
        Target(MANIFEST, b'{"edition": "1", "kind": "as_printed"}', _read_manifest),
        Target("method.toml", shipped_text(list(shipped_methods())[-1]).encode(), _read_method),
    ]


def _xlsx(tow_list: Path) -> bytes:
    """A tow list as a workbook."""
    content = io.BytesIO()
    with xlsxwriter.Workbook(content) as book:
        sheet = book.add_worksheet("2009")
        for row, line in enumerate(tow_list.read_text("cp1252").splitlines()):
            sheet.write_row(row, 0, line.split(";"))
    return content.getvalue()


def _read_list(path: Path, _: bytes) -> None:
    file = ArchiveFile(path.name, path, TOWS, 2009, inside=True)
    faults = read_lists([file], TOWS, Profiles()).faults
    if failures := [fault for fault in faults if isinstance(fault, Failure)]:
        raise RuntimeError(failures[0].trace)


_DECISION: Final = b"""[[besluit]]
sleep_id = "2009-001"
oordeel = "uitsluiten"
reden = "wind"
wie = "TC"
datum = 2026-05-08
"""
_SETTINGS: Final = b'nightly = "0 3 * * *"\nsmtp = "smtp://example.org"\nfactor_jump = 0.01\n'


def _read_manifest(path: Path, _: bytes) -> None:
    read_manifest(path.parent)


def _read_method(path: Path, data: bytes) -> None:
    try:
        text = data.decode()
    except UnicodeDecodeError:
        return
    parse_method(text, path.name)


def fuzz(inputs: int, seed: int, tell: Callable[[str], None] = print) -> Findings:
    """Damages files and reads them."""
    found = Findings()
    signal.signal(signal.SIGVTALRM, _hangs)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        known = targets(folder)
        for number in range(inputs):
            chosen = random.Random(f"{seed}-{number}")
            target = known[number % len(known)]
            _try(folder, target, damage(chosen, target.content), number, found)
            if number % 1000 == 999:
                tell(f"{number + 1} of {inputs} inputs, {len(found.failures)} failures")
    return found


def _hangs(*_: object) -> None:
    raise TimeoutError(f"no answer within {HANG_S:.0f} s")


def assert_told(error: HerijkError, found: Findings, number: int, path: Path) -> None:
    """A refusal must reach a person: a sentence, and of a file of the archive a known code."""
    is_sentence = len(str(error)) > 10 and str(error).isprintable()
    is_known = not isinstance(error, DefectiveInputError) or error.reason_code in REASON_CODES
    if not (is_sentence and is_known):
        found.failures.append(
            f"input {number}, {path.name}: refused, but not told: {error!r}"[:300]
        )


def _try(folder: Path, target: Target, data: bytes, number: int, found: Findings) -> None:
    path = folder / target.name
    path.write_bytes(data)
    begin = time.process_time()
    signal.setitimer(signal.ITIMER_VIRTUAL, HANG_S)
    try:
        target.read(path, data)
        outcome = "accepted"
    except HerijkError as error:
        outcome = "refused"
        assert_told(error, found, number, path)
    except (Exception, pl.exceptions.PanicException) as error:
        outcome = "FAILED"
        what = f"input {number}, {path.name}: {type(error).__name__}: {error}"[:300]
        print(what, file=sys.stderr, flush=True)
        found.failures.append(what)
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
    seconds = time.process_time() - begin
    found.slowest_s = max(found.slowest_s, seconds)
    if seconds > SLOW_S:
        found.failures.append(f"input {number}, {path.name}: took {seconds:.1f} s")
    found.outcomes[f"{path.name}: {outcome}"] += 1
    path.write_bytes(target.content)


def main() -> None:
    """Runs the suite and prints the figures; exit status 1 when a reader failed."""
    inputs = int(sys.argv[1]) if len(sys.argv) > 1 else 20_000
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    found = fuzz(inputs, seed, lambda line: print(line, flush=True))
    for outcome, number in sorted(found.outcomes.items()):
        print(f"  {outcome:32} {number}")
    print(f"seed {seed}, {inputs} inputs; slowest {found.slowest_s:.2f} s of processor time")
    print("\n".join(found.failures[:50]) or "no failure")
    sys.exit(bool(found.failures))


if __name__ == "__main__":
    main()
