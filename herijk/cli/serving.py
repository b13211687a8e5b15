"""`herijk serve`: Dagster's web page and daemon, and the site, until somebody stops it.

All three listen on the given address only, this machine unless told otherwise. Dagster's two are
processes of their own; they end with this one, however it ends.
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
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Final

from herijk.pipeline.errors import UnavailableError

SHOWN: Final = ("/site/", "/report/")
"""What of the data folder the site's address shows."""

PATIENCE_S: Final = 20.0
_DIE_WITH_PARENT: Final = 1
"""PR_SET_PDEATHSIG of Linux."""


@dataclass(frozen=True)
class Served:
    """What is served and where: Dagster at `port`, the site at the next."""

    archive: Path
    data: Path
    host: str
    port: int


def serve_until_stopped(what: Served, home: Path, tell: Callable[[str], None]) -> None:
    """Serves until SIGINT or SIGTERM.

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
    with _site(what), _dagster(what, home) as children:
        tell(f"Site: http://{what.host}:{what.port + 1}/site/index.html")
        tell(f"Dagster: http://{what.host}:{what.port}/")
        while not stop.wait(0.5):
            for name, child in children.items():
                if child.poll() is not None:
                    raise UnavailableError(
                        f"{name} ended by itself with status {child.returncode}; what it said "
                        "stands above. Is its port taken? Name another with --port"
                    )


# The site


class _Handler(SimpleHTTPRequestHandler):
    """Shows the site and the reports, and nothing else of the data folder."""

    def send_head(self):
        """Sends what is asked for, where that may be seen."""
        if self.path == "/":
            self.send_response(302)
            self.send_header("Location", "/site/index.html")
            self.end_headers()
            return None
        folder = Path(self.directory).resolve()
        found = Path(self.translate_path(self.path)).resolve()
        allowed = [folder / name.strip("/") for name in SHOWN]
        if not found.is_file() or not any(found.is_relative_to(a) for a in allowed):
            self.send_error(404)
            return None
        return super().send_head()

    def log_message(self, *_: object) -> None:
        """Says nothing: every page would be a line."""


@contextmanager
def _site(what: Served) -> Iterator[None]:
    handler = partial(_Handler, directory=str(what.data))
    try:
        server = ThreadingHTTPServer((what.host, what.port + 1), handler)
    except OSError as error:
        raise UnavailableError(
            f"{what.host}:{what.port + 1} cannot be used: {error.strerror}. Name another with "
            "--port"
        ) from error
    with server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield
        server.shutdown()


# Dagster


@contextmanager
def _dagster(what: Served, home: Path) -> Iterator[dict[str, subprocess.Popen[bytes]]]:
    """Starts web page and daemon; ends them, and what they started, when left."""
    environment = os.environ | {
        "DAGSTER_HOME": str(home),
        "HERIJK_ARCHIVE": str(what.archive.resolve()),
        "HERIJK_DATA": str(what.data.resolve()),
        "DAGSTER_DISABLE_TELEMETRY": "1",
    }
    location = ["-m", "herijk.assets.definitions"]
    commands = {
        "dagster-webserver": [
            "dagster_webserver",
            "-h",
            what.host,
            "-p",
            str(what.port),
            *location,
        ],
        "dagster-daemon": ["dagster._daemon", "run", *location],
    }
    children: dict[str, subprocess.Popen[bytes]] = {}
    try:
        for name, (module, *arguments) in commands.items():
            children[name] = subprocess.Popen(  # noqa: S603 - our own arguments
                [sys.executable, "-m", module, *arguments],
                env=environment,
                start_new_session=True,
                preexec_fn=_die_with_parent,  # noqa: PLW1509 - no threads share its locks
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
    held = list(children)
    for child in held:
        if child.poll() is None:
            child.send_signal(signal.SIGINT)
    last = time.monotonic() + PATIENCE_S
    for child in held:
        with suppress(subprocess.TimeoutExpired):
            child.wait(max(0.1, last - time.monotonic()))
        with suppress(ProcessLookupError):
            os.killpg(child.pid, signal.SIGKILL)
        child.wait()
