"""The lake: how assets read and write tables, and when a table is made again.

`Lake` is the IO manager: one Parquet file per table. `incremental` is the one rule of freshness:
the footer of a table's file holds a fingerprint of what the table was made from, namely the
contents of the tables that its asset reads, its configuration, the declared columns and the code.
An asset whose fingerprint is unchanged does not run its body. An asset that reads no table looks
outside Dagster (at the archive or at settings), so its body always runs. The hash of a table's
contents is Dagster's data version, so Dagster's page calls the same tables stale.
"""

import logging
import os
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import wraps
from inspect import Signature, signature
from pathlib import Path
from typing import Any, Final

import dagster as dg
import polars as pl
from pydantic import Field

from assets.settings import Settings, read_settings
from pipeline.errors import MissingKnowledgeError
from pipeline.messages import say
from pipeline.method.definition import Method
from pipeline.tables.frames import get_dtypes
from pipeline.tables.schemas import TABLES, conform
from warehouse.store.code import COMPUTING, hash_code
from warehouse.store.lock import hold_write_lock
from warehouse.store.methods import KnownMethods, methods_to_apply
from warehouse.store.store import DamagedFileError, Store, digest_contents, fingerprint
from warehouse.store.unforeseen import format_traceback, is_unforeseen

LOG: Final = logging.getLogger("herijk")
"""Says which assets are made; the command shows it, and Dagster keeps it with the run."""

MADE_FROM: Final = "herijk/made_from"
FAILED: Final = "herijk/failed"
NEW: Final = "herijk/new"
"""Metadata of an output: the fingerprint of what a table was made from, the traceback with which it
could not be made, and whether its body ran."""

Tables = pl.DataFrame | Mapping[str, pl.DataFrame]
"""What the body of an asset returns: its table, or several by name."""

AssetBody = Callable[..., Iterator[dg.MaterializeResult]]


class Folders(dg.ConfigurableResource["Folders"]):
    """The archive that comes in, the data folder that goes out, and the methods to apply."""

    archive: str = Field(description="The archive folder; read only.")
    data: str = Field(description="The data folder; made if it is not there.")
    methods: list[str] = Field(
        default_factory=list,
        description="Methods to apply; the others are compared with the first. Empty: those that "
        "beheer.toml lists, or all that ship.",
    )

    @property
    def archive_root(self) -> Path:
        """The archive, as an absolute path: a worker of Dask may work in another folder."""
        return Path(self.archive).resolve()

    @property
    def store(self) -> Store:
        """The data folder, as an absolute path."""
        return Store(Path(self.data).resolve())

    @property
    def settings(self) -> Settings:
        """What `beheer.toml` says."""
        return read_settings(Path(self.data))

    def get_methods(self) -> list[Method]:
        """Return the methods to apply; the first is what the others are compared with."""
        listed = self.methods or self.settings.methods
        names = methods_to_apply(self.store, listed)
        known = KnownMethods.from_store(self.store)
        return list(map(known.get, names))


class Lake(dg.ConfigurableIOManager):
    """A Parquet file per table, swapped in whole. During a run no other process writes."""

    folders: dg.ResourceDependency[Folders]

    @contextmanager
    def yield_for_execution(self, context: dg.InitResourceContext) -> Iterator["Lake"]:  # noqa: ARG002 - Dagster's signature
        """Hold the lock of the data folder while the steps of this process run.

        Raises:
            MissingKnowledgeError: `herijk serve` works on other folders than the launchpad names.
        """
        served = [os.environ.get(name, "") for name in ("HERIJK_ARCHIVE", "HERIJK_DATA")]
        if os.environ.get("HERIJK_SITE") and [self.folders.archive, self.folders.data] != served:
            raise MissingKnowledgeError("this server works on {} and {} alone", *served)
        with hold_write_lock(Path(self.folders.data), wait=True):
            yield self

    def load_input(self, context: dg.InputContext) -> pl.DataFrame:
        """Read a table. Remove it if it is damaged, so that the next attempt makes it again."""
        try:
            return self.folders.store.read(context.asset_key.to_user_string())
        except DamagedFileError as error:
            error.path.unlink(missing_ok=True)
            raise

    def handle_output(self, context: dg.OutputContext, obj: pl.DataFrame) -> None:
        """Write a table, with the fingerprint that its asset gave as metadata."""
        given = context.output_metadata  # its values are MetadataValues
        made_from = given[MADE_FROM].value if MADE_FROM in given else ""
        failed = given[FAILED].value if FAILED in given else ""
        name = context.asset_key.to_user_string()
        self.folders.store.write(name, obj, str(made_from), str(failed))


def incremental(
    *,
    may_fail: bool = False,
    code: tuple[str, ...] = COMPUTING,
    also: str = "",
    is_whole: Callable[[Store], bool] = lambda _: True,
) -> Callable[[Callable[..., Tables]], AssetBody]:
    """Make the body of an asset run only where something that it is made from has changed.

    Goes under `@dg.asset` or `@dg.multi_asset`. The body takes tables (as frames), resources and a
    configuration, and returns its table, or its tables by name.

    Args:
        may_fail: the other assets can do without the rows of this one. If its body raises an error
            that nobody foresaw, the table is empty and the check `nothing_unforeseen` fails.
        code: packages with which the table is computed, besides the module of the asset.
        also: whatever else the table is made from, as text.
        is_whole: returns whether what the body makes outside the lake is there and undamaged.
    """

    def decorate(compute: Callable[..., Tables]) -> AssetBody:
        @wraps(compute)
        def body(**given: Any) -> Iterator[dg.MaterializeResult]:
            context = dg.AssetExecutionContext.get()
            lake: Lake = context.resources.io_manager
            store = lake.folders.store
            names = sorted(key.to_user_string() for key in context.selected_asset_keys)
            read = sorted(key.to_user_string() for key in context.assets_def.dependency_keys)
            made_from = fingerprint(
                {name: store.contents(name) for name in read},
                {name: str(get_dtypes(TABLES[name])) for name in names if name in TABLES},
                get_config(given),
                also,
                hash_code(*code, compute.__module__),
            )
            is_made = all(store.read_fingerprint(name) == made_from for name in names)
            if read and is_made and is_whole(store):
                yield from confirm_outputs(store, names)
                return
            failure = ""
            began = time.monotonic()
            try:
                frames = _compute_frames(compute, given, names)
            except BaseException as error:  # a panic of a library in Rust is no Exception
                if not may_fail or not is_unforeseen(error):
                    raise
                context.log.exception("Herijk itself failed here: the rows are missing")
                failure = format_traceback(error)
                frames = {name: TABLES[name].create_empty() for name in names}
            if read:  # what looks outside runs every time
                seconds = time.monotonic() - began
                LOG.info(say("{} made in {:.1f} s", context.op_def.name, seconds))
            yield from hand_over_outputs(frames, made_from, failure)

        # Without a return annotation Dagster leaves the file of a result without a value alone.
        parameters = signature(compute)
        body.__signature__ = parameters.replace(return_annotation=Signature.empty)  # type: ignore[attr-defined]
        hints = dict(compute.__annotations__)
        hints.pop("return", None)
        body.__annotations__ = hints
        return body

    return decorate


def get_config(given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the configuration among what the body of an asset is given, without resources."""
    config = {}
    for name, value in given.items():
        if isinstance(value, dg.Config) and not isinstance(value, dg.ConfigurableResource):
            config[name] = value.model_dump()
    return config


def _compute_frames(
    compute: Callable[..., Tables], given: Mapping[str, Any], names: list[str]
) -> dict[str, pl.DataFrame]:
    """Run the body of an asset; check its tables. Remove a damaged file that it meets."""
    try:
        made = compute(**given)
    except DamagedFileError as error:
        error.path.unlink(missing_ok=True)
        raise
    tables = {names[0]: made} if isinstance(made, pl.DataFrame) else made
    frames = {}
    for name in names:
        frames[name] = conform(name, tables[name]) if name in TABLES else tables[name]
    return frames


def hand_over_outputs(
    frames: Mapping[str, pl.DataFrame], made_from: str, failure: str
) -> Iterator[dg.MaterializeResult]:
    """Give Dagster tables to be written, with what their footers say."""
    for name, frame in frames.items():
        metadata: dict[str, int | bool | str] = {
            "dagster/row_count": frame.height,
            NEW: True,
            MADE_FROM: made_from,
        }
        if failure:
            metadata[FAILED] = failure
        version = dg.DataVersion(digest_contents(name, frame))
        yield dg.MaterializeResult(
            asset_key=name, value=frame, data_version=version, metadata=metadata
        )


def confirm_outputs(store: Store, names: Iterable[str]) -> Iterator[dg.MaterializeResult]:
    """Tell Dagster that tables are as they were, without writing them."""
    for name in names:
        metadata = {"dagster/row_count": store.count_rows(name), NEW: False}
        version = dg.DataVersion(str(store.contents(name)))
        yield dg.MaterializeResult(asset_key=name, data_version=version, metadata=metadata)


def make_outs(*names: str) -> dict[str, dg.AssetOut]:
    """Return the outputs of a multi-asset of which a run may ask for some tables."""
    return {name: dg.AssetOut(is_required=False) for name in names}


def describe_table(spec: dg.AssetSpec) -> dg.AssetSpec:
    """Return an asset's spec with the meaning and columns of its table, and its code version."""
    schema = TABLES.get(spec.key.to_user_string())
    version = spec.code_version or hash_code(*COMPUTING, f"assets.{spec.group_name}")
    with_code = spec.replace_attributes(code_version=version)
    if schema is None:
        return with_code
    columns = [
        dg.TableColumn(
            name=name,
            type=str(column.dtype),
            description=column.description,
            constraints=dg.TableColumnConstraints(nullable=column.nullable),
        )
        for name, column in schema.columns().items()
    ]
    description = spec.description if spec.description else schema.__doc__
    return with_code.replace_attributes(description=description).merge_attributes(
        metadata={"dagster/column_schema": dg.TableSchema(columns)}
    )
