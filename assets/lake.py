"""Tables of the lake: read and written for assets, and made again only where something changed.

The one rule of freshness: the footer of a Parquet file holds a fingerprint of what the table was
made from, the contents of the tables that its asset reads and the code. An asset whose fingerprint
is unchanged returns at once. An asset that reads no other looks outside, so it always runs. A hash
of the contents is Dagster's data version, so Dagster's page calls the same tables stale.
"""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial, wraps
from inspect import Signature, signature
from pathlib import Path
from typing import Any, Final

import dagster as dg
import polars as pl
from pydantic import Field

from assets.settings import Settings, read_settings
from pipeline.method.definition import Method
from pipeline.tables.schemas import TABLES, conform
from warehouse.store.code import code_hash
from warehouse.store.lock import only_writer
from warehouse.store.methods import KnownMethods, methods_to_apply
from warehouse.store.store import DamagedFileError, Store, contents_of, fingerprint
from warehouse.store.unforeseen import is_unforeseen, traced

CODE: Final = ("pipeline", "warehouse.archive", "warehouse.derive", "warehouse.intake")
"""What tables are computed with, beside the file of the asset: a changed byte makes them again."""

FAILED: Final = "failed"
"""In a footer: the traceback with which a table could not be made; its rows are missing."""

Made = pl.DataFrame | Mapping[str, pl.DataFrame]


class Folders(dg.ConfigurableResource):  # type: ignore[type-arg]
    """The archive that comes in, and the data folder that goes out."""

    archive: str
    data: str
    methods: list[str] = Field(default_factory=list)

    @property
    def archive_root(self) -> Path:
        """The archive."""
        return Path(self.archive)

    @property
    def store(self) -> Store:
        """The data folder."""
        return Store(Path(self.data))

    @property
    def settings(self) -> Settings:
        """What `beheer.toml` says."""
        return read_settings(Path(self.data))

    def chosen_methods(self) -> list[Method]:
        """The methods to apply; the first is what the others are compared with."""
        asked = self.methods or self.settings.methods
        return [KnownMethods.of(self.store).get(n) for n in methods_to_apply(self.store, asked)]


class Lake(dg.ConfigurableIOManager):
    """A Parquet file per table, written beside and renamed; while a run lasts no other writes."""

    folders: dg.ResourceDependency[Folders]

    @contextmanager
    def yield_for_execution(self, context: dg.InitResourceContext) -> Iterator["Lake"]:  # noqa: ARG002 - Dagster's
        """The lake, with the right to write in it."""
        with only_writer(Path(self.folders.data), wait=True):
            yield self

    def load_input(self, context: dg.InputContext) -> pl.DataFrame:
        """A table; one that is damaged is removed, so that the next run makes it again."""
        try:
            return self.folders.store.read(context.asset_key.to_user_string())
        except DamagedFileError as error:
            error.path.unlink(missing_ok=True)
            raise

    def handle_output(self, context: dg.OutputContext, obj: pl.DataFrame) -> None:
        """Writes a table with the fingerprint that its asset gave."""
        told = context.output_metadata
        about = {key: told[key].value for key in ("made_from", FAILED) if key in told}
        self.folders.store.write(context.asset_key.to_user_string(), obj, **about)


def kept(
    compute: Callable[..., Made] | None = None,
    *,
    may_fail: bool = False,
    code: tuple[str, ...] = CODE,
    is_whole: Callable[[Store], bool] = lambda _: True,
) -> Any:
    """Goes under `@dg.asset`: the body runs only where something that it reads has changed.

    Args:
        compute: makes the table, or several by name, of those that it reads.
        may_fail: the rest can be made without it: where our code fails, it is empty.
        code: packages with which it is computed.
        is_whole: whether what is made beside the lake is still there and undamaged.
    """
    if compute is None:
        return partial(kept, may_fail=may_fail, code=code, is_whole=is_whole)

    @wraps(compute)
    def body(**given: Any) -> Iterator[dg.MaterializeResult]:
        context = dg.AssetExecutionContext.get()
        lake: Lake = context.resources.io_manager
        store = lake.folders.store
        read = sorted(
            key.to_user_string() for key in context.assets_def.keys_by_input_name.values()
        )
        inputs = {name: store.contents(name) for name in read}
        made_from = fingerprint(code_hash(*code, compute.__module__), inputs)
        names = [key.to_user_string() for key in context.selected_asset_keys]
        if read and all(store.made_from(n) == made_from for n in names) and is_whole(store):
            yield from (_confirmed(store, name) for name in names)
            return
        failed: dict[str, Any] = {}
        try:
            made = compute(**given)
            if isinstance(made, pl.DataFrame):
                made = {names[0]: made}
            frames = {n: conform(n, made[n]) if n in TABLES else made[n] for n in names}
        except DamagedFileError as error:
            error.path.unlink(missing_ok=True)
            raise
        except BaseException as error:  # a panic of a library in Rust is no Exception
            if not may_fail or not is_unforeseen(error):
                raise
            context.log.exception("an unforeseen error: these rows are missing")
            failed = {FAILED: traced(error)}
            frames = {name: TABLES[name].create_empty() for name in names}
        for name, frame in frames.items():
            yield dg.MaterializeResult(
                asset_key=name,
                value=frame,
                data_version=dg.DataVersion(contents_of(name, frame)),
                metadata={
                    "dagster/row_count": frame.height, "new": True, "made_from": made_from, **failed
                },
            )  # fmt: skip

    # No return type: so Dagster leaves the file alone where there is a result without a value.
    body.__signature__ = signature(compute).replace(return_annotation=Signature.empty)  # type: ignore[attr-defined]
    body.__annotations__ = {k: v for k, v in compute.__annotations__.items() if k != "return"}
    return body


detector = kept(may_fail=True)
"""Of a table without which the rest can be made."""


def _confirmed(store: Store, name: str) -> dg.MaterializeResult:
    rows, contents = store.count_rows(name), store.contents(name)
    about = {"dagster/row_count": rows, "new": False}
    return dg.MaterializeResult(
        asset_key=name, data_version=dg.DataVersion(str(contents)), metadata=about
    )


def outs(*names: str) -> dict[str, dg.AssetOut]:
    """The tables of a multi-asset, of which a run may ask for some."""
    return {name: dg.AssetOut(is_required=False) for name in names}


def declared(spec: dg.AssetSpec) -> dg.AssetSpec:
    """An asset with the meaning and the columns of its table, and the version of our code."""
    schema = TABLES.get(spec.key.to_user_string())
    room = f"assets.{spec.group_name}"
    version = spec.replace_attributes(code_version=code_hash(*CODE, room))
    if schema is None:
        return version
    columns = [
        dg.TableColumn(
            name,
            str(column.dtype),
            column.description,
            dg.TableColumnConstraints(nullable=column.nullable),
        )
        for name, column in schema.columns().items()
    ]
    told = spec.description if spec.description else schema.__doc__
    return version.replace_attributes(description=told).merge_attributes(
        metadata={"dagster/column_schema": dg.TableSchema(columns)}
    )
