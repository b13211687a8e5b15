"""Where the lake and the editions lie: in folders of this machine, or in a bucket of S3 storage.

`opslag.toml` in the data folder says where; without it both lie in the data folder. How a bucket is
reached is in `warehouse.store.bucket`, which needs the extra `s3`.
"""

import io
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, TYPE_CHECKING, Final, TypeAlias

from pydantic import BaseModel, ConfigDict, Field

from herijk.pipeline.errors import MissingKnowledgeError
from herijk.warehouse.store.files import written_beside
from herijk.warehouse.store.settings_file import read_settings_file
from herijk.words import say

if TYPE_CHECKING:
    from herijk.warehouse.store.bucket import BucketPath

Place: TypeAlias = "Path | BucketPath"
"""A file or folder, of this machine or in a bucket."""

FILE_NAME: Final = "opslag.toml"
_BUCKET: Final = r"^s3://[a-z0-9][a-z0-9.-]+(/[A-Za-z0-9._=-]+)+$"
_MAY_HOLD: Final = say("lake and editions, each as 's3://bucket/prefix' without a name or password")


class Locations(BaseModel):
    """What `opslag.toml` can say.

    Attributes:
        lake: bucket and prefix of samples, blocks and tables: `s3://bucket/prefix`.
        editions: the same of the published editions.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", hide_input_in_errors=True)

    lake: str | None = Field(default=None, pattern=_BUCKET)
    editions: str | None = Field(default=None, pattern=_BUCKET)


def read_locations(root: Path) -> Locations:
    """Where a data folder's lake and editions lie.

    Raises:
        MissingKnowledgeError: the file cannot be understood.
    """
    return read_settings_file(root / FILE_NAME, Locations, _MAY_HOLD)


def place(url: str | None, otherwise: Path) -> Place:
    """The place in a bucket that a setting names, or a folder of this machine where it names none.

    Raises:
        MissingKnowledgeError: the library for buckets is not installed.
    """
    if url is None:
        return otherwise
    try:
        from herijk.warehouse.store.bucket import BucketPath  # noqa: PLC0415 - needs the extra s3
    except ImportError as error:
        raise MissingKnowledgeError(
            "{} needs a library that is not there; install it with: pip install 'herijk[s3]'", url
        ) from error
    return BucketPath.parse(url)


@contextmanager
def written_whole(target: Place) -> Iterator[Path | IO[bytes]]:
    """Gives something to write to; if all went well, that is what then is there, whole."""
    if isinstance(target, Path):
        with written_beside(target) as beside:
            yield beside
    else:
        buffer = io.BytesIO()
        yield buffer
        target.write_bytes(buffer.getvalue())
