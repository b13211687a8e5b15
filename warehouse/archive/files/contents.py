"""Reading the bytes of a file, packed or not, within bounds."""

import os
from pathlib import Path
from typing import IO, Final

import pyarrow as pa  # type: ignore[import-untyped]

from pipeline.errors import DefectiveInputError
from pipeline.messages import say
from warehouse.archive.files.names import COMPRESSION, TEXT_SUFFIXES, kind_of
from warehouse.archive.limits import MOST_ROWS, too_many_rows

_CHUNK_BYTES: Final = 1 << 20


def read_bytes(path: Path, max_bytes: int) -> bytes:
    """The content of a file, unpacked when it is `.gz` or `.zst`.

    Raises:
        DefectiveInputError: `too_large`, `samples_missing` or `unreadable_file`.
    """
    content = _first_bytes(path, max_bytes + 1)
    if len(content) > max_bytes:
        raise too_large(path, max_bytes)
    rows = content.count(b"\n")
    if rows > MOST_ROWS:
        raise too_many_rows(rows)
    return content


def read_start(path: Path, most: int) -> bytes:
    """The first bytes of a file, unpacked, up to a whole line where there is one.

    Raises:
        DefectiveInputError: `samples_missing` or `unreadable_file`.
    """
    content = _first_bytes(path, most)
    is_utf16 = b"\x00" in content[:100]
    return content if is_utf16 else content[: content.rfind(b"\n") + 1] or content


def _first_bytes(path: Path, most: int) -> bytes:
    """A file, unpacked, but not more of it: a small one can unpack to gigabytes."""
    compression = COMPRESSION.get(path.suffix.casefold())
    try:
        with path.open("rb") as raw:
            if compression is None:
                content = raw.read(min(os.fstat(raw.fileno()).st_size, most))
            else:
                content = _unpack(raw, compression, most)
    except FileNotFoundError as error:
        said = say("'{name}' is not there any more.", name=path.name)
        raise DefectiveInputError("samples_missing", said) from error
    except (OSError, pa.ArrowException) as error:
        said = say("'{name}' cannot be read or unpacked: {error}.", name=path.name, error=error)
        raise DefectiveInputError("unreadable_file", said) from error
    has_old_ends = kind_of(path) in TEXT_SUFFIXES and b"\n" not in content  # CR, of old Macs
    return content.replace(b"\r", b"\n") if has_old_ends else content


def _unpack(raw: IO[bytes], compression: str, most: int) -> bytes:
    pieces: list[bytes] = []
    left = most
    with pa.CompressedInputStream(pa.PythonFile(raw, mode="r"), compression) as stream:
        while left and (piece := stream.read(min(_CHUNK_BYTES, left))):
            pieces.append(piece)
            left -= len(piece)
    return b"".join(pieces)


def not_whole(path: Path, kind: str, error: Exception) -> DefectiveInputError:
    """The error for a file of another program that is damaged or cut off."""
    said = say(
        "'{name}' is not a whole {kind} file: {error}.", name=path.name, kind=kind, error=error
    )
    return DefectiveInputError("unreadable_file", said)


def too_large(path: Path, max_bytes: int) -> DefectiveInputError:
    """The error for a file that holds more than `max_bytes`."""
    return DefectiveInputError(
        "too_large",
        say(
            "'{name}' holds more than {limit:.0f} MB, unpacked; a samples file is about 12 MB.",
            name=path.name,
            limit=max_bytes / 1e6,
        ),
    )
