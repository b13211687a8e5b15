"""Dagster's page in a process of its own, asked as a browser asks it."""

import json
import os
import signal
import socket
import subprocess
import sys
import time
import urllib.request
from contextlib import contextmanager, suppress
from pathlib import Path

ROOT = Path(__file__).parents[2]
PATIENCE_S = 600


@contextmanager
def page(*command, home=None, **environment):
    """Starts a command with `--port`; gives a function that asks the page that it serves."""
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        port = str(taken.getsockname()[1])
    process = subprocess.Popen(
        [sys.executable, "-m", *command, "--port", port],
        cwd=ROOT,
        env=os.environ
        | {"LC_ALL": "C", **environment, **({"DAGSTER_HOME": str(home)} if home else {})},
    )

    def ask(query, **variables):
        request = urllib.request.Request(
            f"http://127.0.0.1:{port}/graphql",
            json.dumps({"query": query, "variables": variables}).encode(),
            {"Content-Type": "application/json"},
        )
        with urllib.request.urlopen(request) as answer:  # noqa: S310 - on this machine
            return json.load(answer)["data"]

    try:
        wait_for(lambda: ask("{version}"))
        yield ask
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(PATIENCE_S)


def wait_for(look):
    """Looks until something is so; the page takes a while to answer at all."""
    for _ in range(PATIENCE_S):
        with suppress(OSError):
            if look():
                return
        time.sleep(1)
    raise TimeoutError
