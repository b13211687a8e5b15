"""The hash of a file's content, remembered as long as the file looks unchanged.

A cache and no more: losing it costs time, never a result.
"""

import hashlib
import json
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from warehouse.archive.files.names import PARTS, split_sheet
from warehouse.store.files import file_sha256, written_beside

RACY_SECONDS: Final = 2.0
"""A file this fresh can change again without a change of its time stamp (coarse clocks), so its
hash is not remembered; git calls such an index entry racy."""


@dataclass
class FileHashes:
    """SHA-256 of files by path, size and modification time.

    Attributes:
        entries: absolute path -> (size in bytes, mtime in ns, sha256).
    """

    entries: dict[str, tuple[int, int, str]] = field(default_factory=dict)

    @classmethod
    def load(cls, path: Path) -> "FileHashes":
        """The cache saved at `path`; an empty one when it is absent or damaged."""
        try:
            stored = json.loads(path.read_text(encoding="utf-8"))
            return cls(
                {
                    str(name): (int(size), int(mtime_ns), str(sha256))
                    for name, (size, mtime_ns, sha256) in stored.items()
                }
            )
        except (OSError, ValueError, TypeError, AttributeError):
            return cls()

    def save(self, path: Path) -> None:
        """Writes the cache to `path` in one step: a reader sees the old one or the new one."""
        with written_beside(path) as beside:
            beside.write_text(json.dumps(self.entries, indent=0, sort_keys=True), encoding="utf-8")

    def hash_samples(self, root: Path, path: str) -> str:
        """The SHA-256 of samples; of a file per run that of their hashes, in their order.

        Args:
            root: the archive.
            path: the file, or the files with `PARTS` between them, relative to it.

        Raises:
            OSError: a file cannot be read.
        """
        parts = [split_sheet(part) for part in path.split(PARTS)]
        hashes = [hash_of_sheet(self.hash_file(root / file), sheet) for file, sheet in parts]
        return hash_of_parts(hashes)

    def hash_file(self, path: Path) -> str:
        """The SHA-256 of a file's content, as hexadecimal text.

        Raises:
            OSError: the file cannot be read.
        """
        key = str(path.absolute())
        before = path.stat()
        known = self.entries.get(key)
        if known is not None and known[:2] == (before.st_size, before.st_mtime_ns):
            return known[2]
        sha256 = file_sha256(path)
        after = path.stat()
        unchanged = (before.st_size, before.st_mtime_ns) == (after.st_size, after.st_mtime_ns)
        settled = time.time_ns() - after.st_mtime_ns >= RACY_SECONDS * 1e9
        if unchanged and settled:
            self.entries[key] = (after.st_size, after.st_mtime_ns, sha256)
        else:
            self.entries.pop(key, None)
        return sha256


def hash_of_sheet(sha256: str, sheet: str) -> str:
    """The hash of a sheet from that of its workbook; of a file without one its own."""
    return hashlib.sha256(f"{sha256}#{sheet}".encode()).hexdigest() if sheet else sha256


def hash_of_parts(hashes: list[str]) -> str:
    """One hash of several files from theirs, in their order; that of a single one is it."""
    if len(hashes) == 1:
        return hashes[0]
    return hashlib.sha256("\n".join(hashes).encode()).hexdigest()
