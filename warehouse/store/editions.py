"""The folder of an edition: what it consists of, made whole or not at all, and read again.

Everything is written beside, synced and renamed. A second edition of the same name is refused. What
goes into the files, and whether they are still what they were, belongs to `warehouse.editions`.

Four kinds of hash: of a file, of what something was made from (the inputs of a tow, a method, the
code), the seal over the manifest with the hashes of all files, and the verification code of a line.
"""

import datetime as dt
import hashlib
import json
import re
import shutil
import stat
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

import polars as pl
from filelock import FileLock
from pydantic import BaseModel, ConfigDict, ValidationError

from pipeline.errors import BrokenPromiseError, MissingKnowledgeError
from pipeline.messages import say
from pipeline.method.definition import Method
from pipeline.method.reading import parse_method
from pipeline.register.register import add_empty_thwart
from warehouse.store.code import code_version
from warehouse.store.files import TEMPORARY_PREFIX, write_folder_beside
from warehouse.store.store import Store

Kind = Literal["recomputed", "as_printed"]

MANIFEST: Final = "manifest.json"
OLDER_MANIFEST: Final = "edition.json"
"""What the manifest was called up to version 1.0.0."""

PARQUET: Final = ".parquet"
METHOD: Final = "method.toml"
DECISIONS: Final = "decisions.json"
CSV: Final = "register.csv"
XLSX: Final = "register.xlsx"
NOTICE: Final = "bericht.md"
NOTICE_EN: Final = "notice.md"
CHANGES: Final = "register_changes"
OUTGROWN: Final = ("register", "curves")
"""Tables that got more columns since the first editions."""

_NAME: Final = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,59}")
_LOCK: Final = f"{TEMPORARY_PREFIX}lock"


class Manifest(BaseModel):
    """What an edition is, by whose decision, and the hashes of all its files.

    Manifests of before say more (digests of tables, of all inputs), which their seals cover.

    Attributes:
        kind: `recomputed` from the archive, or `as_printed`: a register as the federation had it.
        method, method_hash: None for a register as printed.
        carried_from: the printed edition of which lines were taken over, if any.
        previous: the edition that it is compared with.
        texts_version: in which words its texts are; None for the first.
        printed_in: season in which a register was printed; None where it was not noted.
        sources: SHA-256 of the lists, or of the printed register, by path in the archive. The
            samples of a tow are in the table `tows`.
        number, after_seal: place in the chain of editions, from 1, and seal of the one published
            before; a number of None where there was no chain yet.
        files: SHA-256 of every other file.
        seal: see `expected_seal`.
    """

    model_config = ConfigDict(frozen=True, extra="allow")

    edition: str
    kind: Kind
    method: str | None
    method_hash: str | None
    code_version: str
    valid_from: dt.date
    published_on: dt.date
    decision: str
    simulated: bool
    carried_from: str | None
    previous: str | None
    texts_version: str | None = None
    printed_in: int | None = None
    sources: dict[str, str] = {}
    number: int | None = None
    after_seal: str | None = None
    files: dict[str, str] = {}
    seal: str = ""

    @property
    def expected_seal(self) -> str:
        """SHA-256 of all that it says but the seal."""
        content = self.model_dump(mode="json", exclude={"seal"}, exclude_unset=True)
        if content.get("texts_version") is None:  # never sealed where it was not noted
            content.pop("texts_version", None)
        return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()

    def sealed(self) -> "Manifest":
        """Return the manifest with its seal."""
        return self.model_copy(update={"seal": self.expected_seal})


@dataclass(frozen=True)
class Edition:
    """An edition with its tables, read or about to be written.

    Attributes:
        manifest: what it is.
        tables: by name: `register` always, `register_changes` when there was an edition before it,
            and when it was recomputed its tows and runs, and what the method made of them.
        method: the method, with every option of every season; None when as printed.
    """

    manifest: Manifest
    tables: dict[str, pl.DataFrame]
    method: Method | None

    @property
    def register(self) -> pl.DataFrame:
        """The lines: the columns of the table `register`, and what else an edition says of them."""
        return self.tables["register"]


def list_edition_names(store: Store) -> list[str]:
    """Return the published editions, sorted, without any that is still being written.

    An empty folder is none.
    """
    folders = [path for path in store.editions.glob("[!.]*") if path.is_dir()]
    return sorted(path.name for path in folders if any(path.iterdir()))


def list_stray_names(store: Store) -> list[str]:
    """Return names among the editions that are none: files, and empty folders."""
    names = {path.name for path in store.editions.glob("[!.]*")}
    return sorted(names - set(list_edition_names(store)))


def is_plain_file(path: Path) -> bool:
    """Return whether a path is a file of its own: no folder, pipe or link, also no hard link."""
    try:
        status = path.lstat()
    except OSError:
        return False
    return stat.S_ISREG(status.st_mode) and status.st_nlink == 1


def is_edition_name(name: str) -> bool:
    """Return whether an edition can have a name: letters, digits, `.`, `_` and `-` of ASCII."""
    return _NAME.fullmatch(name) is not None and not name.startswith("concept-")


def get_edition_path(store: Store, edition: str) -> Path:
    """Return the folder of a published edition.

    Raises:
        MissingKnowledgeError: there is none of that name.
    """
    if edition not in list_edition_names(store):
        known = ", ".join(list_edition_names(store)) or say("none yet")
        raise MissingKnowledgeError("there is no edition {}; published: {}", edition, known)
    return store.editions / edition


def check_new_name(store: Store, edition: str) -> None:
    """Refuse a name that no new edition can have.

    Raises:
        BrokenPromiseError: the name is taken.
        MissingKnowledgeError: it cannot be the name of a folder everywhere, or is a draft's.
    """
    if not is_edition_name(edition):
        raise MissingKnowledgeError(
            "{!r} cannot name an edition: use letters, digits, '.', '_' and '-', "
            "begin with a letter or digit, and not with 'concept-', which marks "
            "drafts",
            edition,
        )
    if (store.editions / edition).is_dir():
        raise BrokenPromiseError(
            "edition {} was already published and is never changed; publish under "
            "another name, for example with a higher number",
            edition,
        )


def find_manifest(path: Path) -> Path:
    """Return the manifest of an edition, under its name of now or of before."""
    older = path / OLDER_MANIFEST
    return older if older.exists() else path / MANIFEST


def read_manifest(path: Path) -> Manifest:
    """Return the description of an edition, from its manifest.

    Raises:
        BrokenPromiseError: its manifest is missing or cannot be read.
    """
    file = find_manifest(path)
    try:
        if not file.is_file():  # to read a pipe would wait for ever
            raise FileNotFoundError(file.name)
        return Manifest.model_validate_json(file.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, ValidationError) as error:
        reason = str(error).splitlines()[0]
        raise BrokenPromiseError(
            "edition {}: {} is missing or damaged ({}); put the folder back from a copy",
            path.name,
            file.name,
            reason,
        ) from error


def has_doubled_key(content: bytes) -> bool:
    """Return whether JSON says something twice: the seal covers what is said last, and alone."""
    is_doubled = False

    def count_keys(pairs: list[tuple[str, object]]) -> dict[str, object]:
        nonlocal is_doubled
        is_doubled |= len(dict(pairs)) < len(pairs)
        return dict(pairs)

    json.loads(content, object_pairs_hook=count_keys)
    return is_doubled


def read_manifests(store: Store) -> tuple[dict[str, Manifest], dict[str, BrokenPromiseError]]:
    """Return the manifests of all editions by folder name, and the errors of damaged ones."""
    manifests, errors = {}, {}
    for name in list_edition_names(store):
        try:
            manifests[name] = read_manifest(store.editions / name)
        except BrokenPromiseError as error:
            errors[name] = error
    return manifests, errors


def find_chain_head(store: Store) -> Manifest | None:
    """Return the edition published last; None before the first that is chained."""
    chained = [m for m in read_manifests(store)[0].values() if m.number is not None]
    return max(chained, key=lambda manifest: manifest.number or 0, default=None)


def read_edition(store: Store, edition: str) -> Edition:
    """Read an edition with its tables; what was not yet said when it was published is empty.

    Raises:
        MissingKnowledgeError: there is none of that name, or its method is not understood by the
            code of today.
        BrokenPromiseError: a file is missing or damaged.
    """
    path = get_edition_path(store, edition)
    manifest = read_manifest(path)
    names = [name.removesuffix(PARQUET) for name in manifest.files if name.endswith(PARQUET)]
    tables = {name: read_table(path, name) for name in names}
    if manifest.code_version != code_version():  # no new column without code that computes it
        for name in OUTGROWN:
            if name in tables:
                tables[name] = _add_later_columns(name, tables[name])
    method = None
    if manifest.kind == "recomputed":
        text = (path / METHOD).read_text(encoding="utf-8")
        method = parse_method(text, f"{edition}/{METHOD}", published=True)
    return Edition(manifest, tables, method)


def read_edition_method(store: Store, edition: str) -> Method:
    """Return the method that an edition was made with, as it was then.

    Raises:
        MissingKnowledgeError: the edition was taken over from print and has no method.
    """
    method = read_edition(store, edition).method
    if method is None:
        raise MissingKnowledgeError(
            "edition {} was taken over from print and has no method; compare it with "
            "another edition: herijk compare {} EDITION",
            edition,
            edition,
        )
    return method


def read_table(path: Path, name: str) -> pl.DataFrame:
    """Read a table of an edition as it was written; its lines name the thwart that is left free.

    Raises:
        BrokenPromiseError: the file is missing or damaged.
    """
    try:
        frame = pl.read_parquet((path / f"{name}{PARQUET}").read_bytes())
    except (OSError, pl.exceptions.PolarsError) as error:
        raise BrokenPromiseError(
            "edition {}: {}.parquet is missing or damaged; put the folder back from a copy",
            path.name,
            name,
        ) from error
    return add_empty_thwart(frame) if name in ("register", CHANGES) else frame


def _add_later_columns(name: str, frame: pl.DataFrame) -> pl.DataFrame:
    """Add the columns that a table got since an edition was made, empty."""
    from pipeline.tables.schemas import TABLES  # noqa: PLC0415 - for older editions alone

    missing = []
    for column, declared in TABLES[name].columns().items():
        if declared.nullable and column not in frame.columns:
            missing.append(pl.lit(None, declared.dtype).alias(column))
    return frame.with_columns(missing)


def write_folder(store: Store, edition: str, contents: Callable[[], Mapping[str, bytes]]) -> Path:
    """Make an edition of files, by name.

    They are asked for where no other publication is at work, since they say which came before.

    After an error, a full disk or a kill there is no edition of that name. What a killed
    publication left is cleared away by the next one.

    Raises:
        BrokenPromiseError: the name is taken, or the folder could not be written.
    """
    target = store.editions / edition
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with _one_at_a_time(target.parent):
            check_new_name(store, edition)
            with write_folder_beside(target) as beside:
                for name, content in contents().items():
                    (beside / name).write_bytes(content)
    except OSError as error:
        raise BrokenPromiseError(
            "edition {} could not be written: {}. Nothing was published; make room "
            "or mend the folder, and publish again",
            edition,
            error.strerror or error,
        ) from error
    return target


@contextmanager
def _one_at_a_time(root: Path) -> Iterator[None]:
    """Keep other publications out, so that anything half-written was left by a dead one."""
    with FileLock(root / _LOCK):
        for left in root.glob(f"{TEMPORARY_PREFIX}*"):
            if left.is_dir():
                shutil.rmtree(left)
        yield
