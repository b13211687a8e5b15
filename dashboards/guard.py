"""What keeps pages of other sites out of a server on this machine, and bounds who connects.

A page that reaches it by a name of its own (DNS rebinding) is refused by its Host header; one that
sends a form or a script, by its Origin and type. Which pages there are is not decided here.
"""

import asyncio
import socket
from typing import Final

import uvicorn
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from uvicorn.protocols.http.h11_impl import H11Protocol

from pipeline.errors import UnavailableError

LOOPBACK: Final = ("127.0.0.1", "localhost", "::1")
MOST_CONNECTIONS: Final = 100
FIRST_REQUEST_S: Final = 10.0
"""A connection on which nothing is asked for so long is closed."""

LARGEST_BODY: Final = 1 << 20
"""Bytes that a request may bring: a method with all its options has a few thousand."""
LONGEST_BODY_S: Final = 10.0

_READING: Final = ("GET", "HEAD", "OPTIONS")


class Guard:
    """An application that answers its own pages only.

    Args:
        app: the application.
        host: the address that it listens on; loopback names are always good.
    """

    def __init__(self, app: ASGIApp, host: str) -> None:
        self._app, self._hosts = app, {*LOOPBACK, host}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Passes a request on, or refuses it with 403."""
        refusal = None if scope["type"] == "lifespan" else self._refusal(scope)
        if refusal is None and scope["type"] == "http" and scope["method"] not in _READING:
            await self._with_body(scope, receive, send)
        elif refusal is None:
            await self._app(scope, receive, send)
        elif scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 1008})
        else:
            await PlainTextResponse(refusal, 403)(scope, receive, send)

    async def _with_body(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Passes a request on when its body is here whole, neither too large nor too slow."""
        try:
            first = await asyncio.wait_for(_whole_body(receive), LONGEST_BODY_S)
        except TimeoutError:
            return await _refuse_body(408, "the request took too long")(scope, receive, send)
        if first is None:
            return await _refuse_body(413, "the request is too large")(scope, receive, send)
        came = [first]

        async def received() -> Message:
            return came.pop() if came else await receive()

        return await self._app(scope, received, send)

    def _refusal(self, scope: Scope) -> str | None:
        """Why a request is not answered; None where it is."""
        sent = {name.decode("latin-1"): value.decode("latin-1") for name, value in scope["headers"]}
        host = sent.get("host", "")
        if _name(host) not in self._hosts:
            return "this server is known under another name"
        if scope["type"] == "http" and scope["method"] in _READING:
            # Whatever is asked there: `%71uery=` is a query too, and any page can have it fetched.
            asks = scope["path"].rstrip("/").endswith("/graphql") and scope["query_string"]
            return "a query is posted" if asks else None
        # No browser leaves it out where it matters; Dagster's own client for scripts does.
        if "origin" in sent and sent["origin"].partition("://")[2] != host:
            return "only its own pages may ask"
        kind = sent.get("content-type", "").partition(";")[0].strip()
        if scope["type"] == "http" and kind != "application/json":
            return "JSON is needed"
        return None


async def _whole_body(receive: Receive) -> Message | None:
    """All parts of a body as one; None where they are more than is allowed."""
    body, more = b"", True
    while more:
        part = await receive()
        if part["type"] != "http.request":
            return part
        body, more = body + part.get("body", b""), part.get("more_body", False)
        if len(body) > LARGEST_BODY:
            return None
    return {"type": "http.request", "body": body, "more_body": False}


def _refuse_body(status: int, why: str) -> PlainTextResponse:
    """A refusal that ends the connection: what is still to come is not waited for."""
    return PlainTextResponse(why, status, headers={"Connection": "close"})


def _name(host: str) -> str:
    """The name in a Host header, without its port."""
    return host[1:].partition("]")[0] if host.startswith("[") else host.partition(":")[0]


class _Impatient(H11Protocol):
    """Closes a connection on which no request comes."""

    def connection_made(self, transport: object) -> None:
        """Starts the clock."""
        super().connection_made(transport)  # type: ignore[arg-type]
        self.loop.call_later(FIRST_REQUEST_S, self._close_when_silent)

    def _close_when_silent(self) -> None:
        if self.cycle is None:
            self.transport.close()


def listen(host: str, port: int) -> socket.socket:
    """A listening socket; port 0 takes any that is free.

    Raises:
        UnavailableError: the address cannot be used.
    """
    listening = socket.socket(
        socket.AF_INET6 if ":" in host else socket.AF_INET, socket.SOCK_STREAM
    )
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


def guarded(app: ASGIApp, host: str) -> uvicorn.Server:
    """A server for an application behind the guard, to be run on a socket of `listen`."""
    return uvicorn.Server(
        uvicorn.Config(
            Guard(app, host),
            http=_Impatient,
            log_level="warning",
            access_log=False,
            limit_concurrency=MOST_CONNECTIONS,
            timeout_keep_alive=5,
        )
    )
