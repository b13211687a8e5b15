"""Which files an archive has, their content, and the hash of it.

No path leads outside the archive. What is in a file belongs to the modules that read it.
"""

import json
import os
import re
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path
from typing import BinaryIO, Final

import pyarrow as pa  # type: ignore[import-untyped]
from zlib_ng import zlib_ng

from pipeline.errors import DefectiveInputError
from pipeline.messages import say
from warehouse.archive.columns import fold_word
from warehouse.archive.faults import DefectiveFileError
from warehouse.archive.kinds import LIST_KINDS, ListKind
from warehouse.archive.profile import PROFILE_FILE, Profiles, make_pattern
from warehouse.store.files import file_sha256, write_beside

SAMPLES: Final = "samples"
TEXT_SUFFIXES: Final = (".csv", ".txt")
REFUSED_SUFFIXES: Final = (".xls", ".ods")
"""Of lists that are told how to be saved."""
LIST_SUFFIXES: Final = TEXT_SUFFIXES + (".xlsx", ".xlsm") + REFUSED_SUFFIXES
COMPRESSION: Final = {".gz": "gzip", ".zst": "zstd"}
SAMPLE_TEXT_SUFFIXES: Final = TEXT_SUFFIXES + (".dat", ".tsv", ".asc")
PACKED_SUFFIXES: Final = tuple(
    text + packed for packed in COMPRESSION for text in SAMPLE_TEXT_SUFFIXES
)
SAMPLE_SUFFIXES: Final = PACKED_SUFFIXES + SAMPLE_TEXT_SUFFIXES + (".parquet", ".tdms", ".lvm")
PARTS: Final = " | "
"""Between the files of a tow that has a file for each run."""
MAX_BYTES: Final = 250_000_000
"""Size of a file, unpacked; one tow of six runs at 1000 Hz is 12 MB."""
UNPACKING_ERROR: Final[type[Exception]] = zlib_ng.error  # type: ignore[assignment]
"""The stubs of zlib-ng declare an instance."""
PIECE_BYTES: Final = 1 << 24
RACY_SECONDS: Final = 2.0
"""A file this fresh can change again without a change of its time stamp (coarse clocks), so its
hash is not remembered; git calls such an index entry racy."""
_NOT_OURS: Final = re.compile(
    r"\..*|~\$.*|thumbs\.db|desktop\.ini|readme.*|leesmij.*", re.IGNORECASE
)


Places = list[tuple[ListKind, str, re.Pattern[str]]]
"""Of each kind of list its folder, and the pattern of its name."""


@dataclass(frozen=True)
class ArchiveFile:
    """A file of the archive.

    Attributes:
        path: posix path relative to the archive.
        full_path: where it is.
        kind: a kind of list, `SAMPLES`, the profile's name, or empty for what nobody reads.
        season: the year in its name or that of its folder; 0 where neither tells it.
        inside: it is a file in the archive and not, through a link, outside.
    """

    path: str
    full_path: Path
    kind: ListKind | str
    season: int
    inside: bool


def list_files(root: Path, profiles: Profiles) -> list[ArchiveFile]:
    """Return the files of an archive, and the folders that nobody reads, by their path.

    Lists are `<folder>/<name>_<jaar>`; samples are `meetdata_<jaar>/<meetfile>`, unless the profile
    names them otherwise.
    """
    lists: Places = []
    for known in LIST_KINDS:
        folder, _, name = profiles.find_place(known).partition("/")
        lists.append((known, folder, make_pattern(name)))
    samples = make_pattern(profiles.samples_place)
    list_folders = {folder for _, folder, _ in lists}
    found = []
    for entry in _list_entries(root):
        is_read = entry.is_dir() and (entry.name in list_folders or samples.fullmatch(entry.name))
        for file in _list_entries(entry) if is_read else [entry]:
            name = file.relative_to(root).as_posix()
            path = os.fsencode(name).decode(errors="replace")
            is_text = path == name  # or else bytes that are no text
            kind, season = _find_kind(root, file, lists, samples) if is_text else ("", 0)
            inside = _is_inside(root, file)
            found.append(
                ArchiveFile(path=path, full_path=file, kind=kind, season=season, inside=inside)
            )
    return sorted(found, key=lambda file: file.path)


def _list_entries(folder: Path) -> list[Path]:
    return [entry for entry in folder.iterdir() if not _NOT_OURS.fullmatch(entry.name)]


def _find_kind(
    root: Path, entry: Path, lists: Places, samples_folder: re.Pattern[str]
) -> tuple[ListKind | str, int]:
    """Return the kind of an entry and its season; empty and 0 where nobody reads it."""
    if entry.parent == root:
        return (PROFILE_FILE if entry.name == PROFILE_FILE else ""), 0
    if entry.is_dir():
        return "", 0
    if samples := samples_folder.fullmatch(entry.parent.name):
        return (SAMPLES if find_sample_suffix(entry.name) else ""), int(samples["year"])
    for kind, folder, name in lists if entry.suffix.lower() in LIST_SUFFIXES else ():
        match = name.fullmatch(entry.stem)
        if match and folder == entry.parent.name:
            return kind, int(match.groupdict().get("year") or 0)
    return "", 0


def _is_inside(root: Path, full: Path) -> bool:
    try:
        return full.is_file() and full.resolve().is_relative_to(root.resolve())
    except (RuntimeError, OSError):  # a link to itself
        return False


def make_outside_archive_error(relative: str) -> DefectiveFileError:
    """Return the error for a path that leaves the archive."""
    said = say("'{path}' leads outside the archive, where nothing is read.", path=relative)
    return DefectiveFileError("path_outside_archive", said, None, relative)


def resolve_inside(root: Path, relative: str) -> Path:
    """Return the full path of a file of the archive.

    Raises:
        DefectiveInputError: `path_outside_archive`, or `samples_missing`.
    """
    full = root / relative
    if not full.exists():
        said = say("'{name}' is not there any more.", name=relative)
        raise DefectiveFileError("samples_missing", said, None, relative)
    if not _is_inside(root, full):
        raise make_outside_archive_error(relative)
    return full


def find_sample_suffix(name: str) -> str:
    """Return the suffix of a samples file, in lower case; empty for any other file."""
    return next((suffix for suffix in SAMPLE_SUFFIXES if name.lower().endswith(suffix)), "")


def fold_file_name(name: str) -> str:
    """Return the name of a samples file for comparing: without case, double blanks and suffix."""
    folded = fold_word(name)
    return folded.removesuffix(find_sample_suffix(folded)).strip()


def read_bytes(path: Path, most: int = MAX_BYTES, start_only: bool = False) -> bytes:
    """Return the content of a file, unpacked when it is `.gz` or `.zst`; at most so much of it.

    Raises:
        DefectiveInputError: `unreadable_file`, or `too_large` unless only its start is wanted.
    """
    compression = COMPRESSION.get(path.suffix.lower())
    try:
        with path.open("rb") as raw:
            size = os.fstat(raw.fileno()).st_size
            if compression is None:
                content = raw.read(min(size, most + 1))
            elif compression == "gzip":
                content = _unpack_gzip(raw, most + 1)
            else:
                content = _unpack(raw, compression, most + 1)
    except (OSError, EOFError, UNPACKING_ERROR, pa.ArrowException) as error:
        said = say("'{name}' cannot be read or unpacked: {error}.", name=path.name, error=error)
        raise DefectiveInputError("unreadable_file", said) from error
    if len(content) > most and not start_only:
        text = say(
            "'{name}' holds more than {limit:.0f} MB, unpacked; a samples file is about 12 MB."
        )
        raise DefectiveInputError("too_large", say(text, name=path.name, limit=most / 1e6))
    return content


def _unpack_gzip(raw: BinaryIO, most: int) -> bytes:
    """Return the first bytes of a gzip file; zlib-ng takes half the time of Arrow's gzip."""
    pieces: list[bytes] = []
    packed = b""
    while most > 0 and (packed := packed or raw.read(PIECE_BYTES)):
        member = zlib_ng.decompressobj(wbits=31)  # with the header and the checksum of gzip
        while most > 0 and not member.eof:
            packed = packed or raw.read(PIECE_BYTES)
            if not packed:
                raise EOFError("the file ends in the middle of a packed part")
            piece = member.decompress(packed, most)
            packed = member.unused_data or member.unconsumed_tail
            pieces.append(piece)
            most -= len(piece)
    return b"".join(pieces)


def _unpack(raw: object, compression: str, most: int) -> bytes:
    """Return the first bytes of a packed file: a small one can unpack to gigabytes."""
    pieces: list[bytes] = []
    with pa.CompressedInputStream(pa.PythonFile(raw, mode="r"), compression) as stream:
        while most > 0 and (piece := stream.read(min(PIECE_BYTES, most))):
            pieces.append(piece)
            most -= len(piece)
    return b"".join(pieces)


def combine_hashes(hashes: list[str]) -> str:
    """Return one hash of several, in their order; that of a single one is it."""
    return hashes[0] if len(hashes) == 1 else sha256("\n".join(hashes).encode()).hexdigest()


Hashes = dict[str, tuple[str, int]]
"""SHA-256 and size in bytes of a file, by its path in the archive."""


def hash_files(
    files: Iterable[ArchiveFile], hash_file: Callable[[Path], str]
) -> tuple[Hashes, list[DefectiveFileError]]:
    """Return the hashes of the files that are read, and the errors of those that cannot be."""
    known: Hashes = {}
    errors = []
    for file in files:
        try:
            if file.kind and file.inside:
                known[file.path] = hash_file(file.full_path), file.full_path.stat().st_size
        except OSError as error:
            text = say("'{name}' cannot be read or unpacked: {error}.")
            said = say(text, name=file.path, error=error.strerror)
            errors.append(DefectiveFileError("unreadable_file", said, None, file.path))
    return known, errors


@dataclass
class FileHashes:
    """SHA-256 of files by path, remembered as long as size and modification time are the same.

    A cache and no more: losing it costs time, never a result.

    Attributes:
        entries: absolute path -> (size in bytes, mtime in ns, sha256).
    """

    entries: dict[str, tuple[int, int, str]] = field(default_factory=dict)

    @classmethod
    def load(cls, path: Path) -> "FileHashes":
        """Return the cache saved at `path`; an empty one when it is absent or damaged."""
        try:
            stored = json.loads(path.read_text(encoding="utf-8"))
            return cls({str(k): (int(v[0]), int(v[1]), str(v[2])) for k, v in stored.items()})
        except (OSError, ValueError, TypeError, AttributeError, IndexError, KeyError):
            return cls()

    def save(self, path: Path) -> None:
        """Write the cache to `path` in one step: a reader sees the old one or the new one."""
        with write_beside(path) as beside:
            beside.write_text(json.dumps(self.entries, indent=0, sort_keys=True), encoding="utf-8")

    def hash_samples(self, root: Path, paths: str) -> str:
        """Return the SHA-256 of a samples file, or of the hashes of a tow's files of one run each.

        Raises:
            OSError: a file cannot be read.
        """
        return combine_hashes([self.hash_file(root / path) for path in paths.split(PARTS)])

    def hash_file(self, path: Path) -> str:
        """Return the SHA-256 of a file's content, as hexadecimal text.

        Raises:
            OSError: the file cannot be read.
        """
        key, before = str(path.absolute()), path.stat()
        known = self.entries.get(key)
        if known is not None and known[:2] == (before.st_size, before.st_mtime_ns):
            return known[2]
        content = file_sha256(path)
        after = path.stat()
        unchanged = (before.st_size, before.st_mtime_ns) == (after.st_size, after.st_mtime_ns)
        settled = time.time_ns() - after.st_mtime_ns >= RACY_SECONDS * 1e9
        if unchanged and settled:
            self.entries[key] = (after.st_size, after.st_mtime_ns, content)
        else:
            self.entries.pop(key, None)
        return content
