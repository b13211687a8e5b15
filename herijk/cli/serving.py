"""`herijk serve`: Dagster's web page and daemon, and the site, until somebody stops it.

Dagster's web server runs as it is, listens on this machine only and has no password. The site is
plain files behind the guard, and may listen elsewhere. Dagster's two are processes of their own;
they end with this one, however it ends.
"""

import ctypes
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from starlette.applications import Starlette
from starlette.responses import RedirectResponse
from starlette.routing import Mount, Route
from starlette.staticfiles import StaticFiles

from dashboards.guard import LOOPBACK, listen, make_server
from pipeline.errors import UnavailableError
from pipeline.messages import LANGUAGE, say

SHOWN: Final = ("site", "report")
"""What of the data folder the site's address shows."""

EXPOSED: Final = say(
    "WARNING: everybody who can reach {host} can read the site: there is no password. Put a proxy "
    "with one in front (docs/operations.md), or serve on 127.0.0.1"
)

PATIENCE_S: Final = 20.0
_DIE_WITH_PARENT: Final = 1
"""PR_SET_PDEATHSIG of Linux."""


@dataclass(frozen=True)
class Served:
    """What is served and where: Dagster at `port` of this machine, the site at the next port.

    Attributes:
        host: address on which the site is served.
        may_start: whether Dagster's page may start rebuilds and switch schedules.
    """

    archive: Path
    data: Path
    host: str
    port: int
    may_start: bool = False

    @property
    def site(self) -> str:
        """Where the site is."""
        return f"http://{self.host}:{self.port + 1}/site"


def serve_until_stopped(what: Served, home: Path, tell: Callable[[str], None]) -> None:
    """Serve until SIGINT or SIGTERM.

    Args:
        what: folders and address.
        home: Dagster's folder, with its settings.
        tell: is told the addresses.

    Raises:
        UnavailableError: an address is taken, or one of Dagster's processes ended by itself.
    """
    stop = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: stop.set())
    if what.host not in LOOPBACK:
        tell(say(EXPOSED, host=what.host).write_in(LANGUAGE.get()))
    listen(LOOPBACK[0], what.port).close()  # told now, not by a child
    with _site(what), _dagster(what, home) as children:
        tell(f"Site: {what.site}/index.html")
        tell(f"Dagster: http://{LOOPBACK[0]}:{what.port}/")
        while not stop.wait(0.5):
            for name, child in children.items():
                if child.poll() is not None:
                    raise UnavailableError(
                        "{} ended by itself with status {}; what it said is above",
                        name,
                        child.returncode,
                    )


# The site


def site_app(data: Path) -> Starlette:
    """Return the site and the reports of a data folder, and nothing else of it."""
    shown = [
        Mount(f"/{name}", StaticFiles(directory=data / name, check_dir=False)) for name in SHOWN
    ]
    first = Route("/", lambda _: RedirectResponse("/site/index.html"))
    return Starlette(routes=[first, *shown])


@contextmanager
def _site(what: Served) -> Iterator[None]:
    with listen(what.host, what.port + 1) as listening:
        server = make_server(site_app(what.data), what.host)
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listening]}, daemon=True)
        thread.start()
        yield
        server.should_exit = True
        thread.join(PATIENCE_S)


# Dagster


@contextmanager
def _dagster(what: Served, home: Path) -> Iterator[dict[str, subprocess.Popen[bytes]]]:
    """Start web page and daemon; ends them, and what they started, when left."""
    environment = os.environ | {
        "DAGSTER_HOME": str(home),
        "HERIJK_ARCHIVE": str(what.archive.resolve()),
        "HERIJK_DATA": str(what.data.resolve()),
        "HERIJK_SITE": what.site,
        "DAGSTER_DISABLE_TELEMETRY": "1",
    }
    programs = Path(sys.executable).parent
    address = ["-h", LOOPBACK[0], "-p", str(what.port)]
    read_only = [] if what.may_start else ["--read-only"]
    location = ["-m", "assets.definitions"]
    commands = {
        "Dagster's page": [
            str(programs / "dagster-webserver"), *location, *address, *read_only,
        ],
        "Dagster's daemon": [str(programs / "dagster-daemon"), "run", *location],
    }  # fmt: skip
    children: dict[str, subprocess.Popen[bytes]] = {}
    try:
        for name, command in commands.items():
            children[name] = subprocess.Popen(  # noqa: S603 - our own arguments
                command,
                cwd=home,  # the user's folder may have an `assets` of its own
                env=environment,
                start_new_session=True,
                preexec_fn=_die_with_parent,  # noqa: PLW1509 - it only asks the system
            )
        yield children
    finally:
        _end(children.values())


def _die_with_parent() -> None:
    """Asks the system to end this process when its parent is gone (Linux)."""
    library = ctypes.CDLL(None)
    if hasattr(library, "prctl"):
        library.prctl(_DIE_WITH_PARENT, signal.SIGTERM)


def _end(children: Iterable[subprocess.Popen[bytes]]) -> None:
    """Asks the processes to end; after a while, makes them."""
    running = list(children)
    for child in running:
        if child.poll() is None:
            child.send_signal(signal.SIGINT)
    last = time.monotonic() + PATIENCE_S
    for child in running:
        with suppress(subprocess.TimeoutExpired):
            child.wait(max(0.1, last - time.monotonic()))
        with suppress(ProcessLookupError):
            os.killpg(child.pid, signal.SIGKILL)
        child.wait()
