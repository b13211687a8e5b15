"""An S3 server as a process of its own: prints its address, and ends when its input does."""

import logging
import sys

from moto.server import ThreadedMotoServer


def main() -> None:
    """Serves until nobody is left who could ask."""
    logging.getLogger("werkzeug").setLevel(logging.ERROR)
    server = ThreadedMotoServer("127.0.0.1", 0, verbose=False)
    server.start()
    host, port = server.get_host_and_port()
    sys.stdout.write(f"http://{host}:{port}\n")
    sys.stdout.flush()
    sys.stdin.read()


if __name__ == "__main__":
    main()
