"""Pages of other sites can neither read nor ask."""

import asyncio

import pytest
from starlette.responses import PlainTextResponse

from herijk.dashboards.guard import Guard

OWN = {"host": "127.0.0.1:3000", "origin": "http://127.0.0.1:3000"}
JSON = {"content-type": "application/json"}


@pytest.mark.parametrize(
    ("method", "path", "headers", "status"),
    [
        ("GET", "/", OWN, 200),
        ("GET", "/", {"host": "evil.example"}, 403),
        ("GET", "/graphql?query=mutation", OWN, 403),
        ("POST", "/graphql", OWN | JSON, 200),
        ("POST", "/graphql", OWN | {"content-type": "text/plain"}, 403),
        ("POST", "/graphql", OWN | JSON | {"origin": "http://evil.example"}, 403),
        ("POST", "/graphql", JSON | {"host": "127.0.0.1:3000"}, 403),
    ],
)
def test_only_the_pages_own_requests_are_answered(method, path, headers, status):
    path, _, query = path.partition("?")
    scope = {
        "type": "http",
        "method": method,
        "path": path,
        "query_string": query.encode(),
        "headers": [(name.encode(), value.encode()) for name, value in headers.items()],
    }
    sent = []

    async def send(message):
        sent.append(message)

    asyncio.run(Guard(PlainTextResponse("ok"), "127.0.0.1")(scope, None, send))
    assert sent[0]["status"] == status
