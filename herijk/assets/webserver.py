"""Dagster's page behind the guard; a process of its own, started by `herijk serve`.

    python -m herijk.assets.webserver HOST PORT read-only|may-start

To read only, unless who serves says otherwise: what starts rebuilds are the schedules, the sensor
and the command.
"""

import sys
from importlib.metadata import version

import dagster as dg
from dagster._core.nux import set_nux_seen
from dagster._core.workspace.context import WorkspaceProcessContext
from dagster._core.workspace.load_target import ModuleTarget
from dagster_webserver.app import create_app_from_workspace_process_context

from herijk.dashboards.guard import guarded, listen

READ_ONLY, MAY_START = "read-only", "may-start"
DEFINITIONS = ModuleTarget("herijk.assets.definitions", None, None, None)


def main(host: str, port: str, rights: str) -> None:
    """Serves until the process is ended."""
    # Without the form that asks for an address to send news to.
    set_nux_seen()  # type: ignore[no-untyped-call]
    with (
        listen(host, int(port)) as listening,
        dg.DagsterInstance.get() as instance,
        WorkspaceProcessContext(
            instance,
            DEFINITIONS,
            version=version("dagster-webserver"),
            read_only=rights == READ_ONLY,
        ) as context,
    ):
        app = create_app_from_workspace_process_context(context)
        guarded(app, host).run(sockets=[listening])


if __name__ == "__main__":
    main(*sys.argv[1:])
