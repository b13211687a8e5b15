"""What keeps pages of other sites out of a server on this machine.

A page that reaches it by a name of its own (DNS rebinding) is refused by its Host header, one that
sends a form or a script by its Origin and type. Which pages there are is not decided here.
"""

import socket
from typing import Final

import uvicorn
from starlette.middleware.trustedhost import TrustedHostMiddleware
from starlette.requests import Request
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Receive, Scope, Send

from pipeline.errors import UnavailableError

LOOPBACK: Final = ("127.0.0.1", "localhost", "::1")
MAX_CONNECTIONS: Final = 100

MAX_BODY_BYTES: Final = 1 << 20
"""Largest request: a method with all its options has a few thousand bytes."""

READING: Final = ("GET", "HEAD", "OPTIONS")


class SameOrigin:
    """An application that takes what is sent from its own pages only, as JSON.

    Args:
        app: the application.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, or refuse it."""
        if scope["type"] == "http" and scope["method"] not in READING:
            request = Request(scope)
            own = f"{request.url.scheme}://{request.headers.get('host', '')}"
            kind = request.headers.get("content-type", "").partition(";")[0]
            length = request.headers.get("content-length", "")
            is_small = length.isdigit() and int(length) <= MAX_BODY_BYTES
            if request.headers.get("origin", own) != own or kind != "application/json":
                refusal = PlainTextResponse("only its own pages may ask", 403)
                return await refusal(scope, receive, send)
            if not is_small:
                refusal = PlainTextResponse("the request is too large", 413)
                return await refusal(scope, receive, send)
        return await self._app(scope, receive, send)


def guard(app: ASGIApp, host: str) -> ASGIApp:
    """Return an application that answers under its own names, and its own pages only.

    Args:
        app: the application.
        host: the address that it listens on; loopback names are always good.
    """
    names = [*LOOPBACK, host]
    in_brackets = [f"[{name}]" for name in names if ":" in name]
    return TrustedHostMiddleware(SameOrigin(app), [*names, *in_brackets], www_redirect=False)


def listen(host: str, port: int) -> socket.socket:
    """Return a listening socket; port 0 takes any that is free.

    Raises:
        UnavailableError: the address cannot be used.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    listening = socket.socket(family, socket.SOCK_STREAM)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((host, port))
        listening.listen()
    except OSError as error:
        listening.close()
        raise UnavailableError(
            "{}:{} cannot be used: {}. Name another with --port", host, port, error.strerror
        ) from error
    return listening


def make_server(app: ASGIApp, host: str) -> uvicorn.Server:
    """Return a server for an application behind the guard, to be run on a socket of `listen`."""
    return uvicorn.Server(
        uvicorn.Config(
            guard(app, host),
            log_level="warning",
            access_log=False,
            limit_concurrency=MAX_CONNECTIONS,
            timeout_keep_alive=5,
        )
    )
