"""Objects in a bucket of S3 storage, with those methods of `pathlib.Path` that the warehouse uses.

An object appears whole or not at all, and replaces an older one at once: that is how S3 storage
works, so nothing is written beside. Which places lie in a bucket is said in
`warehouse.store.storage`.
"""

import fnmatch
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import PurePosixPath

import obstore
from obstore.exceptions import AlreadyExistsError, BaseError
from obstore.store import S3Store

from herijk.pipeline.errors import UnavailableError


@dataclass(frozen=True)
class BucketPath:
    """An object, or all objects below a prefix.

    Attributes:
        bucket: `s3://name`.
        key: path within the bucket.
    """

    bucket: str
    key: PurePosixPath

    @classmethod
    def parse(cls, url: str) -> "BucketPath":
        """The place that `s3://bucket/prefix` names."""
        name, _, key = url.removeprefix("s3://").partition("/")
        return cls(f"s3://{name}", PurePosixPath(key))

    def __str__(self) -> str:
        return f"{self.bucket}/{self.key}"

    def __truediv__(self, name: str) -> "BucketPath":
        return BucketPath(self.bucket, self.key / name)

    @property
    def name(self) -> str:
        """The last part."""
        return self.key.name

    @property
    def stem(self) -> str:
        """The last part without its suffix."""
        return self.key.stem

    @property
    def parent(self) -> "BucketPath":
        """The prefix it lies under."""
        return BucketPath(self.bucket, self.key.parent)

    def exists(self) -> bool:
        """Whether there is an object of this name."""
        try:
            with _explained(self):
                obstore.head(_client(self.bucket), str(self.key))
        except FileNotFoundError:
            return False
        return True

    def iterdir(self) -> Iterator["BucketPath"]:
        """Objects and prefixes directly below it, sorted."""
        with _explained(self):
            listing = obstore.list_with_delimiter(_client(self.bucket), str(self.key))
        below = [*(one["path"] for one in listing["objects"]), *listing["common_prefixes"]]
        yield from (BucketPath(self.bucket, PurePosixPath(path)) for path in sorted(below))

    def glob(self, pattern: str) -> Iterator["BucketPath"]:
        """What lies directly below it and has a name like the pattern."""
        return (one for one in self.iterdir() if fnmatch.fnmatchcase(one.name, pattern))

    def read_bytes(self) -> bytes:
        """The content.

        Raises:
            FileNotFoundError: there is no such object.
        """
        with _explained(self):
            return obstore.get(_client(self.bucket), str(self.key)).bytes().to_bytes()

    def read_text(self, encoding: str) -> str:
        """The content as text; raises as `read_bytes`."""
        return self.read_bytes().decode(encoding)

    def read_end(self, size: int) -> bytes:
        """The last bytes, all where there are fewer; raises as `read_bytes`."""
        with _explained(self):
            response = obstore.get(
                _client(self.bucket), str(self.key), options={"range": {"suffix": size}}
            )
            return response.bytes().to_bytes()

    def write_bytes(self, content: bytes) -> None:
        """Puts an object, in the place of an older one."""
        with _explained(self):
            obstore.put(_client(self.bucket), str(self.key), content)

    def create_bytes(self, content: bytes) -> None:
        """Puts an object where there is none; the service sees to it that only one wins.

        Raises:
            FileExistsError: there is one.
        """
        try:
            with _explained(self):
                obstore.put(_client(self.bucket), str(self.key), content, mode="create")
        except AlreadyExistsError as error:
            raise FileExistsError(str(self)) from error

    def unlink(self, missing_ok: bool = False) -> None:  # noqa: ARG002 - as pathlib has it
        """Removes the object; to S3 storage it is no error that there is none."""
        with _explained(self):
            obstore.delete(_client(self.bucket), str(self.key))


@cache
def _client(bucket: str) -> S3Store:
    """The service, found and entered by the standard AWS variables of the environment."""
    return S3Store.from_url(bucket)


@contextmanager
def _explained(path: BucketPath) -> Iterator[None]:
    """Turns what the service or the network says into a sentence with the way out.

    Raises:
        UnavailableError: the service cannot be reached, or refuses, or has no such bucket.
    """
    try:
        yield
    except AlreadyExistsError:
        raise
    except FileNotFoundError as error:
        if "NoSuchBucket" in str(error):
            raise UnavailableError(
                "{}: there is no bucket {}; make it, or mend opslag.toml", path, path.bucket
            ) from error
        raise
    except BaseError as error:
        said = str(error).splitlines()[0]
        raise UnavailableError(
            "{} cannot be reached: {}. Look at the network, at AWS_ENDPOINT_URL, and "
            "at AWS_ACCESS_KEY_ID and the rights that go with it",
            path,
            said,
        ) from error
