"""Dagster's page behind the guard; a process of its own, started by `herijk serve`.

    python -m assets.webserver HOST PORT read-only|may-start

To read only, unless who serves says otherwise: what starts rebuilds are the schedules, the sensor
and the command.
"""

import sys
from typing import Any
from unittest import mock

from dagster_webserver.cli import create_dagster_webserver_cli
from starlette.types import ASGIApp

from dashboards.guard import guarded, listen

READ_ONLY, MAY_START = "read-only", "may-start"


def main(host: str, port: str, rights: str) -> None:
    """Serves until the process is ended."""

    def behind_the_guard(app: ASGIApp, **_: Any) -> None:
        with listen(host, int(port)) as listening:
            guarded(app, host).run(sockets=[listening])

    command = create_dagster_webserver_cli()  # type: ignore[no-untyped-call]
    arguments = ["-m", "assets.definitions", "-h", host, "-p", port]
    # It hands its application to Uvicorn: the only place where a guard can be put before it.
    with mock.patch("uvicorn.run", behind_the_guard):
        command.main([*arguments, *(["--read-only"] if rights == READ_ONLY else [])])


if __name__ == "__main__":
    main(*sys.argv[1:])
