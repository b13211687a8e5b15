"""What assets are given: the folders, and the methods to apply.

Resources load nothing and compute nothing; they hand plain objects to `warehouse` and `pipeline`.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import dagster as dg
from pydantic import Field

from herijk.assets.settings import Settings
from herijk.pipeline.method.definition import Method
from herijk.warehouse.store.lock import only_writer
from herijk.warehouse.store.methods import KnownMethods, methods_to_apply
from herijk.warehouse.store.store import Store

QUIET_LOG = {"loggers": {"console": {"config": {"log_level": "CRITICAL"}}}}
"""Nothing on the terminal: what Dagster says is in its records."""


class Setup(dg.ConfigurableResource["Setup"]):
    """The archive that comes in, the data folder that goes out, and the methods to apply.

    While a step runs, nobody else writes in the data folder: another waits for its turn.
    """

    archive: str
    data: str
    methods: list[str] = Field(default_factory=list)
    set_aside_share: float = Settings().set_aside_share
    factor_jump: float = Settings().factor_jump

    @classmethod
    def of(cls, archive: Path, data: Path, methods: Sequence[str], settings: Settings) -> "Setup":
        """The setup of a data folder with its settings."""
        return cls(
            archive=str(archive),
            data=str(data),
            methods=list(methods),
            set_aside_share=settings.set_aside_share,
            factor_jump=settings.factor_jump,
        )

    @contextmanager
    def yield_for_execution(self, context: dg.InitResourceContext) -> Iterator["Setup"]:  # noqa: ARG002 - Dagster's signature
        """The folders, with the right to write."""
        with only_writer(self.store.root, wait=True):
            yield self

    @property
    def archive_root(self) -> Path:
        """The archive."""
        return Path(self.archive)

    @property
    def store(self) -> Store:
        """The data folder."""
        return Store(Path(self.data))

    @property
    def chosen_methods(self) -> list[Method]:
        """The methods to apply; the first is what the others are compared with."""
        return [self.known_methods.get(n) for n in methods_to_apply(self.store, self.methods)]

    @property
    def known_methods(self) -> KnownMethods:
        """The methods that ship, and the data folder's own."""
        return KnownMethods.of(self.store)


def fixed(setup: Setup) -> dg.ResourceDefinition:
    """The setup as a resource whose folders no run can name otherwise, also from Dagster's page."""

    @dg.resource(config_schema={})
    def resource(context: dg.InitResourceContext) -> Iterator[Setup]:
        with setup.yield_for_execution(context):
            yield setup

    return resource
